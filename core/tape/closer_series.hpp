// A series to twice the digits of a double, for where formulas lose those that a double has. One that is 0/0 at a
// place, as (x cos x − sin x)/x² at x = 0, is smooth, but beside that place terms cancel, and what rounding has left of
// them is divided by something small, in every order of the series anew: of a divisor that vanishes at the time ρ from
// there, what rounding changes in the rates comes back in the k-th coefficient ρ⁻ᵏ times as large, or, where terms
// happen to cancel to the last digit, as a coefficient that is missing. Sources: Higham, Accuracy and Stability of
// Numerical Algorithms, 2002, 3.3 (running error analysis); for the rules those of core/tape/series.hpp.
#pragma once

#include <memory>
#include <vector>

#include "core/tape/double_double.hpp"
#include "core/tape/series.hpp"

namespace least::tape {

class CloserSeries {
 public:
  /// What rounding takes from a number, at most, relative to it.
  static constexpr double rounding = 0x1p-53;

  /// Of a program that divides, by what may become small; null of others, and where it would take much memory.
  static std::unique_ptr<CloserSeries> of(const Program& program, int order);

  /// How far the nearest zero is of what is divided by, in complex time, or up to half as far, where there may be one
  /// within h of a series; infinite where there is none.
  static double reach(const Program& program, const Workspace& of, double h);
  /// What rounding changes in a rate of the motion at most, about, if values are computed in doubles; `row`: all of
  /// order 0.
  double blur(const Program& program, const double* row);
  /// All orders of all values, at the variables and the time of the workspace, as doubles.
  void expand(const Program& program, const Workspace& of);
  /// What it takes in memory, about, once it has been expanded.
  std::size_t bytes() const { return blurs_.size() * (sizeof(double) + sizeof(DoubleDouble) * orders_); }

 private:
  CloserSeries(const Program& program, std::size_t orders);
  DoubleDouble* row(Index value) { return rows_.data() + static_cast<std::size_t>(value) * orders_; }
  void begin(const Program& program, const Step& s);
  void advance(const Program& program, const Step& s, std::size_t k);

  std::size_t orders_;              ///< with order 0
  std::vector<DoubleDouble> rows_;  ///< by value; made when they are first needed
  std::vector<double> blurs_;       ///< of order 0, by value
};

}  // namespace least::tape
