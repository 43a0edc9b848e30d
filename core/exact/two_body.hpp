// The Kepler problem solved for a time: universal variables, one formula for ellipses, parabolas and hyperbolas.
//   t = r₀ G₁ + η₀ G₂ + μ G₃ with G_k(β, s) = s^k c_k(βs²), β = 2μ/r₀ − v₀², η₀ = q₀·v₀ (c_k: Stumpff's functions)
// Source: Stumpff, Himmelsmechanik I, 1959, §41; Wisdom & Hernandez, MNRAS 453, 3015 (2015), eqs. 5–18.
#pragma once

#include "core/problem.hpp"

namespace least::two_body {

template <class T>
struct Stumpff {
  T g0, g1, g2, g3;
};

/// G₀…G₃ at β and s. Series near β s² = 0, where the closed forms cancel.
template <class T>
Stumpff<T> stumpff(const T& beta, const T& s) {
  using least::abs;
  using least::exp;
  using least::sincos;
  using least::sqrt;
  const T x = beta * s * s;
  if (abs(x) < T(0.01)) {
    T c2 = 0, c3 = 0, term = T(0.5);
    for (int k = 1; k < 14; ++k) {  // c₂ = Σ (−x)^j/(2j+2)!, c₃ = Σ (−x)^j/(2j+3)!
      c2 = c2 + term;
      c3 = c3 + term / T(2 * k + 1);
      term = -term * x / T((2 * k + 1) * (2 * k + 2));
    }
    const T g2 = c2 * s * s, g3 = c3 * s * s * s;
    return {1 - beta * g2, s - beta * g3, g2, g3};
  }
  const T root = sqrt(abs(beta));
  T g0, g1;
  if (beta > T(0)) {
    const auto [sine, cosine] = sincos(root * s);
    g0 = cosine;
    g1 = sine / root;
  } else {
    const T e = exp(root * s);
    g0 = (e + 1 / e) / 2;
    g1 = (e - 1 / e) / (2 * root);
  }
  return {g0, g1, (1 - g0) / beta, (s - g1) / beta};
}

/// Returns the state at the time t; T is a scalar. Not finite where r₀ = 0 or the orbit is not defined.
template <int N, class T, class S>
State<N, T, S> propagate(const State<N, T, S>& x0, const T& mu, const S& t) {
  using least::abs;
  using least::atan2;
  using least::floor;
  using least::isfinite;
  using least::sqrt;
  const T r0 = sqrt(dot(x0.q, x0.q)), eta = dot(x0.q, x0.p), beta = 2 * mu / r0 - dot(x0.p, x0.p);
  T dt = t - x0.t;
  if (beta > T(0)) {  // an ellipse: whole periods fall away, the rest lies within one
    const T period = 8 * atan2(T(1), T(1)) * mu / (beta * sqrt(beta));
    dt = dt - period * floor(dt / period);
  }
  // t(s) grows with slope r > 0: bracket the root, then Newton, halving where it would leave the bracket.
  const auto excess = [&](const Stumpff<T>& g) { return r0 * g.g1 + eta * g.g2 + mu * g.g3 - dt; };
  const T sign = dt < T(0) ? T(-1) : T(1);
  T low = 0, high = sign * abs(dt) / r0;
  for (int k = 0; k < 2000 && sign * excess(stumpff(beta, high)) < T(0); ++k) {
    low = high;
    high = 2 * high;
  }
  T s = (low + high) / 2;
  for (int k = 0; k < 500; ++k) {
    const auto g = stumpff(beta, s);
    const T f = excess(g), r = r0 * g.g0 + eta * g.g1 + mu * g.g2;
    if (sign * f < T(0)) {
      low = s;
    } else {
      high = s;
    }
    T next = s - f / r;
    if (!(sign * (next - low) > T(0) && sign * (high - next) > T(0))) next = (low + high) / 2;
    const T change = abs(next - s);
    s = next;
    if (!(change > 4 * Precision<T>::epsilon * abs(s))) break;
  }
  const auto g = stumpff(beta, s);
  const T r = r0 * g.g0 + eta * g.g1 + mu * g.g2;
  const T f = 1 - mu * g.g2 / r0, h = r0 * g.g1 + eta * g.g2;  // h = dt − μG₃
  const T df = -mu * g.g1 / (r * r0), dh = 1 - mu * g.g2 / r;
  State<N, T, S> x;
  x.t = t;
  for (std::size_t i = 0; i < N; ++i) {
    x.q[i] = f * x0.q[i] + h * x0.p[i];
    x.p[i] = df * x0.q[i] + dh * x0.p[i];
  }
  return x;
}

}  // namespace least::two_body
