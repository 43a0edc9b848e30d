// Vectors and small matrices of any number: what mechanics is written with.
#pragma once

#include <array>

#include "core/number/dual.hpp"

namespace least {

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

/// Solves g x = b for a symmetric positive definite g by elimination: no pivots, so no branch for any number. It solves
/// the first `count` equations and unknowns only; the other entries of x are those of b.
template <std::size_t N, class T>
constexpr std::array<T, N> solve_definite(std::array<std::array<T, N>, N> g, std::array<T, N> b,
                                          std::size_t count = N) {
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t i = k + 1; i < count; ++i) {
      const T f = g[i][k] / g[k][k];
      for (std::size_t j = k + 1; j < count; ++j) g[i][j] = g[i][j] - f * g[k][j];
      b[i] = b[i] - f * b[k];
    }
  for (std::size_t i = count; i-- > 0;) {
    for (std::size_t j = i + 1; j < count; ++j) b[i] = b[i] - g[i][j] * b[j];
    b[i] = b[i] / g[i][i];
  }
  return b;
}

}  // namespace least
