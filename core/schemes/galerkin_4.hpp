// galerkin_4: the variational integrator of a quadratic path through q₀, b, q₁ and Simpson's rule,
//   L_d = extremum over b of (h/6)(L(q₀,v₀,t) + 4 L(b,v_m,t+h/2) + L(q₁,v₁,t+h)),
// v₀ = (4b−3q₀−q₁)/h, v_m = (q₁−q₀)/h, v₁ = (q₀+3q₁−4b)/h; implicit, for any kinetic metric, derivatives of the
// Lagrangian by automatic differentiation. Order 4, symmetric, symplectic; momenta of symmetries are kept. Solved for
// velocities, so that a step of any size and sign, also 0, is well posed. Linearly stable for ωh < 2√2. It assumes that
// Newton's method converges from a guess of constant acceleration; where it does not the step fails by name. Sources:
// Marsden & West, Acta Numerica 10, 357 (2001), 2.6; Hairer, Lubich, Wanner 2006, VI.6.
#pragma once

#include <tuple>

#include "core/newton.hpp"
#include "core/scheme.hpp"
#include "core/schemes/simpson_step.hpp"

namespace least {

/// For metrics that depend on the place; where they are constant SimpsonStepper makes the same steps.
template <Conservative P, class X>
class Galerkin4Stepper {
 public:
  using T = typename X::Number;
  using S = typename X::Time;
  static constexpr std::size_t n = P::dof;

  explicit Galerkin4Stepper(const P& problem) : problem_(problem) {}

  /// Unknowns u = (b − q₀)/h and w = (q₁ − q₀)/h; velocities at the nodes v₀ = 4u − w, v_m = w, v₁ = 3w − 4u. With π =
  /// g v:
  ///   ∂/∂b:   π₀ − π₁ + h L_q(b, v_m) = 0,    −∂/∂q₀ = p₀:   (3π₀ + 4π_m − π₁ − h L_q(q₀, v₀))/6 = p₀.
  StepStatus step(X& x, const S& h) noexcept {
    Vec<2 * P::dof, T> z;
    if (const StepStatus status = solve(x, h, z); status != StepStatus::ok) return status;
    const Path path(*this, x, h, z);
    work_.forces += 3;
    // p₁ = ∂/∂q₁, written as p₀ and an increment that vanishes with h.
    for (std::size_t i = 0; i < n; ++i) {
      x.q[i] = x.q[i] + h * z[n + i];
      x.p[i] = x.p[i] + (h / 6) * (path.f0[i] + 4.0 * path.fm[i] + path.f1[i]);
    }
    return StepStatus::ok;
  }
  const Work& work() const { return work_; }

  /// E_d of the step from x; NaN where the step fails.
  T energy(const X& x, const S& h) noexcept {
    Vec<2 * P::dof, T> z;
    if (solve(x, h, z) != StepStatus::ok) return T(std::numeric_limits<double>::quiet_NaN());
    const Path path(*this, x, h, z);
    const auto at = [&](const auto& pi, const T& u, const T& w, const auto& q, const S& t) {
      Vec<P::dof, T> v;
      for (std::size_t i = 0; i < n; ++i) v[i] = u * z[i] + w * z[n + i];
      return T(0.5 * dot(v, pi) + problem_.potential(q, phase(problem_, t)));
    };
    auto middle = x.q, end = x.q;
    for (std::size_t i = 0; i < n; ++i) {
      middle[i] = x.q[i] + h * z[i];
      end[i] = x.q[i] + h * z[n + i];
    }
    return (at(path.pi0, T(4), T(-1), x.q, x.t) + 4.0 * at(path.pim, T(0), T(1), middle, x.t + h / 2) +
            at(path.pi1, T(-4), T(3), end, x.t + h)) /
           6.0;
  }

 private:
  StepStatus solve(const X& x, const S& h, Vec<2 * P::dof, T>& z) noexcept {
    using least::abs;
    const auto residual = [&](const auto& trial) {
      const Path path(*this, x, h, trial);
      auto r = trial;
      for (std::size_t i = 0; i < n; ++i) {
        r[i] = path.pi0[i] - path.pi1[i] + h * path.fm[i];
        r[n + i] = 3.0 * path.pi0[i] + 4.0 * path.pim[i] - path.pi1[i] - h * path.f0[i] - 6.0 * x.p[i];
      }
      return r;
    };
    // Guess: constant acceleration over the step.
    const Vec<P::dof, T> v = velocity(problem_, x.q, x.p);
    Vec<P::dof, T> p = x.p;
    const auto kick = lagrangian_force(problem_, x.q, v, phase(problem_, x.t));
    ++work_.forces;
    for (std::size_t i = 0; i < n; ++i) p[i] = p[i] + (h / 2) * kick[i];
    const auto mean = velocity(problem_, x.q, p);
    T scale(0);
    for (std::size_t i = 0; i < n; ++i) {
      z[i] = (v[i] + mean[i]) / 4.0;
      z[n + i] = mean[i];
      scale = scale + abs(v[i]) + abs(mean[i]);
    }
    return newton<2 * P::dof>(z, unknowns_of<2 * P::dof, P::dof>(problem_), scale, grain_of(x.q, h), residual, 3,
                              work_);
  }

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
      f0 = lagrangian_force(m, q0, v0, phase(m, x.t));
      fm = lagrangian_force(m, b, vm, phase(m, x.t + h / 2));
      f1 = lagrangian_force(m, q1, v1, phase(m, x.t + h));
    }
  };
  template <class U>
  Path(const Galerkin4Stepper&, const X&, const S&, const std::array<U, 2 * n>&) -> Path<U>;

  P problem_;
  Work work_;
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
        .needs = "a Lagrangian without s: a kinetic metric and a potential",
        .references = {"Marsden, West, Acta Numerica 10, 357 (2001), 2.6", "Hairer, Lubich, Wanner 2006, VI.6.2"}};
  }
  template <Conservative P, class X>
  auto bind(const P& problem, const X& x) const {
    return Composed<decltype(stepper(problem, x)), typename X::Time>(stepper(problem, x), composition);
  }
  template <Conservative P, class X>
  auto step_energy(const P& problem, const X& a, const X&, const typename X::Time& h) const {
    return stepper(problem, a).energy(a, h);
  }

 private:
  template <Conservative P, class X>
  static auto stepper(const P& problem, [[maybe_unused]] const X& x) {
    if constexpr (ConfigurationMetric<P>) {
      return Galerkin4Stepper<P, X>(problem);
    } else {
      return SimpsonStepper<P, X>(problem, x);
    }
  }
};

}  // namespace least
