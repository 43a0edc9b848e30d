// contact_leapfrog: the discrete Herglotz principle with the trapezoidal rule, s₁ = s₀ + (h/2)(L₀ + L₁), in closed form
// for H = K + V + α(t)s and H = K + V + γs²/2 − R:
//   v = (1 − hα₀/2) p₀ − (h/2)∇V₀,  q₁ = q₀ + h g⁻¹v,  p₁ = (v − (h/2)∇V₁)/(1 + hα₁/2)
// and the same with γs₀, γs₁ in the place of α₀, α₁. Damping and force each at its proper end of the step: published
// code that takes α₀ twice is of order 1. One force a step; order 2, symmetric, a contact map with factor
// λ = (1 − hα₀/2)/(1 + hα₁/2); without damping it is leapfrog, bit for bit. Stable for ωh < 2 at every damping; beyond
// αh = 2 it turns the momentum over, at αh = −2 it has a pole, and so has a negative stage of a composition.
// Sources: Vermeeren, Bravetti, Seri, J. Phys. A 52, 445206 (2019), section 4; Bravetti, Seri, Vermeeren, Zadra,
// Celest. Mech. Dyn. Astron. 132, 7 (2020), section 3.
#pragma once

#include <cmath>
#include <tuple>

#include "core/phases.hpp"
#include "core/scheme.hpp"
#include "core/schemes/damping_pole.hpp"

namespace least {

template <SeparableContact P, class X>
class ContactLeapfrogStepper {
 public:
  using T = typename X::Number;
  using S = typename X::Time;
  static constexpr std::size_t n = P::dof;

  ContactLeapfrogStepper(const P& problem, const X& x, double step, const Weights<S>& weights)
      : problem_(problem),
        weights_(&weights),
        clock_(problem, x.t, step, weights.ends(), [&](std::size_t, const S& t) { return end_of(t); }) {
    const End start = end_of(x.t);
    look(seen_, x.q, start.phase);
    seen_.damping = start.damping;
  }

  StatusOf<T> step(X& x, const S& h) noexcept {
    using least::any;
    if constexpr (ConstantDamping<P>) prepare(h);
    if constexpr (HasSeries<P>)
      if (x.t == S(0)) return regular_step(x, h);
    clock_.begin(x.t, h);
    X y = x;
    ForceAtPosition seen = seen_;
    StatusOf<T> status = StepStatus::ok;
    for (std::size_t i = 0; i < static_cast<std::size_t>(weights_->stages); ++i) {
      const S part = weights_->gamma[i] * h, t = x.t + weights_->end[i] * h;
      status = stage(y, seen, status, part, i, t);
      if (!any(succeeded(status))) return status;
    }
    const auto good = succeeded(status);
    take(x, y, good);
    take(seen_.slope, seen.slope, good);
    seen_.potential = select(good, seen.potential, seen_.potential);
    seen_.damping = seen.damping;
    return status;
  }
  const Work& work() const { return work_; }
  /// Calls f with each number kept that belongs to the state; a lane that moves to another stepper takes these along.
  template <class Each>
  void each_kept(Each&& f) {
    for (T& component : seen_.slope) f(component);
    if constexpr (X::acting) f(seen_.potential);
  }

 private:
  using F = decltype(phase(std::declval<const P&>(), std::declval<const S&>()));
  using A =
      std::remove_cvref_t<decltype(std::declval<S>() * action_slope(std::declval<const P&>(), std::declval<const T&>(),
                                                                    std::declval<const F&>()))>;
  /// What the stepper keeps of the state: ∇V and, where s is carried, V at its q; α at its time.
  struct ForceAtPosition {
    Vec<n, T> slope{};
    T potential{};
    A damping{};
  };
  /// What a stage needs of the time at its end.
  struct End {
    F phase;
    A damping{};
  };
  struct Factors {
    A before{}, after{};  ///< 1 − hα₀/2 and 1/(1 + hα₁/2)
  };

  template <class Time>
  End end_of(const Time& t) const {
    End end{phase(problem_, t), {}};
    if constexpr (LinearContact<P>) end.damping = damping(problem_, end.phase);
    return end;
  }
  void look(ForceAtPosition& seen, const Vec<n, T>& q, const F& f) {
    seen.slope = gradient(problem_, q, f);
    if constexpr (X::acting) seen.potential = problem_.potential(q, f);
    ++work_.forces;
  }
  /// Constant damping: the factors of every stage, once per length of step.
  void prepare(const S& h) {
    if (h == prepared_) return;
    prepared_ = h;
    for (std::size_t i = 0; i < static_cast<std::size_t>(weights_->stages); ++i)
      factors_[i] = factors(weights_->gamma[i] * h, seen_.damping, seen_.damping);
  }
  static Factors factors(const S& h, const A& before, const A& after) {
    const A end = 1 + (h / 2) * after;
    return {1 - (h / 2) * before, select(end > A(least_denominator), A(1 / end), A(unusable))};
  }
  static constexpr double unusable = std::numeric_limits<double>::quiet_NaN();

  StatusOf<T> stage(X& y, ForceAtPosition& seen, StatusOf<T> status, const S& h, std::size_t i, const S& t) {
    if constexpr (LinearContact<P>) {
      return linear(y, seen, status, h, i, t);
    } else {
      return quadratic(y, seen, status, h, t);
    }
  }
  StatusOf<T> linear(X& y, ForceAtPosition& seen, StatusOf<T> status, const S& h, std::size_t i,
                     const S& t) requires LinearContact<P> {
    const auto [f, next] = clock_.at(i, t, [&](const auto& time) { return end_of(time); });
    Factors c;
    if constexpr (ConstantDamping<P>) {
      c = factors_[i];
    } else {
      c = factors(h, seen.damping, next);
      seen.damping = next;
    }
    if (all_failed(status, !(c.after > A(0)), StepStatus::singular)) return status;  // NaN at a pole
    Vec<n, T> v;
    for (std::size_t k = 0; k < n; ++k) v[k] = c.before * y.p[k] - (h * 0.5) * seen.slope[k];
    const T potential = seen.potential;
    drift(y, v, h);
    look(seen, y.q, f);
    for (std::size_t k = 0; k < n; ++k) y.p[k] = (v[k] - (h * 0.5) * seen.slope[k]) * c.after;
    if constexpr (X::acting)
      y.action.s = (c.before * y.action.s + h * lagrangian(y, v, potential, seen.potential)) * c.after;
    return status;
  }

  StatusOf<T> quadratic(X& y, ForceAtPosition& seen, StatusOf<T> status, const S& h,
                        const S& t) requires QuadraticContact<P> {
    using least::sqrt;
    const auto gamma = problem_.action_curvature();
    const T s = y.action.s, before = 1 - (h / 2) * (gamma * s);
    Vec<n, T> v;
    for (std::size_t k = 0; k < n; ++k) v[k] = before * y.p[k] - (h * 0.5) * seen.slope[k];
    const T potential = seen.potential;
    drift(y, v, h);
    look(seen, y.q, phase(problem_, t));
    const T r = s - (h / 4) * (gamma * (s * s)) + h * (lagrangian(y, v, potential, seen.potential) + problem_.offset());
    const T under = 1 + h * (gamma * r);
    if (all_failed(status, !(under > T(0)), StepStatus::singular)) return status;
    const T next = 2 * r / (1 + sqrt(under)), after = 1 + (h / 2) * (gamma * next);
    if (all_failed(status, !(after > T(least_denominator)), StepStatus::singular)) return status;
    for (std::size_t k = 0; k < n; ++k) y.p[k] = (v[k] - (h * 0.5) * seen.slope[k]) / after;
    y.action.s = next;
    return status;
  }

  /// The first step of a scene whose damping is 2/t: the weight t² of its Lagrangian is integrated over the step.
  StatusOf<T> regular_step(X& x, const S& h) {
    const ForceAtPosition start = seen_;
    Vec<n, T> v;
    for (std::size_t k = 0; k < n; ++k) v[k] = -(h / 6) * start.slope[k];
    drift(x, v, h);
    const auto f = phase(problem_, x.t + h);
    look(seen_, x.q, f);
    seen_.damping = damping(problem_, f);
    for (std::size_t k = 0; k < n; ++k) x.p[k] = (v[k] - (h / 2) * seen_.slope[k]) / 2;
    if constexpr (X::acting)
      x.action.s = ((h / 3) * start.potential + h * lagrangian(x, v, start.potential, seen_.potential)) / 2;
    return StepStatus::ok;
  }

  void drift(X& y, const Vec<n, T>& v, const S& h) const {
    const auto w = velocity(problem_, y.q, v);
    for (std::size_t k = 0; k < n; ++k) y.q[k] = y.q[k] + h * w[k];
  }
  /// The mean of K − V over the ends, at the new q.
  T lagrangian(const X& y, const Vec<n, T>& v, const T& before, const T& after) const {
    return 0.5 * (dot(v, velocity(problem_, y.q, v)) - (before + after));
  }

  P problem_;
  const Weights<S>* weights_;
  PhaseClock<End, P, S> clock_;
  ForceAtPosition seen_;
  S prepared_ = S(unusable);  ///< the step that factors_ are for
  std::array<Factors, ConstantDamping<P> ? compositions::most_stages : 1> factors_{};
  Work work_;
};

struct ContactLeapfrog {
  double step = 0.01;
  Composition composition = Composition::none;
  static constexpr std::tuple fields{step_field<ContactLeapfrog>(), composition_field<ContactLeapfrog>()};
  static SchemeCard card() {
    return {.id = "contact_leapfrog",
            .title = "Contact leapfrog",
            .summary =
                "The variational integrator of Herglotz' principle and the trapezoidal rule, explicit: leapfrog "
                "for damped and driven systems.",
            .orders = orders_from(2),
            .symmetric = true,
            .structure = "contact",
            .recommended = "kahan_li_6",
            .good_for = "long runs with damping or forcing: the contact form is kept exactly, one force a step",
            .fails_when =
                "ωh ≥ 2; αh ≥ 2, where it turns the momentum over; with a composition beyond αh = 2/w, w the "
                "largest negative weight",
            .needs = "a contact Hamiltonian: a potential, a constant kinetic metric, and α(t)s or γs²/2",
            .references = {"Vermeeren, Bravetti, Seri, Journal of Physics A 52, 445206 (2019)",
                           "Bravetti, Seri, Vermeeren, Zadra, Celest. Mech. Dyn. Astron. 132, 7 (2020)"}};
  }
  template <SeparableContact P, class X>
  auto bind(const P& problem, const X& x) const {
    return ContactLeapfrogStepper<P, X>(problem, x, step, Weights<typename X::Time>::of(composition));
  }

  /// E_d of the step from a to b: K in the drift, and the means of V and of the part of s over the two ends.
  template <SeparableContact P, class X>
  requires X::acting auto step_energy(const P& problem, const X& a, const X& b, const typename X::Time& h) const {
    const auto left = phase(problem, a.t), right = phase(problem, a.t + h);
    const auto slope = gradient(problem, a.q, left);
    const auto factor = 1 - (h / 2) * action_slope(problem, a.action.s, left);
    auto v = a.p;
    for (std::size_t i = 0; i < v.size(); ++i) v[i] = factor * a.p[i] - (h / 2) * slope[i];
    return 0.5 * (dot(v, velocity(problem, a.q, v)) + problem.potential(a.q, left) + problem.potential(b.q, right) +
                  action_energy(problem, a.action.s, left) + action_energy(problem, b.action.s, right));
  }

  /// Its first step from t = 0 is its own; a composition's stages are not.
  template <class P>
  bool starts_at_singularity(const P&) const {
    return composition == Composition::none;
  }
  template <class P>
  std::string unsupported_reason(const P& problem) const {
    return unsupported_by_pole(problem, composition, step);
  }
  double flips_from() const { return least::flips_from(composition); }
};

}  // namespace least
