// CloserSeries computes a Taylor series in double-double, for places where formulas lose the digits of a double. A
// formula that is 0/0 somewhere, such as (x cos x − sin x)/x² at x = 0, may be smooth there, but close by its terms
// cancel, and their rounding errors are divided by something small, in every order of the series anew. If a divisor
// vanishes at the time ρ from the expansion point, a rounding error of the rates returns in the k-th coefficient ρ⁻ᵏ
// times as large; where terms cancel to the last digit, a coefficient is even missing. Sources: Higham, Accuracy and
// Stability of Numerical Algorithms, 2002, 3.3 (running error analysis); for the rules those of core/tape/series.hpp.
#pragma once

#include <memory>
#include <vector>

#include "core/tape/double_double.hpp"
#include "core/tape/series.hpp"

namespace least::tape {

class CloserSeries {
 public:
  /// The largest relative rounding error of a double.
  static constexpr double rounding = 0x1p-53;

  /// Makes the series of a program up to an order; null if the program divides by no value, or if it would take much
  /// memory.
  static std::unique_ptr<CloserSeries> of(const Program& program, int order);

  /// Estimates how far, in complex time, the nearest zero of a divisor d lies: the minimum of |d₀/dₖ|^{1/k} over k ≥ 1
  /// and over those divisors whose series allows a zero within h; no zero lies nearer than half of it. Infinite where
  /// no series does.
  static double reach(const Program& program, const Workspace& of, double h);
  /// Estimates, by running error analysis, the largest absolute rounding error of a rate of the motion that is computed
  /// in doubles. `row` has order 0 of all values.
  double blur(const Program& program, const double* row);
  /// Writes all orders of all values at the variables and the time of the workspace, rounded to doubles, to its rows.
  void expand(const Program& program, const Workspace& of);
  /// Approximate memory in bytes after the first expansion.
  std::size_t bytes() const { return blurs_.size() * (sizeof(double) + sizeof(DoubleDouble) * orders_); }

 private:
  CloserSeries(const Program& program, std::size_t orders);
  DoubleDouble* row(Index value) { return rows_.data() + static_cast<std::size_t>(value) * orders_; }
  void begin(const Program& program, const Step& s);
  void advance(const Program& program, const Step& s, std::size_t k);

  std::size_t orders_;              ///< number of orders, order 0 included
  std::vector<DoubleDouble> rows_;  ///< by value, then by order; allocated by the first expansion
  std::vector<double> blurs_;       ///< by value: the rounding error of order 0
};

}  // namespace least::tape
