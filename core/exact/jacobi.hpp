// Jacobi's elliptic functions by Gauss's descending transformation, for scalar numbers of any precision (Boost.Math's
// do not compile for float128 in strict C++20). Source: Abramowitz & Stegun, Handbook of Mathematical Functions,
// 1964, 16.12.2–4 and 17.3.29.
#pragma once

#include "core/number/math.hpp"

namespace least {

template <class T>
struct Jacobi {
  T sn, cn, dn;
  T quarter;  ///< K(k), a quarter of the period
};

/// sn, cn, dn of argument u and modulus 0 ≤ k ≤ 1; at k = 1 the quarter period is infinite.
template <class T>
Jacobi<T> jacobi(const T& u, const T& k) {
  using least::atan2;
  using least::exp;
  using least::sincos;
  using least::sqrt;
  if (!(k < T(1))) {
    const T e = exp(u < T(0) ? u : -u), sech = 2 * e / (1 + e * e);
    const T tanh = (1 - e) * (1 + e) / (1 + e * e);
    return {u < T(0) ? -tanh : tanh, sech, sech, T(std::numeric_limits<double>::infinity())};
  }
  if (k * k < Precision<T>::epsilon / 4) {
    const auto [s, c] = sincos(u);
    return {s, c, T(1), 2 * atan2(T(1), T(1))};
  }
  const T complement = sqrt((1 - k) * (1 + k)), small = (1 - complement) / (1 + complement);
  const Jacobi<T> below = jacobi(u / (1 + small), small);
  const T s2 = small * below.sn * below.sn, w = 1 + s2;
  return {(1 + small) * below.sn / w, below.cn * below.dn / w, (1 - s2) / w, (1 + small) * below.quarter};
}

}  // namespace least
