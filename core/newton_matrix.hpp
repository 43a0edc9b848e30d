// The matrix of Newton's method for systems whose number of unknowns is known only at run time. It is computed in plain
// numbers now and then, and solves for many right sides in between. For few unknowns it keeps the inverse, whose
// product with a right side costs least; for many the factors L and U, which take a third of the operations to compute.
// Sources: Golub & Van Loan, Matrix Computations, 2013, 3.4; Householder, The Theory of Matrices in Numerical Analysis,
// 1964, 5.3 (Gauss–Jordan elimination in place).
#pragma once

#include <cmath>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/memory_budget.hpp"
#include "core/newton.hpp"
#include "core/number/dense_factors.hpp"

namespace least {

/// NewtonMatrix solves A x = b for n unknowns. It cannot be copied; copies of its owner share it. After construction it
/// allocates nothing, except temporary memory for matrix products while it factors many unknowns.
class NewtonMatrix {
 public:
  /// The largest n for which it computes the inverse: for more unknowns the inverse takes longer than L and U and five
  /// solutions with them.
  static constexpr std::size_t most_inverted = 24;

  explicit NewtonMatrix(std::size_t unknowns) : n_(unknowns) {
    if (n_ <= most_inverted) {
      inverse_.resize(n_ * n_);
      exchanged_.resize(n_);
      return;
    }
    held_ = HeldByThread::take_soon(sizeof(double) * n_ * n_);
    factors_ = std::make_unique<DenseFactors>(n_);
    part_.resize(n_);
  }

  std::size_t size() const { return n_; }
  /// Whether rounds take so long that callers ask in between whether to go on (AskedByThread).
  bool is_large() const { return factors_ != nullptr; }
  /// entries() is A, n × n, row-major. The caller writes all of it before each call of `factor`, which overwrites it.
  double* entries() { return factors_ ? factors_->entries() : inverse_.data(); }
  /// factor() computes the inverse or the factors of A. Returns false where the computation is to end; only for many
  /// unknowns does it ask that (AskedByThread).
  bool factor() {
    if (factors_) return factors_->factor();
    invert();
    return true;
  }
  /// solve writes the x with A x = b; x and b must not overlap. For numbers that carry derivatives, A applies to values
  /// and derivatives alike. The result is not finite where A is singular.
  template <class T>
  void solve(const T* b, T* x) {
    if (factors_) {
      solve_parts<T>(
          b, x, [](auto& number) -> auto& { return number; });
      return;
    }
    const double* row = inverse_.data();
    for (std::size_t i = 0; i < n_; ++i, row += n_) {
      x[i] = row[0] * b[0];
      for (std::size_t j = 1; j < n_; ++j) x[i] = x[i] + row[j] * b[j];
    }
  }

 private:
  /// invert() uses Gauss–Jordan elimination in place, with partial pivoting.
  void invert() {
    double* const a = inverse_.data();
    const std::size_t n = n_;
    for (std::size_t k = 0; k < n; ++k) {
      std::size_t pivot = k;
      for (std::size_t i = k + 1; i < n; ++i)
        if (std::abs(a[i * n + k]) > std::abs(a[pivot * n + k])) pivot = i;
      exchanged_[k] = pivot;
      double* const from = a + k * n;
      if (pivot != k)
        for (std::size_t j = 0; j < n; ++j) std::swap(from[j], a[pivot * n + j]);
      const double share = 1 / from[k];
      from[k] = 1;
      for (std::size_t j = 0; j < n; ++j) from[j] *= share;
      for (std::size_t i = 0; i < n; ++i) {
        if (i == k) continue;
        double* const to = a + i * n;
        const double part = std::exchange(to[k], 0.0);
        for (std::size_t j = 0; j < n; ++j) to[j] -= part * from[j];
      }
    }
    for (std::size_t k = n; k-- > 0;)
      if (exchanged_[k] != k)
        for (std::size_t i = 0; i < n; ++i) std::swap(a[i * n + k], a[i * n + exchanged_[k]]);
  }

  /// `part(number)` refers to the component of a number, its value or one of its slopes, that is solved for.
  template <class Number, class T, class Part>
  void solve_parts(const T* b, T* x, Part&& part) {
    if constexpr (detail::carries_slopes<Number>) {
      using Inner = std::remove_cvref_t<decltype(Number{}.value)>;
      solve_parts<Inner>(
          b, x, [&](auto& number) -> auto& { return part(number).value; });
      for (std::size_t k = 0; k < Number{}.slope.size(); ++k)
        solve_parts<Inner>(
            b, x, [&](auto& number) -> auto& { return part(number).slope[k]; });
    } else {
      for (std::size_t i = 0; i < n_; ++i) part_[i] = static_cast<double>(part(b[i]));
      factors_->solve(part_.data());
      for (std::size_t i = 0; i < n_; ++i) part(x[i]) = Number(part_[i]);
    }
  }

  std::size_t n_;
  std::vector<double> inverse_;
  std::vector<std::size_t> exchanged_;
  std::unique_ptr<DenseFactors> factors_;
  std::vector<double> part_;  ///< a right side in plain numbers
  Held held_;
};

}  // namespace least
