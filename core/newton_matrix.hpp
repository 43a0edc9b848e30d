// The matrix of Newton's method for systems whose number of unknowns is known only when they run: made of plain numbers
// now and then, it solves for many right sides in between. Few unknowns are solved for by the inverse, whose product
// with a right side costs least; many by the factors L and U, which are made in a third of the operations. Sources:
// Golub & Van Loan, Matrix Computations, 2013, 3.4; Householder, The Theory of Matrices in Numerical Analysis, 1964,
// 5.3 (Gauss–Jordan elimination in place).
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

/// Not copied: who is copied shares it. Nothing is allocated once it is made, but by the factors of many unknowns what
/// products of matrices take for a moment.
class NewtonMatrix {
 public:
  /// Unknowns up to which the inverse is made: from there on it takes longer than L and U and five solutions by them.
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
  /// Whether rounds take so long that who makes them asks whether to go on (AskedByThread).
  bool is_large() const { return factors_ != nullptr; }
  /// Row by row: written whole before each call of `factor`, which spoils them.
  double* entries() { return factors_ ? factors_->entries() : inverse_.data(); }
  /// Makes it ready to solve. False: it is not to go on (AskedByThread), which it asks where there are many unknowns.
  bool factor() {
    if (factors_) return factors_->factor();
    invert();
    return true;
  }
  /// x with A x = b, which are two lists. Of numbers that carry derivatives each is solved for by the plain numbers of
  /// A. What is found is not finite where A has no inverse.
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
  /// By elimination in place, with pivots from each column.
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

  /// `part`: which plain number of a number, or of what it carries, is solved for.
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
  std::vector<double> part_;  ///< of a right side
  Held held_;
};

}  // namespace least
