// Tangents computes derivatives of the Taylor series of a motion by its initial values and parameters: first
// derivatives of every value of a program in given directions, and second ones in pairs of directions, by
// differentiating the recurrences. Where a recurrence has a convolution Σ wⱼ aⱼ b_{k−j} of two series, its derivative
// has two convolutions of a series and a tangent, so a direction costs twice as much as the series, whatever the
// equations. Directions run side by side in wide registers. Parameters are variables of the program whose rates are
// zero.
// Sources: Barrio, SIAM J. Sci. Comput. 27, 1929 (2006); Griewank & Walther, Evaluating Derivatives, 2008, chapter 13.
#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "core/tape/series.hpp"

namespace least::tape {

class Tangents {
 public:
  using Pair = std::pair<std::size_t, std::size_t>;

  /// The numbers per variable in lists of derivatives: one for each direction or pair, then zeros up to whole fours.
  static constexpr std::size_t lanes_of(std::size_t count) { return (count + 3) / 4 * 4; }

  /// Prepares a program whose variables beyond the motion are constant.
  Tangents(const Program& program, int order, std::size_t directions, std::vector<Pair> pairs);
  /// Estimates how many numbers such an object keeps.
  static std::size_t numbers(const Program& program, int order, std::size_t directions, std::size_t pairs);

  /// Computes the series of the derivatives from `series`, which is interpreted and of the same program, and from the
  /// derivatives of the variables at its point: `first` and `second` have lanes_of(…) numbers per variable. Products of
  /// first derivatives enter the second derivative of pair i times shares[i], 1 unless derivatives are scaled; scales
  /// are powers of two.
  void expand(const Series& series, std::span<const double> first, std::span<const double> second,
              std::span<const double> shares);
  /// The order up to which all terms are finite; near a singularity they may overflow.
  int told() const { return static_cast<int>(told_); }
  /// The largest absolute value among the terms of an order of the motion's derivatives; NaN if one of them is NaN.
  double largest(int order) const;
  /// Writes the derivatives of the motion at the time h after the expansion point to `first` and `second`. The lists
  /// `…_low` carry rounding errors: on entry those of the start, on return those of the result.
  void evaluate(double h, std::span<double> first, std::span<double> first_low, std::span<double> second,
                std::span<double> second_low) const;

 private:
  /// The first or the second derivatives of all values that have any: by slot of the value, by order, by fours of
  /// lanes.
  struct Level {
    std::size_t fours = 0, orders = 0;
    std::vector<Four> rows;
    std::size_t place(Index slot, std::size_t k) const { return (static_cast<std::size_t>(slot) * orders + k) * fours; }
    Four* at(Index slot, std::size_t k) { return rows.data() + place(slot, k); }
    const Four* at(Index slot, std::size_t k) const { return rows.data() + place(slot, k); }
    const double* row(Index slot, std::size_t k) const { return reinterpret_cast<const double*>(at(slot, k)); }
  };
  /// A summand factor x′ₖ of a step.
  struct Term {
    Index x;
    std::size_t reach;
    double factor;
  };
  /// A summand factor Σ (a + b j/k) x′ⱼ y_{k−j} over j < k.
  struct Sum {
    Index x, y;
    std::size_t x_reach, y_reach;
    double factor, a, b;
    const double* series;  ///< y₀; y₁, y₂ … stand before it
    const Four* tangents;  ///< x′₀
  };
  /// A step with the ranges of its summands in terms_ and sums_; `lasts` if orders above 0 may be nonzero.
  struct Planned {
    std::size_t step, terms, terms_end, sums, sums_end;
    bool lasts;
  };
  class Pass;

  void begin(Level& level, std::span<const double> start);
  void evaluate(const Level& level, double h, std::span<double> end, std::span<double> low) const;

  std::size_t variables_, moving_, order_, told_ = 0;
  std::vector<Pair> pairs_;
  std::vector<Index> slot_;         ///< by value: the slot of its derivatives; none if they are zero
  std::vector<std::size_t> reach_;  ///< by value: how many orders may be nonzero
  Index slots_ = 0;
  std::array<Level, 2> levels_;
  // Scratch of an expansion.
  std::vector<Planned> planned_;
  std::vector<Term> terms_;
  std::vector<Sum> sums_;
  std::vector<Index> mirror_;  ///< by value: where its series stands in reverse order
  std::vector<double> mirrors_, weights_;
  std::vector<Four> found_;  ///< the sums of an order
};

}  // namespace least::tape
