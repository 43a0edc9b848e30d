// StepTangents computes how the state at the end of a Taylor step changes with the state at its beginning and with
// parameters, for several steps at once. The steps stand side by side in wide registers and share the cost of
// interpreting the program. The motion has to be known before: its states at the beginnings of steps are the input, and
// the results are matrices that carry derivatives in any direction from step to step. Their cost does not depend on the
// number of directions; where variables are many, core/tape/tangents.hpp follows directions instead. Sources: as there.
#pragma once

#include <span>
#include <vector>

#include "core/tape/series.hpp"

namespace least::tape {

class StepTangents {
 public:
  /// The number of steps side by side.
  static constexpr std::size_t steps = 8;
  /// One number for each of these steps.
  struct alignas(8 * steps) Side {
    double lane[steps];
  };

  /// Whether the program has no choices between formulas: steps side by side could not choose differently.
  static bool suits(const Program& program) { return program.switches.empty(); }
  /// Prepares a program whose variables beyond the motion are constant parameters. `along`: each step is differentiated
  /// along one direction, given at its beginning, instead of by all variables.
  StepTangents(Program program, int order, bool along = false);
  /// Estimates how many numbers such an object keeps.
  static std::size_t numbers(const Program& program, int order, bool along = false);

  /// Computes the series at the beginnings of at most `steps` steps: y has columns() variables per step, t one time per
  /// step. Fewer steps are padded with the last one.
  void expand(std::span<const double> y, std::span<const double> t) { expand(y, t, {}); }
  /// The same for an object made with `along`; `directions` is laid out as y is.
  void expand(std::span<const double> y, std::span<const double> t, std::span<const double> directions);
  /// Computes `change`, `last_term` and `term_before` from these series for steps of the lengths h.
  void find_changes(std::span<const double> h);
  /// change(i) returns the matrix ∂(y_end − y_start)/∂y_start of step i: moving() rows, columns() columns, row-major.
  const double* change(std::size_t step) const { return matrix(step, 0); }
  /// The highest two Taylor coefficients, of orders order() and order() − 1, of this matrix as a function of the time.
  const double* last_term(std::size_t step) const { return matrix(step, 1); }
  const double* term_before(std::size_t step) const { return matrix(step, 2); }
  /// Writes the matrix of one step for another length h to `change`.
  void change_in(double h, std::size_t step, double* change) const;
  /// The same for an object made with `along`, for steps of the lengths h or one step of the length h. A change has 2
  /// moving() numbers: first the changes of the variables of the motion, then those of their derivatives.
  void find_changes_along(std::span<const double> h);
  const double* change_along(std::size_t step) const { return matrices_.data() + step * 2 * program_.moving; }
  void change_along_in(double h, std::size_t step, double* change) const;
  int order() const { return static_cast<int>(order_); }
  /// Columns of the matrices: all variables, parameters included.
  std::size_t columns() const { return program_.variables; }
  /// Rows of the matrices: the variables of the motion.
  std::size_t moving() const { return program_.moving; }

 private:
  static constexpr std::size_t most_columns = 4;  ///< in a group
  /// Columns of the matrices that are computed together.
  struct Group {
    std::size_t first, count;
    std::vector<Side> rows;  ///< by slot of the value, by order, by column
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
  /// Returns order 0 of the derivative of variable i by variable c; the next orders follow `stride` apart.
  const Side* series_of(std::size_t i, std::size_t c, std::size_t& stride) const;
  /// With `along`: returns order 0 of entry i of a change; the next orders follow.
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
  std::vector<Index> slot_;         ///< by value: the slot of its derivatives; none if they are zero
  std::vector<std::size_t> reach_;  ///< by value: how many orders may be nonzero
  std::vector<Planned> planned_;
  std::vector<Term> terms_;
  std::vector<Sum> sums_;
  std::vector<Side> rows_;   ///< of the motion: by value, by order
  std::vector<Side> gains_;  ///< by step of the program: the inverse of what its recurrence divides by
  std::vector<double> row_;  ///< order 0 of all values of one step
  std::vector<Group> groups_;
  std::vector<std::size_t> group_;  ///< by column
  std::vector<Side> directions_;    ///< by variable
  std::vector<double> matrices_;
  std::vector<Side> found_;  ///< the sums of two orders
};

}  // namespace least::tape
