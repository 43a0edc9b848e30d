// LU decompositions of matrices so small that calls and loops cost as much as their arithmetic: in place, row-major,
// with partial pivoting. The diagonal holds the inverses of the pivots. Source: Golub & Van Loan, Matrix Computations,
// 2013, 3.4.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

namespace least {

/// Calls f(n), with n as a compile-time constant for the smallest sizes, so that loops over n are unrolled.
template <class F>
decltype(auto) with_size(std::size_t n, F&& f) {
  switch (n) {
    case 1:
      return f(std::integral_constant<std::size_t, 1>{});
    case 2:
      return f(std::integral_constant<std::size_t, 2>{});
    case 3:
      return f(std::integral_constant<std::size_t, 3>{});
    case 4:
      return f(std::integral_constant<std::size_t, 4>{});
    default:
      return f(n);
  }
}

/// Replaces A, n × n, by its factors; pivots[k] is the row that was exchanged with row k.
template <class Count>
void factor_small(Count n, double* a, std::uint32_t* pivots) {
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i)
      if (std::abs(a[i * n + k]) > std::abs(a[pivot * n + k])) pivot = i;
    pivots[k] = static_cast<std::uint32_t>(pivot);
    if (pivot != k)
      for (std::size_t j = 0; j < n; ++j) std::swap(a[k * n + j], a[pivot * n + j]);
    const double inverse = a[k * n + k] = 1 / a[k * n + k];
    for (std::size_t i = k + 1; i < n; ++i) {
      const double part = a[i * n + k] *= inverse;
      for (std::size_t j = k + 1; j < n; ++j) a[i * n + j] -= part * a[k * n + j];
    }
  }
}

/// Replaces b by x with A x = b, from the factors and pivots of A; not finite where A is singular.
template <class Count>
void solve_small(Count n, const double* a, const std::uint32_t* pivots, double* b) {
  for (std::size_t k = 0; k + 1 < n; ++k) std::swap(b[k], b[pivots[k]]);
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = k + 1; i < n; ++i) b[i] -= a[i * n + k] * b[k];
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] -= a[k * n + j] * b[j];
    b[k] *= a[k * n + k];
  }
}

}  // namespace least
