// The Kepler problem with a drag that changes its sign in time, H = p²/2 + α sin(Ωt) s + γ/r.
#pragma once

#include <tuple>

#include "core/describe.hpp"
#include "core/problem.hpp"

namespace least::problems {

template <class R = double>
struct PerturbedKepler {
  R gamma{-1}, alpha{0.01}, frequency{3.141592653589793};

  static constexpr int dof = 2;

  template <class T, class S>
  constexpr T potential(const Vec<2, T>& q, const S&) const {
    using least::sqrt;
    return gamma / sqrt(dot(q, q));
  }
  template <class T, class S>
  constexpr Vec<2, T> gradient(const Vec<2, T>& q, const S&) const {
    using least::sqrt;
    const T r2 = dot(q, q), w = gamma / (r2 * sqrt(r2));
    return {-(w * q[0]), -(w * q[1])};
  }
  template <class S>
  constexpr auto damping(const S& t) const {
    using least::sin;
    return alpha * sin(frequency * t);
  }
  constexpr R gravitational_parameter() const { return -gamma; }
  /// (2α/Ω) sin² Ωt/2; 0 where Ω = 0.
  template <class S>
  constexpr auto damping_integral(const S& t) const {
    using least::either;
    using least::sin;
    const auto sine = sin(0.5 * frequency * t);
    const auto twice = 2.0 * alpha * (sine * sine);
    using N = std::remove_const_t<decltype(twice)>;
    return either(
        frequency > 0, [&] { return N(twice / frequency); }, [&] { return twice; });
  }
  /// Steps with ωh above this value cause a warning: periapsis passages lose accuracy long before stability.
  static constexpr double careful_step = 0.3;
  /// |γ|/r³, the squared angular velocity of a circular orbit with this radius.
  template <class T>
  constexpr T frequency_squared(const Vec<2, T>& q) const {
    using least::abs;
    using least::sqrt;
    const T r2 = dot(q, q);
    return abs(gamma) / (r2 * sqrt(r2));
  }
};

}  // namespace least::problems

namespace least {

template <>
struct About<problems::PerturbedKepler> {
  using P = problems::PerturbedKepler<>;
  static constexpr std::tuple fields{
      Field<P>{"gamma", "γ", "length³/time²", "strength of the centre; below 0 it attracts", &P::gamma,
               any_signed_strength},
      Field<P>{"alpha", "α", "1/time", "amplitude of the drag", &P::alpha, any_signed_strength},
      Field<P>{"frequency", "Ω", "1/time", "angular frequency of the drag", &P::frequency, {0, 1e150}},
  };
  static ProblemCard card() {
    return {
        .id = "perturbed_kepler",
        .title = "Kepler problem with periodic drag",
        .summary =
            "A planet in a medium that brakes and pushes it by turns. Watch the ellipse breathe: a good scheme "
            "shows the drag and adds no precession of its own.",
        .formula =
            "<math><mi>H</mi><mo>=</mo><mfrac><msup><mi>p</mi><mn>2</mn></msup><mn>2</mn></mfrac><mo>+</mo>"
            "<mi>α</mi><mi>sin</mi><mrow><mo>(</mo><mi>Ω</mi><mi>t</mi><mo>)</mo></mrow><mi>s</mi><mo>+</mo>"
            "<mfrac><mi>γ</mi><mi>r</mi></mfrac></math>",
        .variables = {{"x", "x", "length", "position", 0.5},
                      {"y", "y", "length", "position", 0},
                      {"px", "pₓ", "length/time", "velocity along x", 0},
                      {"py", "p_y", "length/time", "velocity along y", 1.7320508075688772},
                      {"s", "s", "length²/time", "action", 0, true}},
        .span = 50,
        .suggested = {{"step", 0.02}, {"sigma", 0.03}, {"critical_kinetic_energy", 0.5}},
        .presets = {{"circular",
                     "starts on a circle, the friction changes twice in 2 time units",
                     {{"alpha", 0.01}, {"frequency", 3.141592653589793}},
                     {{"x", 1}, {"y", 0}, {"px", 0}, {"py", 1}}},
                    {"eccentric_half",
                     "e = 0.5 and the same friction",
                     {{"alpha", 0.01}, {"frequency", 3.141592653589793}},
                     {{"x", 0.5}, {"y", 0}, {"px", 0}, {"py", 1.7320508075688772}}},
                    {"eccentric_nine_tenths",
                     "e = 0.9: fast for a short time only, for steps that follow the motion",
                     {{"alpha", 0.01}, {"frequency", 3.141592653589793}},
                     {{"x", 0.1}, {"y", 0}, {"px", 0}, {"py", 4.358898943540674}},
                     {{"step", 0.001}}},
                    {"eccentric_fifth_fast",
                     "e = 0.2, friction of period 1",
                     {{"alpha", 0.01}, {"frequency", 6.283185307179586}},
                     {{"x", 0.8}, {"y", 0}, {"px", 0}, {"py", 1.224744871391589}}},
                    {"eccentric_half_fast",
                     "e = 0.5, friction of period 1",
                     {{"alpha", 0.01}, {"frequency", 6.283185307179586}},
                     {{"x", 0.5}, {"y", 0}, {"px", 0}, {"py", 1.7320508075688772}}},
                    {"strong_fast",
                     "e = 0.4, friction of period 1 that first pushes, seven times as strong",
                     {{"alpha", -0.07}, {"frequency", 6.283185307179586}},
                     {{"x", 0.6}, {"y", 0}, {"px", 0}, {"py", 1.5275252316519468}}},
                    {"weak_push",
                     "e = 0.4, weak friction that first pushes",
                     {{"alpha", -0.01}, {"frequency", 3.141592653589793}},
                     {{"x", 0.6}, {"y", 0}, {"px", 0}, {"py", 1.5275252316519468}}}},
        .references = {"Bravetti, Seri, Vermeeren, Zadra, Numerical integration in celestial mechanics: a case for "
                       "contact geometry, Cel. Mech. Dyn. Astr. 132, 7 (2020)"},
    };
  }
};

}  // namespace least
