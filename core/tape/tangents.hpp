// How the Taylor series of a motion changes with what it depends on: first derivatives of every value of a program in
// some directions, and second ones of pairs of these, by derivatives of the recurrences themselves. A recurrence says
// Σ wⱼ aⱼ b_{k−j} of two series; its derivative says the same of a series and a tangent, so that a direction costs two
// such sums where the series costs one, whatever the equations. The series is the same for all directions: they stand
// side by side in wide registers. Parameters are variables of the program that rest.
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

  /// What stands for each variable, lane by lane: its derivatives in the directions, or of the pairs, then zeros.
  static constexpr std::size_t lanes_of(std::size_t count) { return (count + 3) / 4 * 4; }

  /// Of a program whose variables beyond the motion rest.
  Tangents(const Program& program, int order, std::size_t directions, std::vector<Pair> pairs);
  /// How many numbers that keeps, about.
  static std::size_t numbers(const Program& program, int order, std::size_t directions, std::size_t pairs);

  /// From the series of all values of that program (one that is read) and derivatives of the variables, variable by
  /// variable. `shares`: what a pair's products of first derivatives count; powers of two where derivatives are scaled.
  void expand(const Series& series, std::span<const double> first, std::span<const double> second,
              std::span<const double> shares);
  /// The order up to which terms are numbers: what is near a singularity overflows.
  int told() const { return static_cast<int>(told_); }
  /// The largest derivative among the terms of an order of the variables that move; NaN where one is none.
  double largest(int order) const;
  /// Derivatives of the variables at the time h from there, to `end`; as of the last expansion where h is 0. `low`:
  /// what rounding has kept from them, and keeps from the result.
  void evaluate(double h, std::span<double> first, std::span<double> first_low, std::span<double> second,
                std::span<double> second_low) const;

 private:
  /// The first or the second derivatives of all values that have any, by value, then by order.
  struct Level {
    std::size_t fours = 0, orders = 0;
    std::vector<Four> rows;
    std::size_t place(Index slot, std::size_t k) const { return (static_cast<std::size_t>(slot) * orders + k) * fours; }
    Four* at(Index slot, std::size_t k) { return rows.data() + place(slot, k); }
    const Four* at(Index slot, std::size_t k) const { return rows.data() + place(slot, k); }
    const double* row(Index slot, std::size_t k) const { return reinterpret_cast<const double*>(at(slot, k)); }
  };
  /// factor x′ₖ of a step.
  struct Term {
    Index x;
    std::size_t reach;
    double factor;
  };
  /// factor Σ (a + b j/k) x′ⱼ y_{k−j} over j < k
  struct Sum {
    Index x, y;
    std::size_t x_reach, y_reach;
    double factor, a, b;
    const double* series;  ///< y₀, before which stand y₁, y₂ …
    const Four* tangents;  ///< x′₀
  };
  /// A step, with what its derivatives are made of, from one place to another; lasts: beyond order 0.
  struct Planned {
    std::size_t step, terms, terms_end, sums, sums_end;
    bool lasts;
  };
  class Pass;

  void begin(Level& level, std::span<const double> start);
  void evaluate(const Level& level, double h, std::span<double> end, std::span<double> low) const;

  std::size_t variables_, moving_, order_, told_ = 0;
  std::vector<Pair> pairs_;
  std::vector<Index> slot_;         ///< by value where its derivatives stand; none: they are zero
  std::vector<std::size_t> reach_;  ///< by value how many orders are not zero
  Index slots_ = 0;
  std::array<Level, 2> levels_;
  // Scratch of an expansion.
  std::vector<Planned> planned_;
  std::vector<Term> terms_;
  std::vector<Sum> sums_;
  std::vector<Index> mirror_;  ///< by value where its series stands backward
  std::vector<double> mirrors_, weights_;
  std::vector<Four> found_;  ///< the sums of an order
};

}  // namespace least::tape
