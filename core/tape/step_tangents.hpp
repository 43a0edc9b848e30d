// How the state at the end of a step of a Taylor series changes with the state at its beginning and with parameters: of
// several steps at once, side by side in wide registers, so that reading the program costs a step a fraction of that.
// The steps of a motion are known before its derivatives are: these ask for the states where steps begin, and what they
// find are matrices, which lead the derivatives in any direction from step to step. So they cost the same for one
// direction as for as many as there are variables; where these are many, core/tape/tangents.hpp follows directions.
// Sources: as there.
#pragma once

#include <span>
#include <vector>

#include "core/tape/series.hpp"

namespace least::tape {

class StepTangents {
 public:
  /// How many steps stand side by side.
  static constexpr std::size_t steps = 8;
  /// A number of each of them.
  struct alignas(8 * steps) Side {
    double lane[steps];
  };

  /// Whether formulas never change sides, which steps side by side cannot do each by itself.
  static bool suits(const Program& program) { return program.switches.empty(); }
  /// Of a program whose variables beyond the motion rest: parameters. `along`: in one direction for each step, which is
  /// told where it begins, instead of by all variables.
  StepTangents(Program program, int order, bool along = false);
  /// How many numbers that keeps, about.
  static std::size_t numbers(const Program& program, int order, bool along = false);

  /// From the variables at the beginning of each step, one after the other, and the times there; what is less than all
  /// steps is filled up.
  void expand(std::span<const double> y, std::span<const double> t) { expand(y, t, {}); }
  /// The same in directions that stand as y does, where it is `along` them.
  void expand(std::span<const double> y, std::span<const double> t, std::span<const double> directions);
  /// Then what follows from these series for steps of these lengths, as many.
  void find_changes(std::span<const double> h);
  /// What the derivatives of the variables of the motion by all variables have changed by in a step: by variable of the
  /// motion, then by what it is derived by.
  const double* change(std::size_t step) const { return matrix(step, 0); }
  /// Of these as functions of the time the terms of the last order and of the one before.
  const double* last_term(std::size_t step) const { return matrix(step, 1); }
  const double* term_before(std::size_t step) const { return matrix(step, 2); }
  /// And what they change by in the time h of one.
  void change_in(double h, std::size_t step, double* change) const;
  /// Along directions, found for steps of these lengths or for the time h of one: what the variables of the motion
  /// change by, and then their derivatives.
  void find_changes_along(std::span<const double> h);
  const double* change_along(std::size_t step) const { return matrices_.data() + step * 2 * program_.moving; }
  void change_along_in(double h, std::size_t step, double* change) const;
  int order() const { return static_cast<int>(order_); }
  /// Of the matrices: all variables.
  std::size_t columns() const { return program_.variables; }
  /// And rows: those of the motion.
  std::size_t moving() const { return program_.moving; }

 private:
  static constexpr std::size_t most_columns = 4;  ///< in a group
  /// Columns of the matrices that are found together.
  struct Group {
    std::size_t first, count;
    std::vector<Side> rows;  ///< by value that has derivatives, by order, by column
  };
  struct Term {
    Index x;
    std::size_t reach;
    Side factor;
  };
  struct Sum {
    Index x, y;
    std::size_t x_reach, y_reach;
    double a, b;
    Side factor;
  };
  struct Planned {
    Index out;
    std::size_t terms, terms_end, sums, sums_end;
    bool lasts;
  };
  template <std::size_t Wide>
  class Motion;
  template <std::size_t Wide, std::size_t Count>
  class Columns;
  struct Plan;
  struct Factors;

  std::size_t entries() const { return program_.moving * program_.variables; }
  const double* matrix(std::size_t step, std::size_t which) const {
    return matrices_.data() + (step * 3 + which) * entries();
  }
  /// Where the derivative of a variable by another stands, of order 0, and how far it is from there to the next order.
  const Side* series_of(std::size_t i, std::size_t c, std::size_t& stride) const;
  /// Along directions: of all that changes, the variables of the motion and then their derivatives.
  const Side* series_along(std::size_t i) const;
  std::size_t place(Index value, std::size_t k) const { return static_cast<std::size_t>(value) * (order_ + 1) + k; }
  void begin(std::size_t step, const double* y, double t);
  template <std::size_t Wide>
  void expand_all();
  void expand_by_two();
  void expand_by_four();
  void expand_by_eight();

  Program program_;
  std::size_t order_;
  bool along_;
  std::vector<Index> slot_;         ///< by value where its derivatives stand; none: they are zero
  std::vector<std::size_t> reach_;  ///< by value how many orders are not zero
  std::vector<Planned> planned_;
  std::vector<Term> terms_;
  std::vector<Sum> sums_;
  std::vector<Side> rows_;   ///< of the motion: by value, by order
  std::vector<Side> gains_;  ///< by step what a recurrence divides by: its inverse
  std::vector<double> row_;  ///< order 0 of all values of one step
  std::vector<Group> groups_;
  std::vector<std::size_t> group_;  ///< by column
  std::vector<Side> directions_;    ///< by variable
  std::vector<double> matrices_;
  std::vector<Side> found_;  ///< the sums of two orders
};

}  // namespace least::tape
