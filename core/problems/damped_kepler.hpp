// The Kepler problem in the plane with a constant drag, H = p²/2 − μ/r + α s: the orbit shrinks and its angular
// momentum decays, L = L₀e^{−αt}.
#pragma once

#include <tuple>

#include "core/describe.hpp"
#include "core/problem.hpp"

namespace least::problems {

template <class R = double>
struct DampedKepler {
  R mu{1}, alpha{0.002};

  static constexpr int dof = 2;

  template <class T, class S>
  constexpr T potential(const Vec<2, T>& q, const S&) const {
    using least::sqrt;
    const T r2 = dot(q, q), r = sqrt(r2);
    return -(mu * (1.0 / r2)) * r;  // this division does not wait for the root
  }
  template <class T, class S>
  constexpr Vec<2, T> gradient(const Vec<2, T>& q, const S&) const {
    const T w = frequency_squared(q);
    return {w * q[0], w * q[1]};
  }
  constexpr R damping() const { return alpha; }
  constexpr R gravitational_parameter() const { return mu; }
  /// Steps with ωh above this value cause a warning: periapsis passages lose accuracy long before stability.
  static constexpr double careful_step = 0.3;
  /// μ/r³, the squared angular velocity of a circular orbit with this radius.
  template <class T>
  constexpr T frequency_squared(const Vec<2, T>& q) const {
    using least::sqrt;
    const T r2 = dot(q, q), r = sqrt(r2), inverse = 1.0 / r2;
    return mu * inverse * (inverse * r);
  }

  /// The drag −αp is parallel to the momentum and the force to the position: L̇ = −αL, so that L e^{αt} is conserved.
  template <class T, class S>
  constexpr Vec<1, T> invariants(const Vec<2, T>& q, const Vec<2, T>& p, const S& t) const {
    using least::exp;
    return {(q[0] * p[1] - q[1] * p[0]) * exp(alpha * t)};
  }
};

}  // namespace least::problems

namespace least {

template <>
struct About<problems::DampedKepler> {
  using P = problems::DampedKepler<>;
  static constexpr std::tuple fields{
      Field<P>{"mu", "μ", "length³/time²", "gravitational parameter", &P::mu, any_strength},
      Field<P>{"alpha", "α", "1/time", "drag per momentum; below 0 it drives", &P::alpha, any_signed_strength},
  };
  static ProblemCard card() {
    return {
        .id = "damped_kepler",
        .title = "Kepler problem with drag",
        .summary =
            "A satellite on an eccentric orbit (e = 0.9) in a thin medium: it sinks, and its angular momentum decays "
            "by e^{−αt} whatever the orbit. The default needs short steps for a short time only.",
        .formula =
            "<math><mi>H</mi><mo>=</mo><mfrac><msup><mi>p</mi><mn>2</mn></msup><mn>2</mn></mfrac><mo>−</mo>"
            "<mfrac><mi>μ</mi><mi>r</mi></mfrac><mo>+</mo><mi>α</mi><mi>s</mi></math>",
        .variables = {{"x", "x", "length", "position", 0.1},
                      {"y", "y", "length", "position", 0},
                      {"px", "pₓ", "length/time", "velocity along x", 0},
                      {"py", "p_y", "length/time", "velocity along y", 4.358898943540674},
                      {"s", "s", "length²/time", "action", 0, true}},
        .span = 60,
        .suggested = {{"step", 0.001}, {"sigma", 0.03}, {"critical_kinetic_energy", 0.5}},
        .presets =
            {{"weak",
              "an orbit of e = 0.5 that loses a tenth of its angular momentum in 16,000 revolutions",
              {{"alpha", 1e-6}},
              {{"x", 0.5}, {"y", 0}, {"px", 0}, {"py", 1.7320508075688772}}},
             {"spiral", "a circle that winds inwards", {{"alpha", 0.02}}, {{"x", 1}, {"y", 0}, {"px", 0}, {"py", 1}}}},
        .invariants = {{"undamped_angular_momentum", "L e^{αt}", "angular momentum freed of its decay"}},
        .references = {"Bravetti, Seri, Vermeeren, Zadra, Numerical integration in celestial mechanics: a case for "
                       "contact geometry, Cel. Mech. Dyn. Astr. 132, 7 (2020)"},
    };
  }
};

}  // namespace least
