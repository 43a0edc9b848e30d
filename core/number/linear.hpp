// Small dense linear systems of up to `largest_system` equations. Solving is a primitive of the number type, like sqrt:
// scalars use Eigen, which only linear.cpp includes, dual numbers differentiate the solution, and lanes solve lane by
// lane.
#pragma once

#include <algorithm>
#include <array>

#include "core/number/dual.hpp"

namespace least {

/// The most equations of one system, so that none allocates. The most that a scheme asks for is contact_gauss with
/// three stages, 3 (n + 2) for n degrees of freedom: 30 for 8, 60 for 18.
inline constexpr int largest_system = 64;

namespace detail {

/// Writes x with A x = b; A is n × n, row-major, and may be overwritten, and x must not overlap A or b. For double by
/// LU decomposition; for long double and Quad by LU in double with refinement, which needs a condition number below
/// 1e15 and otherwise gives NaN.
template <class T>
void solve_by_lu(std::size_t n, T* a, const T* b, T* x);
/// Replaces A, n × n, row-major, by its inverse; not finite where A is singular.
void invert(std::size_t n, double* a);
/// Returns det A; A is n × n, row-major, and may be overwritten.
double determinant_by_lu(std::size_t n, double* a);

template <std::size_t N>
constexpr void fits_the_largest_system() {
  static_assert(N <= std::size_t(largest_system),
                "more equations than `largest_system` in core/number/linear.hpp: raise it");
}

}  // namespace detail

/// LinearSolver<T>::solve(A, b, count) returns x with A x = b for the first `count` equations and unknowns; A[i] is row
/// i, and the other entries of x are 0. A singular A gives numbers that are not finite, never an error. Number types
/// that are no scalars specialise it.
template <class T>
struct LinearSolver {
  template <std::size_t N>
  static std::array<T, N> solve(const std::array<std::array<T, N>, N>& a, const std::array<T, N>& b,
                                std::size_t count = N) {
    std::array<T, N> x{};
    if (N == 1 || count == 1) {
      x[0] = b[0] / a[0][0];
      return x;
    }
    detail::fits_the_largest_system<N>();
    std::array<T, N * N> lu;  // NOLINT: what is read is written before
    for (std::size_t i = 0; i < count; ++i) std::copy_n(a[i].begin(), count, lu.begin() + std::ptrdiff_t(i * count));
    detail::solve_by_lu(count, lu.data(), b.data(), x.data());
    return x;
  }
};

/// A x = b differentiated: A x′ = b′ − A′x.
template <class T, int K>
struct LinearSolver<Dual<T, K>> {
  using D = Dual<T, K>;
  template <std::size_t N>
  static std::array<D, N> solve(const std::array<std::array<D, N>, N>& a, const std::array<D, N>& b,
                                std::size_t count = N) {
    std::array<std::array<T, N>, N> value;
    std::array<T, N> right;
    for (std::size_t i = 0; i < N; ++i) {
      right[i] = b[i].value;
      for (std::size_t j = 0; j < N; ++j) value[i][j] = a[i][j].value;
    }
    const auto x0 = LinearSolver<T>::solve(value, right, count);
    std::array<D, N> x;
    for (std::size_t i = 0; i < N; ++i) x[i].value = x0[i];
    for (std::size_t k = 0; k < K; ++k) {
      for (std::size_t i = 0; i < N; ++i) {
        right[i] = b[i].slope[k];
        for (std::size_t j = 0; j < N; ++j) right[i] = right[i] - a[i][j].slope[k] * x0[j];
      }
      const auto x1 = LinearSolver<T>::solve(value, right, count);
      for (std::size_t i = 0; i < N; ++i) x[i].slope[k] = x1[i];
    }
    return x;
  }
};

template <std::size_t N>
double determinant(const std::array<std::array<double, N>, N>& a) {
  detail::fits_the_largest_system<N>();
  auto lu = a;
  return detail::determinant_by_lu(N, lu[0].data());
}

}  // namespace least
