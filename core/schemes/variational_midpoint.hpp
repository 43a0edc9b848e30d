// variational_midpoint: the discrete Euler–Lagrange equations p₀ = −D₁L_d, p₁ = D₂L_d of L_d = h L((q₀+q₁)/2,
// (q₁−q₀)/h, t + h/2), for any kinetic metric; derivatives of the Lagrangian by automatic differentiation. Order 2,
// symmetric, symplectic; momenta of symmetries are kept. Solved for the velocity, q₁ = q₀ + h v, so that a step of any
// size and sign, also 0, is well posed. It assumes that Newton's method converges from an explicit half-step; where it
// does not (ωh of order 1 on strongly curved potentials) the step fails by name. It cannot check that the solution
// found is the one near the motion. Look-alikes: for a constant metric this is the implicit midpoint rule;
// explicit_midpoint is not related. Source: Marsden & West, Acta Numerica 10, 357 (2001), 2.3.1.
#pragma once

#include <tuple>

#include "core/newton.hpp"
#include "core/scheme.hpp"

namespace least {

template <Conservative P, class X>
class MidpointStepper {
 public:
  using T = typename X::Number;
  using S = typename X::Time;
  static constexpr int n = P::dof;

  explicit MidpointStepper(const P& problem) : problem_(problem) {}

  /// Solves g(m) v − (h/2) L_q(m, v) = p₀ with m = q₀ + h v/2.
  StepStatus step(X& x, const S& h) noexcept {
    using least::abs;
    const S half = h / 2;
    const auto middle = phase(problem_, x.t + half);
    const auto at = [&](const auto& v) {  // the midpoint, in the number of v
      auto m = v;
      for (std::size_t i = 0; i < n; ++i) m[i] = x.q[i] + half * v[i];
      return m;
    };
    const auto residual = [&](const auto& v) {
      const auto m = at(v);
      const auto force = lagrangian_force(problem_, m, v, middle);
      auto r = momentum(problem_, m, v);
      for (std::size_t i = 0; i < n; ++i) r[i] = r[i] - half * force[i] - x.p[i];
      return r;
    };
    Vec<n, T> v = velocity(problem_, x.q, x.p);
    T scale(0);
    for (const T& c : v) scale = scale + abs(c);
    Vec<n, T> p = x.p;
    const auto kick = lagrangian_force(problem_, at(v), v, middle);
    for (std::size_t i = 0; i < n; ++i) p[i] = p[i] + half * kick[i];
    v = velocity(problem_, at(v), p);
    for (const T& c : v) scale = scale + abs(c);

    ++work_.forces;
    if (const StepStatus status =
            newton<n>(v, unknowns_of<n, n>(problem_), scale, grain_of(x.q, h), residual, 1, work_);
        status != StepStatus::ok)
      return status;
    const auto force = lagrangian_force(problem_, at(v), v, middle);
    ++work_.forces;
    for (std::size_t i = 0; i < n; ++i) {
      x.q[i] = x.q[i] + h * v[i];
      x.p[i] = x.p[i] + h * force[i];
    }
    return StepStatus::ok;
  }
  const Work& work() const { return work_; }

 private:
  P problem_;
  Work work_;
};

/// E_d = −∂L_d/∂h of such a step of length h from a to b: p₀ and p₁ lie as far below as above the momentum ḡv in the
/// middle, which loses no digits where (q₁ − q₀)/h would.
template <Conservative P, class X>
typename X::Number midpoint_energy(const P& problem, const X& a, const X& b, const typename X::Time& h) {
  auto q = a.q, p = a.p;
  for (std::size_t i = 0; i < q.size(); ++i) {
    q[i] = 0.5 * (a.q[i] + b.q[i]);
    p[i] = 0.5 * (a.p[i] + b.p[i]);
  }
  return mechanical_energy(problem, q, p, phase(problem, a.t + h / 2));
}

struct VariationalMidpoint {
  double step = 0.01;
  Composition composition = Composition::none;
  static constexpr std::tuple fields{step_field<VariationalMidpoint>(), composition_field<VariationalMidpoint>()};
  static SchemeCard card() {
    return {.id = "variational_midpoint",
            .title = "Variational midpoint",
            .summary = "The variational integrator of the midpoint rule, implicit, for any kinetic metric.",
            .orders = orders_from(2),
            .implicit = true,
            .symmetric = true,
            .structure = "symplectic",
            .recommended = "kahan_li_6",
            .good_for =
                "kinetic metrics that depend on the configuration; steps too long for leapfrog (it has no linear "
                "stability limit)",
            .fails_when = "Newton's method finds no solution: steps longer than the scale of the potential's curvature",
            .needs = "a Lagrangian without s: a kinetic metric and a potential",
            .references = {"Marsden, West, Acta Numerica 10, 357 (2001), 2.3.1"}};
  }
  template <Conservative P, class X>
  auto bind(const P& problem, const X&) const {
    using Stepper = MidpointStepper<P, X>;
    return Composed<Stepper, typename X::Time>(Stepper(problem), composition);
  }
  template <Conservative P, class X>
  auto step_energy(const P& problem, const X& a, const X& b, const typename X::Time& h) const {
    return midpoint_energy(problem, a, b, h);
  }
};

}  // namespace least
