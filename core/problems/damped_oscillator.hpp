// The damped oscillator, H = p²/2 + k q²/2 + α s: friction as contact geometry, with its exact motion.
#pragma once

#include <tuple>

#include "core/describe.hpp"
#include "core/problem.hpp"

namespace least::problems {

template <class R = double>
struct DampedOscillator {
  R stiffness{1}, alpha{0.1};

  static constexpr int dof = 1;

  template <class T, class S>
  constexpr T potential(const Vec<1, T>& q, const S&) const {
    return 0.5 * stiffness * (q[0] * q[0]);
  }
  template <class T, class S>
  constexpr Vec<1, T> gradient(const Vec<1, T>& q, const S&) const {
    return {stiffness * q[0]};
  }
  constexpr R damping() const { return alpha; }
  template <class T>
  constexpr T frequency_squared(const Vec<1, T>&) const {
    return T(stiffness);
  }

  /// With δ = α/2, C = e^{−δτ} cos ωτ and S = e^{−δτ} sin(ωτ)/ω: q = C q₀ + S (p₀ + δ q₀), p = C p₀ − S (k q₀ + δ p₀).
  /// Overdamped, ω = ir: e^{−(δ−r)τ} is taken out, so that nothing overflows and S is smooth through r = 0.
  template <class T, class S>
  State<1, T, S> exact(const State<1, T, S>& x0, const S& t) const {
    using least::exp;
    using least::phi1;
    using least::sincos;
    using least::sqrt;
    const T k(stiffness), delta = T(alpha) / 2, tau(t - x0.t), excess = k - delta * delta;
    T c, s;
    if (excess > 0) {
      const T omega = sqrt(excess), decay = exp(-delta * tau);
      const auto [sine, cosine] = sincos(omega * tau);
      c = decay * cosine;
      s = decay * sine / omega;
    } else {
      const T r = tau < 0 ? -sqrt(-excess) : sqrt(-excess);
      const T rate = delta * r > 0 ? k / (delta + r) : delta - r;  // δ − r
      const T decay = exp(-rate * tau);
      c = decay * (1 + exp(-2 * r * tau)) / 2;
      s = decay * tau * phi1(T(-2 * r * tau));
    }
    const T q = x0.q[0], p = x0.p[0];
    return {t, {c * q + s * (p + delta * q)}, {c * p - s * (k * q + delta * p)}, {}};
  }
};

}  // namespace least::problems

namespace least {

template <>
struct About<problems::DampedOscillator> {
  using P = problems::DampedOscillator<>;
  static constexpr std::tuple fields{
      Field<P>{"stiffness", "k", "1/time²", "force per displacement and mass", &P::stiffness, {0, 1e150, true}},
      Field<P>{"damping", "α", "1/time", "friction per momentum; below 0 it drives", &P::alpha, any_signed_strength},
  };
  static ProblemCard card() {
    return {
        .id = "damped_oscillator",
        .title = "Damped oscillator",
        .summary =
            "A mass on a spring that loses its energy to friction. Watch how well a scheme keeps the rate "
            "e^{−αt} at which H decays, long after the motion itself has become small.",
        .formula =
            "<math><mi>H</mi><mo>=</mo><mfrac><msup><mi>p</mi><mn>2</mn></msup><mn>2</mn></mfrac><mo>+</mo>"
            "<mfrac><mrow><mi>k</mi><msup><mi>q</mi><mn>2</mn></msup></mrow><mn>2</mn></mfrac><mo>+</mo>"
            "<mi>α</mi><mi>s</mi></math>",
        .variables = {{"q", "q", "length", "displacement from rest", -0.25},
                      {"p", "p", "length/time", "momentum per mass", 0.75},
                      {"s", "s", "length²/time", "action", 0, true}},
        .span = 50,
        .suggested = {{"step", 0.1}, {"sigma", 0.15}},
        .presets = {{"critical", "at the edge between swinging and creeping", {{"damping", 2}}, {}},
                    {"overdamped",
                     "a fast and a slow decay side by side: stiff",
                     {{"damping", 100}},
                     {{"q", 1}, {"p", 0}},
                     {{"step", 0.02}}}},
        .references = {"Vermeeren, Bravetti, Seri, Contact variational integrators, J. Phys. A 52, 445206 (2019)"},
    };
  }
};

}  // namespace least
