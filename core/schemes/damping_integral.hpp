// What a step along time reads of α(t) and V(q, t): the rate of damping with its integral, and how V changes.
#pragma once

#include "core/equations.hpp"

namespace least {

/// α at a time, its derivative in time, and its integral from a time that the problem or the run chooses.
template <class T>
struct DampingAt {
  T rate{}, slope{}, integral{};
};

namespace detail {
/// ∫α from t₀ to t₁ by Gauss's rule of order 10.
template <LinearContact P, class T>
T damping_by_quadrature(const P& m, const T& t0, const T& t1) {
  using least::sqrt;
  const T half = 0.5 * (t1 - t0), middle = 0.5 * (t0 + t1);
  const auto both = [&](const T& node) {
    return damping(m, phase(m, T(middle + half * node))) + damping(m, phase(m, T(middle - half * node)));
  };
  const T root = 2.0 * sqrt(T(10) / T(7)), inner = sqrt(T(5) - root) / 3.0, outer = sqrt(T(5) + root) / 3.0;
  const T far = sqrt(T(70)), w0 = T(128) / T(225), w1 = (322.0 + 13.0 * far) / 900.0, w2 = (322.0 - 13.0 * far) / 900.0;
  return half * (w0 * damping(m, phase(m, middle)) + w1 * both(inner) + w2 * both(outer));
}
}  // namespace detail

/// Returns α at t. The integral begins at t if the problem does not give it.
template <LinearContact P, class T>
requires(!ConstantDamping<P>) DampingAt<T> damping_at(const P& m, const T& t) {
  using D = Dual<T, 1>;
  const D now(t, {T(1)});
  if constexpr (HasDampingIntegral<P>) {
    const auto a = m.damping_integral(Dual<D, 1>(now, {D(T(1))}));
    return {a.slope[0].value, a.slope[0].slope[0], a.value.value};
  } else {
    const D rate = damping(m, phase(m, now));
    return {rate.value, rate.slope[0], T(0)};
  }
}
/// Returns α at t₁, with the integral continued from `before`, its value at t₀.
template <LinearContact P, class T>
DampingAt<T> damping_after(const P& m, [[maybe_unused]] const DampingAt<T>& before, [[maybe_unused]] const T& t0,
                           const T& t1) {
  DampingAt<T> at = damping_at(m, t1);
  if constexpr (!HasDampingIntegral<P>) at.integral = before.integral + detail::damping_by_quadrature(m, t0, t1);
  return at;
}

/// Returns ∂V/∂t at q and t.
template <Potential P, class T>
T potential_rate(const P& m, const Vec<P::dof, T>& q, const T& t) {
  using D = Dual<T, 1>;
  Vec<P::dof, D> fixed;
  for (std::size_t i = 0; i < q.size(); ++i) fixed[i] = D(q[i]);
  return m.potential(fixed, phase(m, D(t, {T(1)}))).slope[0];
}

}  // namespace least
