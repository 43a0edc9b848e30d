// The Kepler problem in space, H = p²/2 − μ/r, in units of the reduced mass.
#pragma once

#include <tuple>

#include "core/describe.hpp"
#include "core/exact/two_body.hpp"
#include "core/problem.hpp"

namespace least::problems {

template <class R = double>
struct Kepler3d {
  R mu{1};

  static constexpr int dof = 3;

  template <class T, class S>
  constexpr T potential(const Vec<3, T>& q, const S&) const {
    using least::sqrt;
    return -mu / sqrt(dot(q, q));
  }
  template <class T, class S>
  constexpr Vec<3, T> gradient(const Vec<3, T>& q, const S&) const {
    const T w = frequency_squared(q);
    return {w * q[0], w * q[1], w * q[2]};
  }
  /// factor · ∇ ln(−V), without the root that V needs.
  template <class T>
  constexpr Vec<3, T> log_gradient(const Vec<3, T>& q, const T& factor) const {
    const T c = -factor / dot(q, q);
    return {c * q[0], c * q[1], c * q[2]};
  }
  constexpr R gravitational_parameter() const { return mu; }
  /// Steps with ωh above this value cause a warning: periapsis passages lose accuracy long before stability.
  static constexpr double careful_step = 0.3;
  /// μ/r³, the squared angular velocity of a circular orbit with this radius.
  template <class T>
  constexpr T frequency_squared(const Vec<3, T>& q) const {
    using least::sqrt;
    const T r2 = dot(q, q);
    return mu / (r2 * sqrt(r2));
  }

  /// Angular momentum L = q × p, then the Laplace–Runge–Lenz vector p × L − μ q/r: three components each.
  template <class T, class S>
  constexpr Vec<6, T> invariants(const Vec<3, T>& q, const Vec<3, T>& p, const S&) const {
    using least::sqrt;
    const Vec<3, T> l{q[1] * p[2] - q[2] * p[1], q[2] * p[0] - q[0] * p[2], q[0] * p[1] - q[1] * p[0]};
    const T w = mu / sqrt(dot(q, q));
    return {l[0],
            l[1],
            l[2],
            p[1] * l[2] - p[2] * l[1] - w * q[0],
            p[2] * l[0] - p[0] * l[2] - w * q[1],
            p[0] * l[1] - p[1] * l[0] - w * q[2]};
  }

  template <class T, class S>
  State<3, T, S> exact(const State<3, T, S>& x0, const S& t) const {
    return two_body::propagate(x0, T(mu), t);
  }
};

}  // namespace least::problems

namespace least {

template <>
struct About<problems::Kepler3d> {
  using P = problems::Kepler3d<>;
  static constexpr std::tuple fields{
      Field<P>{"mu", "μ", "length³/time²", "gravitational parameter", &P::mu, any_strength},
  };
  static ProblemCard card() {
    return {
        .id = "kepler_3d",
        .title = "Kepler problem in space",
        .summary =
            "A body around a fixed centre in three dimensions; the plane of the orbit and the direction of its "
            "periapsis stand still.",
        .formula =
            "<math><mi>H</mi><mo>=</mo><mfrac><msup><mi>p</mi><mn>2</mn></msup><mn>2</mn></mfrac><mo>−</mo>"
            "<mfrac><mi>μ</mi><mi>r</mi></mfrac></math>",
        .variables = {{"x", "x", "length", "position", 1},
                      {"y", "y", "length", "position", 0},
                      {"z", "z", "length", "position", 0},
                      {"px", "pₓ", "length/time", "velocity along x", 0},
                      {"py", "p_y", "length/time", "velocity along y", 1.1},
                      {"pz", "p_z", "length/time", "velocity along z", 0.3}},
        .span = 40,
        .suggested = {{"step", 0.02}, {"theta", 0.02}, {"critical_kinetic_energy", 0.75}, {"sigma", 0.05}},
        .invariants = {{"angular_momentum_x", "L_x", "angular momentum about x"},
                       {"angular_momentum_y", "L_y", "angular momentum about y"},
                       {"angular_momentum_z", "L_z", "angular momentum about z"},
                       {"laplace_runge_lenz_x", "A_x", "Laplace–Runge–Lenz vector along x"},
                       {"laplace_runge_lenz_y", "A_y", "Laplace–Runge–Lenz vector along y"},
                       {"laplace_runge_lenz_z", "A_z", "Laplace–Runge–Lenz vector along z"}},
        .references = {"Goldstein, Poole, Safko, Classical Mechanics, 2002, chapter 3"},
    };
  }
};

}  // namespace least
