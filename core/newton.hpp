// Implicit steps: Newton's method with the Jacobian from dual numbers. The linear solve is a primitive of the number,
// like sqrt: scalars hand it to Eigen (the one place that uses it), dual numbers differentiate it, lanes take it lane
// by lane.
#pragma once

#include <Eigen/LU>

#include "core/number/dual.hpp"
#include "core/number/quad.hpp"
#include "core/status.hpp"

#if LDBL_MANT_DIG < 113
template <>
struct Eigen::NumTraits<least::Quad> : Eigen::GenericNumTraits<least::Quad> {
  enum {
    IsInteger = 0,
    IsSigned = 1,
    IsComplex = 0,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 8,
    MulCost = 8
  };
};
#endif

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
      using Matrix = Eigen::Matrix<T, int(N), int(N), Eigen::RowMajor>;
      using Column = Eigen::Matrix<T, int(N), 1>;
      std::array<T, N> x;
      Eigen::Map<Column>(x.data()) =
          Eigen::Map<const Matrix>(a[0].data()).partialPivLu().solve(Eigen::Map<const Column>(b.data()));
      return x;
    }
  }
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

template <std::size_t N>
double determinant(const std::array<std::array<double, N>, N>& a) {
  return Eigen::Map<const Eigen::Matrix<double, int(N), int(N), Eigen::RowMajor>>(a[0].data()).determinant();
}

/// The change of a velocity that moves the positions q by a few units in their last place within a step h: a force that
/// varies with q is not known better, whatever the velocity. Infinite for h = 0.
template <std::size_t N, class T, class S>
T grain_of(const std::array<T, N>& q, const S& h) {
  using least::abs;
  T size(std::numeric_limits<double>::min());
  for (const T& c : q) size = size + 8 * Precision<T>::epsilon * abs(c);
  return size / abs(h);
}

/// Solves residual(x) = 0 from the guess x. residual takes and gives Vec<N, U> for any number U; `scale` is the size of
/// a solution's components and `grain` the size below which an update means nothing (see `grain_of`). Ends when the
/// update is below ε^¾·scale + grain, where the next one would be below round-off; derivatives that ride along have
/// converged with it. `evaluations`: force evaluations per residual. On failure x is not a solution.
template <int N, class T, class F>
Status newton(Vec<N, T>& x, const T& scale, const T& grain, F&& residual, int evaluations, Work& work) {
  using least::abs;
  using least::any;
  using least::select;
  static constexpr int most_iterations = 50;
  const double tolerance = std::pow(Precision<T>::epsilon, 0.75);
  auto active = !(scale < scale);  // every lane; NOLINT(misc-redundant-expression)
  for (int k = 0; k < most_iterations; ++k) {
    Vec<N, Dual<T, N>> u;
    for (int i = 0; i < N; ++i) u[std::size_t(i)] = Dual<T, N>::variable(x[std::size_t(i)], i);
    const auto r = residual(u);
    Mat<N, T> jacobian;
    Vec<N, T> right;
    for (std::size_t i = 0; i < N; ++i) {
      jacobian[i] = r[i].slope;
      right[i] = r[i].value;
    }
    work.forces += evaluations;
    ++work.iterations;
    const Vec<N, T> update = LinearSolver<T>::solve(jacobian, right);
    T size = abs(update[0]);
    for (std::size_t i = 1; i < N; ++i) size = size + abs(update[i]);
    for (std::size_t i = 0; i < N; ++i) x[i] = select(active, x[i] - update[i], x[i]);
    active = active & !(size <= tolerance * scale + grain);
    if (!any(active)) return Status::ok;
  }
  return Status::solver_failed;
}

}  // namespace least
