// The discrete Lagrangian of a conservative autonomous scene over a step h from q₀ to q₁, Δ = q₁ − q₀, v = Δ/h,
//   L_d(q₀, q₁; h) = ℓ²/(2h) − h V̄,  ℓ² = ḡ_ij Δ^iΔ^j
// under two quadratures: trapezoid (g and V averaged over the ends) and midpoint (g and V at the middle). Its
// derivatives are the momenta at the ends, p₀ = −D₁L_d = ḡv − (h/2)F₀ and p₁ = D₂L_d = ḡv + (h/2)F₁, where
// F_i = ½ v·∂_i g v − ∂_i V is taken at the ends, or both times at the middle. Its discrete energy is
// E_d = −∂L_d/∂h = ℓ²/(2h²) + V̄. Source: Marsden & West, Acta Numerica 10, 357 (2001), 2.3.1, 2.6.1 and 4.
#pragma once

#include "core/newton.hpp"
#include "core/scheme.hpp"
#include "core/schemes/variational_midpoint.hpp"

namespace least {

enum class Quadrature : std::uint8_t { trapezoid, midpoint };
inline constexpr std::array<std::string_view, 2> quadrature_names{"trapezoid", "midpoint"};

/// LagrangianTerms is V at a point, and g there if g depends on the point.
template <Conservative P, class T>
struct LagrangianTerms {
  static constexpr int n = P::dof;
  struct Flat {};
  T potential{};
  [[no_unique_address]] std::conditional_t<ConfigurationMetric<P>, Mat<n, T>, Flat> metric{};

  LagrangianTerms() = default;
  LagrangianTerms(const P& problem, const Vec<n, T>& q) : potential(least::potential(problem, q)) {
    if constexpr (ConfigurationMetric<P>) metric = problem.metric(q);
  }
  /// The mean of two of them.
  LagrangianTerms(const LagrangianTerms& a, const LagrangianTerms& b) : potential((a.potential + b.potential) * 0.5) {
    if constexpr (ConfigurationMetric<P>)
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) metric[i][j] = (a.metric[i][j] + b.metric[i][j]) * 0.5;
  }
  /// g v
  template <class U>
  Vec<n, U> lower(const P& problem, const Vec<n, U>& v) const {
    if constexpr (ConfigurationMetric<P>) {
      Vec<n, U> p{};
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) p[i] = p[i] + metric[i][j] * v[j];
      return p;
    } else {
      return momentum(problem, v, v);
    }
  }
  /// g⁻¹ p
  Vec<n, T> raise(const P& problem, const Vec<n, T>& p) const {
    if constexpr (ConfigurationMetric<P>) {
      return solve_definite(metric, p, coordinates_of(problem));
    } else {
      return velocity(problem, p, p);
    }
  }
};

/// Slopes is LagrangianTerms with the derivatives by the point: one force evaluation.
template <Conservative P, class T>
struct Slopes : LagrangianTerms<P, T> {
  using LagrangianTerms<P, T>::n;
  Vec<n, T> gradient{};  ///< ∇V
  [[no_unique_address]] std::conditional_t<ConfigurationMetric<P>, Vec<n, Mat<n, T>>,
                                           typename LagrangianTerms<P, T>::Flat>
      metric_slope{};  ///< ∂_k g, by k

  Slopes() = default;
  Slopes(const P& problem, const Vec<n, T>& q) {
    if constexpr (HasGradient<P>) {
      this->potential = least::potential(problem, q);
      gradient = least::gradient(problem, q);
    } else {
      const auto v = least::potential(problem, seed<n, T>(q));
      this->potential = v.value;
      gradient = v.slope;
    }
    if constexpr (ConfigurationMetric<P>) {
      const auto g = problem.metric(seed<n, T>(q));
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) {
          this->metric[i][j] = g[i][j].value;
          for (std::size_t k = 0; k < n; ++k) metric_slope[k][i][j] = g[i][j].slope[k];
        }
    }
  }
  /// F_i = ½ v·∂_i g v − ∂_i V
  template <class U>
  Vec<n, U> force(const Vec<n, U>& v) const {
    Vec<n, U> f;
    for (std::size_t k = 0; k < n; ++k) {
      f[k] = -gradient[k];
      if constexpr (ConfigurationMetric<P>)
        for (std::size_t i = 0; i < n; ++i)
          for (std::size_t j = 0; j < n; ++j) f[k] = f[k] + 0.5 * metric_slope[k][i][j] * v[i] * v[j];
    }
    return f;
  }
};

/// Moves q and p by a step of length h in time of the variational integrator of a quadrature. For the trapezoid, `here`
/// has the slopes at q before the step, and those at the new q afterwards. Order 2, symmetric, symplectic. Where the
/// metric is constant the trapezoid is leapfrog.
template <Conservative P, class T>
StepStatus variational_step(const P& problem, Quadrature quadrature, Vec<P::dof, T>& q, Vec<P::dof, T>& p,
                            Slopes<P, T>& here, const T& h, Work& work) {
  using least::abs;
  static constexpr int n = P::dof;
  if (quadrature == Quadrature::midpoint) {
    using X = State<n, T, T>;
    MidpointStepper<P, X> stepper(problem);
    X x{T(0), q, p, {}};
    const StepStatus status = stepper.step(x, h);
    work.forces += stepper.work().forces;
    work.iterations += stepper.work().iterations;
    q = x.q;
    p = x.p;
    return status;
  }
  const T half = h * 0.5;
  Vec<n, T> v, kicked = p;
  if constexpr (ConfigurationMetric<P>) {
    v = here.raise(problem, p);
    T scale(0);
    for (const T& c : v) scale = scale + abs(c);
    const auto residual = [&](const auto& w) {
      using U = std::remove_cvref_t<decltype(w[0])>;
      auto end = w;
      for (std::size_t i = 0; i < n; ++i) end[i] = q[i] + h * w[i];
      const auto left = here.lower(problem, w), right = LagrangianTerms<P, U>(problem, end).lower(problem, w);
      const auto f = here.force(w);
      auto r = w;
      for (std::size_t i = 0; i < n; ++i) r[i] = (left[i] + right[i]) * 0.5 - half * f[i] - p[i];
      return r;
    };
    if (const StepStatus status = newton<n>(v, unknowns_of<n, n>(problem), scale, grain_of(q, h), residual, 1, work);
        status != StepStatus::ok)
      return status;
    const auto f = here.force(v);
    for (std::size_t i = 0; i < n; ++i) kicked[i] = p[i] + half * f[i];
  } else {
    for (std::size_t i = 0; i < n; ++i) kicked[i] = p[i] - half * here.gradient[i];
    v = here.raise(problem, kicked);
  }
  for (std::size_t i = 0; i < n; ++i) q[i] = q[i] + h * v[i];
  here = Slopes<P, T>(problem, q);
  ++work.forces;
  const auto f = here.force(v);
  for (std::size_t i = 0; i < n; ++i) p[i] = kicked[i] + half * f[i];
  return StepStatus::ok;
}

}  // namespace least
