// contact_symplectic_euler: the discrete Herglotz principle as first published, s₁ = s₀ + h L(q₀, v, s₀, t₀),
// v = (q₁ − q₀)/h:
//   p₀ = −h D₁L/(1 + h D₃L),  p₁ = h D₂L = L_v,  λ = 1 + h D₃L = 1 − h H_s
// Order 1, not symmetric, a contact map. For a constant metric explicit,
//   g v = (1 − hH_s) p₀ − h ∇V(q₀, t₀), q₁ = q₀ + h v, p₁ = g v
// and symplectic Euler, kick before drift, where nothing depends on s; where the metric depends on the configuration
// p₀ = −D₁L is solved for v by Newton's method. No pole: for αh ≥ 1 it turns the momentum over where the motion only
// damps it, and at αh = 1 it loses it altogether (λ = 0); quadratic in s, λ ≤ 0 is a property of the state and the step
// fails as singular. Look-alike: symplectic Euler with damping as a force −αp is explicit as well, but keeps no form.
// Source: Vermeeren, Bravetti, Seri, J. Phys. A 52, 445206 (2019), section 3.
#pragma once

#include <tuple>

#include "core/newton.hpp"
#include "core/phases.hpp"
#include "core/scheme.hpp"
#include "core/schemes/damping_pole.hpp"

namespace least {

template <Contact P, class X>
class ContactSymplecticEulerStepper {
 public:
  using T = typename X::Number;
  using S = typename X::Time;
  static constexpr std::size_t n = P::dof;

  ContactSymplecticEulerStepper(const P& problem, const X& x, double step)
      : problem_(problem),
        clock_(problem, x.t, step, nodes(), [&](std::size_t, const S& t) { return phase(problem, t); }) {}

  StatusOf<T> step(X& x, const S& h) noexcept {
    clock_.begin(x.t, h);
    const auto f = clock_.at(0, x.t, [&](const auto& t) { return phase(problem_, t); });
    StatusOf<T> status = StepStatus::ok;
    const auto factor = 1 - h * loss(x, f);
    using Factor = std::remove_cvref_t<decltype(factor)>;
    if constexpr (QuadraticContact<P>)
      if (all_failed(status, !(factor > Factor(least_denominator)), StepStatus::singular)) return status;
    X y = x;
    Vec<n, T> v;
    if constexpr (ConfigurationMetric<P>) {
      if (const StepStatus solved = solve(x, h, factor, f, v); solved != StepStatus::ok) return solved;
      y.p = momentum(problem_, x.q, v);
    } else {
      const auto slope = gradient(problem_, x.q, f);
      for (std::size_t i = 0; i < n; ++i) y.p[i] = factor * x.p[i] - h * slope[i];
      v = velocity(problem_, x.q, y.p);
    }
    ++work_.forces;
    for (std::size_t i = 0; i < n; ++i) y.q[i] = x.q[i] + h * v[i];
    if constexpr (X::acting)
      y.action.s =
          x.action.s + h * (0.5 * dot(y.p, v) - problem_.potential(x.q, f) - action_energy(problem_, x.action.s, f));
    take(x, y, succeeded(status));
    return status;
  }
  const Work& work() const { return work_; }
  /// The stepper keeps nothing of the state: a lane that moves to another stepper takes nothing along.
  template <class F>
  void each_kept(F&&) {}

 private:
  using F = decltype(phase(std::declval<const P&>(), std::declval<const S&>()));

  /// A step reads the phase at its beginning alone.
  static std::span<const S> nodes() {
    static const std::array<S, 1> start{S(0)};
    return start;
  }
  /// H_s
  auto loss(const X& x, const F& f) const {
    if constexpr (QuadraticContact<P>) {
      return action_slope(problem_, x.action.s, f);
    } else {
      return damping(problem_, f);
    }
  }
  /// g(q₀)v − h L_q(q₀, v) = λp₀
  template <class Factor>
  StepStatus solve(const X& x, const S& h, const Factor& factor, const F& f, Vec<n, T>& v) {
    using least::abs;
    const auto residual = [&](const auto& w) {
      auto q = w;
      for (std::size_t i = 0; i < n; ++i) q[i] = std::remove_cvref_t<decltype(q[0])>(x.q[i]);
      const auto force = lagrangian_force(problem_, q, w, f);
      auto r = momentum(problem_, q, w);
      for (std::size_t i = 0; i < n; ++i) r[i] = r[i] - h * force[i] - factor * x.p[i];
      return r;
    };
    // Guess: the kick at the velocity that the step begins with.
    v = velocity(problem_, x.q, x.p);
    const auto kick = lagrangian_force(problem_, x.q, v, f);
    ++work_.forces;
    T scale(0);
    Vec<n, T> p;
    for (std::size_t i = 0; i < n; ++i) {
      scale = scale + abs(v[i]);
      p[i] = factor * x.p[i] + h * kick[i];
    }
    v = velocity(problem_, x.q, p);
    for (const T& c : v) scale = scale + abs(c);
    return newton<P::dof>(v, unknowns_of<P::dof, P::dof>(problem_), scale, grain_of(x.q, h), residual, 1, work_);
  }

  P problem_;
  PhaseClock<F, P, S> clock_;
  Work work_;
};

struct ContactSymplecticEuler {
  double step = 0.01;
  static constexpr std::tuple fields{step_field<ContactSymplecticEuler>()};
  static SchemeCard card() {
    return {.id = "contact_symplectic_euler",
            .title = "Contact symplectic Euler",
            .summary =
                "The discrete Herglotz principle as first published, the action read at the start of each step: the "
                "simplest scheme that keeps the contact form. Explicit where the kinetic metric is constant.",
            .orders = {{"", 1}},
            .structure = "contact",
            .good_for = "first lessons, and long runs where the picture counts, not the digits",
            .fails_when =
                "accuracy counts (contact_leapfrog costs the same), (ωh)² ≥ 4 − 2αh, or αh ≥ 1, where it turns the "
                "momentum over",
            .needs = "a Lagrangian that depends on s: a kinetic metric, a potential, and α(t)s or γs²/2",
            .references = {"Vermeeren, Bravetti, Seri, Journal of Physics A 52, 445206 (2019)"}};
  }
  template <Contact P, class X>
  auto bind(const P& problem, const X& x) const {
    return ContactSymplecticEulerStepper<P, X>(problem, x, step);
  }
  template <Contact P, class X>
  requires X::acting auto step_energy(const P& problem, const X& a, const X& b, const typename X::Time&) const {
    const auto f = phase(problem, a.t);
    return mechanical_energy(problem, a.q, b.p, f) + action_energy(problem, a.action.s, f);
  }
  double flips_from() const { return 1; }
};

}  // namespace least
