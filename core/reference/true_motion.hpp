// The motion of equations on a tape to some thirty digits: its Taylor series with coefficients of 106 bits, operation
// by operation. A series counts time in units of about its own step, so that no coefficient over- or underflows. Any
// time within a step is told by the polynomial. Sources: as core/tape/series.hpp.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "core/memory_budget.hpp"
#include "core/tape/double_double.hpp"
#include "core/tape/steep.hpp"

namespace least {

class TrueMotion {
 public:
  /// Of the tape of equations the rates ẋ of the variables, in their order. `tolerance`: of the last terms of a step,
  /// relative to the largest component, now or at the start, or to 1 where the start is larger.
  TrueMotion(tape::Tape equations, std::span<const tape::Index> rates, double tolerance);

  /// Whether series are made of all that stands on the tape: of x^y of two that vary and of sums of terms none are.
  static bool covers(const tape::Tape& tape);

  void start(std::vector<DoubleDouble> x, double t);
  /// The state at t, which is no earlier than any time asked for before. Empty where keep_going() says so, which is
  /// asked at each step, and of long equations within it, or where the motion does not go on. Once it has said so
  /// nothing is known of the motion any more until it is started again.
  std::span<const DoubleDouble> at(double t, const std::function<bool()>& keep_going);
  /// Whether it ended where the equations have no series, as √q³ at q = 0: others may go on.
  bool lost() const { return lost_; }
  /// Whether it ended where a formula changes and either side leads back to the other, as where friction holds what
  /// has come to rest: the equations have no solution from there.
  bool stuck() const { return stuck_; }

 private:
  /// Rows of coefficients beside the node's own; none where it needs none.
  struct Rows {
    tape::Index weighted = tape::none;  ///< k times the coefficient k
    tape::Index helper = tape::none;  ///< of sin the row of cos, of tan that of 1 + tan², of atan that of 1 + a² …
  };
  DoubleDouble* row(tape::Index i) { return rows_.data() + static_cast<std::size_t>(i) * (order_ + 1); }
  const DoubleDouble* row(tape::Index i) const { return rows_.data() + static_cast<std::size_t>(i) * (order_ + 1); }
  /// What formulas are chosen by, and which of the two is.
  struct Choice {
    tape::Index by = tape::none;  ///< the value that decides
    bool first = false;           ///< it is negative
    int turns = 0;                ///< how often it has been changed where the series stands
  };
  void begin(tape::Index i);
  void begin_all(double bound);
  bool finite_rates() const;
  void begin_at(const std::vector<DoubleDouble>& x, bool bounded);
  const DoubleDouble* divisor_of(tape::Index i) const;
  void extend(tape::Index i, std::size_t k);
  bool expand(const std::function<bool()>& keep_going);
  double largest(std::size_t k) const;
  std::size_t finite_orders() const;
  double length(std::size_t used) const;
  double until_pole(double h, std::size_t used) const;
  bool settle(const std::function<bool()>& keep_going);
  bool solves(double h);
  bool until_steep();
  bool take_sides();
  double most_change(const Choice& choice, double end) const;
  double change_of(const Choice& choice, double end) const;
  double told_until(const Choice& choice, double end) const;
  void until_change();
  bool shorten(const std::function<bool()>& keep_going);
  DoubleDouble within(tape::Index variable, const DoubleDouble& h) const;

  tape::Tape tape_;
  std::vector<tape::Index> rates_, variables_;
  std::vector<tape::SteepArgument> steep_;
  std::vector<tape::Index> poles_;  ///< divisors linear in time
  std::vector<Choice> choices_;
  std::vector<std::size_t> choice_of_;                      ///< by node that chooses
  std::vector<Rows> rows_of_;                               ///< by node
  std::vector<tape::Index> made_;                           ///< nodes of which a rule makes orders
  std::vector<std::pair<tape::Index, tape::Index>> given_;  ///< others that are weighted, and where that goes
  tape::Index time_ = tape::none;
  double tolerance_, least_size_ = 1;
  std::size_t order_;
  Held held_{};  ///< for the rows
  std::vector<DoubleDouble> inverses_, reciprocals_, rows_, x_, asked_;
  std::vector<DoubleDouble> ahead_, slopes_;  ///< at the end of the step, and as its polynomials have it
  double bound_ = 0;                          ///< of steep functions where their order 0 is made
  bool begun_ = false;                        ///< order 0 of all nodes is that at x_, or at `ahead_`
  DoubleDouble t_{};                          ///< where the series stands
  double unit_ = 1, length_ = 0;              ///< of time; of the step from there, in units; 0: there is no series yet
  double free_ = 0;                           ///< the length that it would have if no formula changed
  double longest_ = 0;                        ///< a step may be
  double start_ = 0;
  int short_ = 0;                                        ///< steps in a row that are next to nothing
  bool lost_ = false, stuck_ = false, chooses_ = false;  ///< sides are those of order 0
};

/// The states of two motions of the same equations at increasing times, one after the other, as far as each comes.
struct SideBySide {
  std::array<std::vector<DoubleDouble>, 2> states;
  /// One has come to a place without a series, no later than where the other one ended: then there are no states.
  bool lost = false;
};
/// Side by side, as they take their time. keep_going() is asked by the thread that calls, and no more once it has said
/// no.
SideBySide side_by_side(TrueMotion& one, TrueMotion& other, std::span<const double> times,
                        const std::function<bool()>& keep_going);

}  // namespace least
