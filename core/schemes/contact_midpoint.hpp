// contact_variational_midpoint: the discrete Herglotz principle s₁ = s₀ + h L(m, v, (s₀+s₁)/2, t + h/2), m = (q₀+q₁)/2,
// v = (q₁−q₀)/h, for any kinetic metric:
//   π − (h/2)L_q = (1 + (h/2)L_s) p₀,  p₁ = ((1 + (h/2)L_s) p₀ + h L_q)/(1 − (h/2)L_s),  π = L_v
// Implicit, order 2, symmetric, a contact map with λ = (1 + (h/2)L_s)/(1 − (h/2)L_s). Where L is linear in s, q is
// solved for alone and s never enters a convergence test; without s it is variational_midpoint. No linear stability
// limit. It assumes that Newton's method converges from an explicit half-step; where it does not the step fails by
// name. Source: Vermeeren, Bravetti, Seri, J. Phys. A 52, 445206 (2019), section 3.
#pragma once

#include <tuple>

#include "core/newton.hpp"
#include "core/scheme.hpp"
#include "core/schemes/damping_pole.hpp"

namespace least {

template <Contact P, class X>
class ContactMidpointStepper {
 public:
  using T = typename X::Number;
  using S = typename X::Time;
  static constexpr std::size_t n = P::dof;

  explicit ContactMidpointStepper(const P& problem) : problem_(problem) {}

  /// Unknowns: v, and where the motion reads it σ = (s₁ − s₀)/h.
  StepStatus step(X& x, const S& h) noexcept {
    using least::abs;
    using least::any;
    const S half = h / 2;
    const auto f = phase(problem_, x.t + half);
    const auto at = [&](const auto& z) {  // the midpoint, in the number of z
      using U = std::remove_cvref_t<decltype(z[0])>;
      Vec<P::dof, U> m;
      for (std::size_t i = 0; i < n; ++i) m[i] = x.q[i] + half * z[i];
      return m;
    };
    const auto action = [&](const auto& z) {
      using U = std::remove_cvref_t<decltype(z[0])>;
      if constexpr (QuadraticContact<P>) {
        return U(x.action.s + half * z[n]);
      } else {
        return U(0);
      }
    };
    const auto residual = [&](const auto& z) {
      using U = std::remove_cvref_t<decltype(z[0])>;
      const auto m = at(z);
      const auto v = velocity_of(z);
      const U s = action(z);
      const auto loss = half * action_slope(problem_, s, f);
      const auto force = lagrangian_force(problem_, m, v, f);
      const auto pi = momentum(problem_, m, v);
      auto r = z;
      for (std::size_t i = 0; i < n; ++i) r[i] = pi[i] - half * force[i] - (1 - loss) * x.p[i];
      if constexpr (QuadraticContact<P>)
        r[n] = z[n] - (0.5 * dot(pi, v) - problem_.potential(m, f) - action_energy(problem_, s, f));
      return r;
    };

    // Guess: an explicit half-step.
    const Vec<P::dof, T> rate = velocity(problem_, x.q, x.p);
    Unknowns z{};
    T scale(0);
    for (std::size_t i = 0; i < n; ++i) {
      z[i] = rate[i];
      scale = scale + abs(rate[i]);
    }
    Vec<P::dof, T> p = x.p;
    const auto kick = lagrangian_force(problem_, at(z), rate, f);
    for (std::size_t i = 0; i < n; ++i) p[i] = p[i] + half * kick[i];
    const auto mean = velocity(problem_, at(z), p);
    for (std::size_t i = 0; i < n; ++i) {
      z[i] = mean[i];
      scale = scale + abs(mean[i]);
    }
    if constexpr (QuadraticContact<P>) {
      z[n] = 0.5 * dot(p, mean) - problem_.potential(x.q, f) - action_energy(problem_, x.action.s, f);
      scale = scale + abs(z[n]);
    }
    ++work_.forces;
    T grain = grain_of(x.q, h);
    if constexpr (QuadraticContact<P>) grain = grain + grain_of(Vec<1, T>{x.action.s}, h);
    if (const StepStatus status =
            newton<unknowns>(z, unknowns_of<unknowns, unknowns>(problem_), scale, grain, residual, 1, work_);
        status != StepStatus::ok)
      return status;

    const auto m = at(z);
    const auto v = velocity_of(z);
    const auto loss = half * action_slope(problem_, action(z), f);
    const auto end = 1 + loss;
    if (any(!(end > decltype(end)(least_denominator)))) return StepStatus::singular;
    const auto force = lagrangian_force(problem_, m, v, f);
    ++work_.forces;
    for (std::size_t i = 0; i < n; ++i) {
      x.q[i] = x.q[i] + h * z[i];
      x.p[i] = ((1 - loss) * x.p[i] + h * force[i]) / end;
    }
    if constexpr (QuadraticContact<P>) {
      x.action.s = x.action.s + h * z[n];
    } else if constexpr (X::acting) {
      const T lagrangian = 0.5 * dot(momentum(problem_, m, v), v) - problem_.potential(m, f);
      x.action.s = ((1 - loss) * x.action.s + h * lagrangian) / end;
    }
    return StepStatus::ok;
  }
  const Work& work() const { return work_; }

 private:
  static constexpr int unknowns = int(n) + (QuadraticContact<P> ? 1 : 0);
  using Unknowns = Vec<unknowns, T>;
  template <class Z>
  static auto velocity_of(const Z& z) {
    Vec<P::dof, std::remove_cvref_t<decltype(z[0])>> v;
    for (std::size_t i = 0; i < n; ++i) v[i] = z[i];
    return v;
  }

  P problem_;
  Work work_;
};

struct ContactVariationalMidpoint {
  double step = 0.01;
  Composition composition = Composition::none;
  static constexpr std::tuple fields{step_field<ContactVariationalMidpoint>(),
                                     composition_field<ContactVariationalMidpoint>()};
  static SchemeCard card() {
    return {.id = "contact_variational_midpoint",
            .title = "Contact variational midpoint",
            .summary =
                "The variational integrator of Herglotz' principle and the midpoint rule, implicit, for any "
                "Lagrangian L(q, v, s, t).",
            .orders = orders_from(2),
            .implicit = true,
            .symmetric = true,
            .structure = "contact",
            .recommended = "kahan_li_6",
            .good_for = "steps too long for contact_leapfrog: no linear stability limit",
            .fails_when = "Newton's method finds no solution; αh ≥ 2, where it turns the momentum over",
            .needs =
                "a Lagrangian that depends on s: a kinetic metric, a potential, and α(t)s or γs²/2; or a general "
                "one given as text",
            .references = {"Vermeeren, Bravetti, Seri, Journal of Physics A 52, 445206 (2019)"}};
  }
  template <Contact P, class X>
  auto bind(const P& problem, const X&) const {
    using Stepper = ContactMidpointStepper<P, X>;
    return Composed<Stepper, typename X::Time>(Stepper(problem), composition);
  }
  /// E_d of the step from a to b. With l = (h/2)H_s the momentum in the middle is ½((1 − l) p₀ + (1 + l) p₁).
  template <Contact P, class X>
  requires X::acting auto step_energy(const P& problem, const X& a, const X& b, const typename X::Time& h) const {
    const auto f = phase(problem, a.t + h / 2);
    const auto s = 0.5 * (a.action.s + b.action.s);
    const auto loss = (h / 2) * action_slope(problem, s, f);
    auto q = a.q, p = a.p;
    for (std::size_t i = 0; i < q.size(); ++i) {
      q[i] = 0.5 * (a.q[i] + b.q[i]);
      p[i] = 0.5 * ((1 - loss) * a.p[i] + (1 + loss) * b.p[i]);
    }
    return mechanical_energy(problem, q, p, f) + action_energy(problem, s, f);
  }

  template <class P>
  std::string unsupported_reason(const P& problem) const {
    return unsupported_by_pole(problem, composition, step);
  }
  double flips_from() const { return least::flips_from(composition); }
};

}  // namespace least
