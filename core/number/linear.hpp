// Small dense linear systems. The solve is a primitive of the number, like sqrt: scalars hand it to Eigen, which
// linear.cpp alone sees, dual numbers differentiate it, lanes take it lane by lane.
#pragma once

#include <array>

#include "core/number/dual.hpp"

namespace least {

/// solve(A, b): x with A x = b, rows of A first. A singular A gives numbers that are not finite, never an error. A
/// number that is no scalar specialises it.
template <class T>
struct LinearSolver {
  template <std::size_t N>
  static std::array<T, N> solve(const std::array<std::array<T, N>, N>& a, const std::array<T, N>& b) {
    if constexpr (N == 1) {
      return {b[0] / a[0][0]};
    } else {
      return by_lu(a, b);
    }
  }

 private:
  /// For double, long double and Quad, N from 2 to 9: linear.cpp lists them.
  template <std::size_t N>
  static std::array<T, N> by_lu(const std::array<std::array<T, N>, N>& a, const std::array<T, N>& b);
};

/// A x = b differentiated: A x′ = b′ − A′x.
template <class T, int K>
struct LinearSolver<Dual<T, K>> {
  using D = Dual<T, K>;
  template <std::size_t N>
  static std::array<D, N> solve(const std::array<std::array<D, N>, N>& a, const std::array<D, N>& b) {
    std::array<std::array<T, N>, N> value;
    std::array<T, N> right;
    for (std::size_t i = 0; i < N; ++i) {
      right[i] = b[i].value;
      for (std::size_t j = 0; j < N; ++j) value[i][j] = a[i][j].value;
    }
    const auto x0 = LinearSolver<T>::solve(value, right);
    std::array<D, N> x;
    for (std::size_t i = 0; i < N; ++i) x[i].value = x0[i];
    for (std::size_t k = 0; k < K; ++k) {
      for (std::size_t i = 0; i < N; ++i) {
        right[i] = b[i].slope[k];
        for (std::size_t j = 0; j < N; ++j) right[i] = right[i] - a[i][j].slope[k] * x0[j];
      }
      const auto x1 = LinearSolver<T>::solve(value, right);
      for (std::size_t i = 0; i < N; ++i) x[i].slope[k] = x1[i];
    }
    return x;
  }
};

/// For N = 3, 5 or 7, the sizes of a contact state.
template <std::size_t N>
double determinant(const std::array<std::array<double, N>, N>& a);

}  // namespace least
