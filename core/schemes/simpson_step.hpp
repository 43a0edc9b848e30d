// The step of a parabola through q₀, b, q₁ and Simpson's rule where the metric is constant: of galerkin_4, and of
// contact_galerkin_4 with H = K + V + α(t)s. All velocities of the path follow from u = (b − q₀)/h and w = (q₁ − q₀)/h,
// and the equations of both schemes are linear in u and w but for the force at b, the one place that is not known
// beforehand. With F = −∇V, π = λp₀ + c₁hF₀, the parts c₁, c, c₄ that start, middle and end have in the action (1/6,
// 4/6, 1/6 without damping), m = 3c₁ − c + 3c₄ and D = 16(c₁ + 3c₄)(3c₁ + c₄) − 16(c₁ + c₄)m:
//   g u = (4(c₁ + 3c₄) π + m c h F_b)/D,   g w = (16(c₁ + c₄) π + 4(3c₁ + c₄) c h F_b)/D,
//   p₁ = λp₀ + h(c₁F₀ + cF_b + c₄F₁)
// Newton's method solves the first for u; one force is new in each round, and the last one of a step is the first of
// the next. Sources: those of the two schemes; Hairer, Lubich, Wanner 2006, II.2.1 (without damping it is Lobatto's
// pair IIIA–IIIB of order 4).
#pragma once

#include "core/newton.hpp"
#include "core/scheme.hpp"
#include "core/schemes/damping_pole.hpp"

namespace least {

/// H = K + V + α(t)s with a constant metric.
template <class P>
concept LinearSeparableContact = SeparableContact<P> && LinearContact<P>;

/// −L_s of a scene with or without damping.
template <class P, class F>
constexpr auto loss_at([[maybe_unused]] const P& problem, [[maybe_unused]] const F& f) {
  if constexpr (LinearSeparableContact<P>) {
    return damping(problem, f);
  } else {
    return 0.0;
  }
}

template <class P, class X>
requires(Separable<P> || LinearSeparableContact<P>) class SimpsonStepper {
 public:
  using T = typename X::Number;
  using S = typename X::Time;
  static constexpr std::size_t n = P::dof;

  SimpsonStepper(const P& problem, const X& x) : problem_(problem) { begin(x); }
  /// Looks at the state where the next step begins.
  void begin(const X& x) { force_ = force(x.q, phase(problem_, x.t)); }

  StepStatus step(X& x, const S& h) noexcept {
    // Where the force depends on the time, that of a step's end is rounded in another way than that of the next start.
    if constexpr (!Autonomous<P>) begin(x);
    Path path;
    if (const StepStatus status = solve(x, h, path); status != StepStatus::ok) return status;
    X y = x;
    for (std::size_t i = 0; i < n; ++i) y.q[i] = x.q[i] + h * path.w[i];
    const Vec<P::dof, T> end = force(y.q, path.times.end);
    const Weights& c = path.weights;
    for (std::size_t i = 0; i < n; ++i)
      y.p[i] = c.factor * x.p[i] + h * (c.start * force_[i] + c.middle * path.force[i] + c.end * end[i]);
    if constexpr (X::acting) {
      const auto [k1, k2, k3, k4] = lagrangians(x, y.q, h, path);
      y.action.s = x.action.s + h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
    }
    x = y;
    force_ = end;
    return StepStatus::ok;
  }
  const Work& work() const { return work_; }

  /// E_d of the step from x: the mean of K + V over the nodes, with s that of v·L_v − L over the stages; NaN where the
  /// step fails.
  T energy(const X& x, const S& h) noexcept requires(X::acting || Separable<P>) {
    Path path;
    if (solve(x, h, path) != StepStatus::ok) return T(std::numeric_limits<double>::quiet_NaN());
    Vec<P::dof, T> end;
    for (std::size_t i = 0; i < n; ++i) end[i] = x.q[i] + h * path.w[i];
    const auto twice = twice_kinetic(path);
    if constexpr (X::acting) {
      const auto [k1, k2, k3, k4] = lagrangians(x, end, h, path);
      return ((twice[0] - k1) + 2.0 * (twice[1] - k2) + 2.0 * (twice[1] - k3) + (twice[2] - k4)) / 6.0;
    } else {
      const auto v = potentials(x, end, path);
      return ((0.5 * twice[0] + v[0]) + 4.0 * (0.5 * twice[1] + v[1]) + (0.5 * twice[2] + v[2])) / 6.0;
    }
  }

 private:
  using F = decltype(phase(std::declval<const P&>(), std::declval<const S&>()));
  struct Times {
    F start, middle, end;
  };
  /// h L_s and numbers that follow from it.
  using A = std::remove_cvref_t<decltype(std::declval<S>() * loss_at(std::declval<const P&>(), std::declval<F>()))>;
  /// c₁, c, c₄ and λ.
  struct Weights {
    A start, middle, end, factor;
  };
  struct Path {
    Times times;
    Weights weights;
    Vec<P::dof, T> u, w;
    Vec<P::dof, T> middle, force;  ///< b and F_b
  };

  Vec<P::dof, T> force(const Vec<P::dof, T>& q, const F& f) {
    ++work_.forces;
    return lagrangian_force(problem_, q, q, f);  // of a constant metric whatever the velocity
  }

  /// Without damping all are constants, which the compiler finds.
  Weights weights_of(const Times& times, const S& h) const {
    if constexpr (Separable<P>) return {A(1) / 6.0, A(2) / 3.0, A(1) / 6.0, A(1)};
    const A middle = A(loss_at(problem_, times.middle)), a = (h / 2) * middle, d = h * loss_at(problem_, times.end);
    Weights c{(1.0 - 2.0 * a + 2.0 * a * a - a * a * d) / 6.0, (4.0 - 2.0 * a + a * d - d) / 6.0, A(1) / 6.0, A(1)};
    c.factor =
        1.0 - h * (c.start * loss_at(problem_, times.start) + c.middle * middle + c.end * loss_at(problem_, times.end));
    return c;
  }

  StepStatus solve(const X& x, const S& h, Path& path) noexcept {
    using least::abs;
    using least::any;
    path.times = {phase(problem_, x.t), phase(problem_, x.t + h / 2), phase(problem_, x.t + h)};
    const Weights c = path.weights = weights_of(path.times, h);
    if (any(!(abs(c.factor) > A(least_denominator)))) return StepStatus::singular;
    const A to_middle = 4.0 * (c.start + 3.0 * c.end), to_end = 4.0 * (3.0 * c.start + c.end),
            all = 16.0 * (c.start + c.end), less = 3.0 * c.start - c.middle + 3.0 * c.end,
            whole = 1.0 / (to_middle * to_end - all * less), kick = c.middle * h * whole;
    Vec<P::dof, T> known, p, guess;
    for (std::size_t i = 0; i < n; ++i) {
      known[i] = whole * (c.factor * x.p[i] + (c.start * h) * force_[i]);
      p[i] = to_middle * known[i];
      guess[i] = p[i] + (less * kick) * force_[i];
    }
    path.u = velocity(problem_, x.q, guess);
    T scale(0);
    for (const T& component : path.u) scale = scale + 2.0 * abs(component);
    const auto middle = [&](const auto& u) {
      auto b = u;
      for (std::size_t i = 0; i < n; ++i) b[i] = x.q[i] + h * u[i];
      return b;
    };
    const auto residual = [&](const auto& u) {
      const auto b = middle(u);
      const auto forces = lagrangian_force(problem_, b, u, path.times.middle);
      auto r = momentum(problem_, b, u);
      for (std::size_t i = 0; i < n; ++i) r[i] = r[i] - ((less * kick) * forces[i] + p[i]);
      return r;
    };
    if (const StepStatus status =
            newton<P::dof>(path.u, unknowns_of<P::dof, P::dof>(problem_), scale, grain_of(x.q, h), residual, 1, work_);
        status != StepStatus::ok)
      return status;
    path.middle = middle(path.u);
    path.force = force(path.middle, path.times.middle);
    for (std::size_t i = 0; i < n; ++i) p[i] = all * known[i] + (to_end * kick) * path.force[i];
    path.w = velocity(problem_, x.q, p);
    return StepStatus::ok;
  }

  /// 2K with the velocities v₀ = 4u − w, v_m = w and v₁ = 3w − 4u.
  std::array<T, 3> twice_kinetic(const Path& path) const {
    const auto at = [&](double u, double w) {
      Vec<P::dof, T> v;
      for (std::size_t i = 0; i < n; ++i) v[i] = u * path.u[i] + w * path.w[i];
      return T(dot(momentum(problem_, path.middle, v), v));
    };
    return {at(4, -1), at(0, 1), at(-4, 3)};
  }
  std::array<T, 3> potentials(const X& x, const Vec<P::dof, T>& end, const Path& path) const {
    return {problem_.potential(x.q, path.times.start), problem_.potential(path.middle, path.times.middle),
            problem_.potential(end, path.times.end)};
  }
  /// L at the stages of the classical Runge–Kutta scheme, which carries s along the path.
  std::array<T, 4> lagrangians(const X& x, const Vec<P::dof, T>& end, const S& h,
                               const Path& path) const requires X::acting {
    const auto twice = twice_kinetic(path), v = potentials(x, end, path);
    const auto at = [&](std::size_t node, const F& f, const T& s) {
      return T(0.5 * twice[node] - v[node] - loss_at(problem_, f) * s);
    };
    const S half = h / 2;
    const T& s = x.action.s;
    const T k1 = at(0, path.times.start, s), k2 = at(1, path.times.middle, s + half * k1),
            k3 = at(1, path.times.middle, s + half * k2), k4 = at(2, path.times.end, s + h * k3);
    return {k1, k2, k3, k4};
  }

  P problem_;
  Vec<P::dof, T> force_{};  ///< F at the state
  Work work_;
};

}  // namespace least
