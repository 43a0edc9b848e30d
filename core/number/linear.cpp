#include "core/number/linear.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/number/asked_by_thread.hpp"
#include "core/number/dense_factors.hpp"
#include "core/number/quad.hpp"

namespace least {
namespace {

template <int N>
using Square = Eigen::Matrix<double, N, N, Eigen::RowMajor, N == Eigen::Dynamic ? largest_system : N,
                             N == Eigen::Dynamic ? largest_system : N>;
template <int N>
using Column = Eigen::Matrix<double, N, 1, 0, N == Eigen::Dynamic ? largest_system : N, 1>;
/// Factors in the place of the matrix, so that only the list of pivots is reserved for the largest system.
template <int N>
using Factors = Eigen::PartialPivLU<Eigen::Ref<Square<N>>>;

template <int N>
void solve(std::size_t n, double* a, const double* b, double* x) {
  const auto size = static_cast<Eigen::Index>(n);
  Eigen::Map<Square<N>> rows(a, size, size);
  const Factors<N> lu(rows);
  Eigen::Map<Column<N>>(x, size) = lu.solve(Eigen::Map<const Column<N>>(b, size));
}

/// Matrices of systems with more than `largest_system` equations.
using Large = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
bool is_large(std::size_t n) { return n > std::size_t(largest_system); }
Eigen::PartialPivLU<Large> large_factors(std::size_t n, const double* a) {
  const auto size = static_cast<Eigen::Index>(n);
  return Eigen::PartialPivLU<Large>(Eigen::Map<const Large>(a, size, size));
}
void solve_large(std::size_t n, const double* a, const double* b, double* x) {
  const auto size = static_cast<Eigen::Index>(n);
  Eigen::Map<Eigen::VectorXd>(x, size) = large_factors(n, a).solve(Eigen::Map<const Eigen::VectorXd>(b, size));
}

/// Factors in double and residuals in T: each round gains the digits that double has beyond those that the condition of
/// A costs. (Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., 12.1. Eigen's own factors in T take
/// fifteen seconds to compile, in each of three builds.)
template <class T>
void solve_refined(std::size_t n, const T* a, const T* b, T* x) {
  using std::abs;
  constexpr auto any = Eigen::Dynamic;
  const auto size = static_cast<Eigen::Index>(n);
  Square<any> rows(size, size);
  for (std::size_t i = 0; i < n * n; ++i) rows.data()[i] = static_cast<double>(a[i]);
  Eigen::Ref<Square<any>> in_place(rows);
  const Factors<any> lu(in_place);
  Column<any> residual(size), correction(size);
  for (std::size_t i = 0; i < n; ++i) {
    x[i] = T(0);
    residual[Eigen::Index(i)] = static_cast<double>(b[i]);
  }
  double before = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 50; ++round) {
    correction = lu.solve(residual);
    const double size_now = correction.lpNorm<Eigen::Infinity>();
    if (round > 0 && !(size_now < before / 2)) {  // only rounding is left, or A is too ill-conditioned
      double size_of_x = 0;
      for (std::size_t i = 0; i < n; ++i) size_of_x = std::max(size_of_x, std::abs(static_cast<double>(x[i])));
      const double grain = 1e9 * static_cast<double>(std::numeric_limits<T>::epsilon());
      if (!(size_now <= grain * size_of_x)) std::fill_n(x, n, std::numeric_limits<T>::quiet_NaN());
      return;
    }
    before = size_now;
    for (std::size_t i = 0; i < n; ++i) x[i] += T(correction[Eigen::Index(i)]);
    for (std::size_t i = 0; i < n; ++i) {
      T rest = b[i];
      for (std::size_t j = 0; j < n; ++j) rest -= a[i * n + j] * x[j];
      residual[Eigen::Index(i)] = static_cast<double>(rest);
    }
  }
}

void invert_in_place(std::size_t n, double* a) {
  const auto size = static_cast<Eigen::Index>(n);
  Eigen::Map<Square<Eigen::Dynamic>> rows(a, size, size);
  Square<Eigen::Dynamic> factored = rows;
  Eigen::Ref<Square<Eigen::Dynamic>> in_place(factored);
  const Factors<Eigen::Dynamic> lu(in_place);
  Column<Eigen::Dynamic> axis(size);
  for (Eigen::Index k = 0; k < size; ++k) {
    axis.setZero();
    axis[k] = 1;
    rows.col(k) = lu.solve(axis);
  }
}

}  // namespace

template <class T>
void detail::solve_by_lu(std::size_t n, T* a, const T* b, T* x) {
  if constexpr (std::is_same_v<T, double>) {
    // A fixed size saves up to 50 ns but takes two seconds to compile: only the smallest, most frequent sizes have it.
    if (is_large(n)) return solve_large(n, a, b, x);
    if (n == 2) return solve<2>(n, a, b, x);
#ifndef LEAST_FEW_SIZES
    if (n == 3) return solve<3>(n, a, b, x);
    if (n == 4) return solve<4>(n, a, b, x);
#endif
    solve<Eigen::Dynamic>(n, a, b, x);
  } else {
    solve_refined(n, a, b, x);
  }
}
template void detail::solve_by_lu(std::size_t, double*, const double*, double*);
template void detail::solve_by_lu(std::size_t, long double*, const long double*, long double*);
#if LDBL_MANT_DIG < 113
template void detail::solve_by_lu(std::size_t, Quad*, const Quad*, Quad*);
#endif

void detail::invert(std::size_t n, double* a) {
  if (!is_large(n)) return invert_in_place(n, a);
  const auto size = static_cast<Eigen::Index>(n);
  Eigen::Map<Large>(a, size, size) = large_factors(n, a).inverse();
}

struct DenseFactors::Eigens {
  Large matrix;  ///< in which L and U take the place of A
  Eigen::VectorXi exchanged;
};
DenseFactors::DenseFactors(std::size_t n) : of_(std::make_unique<Eigens>()) {
  const auto size = static_cast<Eigen::Index>(n);
  of_->matrix.resize(size, size);
  of_->exchanged.resize(size);
}
DenseFactors::~DenseFactors() = default;
double* DenseFactors::entries() { return of_->matrix.data(); }
/// Blocked Gaussian elimination with partial pivoting: the columns to the right of a block of `at_once` columns are
/// updated by products of matrices. (Golub & Van Loan, Matrix Computations, 2013, 3.4.6.) Entries that are negligible
/// beside their pivot become 0: where only neighbours are coupled, factors decay with the distance until they are
/// subnormal, and processors are a hundred times slower with these.
bool DenseFactors::factor() {
  constexpr Eigen::Index at_once = 48;
  constexpr double nothing = 1e-150;
  Large& a = of_->matrix;
  const Eigen::Index n = a.rows();
  for (Eigen::Index first = 0; first < n; first += at_once) {
    if (!AskedByThread::goes_on()) return false;
    const Eigen::Index count = std::min(at_once, n - first), right = n - first - count;
    for (Eigen::Index k = first; k < first + count; ++k) {
      Eigen::Index pivot = 0;
      a.col(k).tail(n - k).cwiseAbs().maxCoeff(&pivot);
      pivot += k;
      of_->exchanged[k] = static_cast<int>(pivot);
      if (pivot != k) a.row(k).swap(a.row(pivot));
      const Eigen::Index left = first + count - k - 1;
      for (Eigen::Index i = k + 1; i < n; ++i) {
        const double part = a(i, k) /= a(k, k);
        if (std::abs(part) < nothing) {
          a(i, k) = 0;
        } else {
          a.row(i).segment(k + 1, left) -= part * a.row(k).segment(k + 1, left);
        }
      }
    }
    if (right == 0) break;
    auto beside = a.block(first, n - right, count, right);
    a.block(first, first, count, count).triangularView<Eigen::UnitLower>().solveInPlace(beside);
    for (Eigen::Index k = 0; k < count; ++k) {
      const double least = nothing * std::abs(a(first + k, first + k));
      for (Eigen::Index j = 0; j < right; ++j)
        if (std::abs(beside(k, j)) < least) beside(k, j) = 0;
    }
    a.bottomRightCorner(right, right).noalias() -= a.block(n - right, first, right, count) * beside;
  }
  return true;
}
void DenseFactors::solve(double* b) {
  Eigen::Map<Eigen::VectorXd> x(b, of_->matrix.rows());
  for (Eigen::Index k = 0; k < x.size(); ++k) std::swap(x[k], x[of_->exchanged[k]]);
  of_->matrix.triangularView<Eigen::UnitLower>().solveInPlace(x);
  of_->matrix.triangularView<Eigen::Upper>().solveInPlace(x);
}

double detail::determinant_by_lu(std::size_t n, double* a) {
  if (is_large(n)) return large_factors(n, a).determinant();
  const auto size = static_cast<Eigen::Index>(n);
  Eigen::Map<Square<Eigen::Dynamic>> rows(a, size, size);
  return Factors<Eigen::Dynamic>(rows).determinant();
}

}  // namespace least
