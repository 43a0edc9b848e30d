// The harmonic oscillator, H = p²/2m + k q²/2, for which everything is known in closed form.
#pragma once

#include <tuple>

#include "core/describe.hpp"
#include "core/problem.hpp"

namespace least::problems {

template <class R = double>
struct HarmonicOscillator {
  R mass{1}, stiffness{1};

  static constexpr int dof = 1;

  constexpr Vec<1, R> inverse_mass() const { return {1 / mass}; }

  template <class T, class S>
  constexpr T potential(const Vec<1, T>& q, const S&) const {
    return 0.5 * stiffness * (q[0] * q[0]);
  }
  template <class T, class S>
  constexpr Vec<1, T> gradient(const Vec<1, T>& q, const S&) const {
    return {stiffness * q[0]};
  }
  template <class T>
  constexpr T frequency_squared(const Vec<1, T>&) const {
    return T(stiffness / mass);
  }

  /// q = q₀ cos ωt + p₀/(mω) sin ωt with ω = √(k/m)
  template <class T, class S>
  State<1, T, S> exact(const State<1, T, S>& x0, const S& t) const {
    using least::sincos;
    using least::sqrt;
    const T omega = sqrt(T(stiffness) / T(mass));
    const auto [s, c] = sincos(omega * (t - x0.t));
    const T impedance = mass * omega;
    return {t, {c * x0.q[0] + s * x0.p[0] / impedance}, {c * x0.p[0] - s * x0.q[0] * impedance}, {}};
  }
};

}  // namespace least::problems

namespace least {

template <>
struct About<problems::HarmonicOscillator> {
  using P = problems::HarmonicOscillator<>;
  static constexpr std::tuple fields{
      Field<P>{"mass", "m", "mass", "inertia of the body", &P::mass, any_strength},
      Field<P>{"stiffness", "k", "mass/time²", "force per displacement", &P::stiffness, any_strength},
  };
  static ProblemCard card() {
    return {
        .id = "harmonic_oscillator",
        .title = "Harmonic oscillator",
        .summary =
            "A mass on a linear spring. Every scheme's stability limit can be read off it: leapfrog holds up to "
            "ωh = 2.",
        .formula =
            "<math><mi>H</mi><mo>=</mo><mfrac><msup><mi>p</mi><mn>2</mn></msup><mrow><mn>2</mn><mi>m</mi></mrow>"
            "</mfrac><mo>+</mo><mfrac><mrow><mi>k</mi><msup><mi>q</mi><mn>2</mn></msup></mrow><mn>2</mn></mfrac>"
            "</math>",
        .variables = {{"q", "q", "length", "displacement from rest", 1}, {"p", "p", "mass·length/time", "momentum", 0}},
        .span = 20,
        .suggested = {{"step", 0.1}},
        .references = {"Hairer, Lubich, Wanner, Geometric Numerical Integration, 2006, I.1"},
    };
  }
};

}  // namespace least
