// The spin of a moon on an eccentric orbit, q̈ + (c + Ċ/C) q̇ + (ε/C) Σ W_k(e) sin(2q − kt) = μ, C = 1 + λ cos(ot). W_k
// are Hansen coefficients, from Cayley's series up to e⁷ for k = −5 … 9: valid for e ≤ 0.1, to 1e-8 at e = .05.
#pragma once

#include <array>
#include <string_view>
#include <tuple>

#include "core/describe.hpp"
#include "core/problem.hpp"

namespace least::problems {

template <class R = double>
struct SpinOrbit {
  R eccentricity{0.01}, epsilon{0.0075}, lambda{0.001}, frequency{1}, friction{0}, torque{0};

  static constexpr int dof = 1;

  /// (ε/C) Σ W_k cos kt, (ε/C) Σ W_k sin kt and the friction c + Ċ/C.
  template <class N>
  struct Phase {
    N a, b, alpha;
  };
  template <class S>
  constexpr auto phases(const S& t) const {
    using least::sincos;
    const auto angle = frequency * t;
    using N = std::decay_t<decltype(angle)>;
    const auto [s, c] = sincos(angle);
    const N shape = 1.0 + lambda * c;
    const auto [even, odd] = harmonics<N>();
    const auto [s1, c1] = sincos(t);
    N a = even[0] * c1, b = odd[0] * s1;
    auto sk = s1, ck = c1;
    for (std::size_t k = 1; k < even.size(); ++k) {
      const auto next = sk * c1 + ck * s1;
      ck = ck * c1 - sk * s1;
      sk = next;
      a += even[k] * ck;
      b += odd[k] * sk;
    }
    const N strength = epsilon / shape;
    return Phase<N>{strength * a, strength * b, friction - lambda * (frequency * s) / shape};
  }
  /// W_k + W_{−k} and W_k − W_{−k} for k = 1 … 9.
  template <class N>
  constexpr std::array<Vec<9, N>, 2> harmonics() const {
    const auto ratio = [](int a, int b) { return N(a) / N(b); };
    const N e(eccentricity), e2 = e * e, e3 = e * e2, e4 = e2 * e2, e5 = e2 * e3;
    const Vec<9, N> w{e * (ratio(-1, 2) + e2 * (ratio(1, 16) - e2 * (ratio(5, 384) + e2 * ratio(143, 18432)))),
                      1.0 - e2 * (ratio(5, 2) - e2 * (ratio(13, 16) - e2 * ratio(35, 288))),
                      e * (ratio(7, 2) - e2 * (ratio(123, 16) - e2 * (ratio(489, 128) - e2 * ratio(1763, 2048)))),
                      e2 * (ratio(17, 2) - e2 * (ratio(115, 6) - e2 * ratio(601, 48))),
                      e3 * (ratio(845, 48) - e2 * (ratio(32525, 768) - e2 * ratio(208225, 6144))),
                      e4 * (ratio(533, 16) - e2 * ratio(13827, 160)),
                      e5 * (ratio(228347, 3840) - e2 * ratio(3071075, 18432)),
                      e3 * e3 * ratio(73369, 720),
                      e3 * e4 * ratio(12144273, 71680)};
    const Vec<5, N> v{e3 * (ratio(1, 48) + e2 * (ratio(11, 768) + e2 * ratio(313, 30720))),
                      e4 * (ratio(1, 24) + e2 * ratio(7, 240)), e5 * (ratio(81, 1280) + e2 * ratio(81, 2048)),
                      e3 * e3 * ratio(4, 45), e3 * e4 * ratio(15625, 129024)};
    std::array<Vec<9, N>, 2> both{w, w};
    for (std::size_t k = 0; k < v.size(); ++k) {
      both[0][k] = w[k] + v[k];
      both[1][k] = w[k] - v[k];
    }
    return both;
  }
  /// The period of the time dependence; 0 where it has none.
  constexpr R period() const {
    using least::abs;
    using least::select;
    const R turn(6.283185307179586);
    R found = select(abs(lambda) > R(0), R(0), turn);
    for (int k = 0; k < 10; ++k) found = select(abs(frequency - k) > R(0), found, turn);
    return found;
  }

  template <class T, class F>
  constexpr T potential(const Vec<1, T>& q, const F& f) const {
    using least::sincos;
    const auto [s, c] = sincos(2.0 * q[0]);
    return -0.5 * (c * f.a + s * f.b) - torque * q[0];
  }
  template <class T, class F>
  constexpr Vec<1, T> gradient(const Vec<1, T>& q, const F& f) const {
    using least::sincos;
    const auto [s, c] = sincos(2.0 * q[0]);
    return {s * f.a - c * f.b - torque};
  }
  template <class F>
  constexpr auto damping(const F& f) const {
    return f.alpha;
  }
  /// ct + ln C
  template <class S>
  constexpr auto damping_integral(const S& t) const {
    using least::cos;
    using least::log;
    return friction * t + log(1.0 + lambda * cos(frequency * t));
  }
  /// An upper bound of ω² to leading order in e.
  template <class T>
  constexpr T frequency_squared(const Vec<1, T>&) const {
    using least::abs;
    return T(2.0 * epsilon / (1.0 - abs(lambda)));
  }
};

}  // namespace least::problems

namespace least {

template <>
struct About<problems::SpinOrbit> {
  using P = problems::SpinOrbit<>;
  static constexpr std::tuple fields{
      Field<P>{"eccentricity", "e", "1", "eccentricity of the orbit", &P::eccentricity, {0, 0.1}},
      Field<P>{"epsilon", "ε", "1", "how far the moon is from round", &P::epsilon, {0, 1e3}},
      Field<P>{"lambda", "λ", "1", "how much its moment of inertia changes", &P::lambda, {-0.99, 0.99}},
      Field<P>{"frequency", "o", "1", "angular frequency of that change", &P::frequency, {0, 1e3}},
      Field<P>{"damping", "c", "1", "tidal friction", &P::friction, {-1e3, 1e3}},
      Field<P>{"torque", "μ", "1", "constant torque", &P::torque, {-1e3, 1e3}},
  };
  static ProblemCard card() {
    return {
        .id = "spin_orbit",
        .title = "Spin–orbit problem",
        .summary =
            "A moon that turns once per revolution, like ours, and sways about it. Look once per period 2π: "
            "islands around the resonance, chaos at their edge and, with friction, capture. Steps that divide 2π "
            "take half the time of others: what depends on time alone is known after one period.",
        .formula =
            "<math><mover><mi>q</mi><mo>¨</mo></mover><mo>+</mo><mrow><mo>(</mo><mi>c</mi><mo>+</mo><mfrac>"
            "<mover><mi>C</mi><mo>˙</mo></mover><mi>C</mi></mfrac><mo>)</mo></mrow><mover><mi>q</mi>"
            "<mo>˙</mo></mover><mo>+</mo><mfrac><mi>ε</mi><mi>C</mi></mfrac><munder><mo>∑</mo><mi>k</mi>"
            "</munder><msub><mi>W</mi><mi>k</mi></msub><mrow><mo>(</mo><mi>e</mi><mo>)</mo></mrow>"
            "<mi>sin</mi><mrow><mo>(</mo><mn>2</mn><mi>q</mi><mo>−</mo><mi>k</mi><mi>t</mi><mo>)</mo></mrow>"
            "<mo>=</mo><mi>μ</mi></math>",
        .variables = {angle("q", "q", "angle of the long axis", 0),
                      {"p", "p", "rad/time", "rate of the spin; 1 is once per revolution", 1},
                      {"s", "s", "1", "action", 0, true}},
        .span = 62.83185307179586,
        .suggested = {{"step", 0.3141592653589793}, {"sigma", 0.5}},
        .presets = {{"resonant_1",
                     "figure and orbit in step, the shape hardly changes",
                     {{"eccentricity", 0.01}, {"epsilon", 0.0075}, {"frequency", 1}, {"lambda", 0.001}},
                     {{"q", 0}, {"p", 1}}},
                    {"resonant_2",
                     "the shape changes by 1 %",
                     {{"eccentricity", 0.01}, {"epsilon", 0.0075}, {"frequency", 1}, {"lambda", 0.01}},
                     {{"q", 0}, {"p", 1}}},
                    {"resonant_3",
                     "the shape changes by 10 %",
                     {{"eccentricity", 0.01}, {"epsilon", 0.0075}, {"frequency", 1}, {"lambda", 0.1}},
                     {{"q", 0}, {"p", 1.029}}},
                    {"resonant_4",
                     "the shape changes by 20 %",
                     {{"eccentricity", 0.01}, {"epsilon", 0.0075}, {"frequency", 1}, {"lambda", 0.2}},
                     {{"q", 0}, {"p", 1}}},
                    {"non_resonant_1",
                     "the shape changes out of step with the orbit, by 1 %",
                     {{"eccentricity", 0.06}, {"epsilon", 0.045}, {"frequency", 1.4142135623730951}, {"lambda", 0.01}},
                     {{"q", 3.141592653589793}, {"p", 1}}},
                    {"non_resonant_2",
                     "the same by 20 %",
                     {{"eccentricity", 0.06}, {"epsilon", 0.045}, {"frequency", 1.4142135623730951}, {"lambda", 0.2}},
                     {{"q", 3.141592653589793}, {"p", 1}}},
                    {"capture",
                     "friction slows a fast spin until it stays near the resonance, from about t = 2670 on",
                     {{"eccentricity", 0.01},
                      {"epsilon", 0.0075},
                      {"frequency", 1},
                      {"lambda", 1e-4},
                      {"damping", 0.001},
                      {"torque", 0.001}},
                     {{"q", 2.7}, {"p", 3}},
                     {},
                     3000}},
        .references =
            {"Gkolias, Efthymiopoulos, Pucacco, Celletti, Hamiltonian formulation of the spin-orbit model with "
             "time-varying non-conservative forces, Commun. Nonlinear Sci. Numer. Simul. 51, 23 (2017)",
             "Bravetti, Seri, Vermeeren, Zadra, Numerical integration in celestial mechanics: a case for "
             "contact geometry, Cel. Mech. Dyn. Astr. 132, 7 (2020)"},
    };
  }
};

}  // namespace least
