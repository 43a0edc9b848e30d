// The Kepler problem in the plane, H = p²/2 − μ/r, in units of the reduced mass.
#pragma once

#include <tuple>

#include "core/describe.hpp"
#include "core/exact/two_body.hpp"
#include "core/problem.hpp"

namespace least::problems {

template <class R = double>
struct Kepler {
  R mu{1};

  static constexpr int dof = 2;

  template <class T, class S>
  constexpr T potential(const Vec<2, T>& q, const S&) const {
    using least::sqrt;
    return -mu / sqrt(dot(q, q));
  }
  template <class T, class S>
  constexpr Vec<2, T> gradient(const Vec<2, T>& q, const S&) const {
    const T w = frequency_squared(q);
    return {w * q[0], w * q[1]};
  }
  /// factor · ∇ ln(−V), without the root that V needs.
  template <class T>
  constexpr Vec<2, T> log_gradient(const Vec<2, T>& q, const T& factor) const {
    const T c = -factor / dot(q, q);
    return {c * q[0], c * q[1]};
  }
  constexpr R gravitational_parameter() const { return mu; }
  /// Steps with ωh above this value cause a warning: periapsis passages lose accuracy long before stability.
  static constexpr double careful_step = 0.3;
  /// μ/r³, the squared angular velocity of a circular orbit with this radius.
  template <class T>
  constexpr T frequency_squared(const Vec<2, T>& q) const {
    using least::sqrt;
    const T r2 = dot(q, q);
    return mu / (r2 * sqrt(r2));
  }

  /// Angular momentum L = x p_y − y p_x and the Laplace–Runge–Lenz vector (p_y L, −p_x L) − μ q/r, which points to the
  /// periapsis and has length μe.
  template <class T, class S>
  constexpr Vec<3, T> invariants(const Vec<2, T>& q, const Vec<2, T>& p, const S&) const {
    using least::sqrt;
    const T l = q[0] * p[1] - q[1] * p[0], w = mu / sqrt(dot(q, q));
    return {l, p[1] * l - w * q[0], -(p[0] * l) - w * q[1]};
  }

  template <class T, class S>
  State<2, T, S> exact(const State<2, T, S>& x0, const S& t) const {
    return two_body::propagate(x0, T(mu), t);
  }
};

}  // namespace least::problems

namespace least {

template <>
struct About<problems::Kepler> {
  using P = problems::Kepler<>;
  static constexpr std::tuple fields{
      Field<P>{"mu", "μ", "length³/time²", "gravitational parameter", &P::mu, any_strength},
  };
  static ProblemCard card() {
    return {
        .id = "kepler",
        .title = "Kepler problem",
        .summary =
            "A planet around the sun. The default start is the eccentric orbit (e = 0.96) of Nair, Ober-Blöbaum "
            "and Marsden, whose ellipse a fixed-step scheme makes precess.",
        .formula =
            "<math><mi>H</mi><mo>=</mo><mfrac><msup><mi>p</mi><mn>2</mn></msup><mn>2</mn></mfrac><mo>−</mo>"
            "<mfrac><mi>μ</mi><mi>r</mi></mfrac></math>",
        .variables = {{"x", "x", "length", "position", 0},
                      {"y", "y", "length", "position", -4},
                      {"px", "pₓ", "length/time", "velocity along x", -0.1},
                      {"py", "p_y", "length/time", "velocity along y", -0.1}},
        .span = 40,
        .suggested = {{"step", 0.01}, {"theta", 0.01}, {"critical_kinetic_energy", 0.75}, {"sigma", 0.02}},
        .invariants = {{"angular_momentum", "L", "angular momentum about the centre"},
                       {"laplace_runge_lenz_x", "A_x", "Laplace–Runge–Lenz vector along x"},
                       {"laplace_runge_lenz_y", "A_y", "Laplace–Runge–Lenz vector along y"}},
        .references =
            {"Nair, Ober-Blöbaum, Marsden, The Jacobi–Maupertuis principle in variational integrators, 2009, Fig. 1",
             "Goldstein, Poole, Safko, Classical Mechanics, 2002, chapter 3"},
    };
  }
};

}  // namespace least
