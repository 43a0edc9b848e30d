// What a problem can offer, as concepts, and the mechanics that follows from it.
//
// A problem is `template <class R = double> struct X` holding its parameters and nothing else. It states its mechanics
// once, generic in the number T of the state and S of time:
//   potential(q, t)       V, the primary form
//   inverse_mass()        diagonal of g⁻¹ where the constant kinetic metric g is not the identity
//   metric(q)             g(q), symmetric and positive definite, where it depends on the configuration
//   gradient(q, t)        ∇V by hand, where that pays (a law checks it against the potential)
//   frequency_squared(q)  estimate of the largest squared local frequency, where a step can be too long for it
//   careful_step          ωh from which a run warns, where half the stability bound is too late
//   invariants(q, p, t)   what the exact motion conserves besides energy
//   exact(x0, t)          the solution, where there is a closed form (scalar numbers only)
// Everything else (vector field, Hamiltonian, Lagrangian, their derivatives) is derived here.
// Notation: K = ½ g_ij v^i v^j = ½ pᵀg⁻¹p, H = K + V, L = K − V.
#pragma once

#include <concepts>

#include "core/number/dual.hpp"
#include "core/state.hpp"

namespace least {

template <class P>
concept Potential = requires(const P& m, const Vec<P::dof>& q, double t) {
  { m.potential(q, t) } -> std::convertible_to<double>;
};
template <class P>
concept ConfigurationMetric = Potential<P> && requires(const P& m, const Vec<P::dof>& q) {
  { m.metric(q) } -> std::same_as<Mat<P::dof>>;
};
/// H = ½ pᵀg⁻¹p + V(q, t) with a constant diagonal metric g: kicks and drifts are explicit.
template <class P>
concept Separable = Potential<P> && !ConfigurationMetric<P>;
/// L = ½ g_ij v^i v^j − V with any metric.
template <class P>
concept Lagrangian = Potential<P>;
/// Has equations of motion ẏ = f(t, y).
template <class P>
concept VectorField = Potential<P>;

template <class P>
concept HasGradient = requires(const P& m, const Vec<P::dof>& q, double t) {
  m.gradient(q, t);
};
template <class P>
concept HasInverseMass = requires(const P& m) {
  m.inverse_mass();
};
template <class P>
concept HasFrequency = requires(const P& m, const Vec<P::dof>& q) {
  m.frequency_squared(q);
};
template <class P>
concept HasInvariants = requires(const P& m, const Vec<P::dof>& q) {
  m.invariants(q, q, 0.0);
};
template <class P>
concept HasExact = requires(const P& m, const State<P::dof>& x) {
  { m.exact(x, 0.0) } -> std::same_as<State<P::dof>>;
};

template <class P, class T = double, class S = double>
using StateOf = State<P::dof, T, S>;

/// The coordinates as independent variables of a dual number.
template <int N, class T>
constexpr Vec<N, Dual<T, N>> seed(const Vec<N, T>& q) {
  Vec<N, Dual<T, N>> x;
  for (int i = 0; i < N; ++i) x[std::size_t(i)] = Dual<T, N>::variable(q[std::size_t(i)], i);
  return x;
}

template <std::size_t N, class T>
constexpr std::array<T, N> operator*(const std::array<std::array<T, N>, N>& a, const std::array<T, N>& x) {
  std::array<T, N> y;
  for (std::size_t i = 0; i < N; ++i) {
    y[i] = a[i][0] * x[0];
    for (std::size_t j = 1; j < N; ++j) y[i] = y[i] + a[i][j] * x[j];
  }
  return y;
}

template <std::size_t N, class T>
constexpr T dot(const std::array<T, N>& a, const std::array<T, N>& b) {
  T sum = a[0] * b[0];
  for (std::size_t i = 1; i < N; ++i) sum = sum + a[i] * b[i];
  return sum;
}

/// Solves g x = b for a symmetric positive definite g by elimination: no pivots, so no branch for any number.
template <std::size_t N, class T>
constexpr std::array<T, N> solve_definite(std::array<std::array<T, N>, N> g, std::array<T, N> b) {
  for (std::size_t k = 0; k < N; ++k)
    for (std::size_t i = k + 1; i < N; ++i) {
      const T f = g[i][k] / g[k][k];
      for (std::size_t j = k + 1; j < N; ++j) g[i][j] = g[i][j] - f * g[k][j];
      b[i] = b[i] - f * b[k];
    }
  for (std::size_t i = N; i-- > 0;) {
    for (std::size_t j = i + 1; j < N; ++j) b[i] = b[i] - g[i][j] * b[j];
    b[i] = b[i] / g[i][i];
  }
  return b;
}

/// ∇V at (q, t).
template <Potential P, class T, class S>
constexpr Vec<P::dof, T> gradient(const P& m, const Vec<P::dof, T>& q, const S& t) {
  if constexpr (HasGradient<P>) {
    return m.gradient(q, t);
  } else {
    return m.potential(seed<P::dof, T>(q), t).slope;
  }
}

/// v = g⁻¹ p
template <Potential P, class T>
constexpr Vec<P::dof, T> velocity(const P& m, const Vec<P::dof, T>& q, const Vec<P::dof, T>& p) {
  if constexpr (ConfigurationMetric<P>) {
    return solve_definite(m.metric(q), p);
  } else if constexpr (HasInverseMass<P>) {
    const auto w = m.inverse_mass();
    Vec<P::dof, T> v;
    for (std::size_t i = 0; i < v.size(); ++i) v[i] = w[i] * p[i];
    return v;
  } else {
    return p;
  }
}

/// p = g v
template <Potential P, class T>
constexpr Vec<P::dof, T> momentum(const P& m, const Vec<P::dof, T>& q, const Vec<P::dof, T>& v) {
  if constexpr (ConfigurationMetric<P>) {
    return m.metric(q) * v;
  } else if constexpr (HasInverseMass<P>) {
    const auto w = m.inverse_mass();
    Vec<P::dof, T> p;
    for (std::size_t i = 0; i < p.size(); ++i) p[i] = v[i] / w[i];
    return p;
  } else {
    return v;
  }
}

/// H(q, p, t)
template <Potential P, class T, class S>
constexpr T hamiltonian(const P& m, const Vec<P::dof, T>& q, const Vec<P::dof, T>& p, const S& t) {
  return T(0.5) * dot(p, velocity(m, q, p)) + m.potential(q, t);
}

/// ∂L/∂q at fixed velocity v: the force, with the metric's own part where it depends on q.
template <Lagrangian P, class T, class S>
constexpr Vec<P::dof, T> lagrangian_force(const P& m, const Vec<P::dof, T>& q, const Vec<P::dof, T>& v, const S& t) {
  Vec<P::dof, T> f;
  if constexpr (ConfigurationMetric<P>) {
    const auto x = seed<P::dof, T>(q);
    Vec<P::dof, Dual<T, P::dof>> w;
    for (std::size_t i = 0; i < w.size(); ++i) w[i] = v[i];
    f = (T(0.5) * dot(w, m.metric(x) * w) - m.potential(x, t)).slope;
  } else {
    f = gradient(m, q, t);
    for (auto& c : f) c = -c;
  }
  return f;
}

/// Right-hand side of Hamilton's equations: q̇ = ∂H/∂p, ṗ = −∂H/∂q = ∂L/∂q at v = ∂H/∂p. One force evaluation.
template <VectorField P, class T, class S>
constexpr StateOf<P, T, S> derivative(const P& m, const StateOf<P, T, S>& x) {
  StateOf<P, T, S> d;
  d.t = S(1);
  d.q = velocity(m, x.q, x.p);
  d.p = lagrangian_force(m, x.q, d.q, x.t);
  return d;
}

/// x + h d, component by component, for q and p; t is left to the caller.
template <int N, class T, class S>
constexpr State<N, T, S> shifted(const State<N, T, S>& x, const S& h, const State<N, T, S>& d) {
  State<N, T, S> y = x;
  for (std::size_t i = 0; i < y.q.size(); ++i) {
    y.q[i] = y.q[i] + h * d.q[i];
    y.p[i] = y.p[i] + h * d.p[i];
  }
  return y;
}

}  // namespace least
