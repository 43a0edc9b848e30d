// Implicit variational integrators: discrete Euler–Lagrange equations p₀ = −D₁L_d, p₁ = D₂L_d of a discrete Lagrangian,
// for any kinetic metric; derivatives of the Lagrangian by automatic differentiation.
//   variational_midpoint  L_d = h L((q₀+q₁)/2, (q₁−q₀)/h)                                         order 2
//   galerkin_4            L_d = extremum over b of (h/6)(L(q₀,v₀) + 4 L(b,v_m) + L(q₁,v₁)), the quadratic path through
//                         q₀, b, q₁ and Simpson's rule                                            order 4
// Both symmetric and symplectic; momenta of symmetries are kept. They are solved for velocities, q₁ = q₀ + h v, so that
// a step of any size and sign, also 0, is well posed. They assume that Newton's method converges from an explicit
// half-step; where it does not (ωh of order 1 on strongly curved potentials) the step fails by name. Look-alikes: for a
// constant metric variational_midpoint is the implicit midpoint rule; explicit_midpoint is not related. Sources:
// Marsden & West, Acta Numerica 10, 357 (2001), 2.3.1 and 2.6; Hairer, Lubich, Wanner 2006, VI.6.
#pragma once

#include <tuple>

#include "core/newton.hpp"
#include "core/scheme.hpp"

namespace least {

template <Lagrangian P, class X>
class MidpointStepper {
 public:
  using T = typename X::Number;
  using S = typename X::Time;
  static constexpr int n = P::dof;

  explicit MidpointStepper(const P& problem) : problem_(problem) {}

  /// Solves g(m) v − (h/2) L_q(m, v) = p₀ with m = q₀ + h v/2.
  Status step(X& x, const S& h) noexcept {
    using least::abs;
    const S half = h / 2, middle = x.t + half;
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
    if (const Status status = newton<n>(v, scale, residual, 1, work_); status != Status::ok) return status;
    const auto force = lagrangian_force(problem_, at(v), v, middle);
    ++work_.forces;
    for (std::size_t i = 0; i < n; ++i) {
      x.q[i] = x.q[i] + h * v[i];
      x.p[i] = x.p[i] + h * force[i];
    }
    return Status::ok;
  }
  const Work& work() const { return work_; }

 private:
  P problem_;
  Work work_;
};

template <Lagrangian P, class X>
class Galerkin4Stepper {
 public:
  using T = typename X::Number;
  using S = typename X::Time;
  static constexpr std::size_t n = P::dof;

  explicit Galerkin4Stepper(const P& problem) : problem_(problem) {}

  /// Unknowns u = (b − q₀)/h and w = (q₁ − q₀)/h; velocities at the nodes v₀ = 4u − w, v_m = w, v₁ = 3w − 4u. With π =
  /// g v:
  ///   ∂/∂b:   π₀ − π₁ + h L_q(b, v_m) = 0,    −∂/∂q₀ = p₀:   (3π₀ + 4π_m − π₁ − h L_q(q₀, v₀))/6 = p₀.
  Status step(X& x, const S& h) noexcept {
    using least::abs;
    const auto residual = [&](const auto& z) {
      const Path path(*this, x, h, z);
      auto r = z;
      for (std::size_t i = 0; i < n; ++i) {
        r[i] = path.pi0[i] - path.pi1[i] + h * path.fm[i];
        r[n + i] = 3.0 * path.pi0[i] + 4.0 * path.pim[i] - path.pi1[i] - h * path.f0[i] - 6.0 * x.p[i];
      }
      return r;
    };
    // Guess: constant acceleration over the step.
    const Vec<P::dof, T> v = velocity(problem_, x.q, x.p);
    Vec<P::dof, T> p = x.p;
    const auto kick = lagrangian_force(problem_, x.q, v, x.t);
    ++work_.forces;
    for (std::size_t i = 0; i < n; ++i) p[i] = p[i] + (h / 2) * kick[i];
    const auto mean = velocity(problem_, x.q, p);
    Vec<2 * P::dof, T> z;
    T scale(0);
    for (std::size_t i = 0; i < n; ++i) {
      z[i] = (v[i] + mean[i]) / 4.0;
      z[n + i] = mean[i];
      scale = scale + abs(v[i]) + abs(mean[i]);
    }
    if (const Status status = newton<2 * P::dof>(z, scale, residual, 3, work_); status != Status::ok) return status;
    const Path path(*this, x, h, z);
    work_.forces += 3;
    // p₁ = ∂/∂q₁, written as p₀ and an increment that vanishes with h.
    for (std::size_t i = 0; i < n; ++i) {
      x.q[i] = x.q[i] + h * z[n + i];
      x.p[i] = x.p[i] + (h / 6) * (path.f0[i] + 4.0 * path.fm[i] + path.f1[i]);
    }
    return Status::ok;
  }
  const Work& work() const { return work_; }

 private:
  /// Momenta g v and forces L_q at the three nodes, in the number U of the unknowns.
  template <class U>
  struct Path {
    Vec<P::dof, U> pi0, pim, pi1, f0, fm, f1;
    Path(const Galerkin4Stepper& self, const X& x, const S& h, const Vec<2 * P::dof, U>& z) {
      Vec<P::dof, U> q0, b, q1, v0, vm, v1;
      for (std::size_t i = 0; i < n; ++i) {
        const U &u = z[i], &w = z[n + i];
        q0[i] = U(x.q[i]);
        b[i] = x.q[i] + h * u;
        q1[i] = x.q[i] + h * w;
        v0[i] = 4.0 * u - w;
        vm[i] = w;
        v1[i] = 3.0 * w - 4.0 * u;
      }
      const P& m = self.problem_;
      pi0 = momentum(m, q0, v0);
      pim = momentum(m, b, vm);
      pi1 = momentum(m, q1, v1);
      f0 = lagrangian_force(m, q0, v0, x.t);
      fm = lagrangian_force(m, b, vm, x.t + h / 2);
      f1 = lagrangian_force(m, q1, v1, x.t + h);
    }
  };
  template <class U>
  Path(const Galerkin4Stepper&, const X&, const S&, const std::array<U, 2 * n>&) -> Path<U>;

  P problem_;
  Work work_;
};

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
            .needs = "a Lagrangian: a kinetic metric and a potential",
            .references = {"Marsden, West, Acta Numerica 10, 357 (2001), 2.3.1"}};
  }
  template <Lagrangian P, class X>
  auto bind(const P& problem, const X&) const {
    using Stepper = MidpointStepper<P, X>;
    return Composed<Stepper, typename X::Time>(Stepper(problem), composition);
  }
};

struct Galerkin4 {
  double step = 0.01;
  Composition composition = Composition::none;
  static constexpr std::tuple fields{step_field<Galerkin4>(), composition_field<Galerkin4>()};
  static SchemeCard card() {
    return {
        .id = "galerkin_4",
        .title = "Galerkin 4",
        .summary = "The variational integrator of a quadratic path and Simpson's rule: order 4 in one implicit solve.",
        .orders = orders_from(4),
        .implicit = true,
        .symmetric = true,
        .structure = "symplectic",
        .recommended = "none",
        .good_for = "kinetic metrics that depend on the configuration at order 4, without negative substeps",
        .fails_when = "Newton's method finds no solution, or ωh > 2√2",
        .needs = "a Lagrangian: a kinetic metric and a potential",
        .references = {"Marsden, West, Acta Numerica 10, 357 (2001), 2.6", "Hairer, Lubich, Wanner 2006, VI.6.2"}};
  }
  template <Lagrangian P, class X>
  auto bind(const P& problem, const X&) const {
    using Stepper = Galerkin4Stepper<P, X>;
    return Composed<Stepper, typename X::Time>(Stepper(problem), composition);
  }
};

}  // namespace least
