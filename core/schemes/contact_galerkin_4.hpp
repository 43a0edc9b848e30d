// contact_galerkin_4: the discrete Herglotz principle of a quadratic path through q₀, b, q₁. The action is carried
// along the path by the classical Runge–Kutta scheme, stages L at q₀, b, b, q₁ with velocities v₀ = (4b−3q₀−q₁)/h, v_m
// = (q₁−q₀)/h, v₁ = (q₀+3q₁−4b)/h:
//   Z = s₀ + h(k₁ + 2k₂ + 2k₃ + k₄)/6,   Z_b = 0,  Z_q₀ + p₀ Z_s₀ = 0,  p₁ = Z_q₁,  s₁ = Z,  λ = Z_s₀
// Implicit, order 4, for any Lagrangian L(q, v, s, t): L_q, L_v and L_s at the nodes are all it needs. A contact map;
// symmetric only where L does not depend on s, and then it is galerkin_4: it takes no compositions. Where L is linear
// in s, that is not read by the equations. Solved for velocities, so that a step of any size, also 0, is well posed.
// Sources: Vermeeren, Bravetti, Seri, J. Phys. A 52, 445206 (2019); Simões, Martín de Diego, Lainz Valcázar, de León,
// J. Nonlinear Sci. 31, 35 (2021); Hairer, Lubich, Wanner 2006, VI.6.
#pragma once

#include <tuple>

#include "core/newton.hpp"
#include "core/scheme.hpp"
#include "core/schemes/damping_pole.hpp"
#include "core/schemes/simpson_step.hpp"

namespace least {

/// For any Lagrangian of the kind K − V − f(s, t); where the metric is constant and L linear in s, SimpsonStepper makes
/// the same steps.
template <Contact P, class X>
class ContactGalerkin4Stepper {
 public:
  using T = typename X::Number;
  using S = typename X::Time;
  static constexpr std::size_t n = P::dof;

  explicit ContactGalerkin4Stepper(const P& problem) : problem_(problem) {}

  /// Unknowns u = (b − q₀)/h and w = (q₁ − q₀)/h.
  StepStatus step(X& x, const S& h) noexcept {
    using least::abs;
    using least::any;
    const Times times = times_of(x, h);
    Vec<2 * P::dof, T> z;
    if (const StepStatus status = solve(x, h, times, z); status != StepStatus::ok) return status;
    const auto path = walk(x, h, times, z);
    work_.forces += nodes;
    if (any(!(abs(path.factor) > T(least_denominator)))) return StepStatus::singular;
    // p₁ = Z_q₁ = λp₀ + (Z_q₀ + Z_b + Z_q₁): a shift of the whole path changes no velocity, so the increment vanishes
    // with h.
    for (std::size_t i = 0; i < n; ++i) {
      x.q[i] = x.q[i] + h * z[n + i];
      x.p[i] = path.factor * x.p[i] + path.by_shift[i];
    }
    if constexpr (X::acting) x.action.s = x.action.s + path.gain;
    return StepStatus::ok;
  }
  const Work& work() const { return work_; }

  /// E_d of the step from x, the mean of v·L_v − L over the stages; NaN where the step fails.
  T energy(const X& x, const S& h) noexcept requires X::acting {
    const Times times = times_of(x, h);
    Vec<2 * P::dof, T> z;
    if (solve(x, h, times, z) != StepStatus::ok) return T(std::numeric_limits<double>::quiet_NaN());
    const auto stages = stages_of(x, h, times, z);
    const auto& [k1, k2, k3, k4] = stages.k;
    const auto at = [](const auto& k, const auto& v) { return T(dot(k.pi, v) - k.lagrangian); };
    return (at(k1, stages.v0) + 2.0 * at(k2, stages.vm) + 2.0 * at(k3, stages.vm) + at(k4, stages.v1)) / 6.0;
  }

 private:
  struct Times;
  Times times_of(const X& x, const S& h) const {
    return {phase(problem_, x.t), phase(problem_, x.t + h / 2), phase(problem_, x.t + h)};
  }
  StepStatus solve(const X& x, const S& h, const Times& times, Vec<2 * P::dof, T>& z) noexcept {
    using least::abs;
    const auto residual = [&](const auto& trial) {
      const auto path = walk(x, h, times, trial);
      auto r = trial;
      for (std::size_t i = 0; i < n; ++i) {
        r[i] = path.by_middle[i] / 4.0;
        r[n + i] = path.by_start[i] + path.factor * x.p[i];
      }
      return r;
    };
    // Guess: constant acceleration over the step.
    const Vec<P::dof, T> v = velocity(problem_, x.q, x.p);
    Vec<P::dof, T> p = x.p;
    const auto kick = lagrangian_force(problem_, x.q, v, times.start);
    ++work_.forces;
    for (std::size_t i = 0; i < n; ++i) p[i] = p[i] + (h / 2) * kick[i];
    const auto mean = velocity(problem_, x.q, p);
    T scale(0);
    for (std::size_t i = 0; i < n; ++i) {
      z[i] = (v[i] + mean[i]) / 4.0;
      z[n + i] = mean[i];
      scale = scale + abs(v[i]) + abs(mean[i]);
    }
    return newton<2 * P::dof>(z, unknowns_of<2 * P::dof, P::dof>(problem_), scale, grain_of(x.q, h), residual, nodes,
                              work_);
  }

  /// Evaluations of a path: the middle is evaluated once where L is linear in s, else twice.
  static constexpr int nodes = LinearContact<P> ? 3 : 4;
  using F = decltype(phase(std::declval<const P&>(), std::declval<const S&>()));
  struct Times {
    F start, middle, end;
  };
  /// Derivatives of Z by b, by q₀, by a shift of the whole path and by s₀ (`factor`), and Z − s₀.
  template <class U>
  struct Path {
    Vec<P::dof, U> by_middle{}, by_start{}, by_shift{};
    U factor{1}, gain{0};
  };
  /// L, its derivatives, and −L_s at a node.
  template <class U>
  struct Node {
    Vec<P::dof, U> pi, force;
    U lagrangian{0}, loss{0};
  };

  template <class U>
  Node<U> node(const Vec<P::dof, U>& q, const Vec<P::dof, U>& v, const U& s, const F& f) const {
    Node<U> at{momentum(problem_, q, v), lagrangian_force(problem_, q, v, f), U(0), U(0)};
    at.loss = U(action_slope(problem_, s, f));
    if constexpr (X::acting)
      at.lagrangian = 0.5 * dot(at.pi, v) - problem_.potential(q, f) - action_energy(problem_, s, f);
    return at;
  }

  /// The stages of Runge–Kutta's scheme along the path, and the velocities that they are at.
  template <class U>
  struct Stages {
    Vec<P::dof, U> v0, vm, v1;
    std::array<Node<U>, 4> k;
  };
  template <std::size_t M, class U>
  Stages<U> stages_of(const X& x, const S& h, const Times& times, const std::array<U, M>& z) const {
    Vec<P::dof, U> q0, b, q1;
    Stages<U> at;
    for (std::size_t i = 0; i < n; ++i) {
      const U &u = z[i], &w = z[n + i];
      q0[i] = U(x.q[i]);
      b[i] = x.q[i] + h * u;
      q1[i] = x.q[i] + h * w;
      at.v0[i] = 4.0 * u - w;
      at.vm[i] = w;
      at.v1[i] = 3.0 * w - 4.0 * u;
    }
    U s0(0);
    if constexpr (X::acting) s0 = U(x.action.s);
    const S half = h / 2;
    auto& [k1, k2, k3, k4] = at.k;
    k1 = node(q0, at.v0, s0, times.start);
    k2 = node(b, at.vm, U(s0 + half * k1.lagrangian), times.middle);
    k3 = node(b, at.vm, U(s0 + half * k2.lagrangian), times.middle);
    k4 = node(q1, at.v1, U(s0 + h * k3.lagrangian), times.end);
    return at;
  }

  template <std::size_t M, class U>
  Path<U> walk(const X& x, const S& h, const Times& times, const std::array<U, M>& z) const {
    const Stages<U> stages = stages_of(x, h, times, z);
    const auto &k1 = stages.k[0], &k2 = stages.k[1], &k3 = stages.k[2], &k4 = stages.k[3];
    const S half = h / 2;

    // Each derivative runs through the stages: dk_{j+1} = own part + L_s · (part of h) · dk_j. All are h times dk.
    Path<U> path;
    const auto through = [&](const U& d1, const U& d2, const U& d3, const U& d4) {
      const U e2 = d2 - half * (k2.loss * d1), e3 = d3 - half * (k3.loss * e2), e4 = d4 - h * (k4.loss * e3);
      return U((d1 + 2.0 * e2 + 2.0 * e3 + e4) / 6.0);
    };
    for (std::size_t i = 0; i < n; ++i) {
      path.by_middle[i] = through(4.0 * k1.pi[i], h * k2.force[i], h * k3.force[i], -4.0 * k4.pi[i]);
      path.by_start[i] = through(h * k1.force[i] - 3.0 * k1.pi[i], -k2.pi[i], -k3.pi[i], k4.pi[i]);
      path.by_shift[i] = through(h * k1.force[i], h * k2.force[i], h * k3.force[i], h * k4.force[i]);
    }
    path.factor = 1.0 + through(-(h * k1.loss), -(h * k2.loss), -(h * k3.loss), -(h * k4.loss));
    path.gain = h * (k1.lagrangian + 2.0 * k2.lagrangian + 2.0 * k3.lagrangian + k4.lagrangian) / 6.0;
    return path;
  }

  P problem_;
  Work work_;
};

struct ContactGalerkin4 {
  double step = 0.01;
  static constexpr std::tuple fields{step_field<ContactGalerkin4>()};
  static SchemeCard card() {
    return {.id = "contact_galerkin_4",
            .title = "Contact Galerkin 4",
            .summary =
                "The variational integrator of Herglotz' principle on a quadratic path: order 4 in one implicit "
                "solve, for any Lagrangian L(q, v, s, t).",
            .orders = {{"", 4}},
            .implicit = true,
            .structure = "contact",
            .good_for = "order 4 with the contact form kept, without negative substeps",
            .fails_when = "Newton's method finds no solution; ωh > 2√2; αh > 1.5, where steps can grow",
            .needs =
                "a Lagrangian that depends on s: a kinetic metric, a potential, and α(t)s or γs²/2; or a general "
                "one given as text",
            .references = {"Vermeeren, Bravetti, Seri, Journal of Physics A 52, 445206 (2019)",
                           "Simões, Martín de Diego, Lainz Valcázar, de León, J. Nonlinear Sci. 31, 35 (2021)"}};
  }
  template <Contact P, class X>
  auto bind(const P& problem, [[maybe_unused]] const X& x) const {
    if constexpr (LinearSeparableContact<P>) {
      return SimpsonStepper<P, X>(problem, x);
    } else {
      return ContactGalerkin4Stepper<P, X>(problem);
    }
  }
  template <Contact P, class X>
  requires X::acting auto step_energy(const P& problem, const X& a, const X&, const typename X::Time& h) const {
    return bind(problem, a).energy(a, h);
  }

  template <class P>
  double stiff_from(const P&) const {
    return 2;
  }
};

}  // namespace least
