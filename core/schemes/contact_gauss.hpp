// contact_gauss: the s-stage Gauss–Legendre collocation of the homogeneous Hamiltonian 𝓗 = −P_s H(q, −P_q/P_s, s, t)
// that a contact Hamiltonian lifts to, started afresh each step at P_s = 1, P_q = −p:
//   q′ = H_p,  s′ = p·H_p − H,  P_q′ = P_s H_q,  P_s′ = P_s H_s,  p = −P_q/P_s at every stage and at the end
// A symplectic map that commutes with scaling (P_q, P_s) is the lift of a contact map: λ = 1/P_s. Implicit, orders 2, 4
// and 6, symmetric. Where H is linear in s, P_s is known beforehand and s is a quadrature after the fact. Newton's
// method, not fixed-point iteration, which fails at h = 0.8. Look-alike: the Gauss rule in (q, p, s) itself is no
// contact map. Sources: Arnold, Mathematical Methods of Classical Mechanics, 1989, appendix 4; Hairer, Lubich, Wanner
// 2006, II.1.3 and VI.4.
#pragma once

#include <limits>
#include <tuple>

#include "core/newton.hpp"
#include "core/scheme.hpp"
#include "core/schemes/damping_pole.hpp"

namespace least {

/// Nodes, weights and coefficients of the M-stage Gauss rule in the number S.
template <int M, class S>
struct GaussRule {
  Vec<M, S> node{}, weight{};
  Mat<M, S> a{};

  static const GaussRule& get() {
    static const GaussRule rule = make();
    return rule;
  }

 private:
  static GaussRule make() {
    using least::sqrt;
    const S half = S(1) / 2;
    if constexpr (M == 1) {
      return {{half}, {S(1)}, {{{half}}}};
    } else if constexpr (M == 2) {
      const S r = sqrt(S(3)) / 6, quarter = S(1) / 4;
      return {{half - r, half + r}, {half, half}, {{{quarter, quarter - r}, {quarter + r, quarter}}}};
    } else {
      const S r = sqrt(S(15)), f = S(5) / 36, n = S(2) / 9;
      return {{half - r / 10, half, half + r / 10},
              {S(5) / 18, S(4) / 9, S(5) / 18},
              {{{f, n - r / 15, f - r / 30}, {f + r / 24, n, f - r / 24}, {f + r / 30, n + r / 15, f}}}};
    }
  }
};

template <SeparableContact P, class X>
class ContactGaussStepper {
 public:
  using T = typename X::Number;
  using S = typename X::Time;
  static constexpr std::size_t n = P::dof;

  ContactGaussStepper(const P& problem, int stages) : problem_(problem), stages_(stages) {}

  StepStatus step(X& x, const S& h) noexcept {
    return stages_ == 1 ? take<1>(x, h) : stages_ == 2 ? take<2>(x, h) : take<3>(x, h);
  }
  const Work& work() const { return work_; }

 private:
  using F = decltype(phase(std::declval<const P&>(), std::declval<const S&>()));
  /// Unknowns of a stage: P_q′/P_s = H_q, and where the motion reads s also s′ and P_s′.
  static constexpr std::size_t width = n + (QuadraticContact<P> ? 2 : 0);

  /// The stages of a step as functions of the unknowns, in the number U.
  template <int M, class U>
  struct Stages {
    Vec<M, Vec<P::dof, U>> q, p, v;
    Vec<M, U> s, scale;  ///< scale: P_s
  };

  template <int M, class U>
  Stages<M, U> stages(const X& x, const S& h, const Vec<M, F>& f, const std::array<U, M * width>& z) const {
    const auto& rule = GaussRule<M, S>::get();
    Stages<M, U> at;
    if constexpr (QuadraticContact<P>) {
      for (std::size_t i = 0; i < M; ++i) {
        at.s[i] = U(x.action.s);
        at.scale[i] = U(1);
        for (std::size_t j = 0; j < M; ++j) {
          at.s[i] = at.s[i] + (h * rule.a[i][j]) * z[j * width + n];
          at.scale[i] = at.scale[i] + (h * rule.a[i][j]) * z[j * width + n + 1];
        }
      }
    } else {
      const auto known = scales<M>(h, f);
      for (std::size_t i = 0; i < M; ++i) {
        at.s[i] = U(0);
        at.scale[i] = U(known[i]);
      }
    }
    for (std::size_t i = 0; i < M; ++i)
      for (std::size_t k = 0; k < n; ++k) {
        U pulled = U(x.p[k]);  // −P_q
        for (std::size_t j = 0; j < M; ++j) pulled = pulled - (h * rule.a[i][j]) * (at.scale[j] * z[j * width + k]);
        at.p[i][k] = pulled / at.scale[i];
      }
    for (std::size_t i = 0; i < M; ++i) at.v[i] = velocity(problem_, at.p[i], at.p[i]);
    for (std::size_t i = 0; i < M; ++i)
      for (std::size_t k = 0; k < n; ++k) {
        at.q[i][k] = U(x.q[k]);
        for (std::size_t j = 0; j < M; ++j) at.q[i][k] = at.q[i][k] + (h * rule.a[i][j]) * at.v[j][k];
      }
    return at;
  }

  /// P_s at the stages where P_s′ = α(t) P_s: a linear system in time alone.
  template <int M>
  auto scales(const S& h, const Vec<M, F>& f) const {
    using A = std::remove_cvref_t<decltype(h * damping(problem_, f[0]))>;
    const auto& rule = GaussRule<M, S>::get();
    Mat<M, A> matrix;
    Vec<M, A> right;
    for (std::size_t i = 0; i < M; ++i) {
      right[i] = A(1);
      for (std::size_t j = 0; j < M; ++j) {
        matrix[i][j] = -(rule.a[i][j] * h) * damping(problem_, f[j]);
        if (i == j) matrix[i][j] = matrix[i][j] + 1;
      }
    }
    return solve_by_elimination(matrix, right);
  }

  template <int M>
  StepStatus take(X& x, const S& h) noexcept {
    using least::abs;
    using least::any;
    const auto& rule = GaussRule<M, S>::get();
    Vec<M, F> f;
    for (std::size_t i = 0; i < M; ++i) f[i] = phase(problem_, x.t + rule.node[i] * h);
    const auto residual = [&](const auto& z) {
      using U = std::remove_cvref_t<decltype(z[0])>;
      const auto at = stages<M, U>(x, h, f, z);
      auto r = z;
      for (std::size_t i = 0; i < M; ++i) {
        const auto slope = gradient(problem_, at.q[i], f[i]);
        for (std::size_t k = 0; k < n; ++k) r[i * width + k] = z[i * width + k] - slope[k];
        if constexpr (QuadraticContact<P>) {
          r[i * width + n] = z[i * width + n] - action_rate(at, i, f[i]);
          r[i * width + n + 1] = z[i * width + n + 1] - at.scale[i] * action_slope(problem_, at.s[i], f[i]);
        }
      }
      return r;
    };

    // Guess: the force at an explicit half-step.
    Vec<P::dof, T> q = x.q;
    const auto v = velocity(problem_, x.q, x.p);
    for (std::size_t k = 0; k < n; ++k) q[k] = q[k] + (h / 2) * v[k];
    const auto slope = gradient(problem_, q, f[0]);
    std::array<T, M * width> z{};
    T scale(0), grain(0);
    for (std::size_t i = 0; i < M; ++i) {
      for (std::size_t k = 0; k < n; ++k) z[i * width + k] = slope[k];
      if constexpr (QuadraticContact<P>) {
        z[i * width + n] =
            0.5 * dot(x.p, v) - problem_.potential(x.q, f[0]) - action_energy(problem_, x.action.s, f[0]);
        z[i * width + n + 1] = T(action_slope(problem_, x.action.s, f[0]));
      }
    }
    // A force matters down to the rounding of the momenta and positions that it changes.
    for (const T& c : z) scale = scale + abs(c);
    grain = grain_of(x.p, h) + grain_of(x.q, h);
    if constexpr (QuadraticContact<P>) grain = grain + grain_of(Vec<1, T>{x.action.s}, h);
    work_.forces += 1;
    if (const StepStatus status = newton<int(M * width)>(z, unknowns_of<int(M * width), int(width)>(problem_), scale,
                                                         grain, residual, M, work_);
        status != StepStatus::ok)
      return status;

    const auto at = stages<M, T>(x, h, f, z);
    T end(1), gained(0);
    Vec<P::dof, T> pulled{};
    X y = x;
    for (std::size_t i = 0; i < M; ++i) {
      const S weight = h * rule.weight[i];
      end = end + weight * (at.scale[i] * action_slope(problem_, at.s[i], f[i]));
      for (std::size_t k = 0; k < n; ++k) {
        y.q[k] = y.q[k] + weight * at.v[i][k];
        pulled[k] = pulled[k] + weight * (at.scale[i] * z[i * width + k]);
      }
      if constexpr (QuadraticContact<P>) gained = gained + weight * z[i * width + n];
    }
    if (any(!(abs(end) > T(least_denominator)))) return StepStatus::singular;
    for (std::size_t k = 0; k < n; ++k) y.p[k] = (x.p[k] - pulled[k]) / end;
    if constexpr (QuadraticContact<P>) {
      y.action.s = x.action.s + gained;
    } else if constexpr (X::acting) {
      y.action.s = linear_action<M>(x, h, f, at);
    }
    x = y;
    return StepStatus::ok;
  }

  /// s′ = p·H_p − H at a stage
  template <class At>
  auto action_rate(const At& at, std::size_t i, const F& f) const {
    return 0.5 * dot(at.p[i], at.v[i]) - problem_.potential(at.q[i], f) - action_energy(problem_, at.s[i], f);
  }
  /// s′ = K − V − α s by the same collocation, linear in s.
  template <int M, class At>
  T linear_action(const X& x, const S& h, const Vec<M, F>& f, const At& at) const {
    using A = std::remove_cvref_t<decltype(h * damping(problem_, f[0]))>;
    const auto& rule = GaussRule<M, S>::get();
    Mat<M, A> matrix;
    Vec<M, T> free;
    for (std::size_t i = 0; i < M; ++i) {
      free[i] = 0.5 * dot(at.p[i], at.v[i]) - problem_.potential(at.q[i], f[i]);
      for (std::size_t j = 0; j < M; ++j) {
        matrix[i][j] = (rule.a[i][j] * h) * damping(problem_, f[i]);
        if (i == j) matrix[i][j] = matrix[i][j] + 1;
      }
    }
    // s′_i = free_i − α_i (s₀ + h Σ a_ij s′_j)
    Vec<M, T> right;
    for (std::size_t i = 0; i < M; ++i) right[i] = free[i] - damping(problem_, f[i]) * x.action.s;
    const auto rate = solve_by_elimination(matrix, right);
    T s = x.action.s;
    for (std::size_t i = 0; i < M; ++i) s = s + (h * rule.weight[i]) * rate[i];
    return s;
  }

  /// A x = b for at most three equations whose A is near 1: no pivots, so no branch for any number.
  template <std::size_t M, class A, class B>
  static std::array<B, M> solve_by_elimination(std::array<std::array<A, M>, M> a, std::array<B, M> b) {
    for (std::size_t k = 0; k < M; ++k)
      for (std::size_t i = k + 1; i < M; ++i) {
        const A f = a[i][k] / a[k][k];
        for (std::size_t j = k + 1; j < M; ++j) a[i][j] = a[i][j] - f * a[k][j];
        b[i] = b[i] - f * b[k];
      }
    for (std::size_t i = M; i-- > 0;) {
      for (std::size_t j = i + 1; j < M; ++j) b[i] = b[i] - a[i][j] * b[j];
      b[i] = b[i] / a[i][i];
    }
    return b;
  }

  P problem_;
  int stages_;
  Work work_;
};

template <GeneralHamiltonian P, class X>
class HamiltonianGaussStepper;  // core/schemes/hamiltonian_gauss.hpp

struct ContactGauss {
  double step = 0.01;
  int stages = 2;
  static constexpr std::tuple fields{
      step_field<ContactGauss>(),
      Field<ContactGauss, int>{
          "stages", "", "", "stages of the Gauss rule; the order is twice as many", &ContactGauss::stages, {1, 3}}};
  static SchemeCard card() {
    return {
        .id = "contact_gauss",
        .title = "Contact Gauss",
        .summary =
            "Gauss–Legendre collocation of the homogeneous Hamiltonian that a contact Hamiltonian lifts to: "
            "implicit, orders 2, 4 and 6.",
        .orders = {{"1", 2}, {"2", 4}, {"3", 6}},
        .implicit = true,
        .symmetric = true,
        .structure = "contact",
        .good_for = "long steps at high order with the contact form kept; without damping no linear stability limit",
        .fails_when =
            "Newton's method finds no solution; αh > 2, where the damping is not resolved: one stage turns the "
            "momentum over, three from αh = 4.64 on, and with two or three there are steps that grow (for α = ω, ωh = "
            "2.65 to 3.46 and 4.60 to 5.00)",
        .needs = "a contact Hamiltonian with a constant kinetic metric, or a general one given as text",
        .references = {"Arnold, Mathematical Methods of Classical Mechanics, 1989, appendix 4",
                       "Hairer, Lubich, Wanner 2006, II.1.3"}};
  }
  template <SeparableContact P, class X>
  auto bind(const P& problem, const X&) const {
    return ContactGaussStepper<P, X>(problem, stages);
  }
  template <GeneralHamiltonian P, class X>
  auto bind(const P& problem, const X&) const {
    return HamiltonianGaussStepper<P, X>(problem, stages);
  }

  /// Where λ, the diagonal Padé approximation of e^{−αh}, changes its sign: that of two stages has no real zero.
  double flips_from() const {
    constexpr double never = std::numeric_limits<double>::infinity();
    return stages == 1 ? 2 : stages == 2 ? never : 4.644370709252171;
  }
  template <class P>
  double stiff_from(const P&) const {
    return 2;
  }
};

}  // namespace least
