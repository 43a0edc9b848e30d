// contact_variational_midpoint and contact_galerkin_4 for a Lagrangian L(q, v, s, t) of which no more is known: the
// same discrete Herglotz equations. With L, L_q, L_v = π and L_s at m = q₀ + hv/2, σ = (s₁ − s₀)/h, s̄ = s₀ + hσ/2, t +
// h/2:
//   π − (h/2)L_q = (1 + (h/2)L_s) p₀,  σ = L,  p₁ = ((1 + (h/2)L_s) p₀ + h L_q)/(1 − (h/2)L_s)
// in (v, σ), and those of the quadratic path in its two velocities. Solved by a simplified Newton iteration for as many
// coordinates as the scene has; where L does not depend on s, that rests and is none of the unknowns, and the maps are
// symplectic. Sources: those of the two schemes.
#pragma once

#include "core/schemes/contact_galerkin_4.hpp"
#include "core/schemes/contact_midpoint.hpp"
#include "core/simplified_newton.hpp"

namespace least {

/// A step begins here, in the number T.
template <int N, class T, class S>
struct StepStart {
  Vec<N, T> q, p;
  T s;
  S t, h;
};

/// What both have in common: the equations of a scheme, `residual(start, z, wrong)` in any number, and their solution.
template <class P, class X, int Most>
class GeneralHerglotz {
 public:
  using T = typename X::Number;
  using S = typename X::Time;
  static constexpr int dof = P::dof;
  using Start = StepStart<dof, T, S>;
  using PlainStart = StepStart<dof, double, double>;

  explicit GeneralHerglotz(const P& problem)
      : problem_(problem), n_(problem.coordinates()), acts_(problem.reads_action()) {}

  const P& problem() const { return problem_; }
  std::size_t coordinates() const { return n_; }
  bool acts() const { return acts_; }
  Work& work() { return work_; }
  const Work& work() const { return work_; }

  static Start start_of_step(const X& x, const S& h) { return {x.q, x.p, x.action.s, x.t, h}; }
  static PlainStart plain_start(const X& x, const S& h) {
    PlainStart start{{}, {}, plain_number(x.action.s), plain_number(x.t), plain_number(h)};
    for (std::size_t i = 0; i < dof; ++i) {
      start.q[i] = plain_number(x.q[i]);
      start.p[i] = plain_number(x.p[i]);
    }
    return start;
  }
  /// The velocity that a step begins with.
  Vec<dof> velocity(const PlainStart& start) const {
    return problem_.slopes(start.q, start.p, start.s, phase(problem_, start.t)).by_p;
  }

  /// z from a guess, for `count` unknowns.
  template <class Equations>
  StepStatus solve(const X& x, const S& h, std::size_t count, T* z, int evaluations, const Equations& equations) {
    const Start start = start_of_step(x, h);
    const PlainStart plain = plain_start(x, h);
    // A velocity means something down to what it does to the position.
    double size = 0;
    for (std::size_t i = 0; i < n_; ++i) size += std::abs(plain.q[i]);
    size /= std::abs(plain.h);
    const auto residual = [&](const T* at, T* wrong) {
      work_.forces += evaluations;
      equations(start, at, wrong);
    };
    const auto prepare = [&](const T* at) {
      using D = Dual<double, 1>;
      std::array<D, std::size_t(Most)> trial, wrong;
      for (std::size_t k = 0; k < count; ++k) {
        for (std::size_t i = 0; i < count; ++i) trial[i] = D(plain_number(at[i]));
        trial[k].slope[0] = 1;
        equations(plain, trial.data(), wrong.data());
        for (std::size_t i = 0; i < count; ++i) newton_.matrix[i * count + k] = wrong[i].slope[0];
      }
      newton_.invert(count);
      work_.forces += evaluations * std::int64_t(count);
    };
    const auto alike = [](std::size_t) { return 1.0; };
    return newton_.solve(count, z, size, alike, residual, prepare, work_);
  }

 private:
  P problem_;
  std::size_t n_;
  bool acts_;
  SimplifiedNewton<T, std::size_t(Most)> newton_;
  Work work_;
};

template <GeneralLagrangian P, class X>
class LagrangianMidpointStepper {
 public:
  using T = typename X::Number;
  using S = typename X::Time;

  explicit LagrangianMidpointStepper(const P& problem) : herglotz_(problem) {}

  StepStatus step(X& x, const S& h) noexcept {
    using least::any;
    const std::size_t n = herglotz_.coordinates(), count = n + (herglotz_.acts() ? 1 : 0);
    const auto plain = Herglotz::plain_start(x, h);
    const Vec<P::dof> v = herglotz_.velocity(plain);
    Unknowns<T> z{};
    for (std::size_t i = 0; i < n; ++i) z[i] = T(v[i]);
    if (herglotz_.acts()) z[n] = T(at(plain, v, plain.s).value);
    const auto equations = [&](const auto& start, const auto* trial, auto* wrong) {
      using U = std::remove_cvref_t<decltype(*trial)>;
      Vec<P::dof, U> velocity{};
      for (std::size_t i = 0; i < n; ++i) velocity[i] = trial[i];
      const auto half = start.h / 2;
      const U s = herglotz_.acts() ? U(start.s + half * trial[n]) : U(start.s);
      const auto l = at(start, velocity, s);
      for (std::size_t i = 0; i < n; ++i) wrong[i] = l.by_v[i] - half * l.by_q[i] - (1.0 + half * l.by_s) * start.p[i];
      if (herglotz_.acts()) wrong[n] = trial[n] - l.value;
    };
    if (const StepStatus status = herglotz_.solve(x, h, count, z.data(), 1, equations); status != StepStatus::ok)
      return status;

    Vec<P::dof, T> velocity{};
    for (std::size_t i = 0; i < n; ++i) velocity[i] = z[i];
    const S half = h / 2;
    const T s = herglotz_.acts() ? T(x.action.s + half * z[n]) : x.action.s;
    const auto l = at(Herglotz::start_of_step(x, h), velocity, s);
    ++herglotz_.work().forces;
    const T end = 1.0 - half * l.by_s;
    if (any(!(end > T(least_denominator)))) return StepStatus::singular;
    for (std::size_t i = 0; i < n; ++i) {
      x.q[i] = x.q[i] + h * z[i];
      x.p[i] = ((1.0 + half * l.by_s) * x.p[i] + h * l.by_q[i]) / end;
    }
    if (herglotz_.acts()) x.action.s = x.action.s + h * z[n];
    return StepStatus::ok;
  }
  const Work& work() const { return herglotz_.work(); }

 private:
  static constexpr int most = P::dof + 1;
  using Herglotz = GeneralHerglotz<P, X, most>;
  template <class U>
  using Unknowns = std::array<U, std::size_t(most)>;

  /// L in the middle.
  template <class Start, class U>
  auto at(const Start& start, const Vec<P::dof, U>& v, const U& s) const {
    const P& problem = herglotz_.problem();
    Vec<P::dof, U> m{};
    for (std::size_t i = 0; i < herglotz_.coordinates(); ++i) m[i] = start.q[i] + (start.h / 2) * v[i];
    return problem.lagrangian(m, v, s, phase(problem, start.t + start.h / 2));
  }

  Herglotz herglotz_;
};

/// Of a step along a quadratic path, in the number U: L at a node with its derivatives, `loss` for −L_s. What follows
/// is what ContactGalerkin4Stepper does, for as many of N coordinates as there are: said once for both, its steps would
/// take a tenth more instructions.
template <int N, class U>
struct PathNode {
  Vec<N, U> pi, force;
  U lagrangian{0}, loss{0};
};
/// The stages of Runge–Kutta's scheme along the path, and the velocities that they are at.
template <int N, class U>
struct PathStages {
  Vec<N, U> v0, vm, v1;
  std::array<PathNode<N, U>, 4> k;
};
/// Derivatives of Z by b, by q₀, by a shift of the whole path and by s₀ (`factor`), and Z − s₀.
template <int N, class U>
struct PathAction {
  Vec<N, U> by_middle{}, by_start{}, by_shift{};
  U factor{1}, gain{0};
};

/// Of n coordinates, with z = ((b − q₀)/h, (q₁ − q₀)/h); node(q, v, s, time) → PathNode at the `time`: 0 at the start,
/// 1 in the middle, 2 at the end.
template <class U, int N, class T, class S, class NodeAt>
PathStages<N, U> path_stages(const Vec<N, T>& start, const T& action, const S& h, const U* z, std::size_t n,
                             NodeAt&& node) {
  Vec<N, U> q0{}, b{}, q1{};
  PathStages<N, U> at{};
  for (std::size_t i = 0; i < n; ++i) {
    const U &u = z[i], &w = z[n + i];
    q0[i] = U(start[i]);
    b[i] = start[i] + h * u;
    q1[i] = start[i] + h * w;
    at.v0[i] = 4.0 * u - w;
    at.vm[i] = w;
    at.v1[i] = 3.0 * w - 4.0 * u;
  }
  const U s0(action);
  const S half = h / 2;
  auto& [k1, k2, k3, k4] = at.k;
  k1 = node(q0, at.v0, s0, 0);
  k2 = node(b, at.vm, U(s0 + half * k1.lagrangian), 1);
  k3 = node(b, at.vm, U(s0 + half * k2.lagrangian), 1);
  k4 = node(q1, at.v1, U(s0 + h * k3.lagrangian), 2);
  return at;
}

/// Each derivative runs through the stages: dk_{j+1} = own part + L_s · (part of h) · dk_j.
template <int N, class U, class S>
PathAction<N, U> path_action(const PathStages<N, U>& stages, const S& h, std::size_t n) {
  const auto &k1 = stages.k[0], &k2 = stages.k[1], &k3 = stages.k[2], &k4 = stages.k[3];
  const S half = h / 2;
  PathAction<N, U> path;
  const auto through = [&](const U& d1, const U& d2, const U& d3, const U& d4) {  // all are h times dk
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

/// E_d of the step: the mean of v·L_v − L over the stages.
template <int N, class U>
U path_energy(const PathStages<N, U>& stages) {
  const auto at = [](const auto& k, const auto& v) { return U(dot(k.pi, v) - k.lagrangian); };
  return (at(stages.k[0], stages.v0) + 2.0 * at(stages.k[1], stages.vm) + 2.0 * at(stages.k[2], stages.vm) +
          at(stages.k[3], stages.v1)) /
         6.0;
}

template <GeneralLagrangian P, class X>
class LagrangianGalerkinStepper {
 public:
  using T = typename X::Number;
  using S = typename X::Time;

  explicit LagrangianGalerkinStepper(const P& problem) : herglotz_(problem) {}

  StepStatus step(X& x, const S& h) noexcept {
    using least::abs;
    using least::any;
    Unknowns z{};
    if (const StepStatus status = solve(x, h, z); status != StepStatus::ok) return status;
    const std::size_t n = herglotz_.coordinates();
    const auto path = path_action(stages(Herglotz::start_of_step(x, h), z.data()), h, n);
    herglotz_.work().forces += nodes();
    if (any(!(abs(path.factor) > T(least_denominator)))) return StepStatus::singular;
    for (std::size_t i = 0; i < n; ++i) {
      x.q[i] = x.q[i] + h * z[n + i];
      x.p[i] = path.factor * x.p[i] + path.by_shift[i];
    }
    if (herglotz_.acts()) x.action.s = x.action.s + path.gain;
    return StepStatus::ok;
  }
  const Work& work() const { return herglotz_.work(); }

  /// E_d of the step from x; not a number where there is none.
  T energy(const X& x, const S& h) noexcept {
    Unknowns z{};
    if (solve(x, h, z) != StepStatus::ok) return T(std::numeric_limits<double>::quiet_NaN());
    return path_energy(stages(Herglotz::start_of_step(x, h), z.data()));
  }

 private:
  static constexpr int most = 2 * P::dof;
  using Herglotz = GeneralHerglotz<P, X, most>;
  using Unknowns = std::array<T, std::size_t(most)>;

  /// Where L does not depend on s, the middle is met once.
  int nodes() const { return herglotz_.acts() ? 4 : 3; }

  template <class Start, class U>
  PathStages<P::dof, U> stages(const Start& start, const U* z) const {
    const P& problem = herglotz_.problem();
    PathNode<P::dof, U> middle;
    bool met = false;
    const auto node = [&](const auto& q, const auto& v, const U& s, int time) {
      if (time == 1 && met && !herglotz_.acts()) return middle;
      const auto l = problem.lagrangian(q, v, s, phase(problem, start.t + (time * 0.5) * start.h));
      PathNode<P::dof, U> here{l.by_v, l.by_q, l.value, -l.by_s};
      if (time == 1) {
        middle = here;
        met = true;
      }
      return here;
    };
    return path_stages<U, P::dof>(start.q, start.s, start.h, z, herglotz_.coordinates(), node);
  }

  StepStatus solve(const X& x, const S& h, Unknowns& z) noexcept {
    const std::size_t n = herglotz_.coordinates();
    const Vec<P::dof> v = herglotz_.velocity(Herglotz::plain_start(x, h));
    for (std::size_t i = 0; i < n; ++i) {
      z[i] = T(0.5 * v[i]);
      z[n + i] = T(v[i]);
    }
    return herglotz_.solve(x, h, 2 * n, z.data(), nodes(), [&](const auto& start, const auto* trial, auto* wrong) {
      const auto path = path_action(stages(start, trial), start.h, n);
      for (std::size_t i = 0; i < n; ++i) {
        wrong[i] = path.by_middle[i] / 4.0;
        wrong[n + i] = path.by_start[i] + path.factor * start.p[i];
      }
    });
  }

  Herglotz herglotz_;
};

}  // namespace least
