// TrueMotion integrates equations on a tape to some thirty digits, by Taylor series with coefficients of 106 bits that
// are computed operation by operation. A series counts time in units of about its own step, so that no coefficient
// over- or underflows. Its polynomial gives the state at any time within the step. Sources: as core/tape/series.hpp.
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
  /// `rates`: the rates ẋ, nodes of `equations` in the order of the variables. `tolerance` bounds the last terms of a
  /// step relative to the largest component, or to the smaller of 1 and the largest component at the start where that
  /// is larger.
  TrueMotion(tape::Tape equations, std::span<const tape::Index> rates, double tolerance);

  /// Whether all operations on the tape have series here: x^y with a variable exponent and sums of terms do not.
  static bool covers(const tape::Tape& tape);

  void start(std::vector<DoubleDouble> x, double t);
  /// Returns the state at t, valid until the next call; t must not be earlier than any time asked for before. The
  /// result is empty where the motion does not go on, or if keep_going() returns false, which is asked at each step,
  /// and with long equations within a step. After that the motion has to be started again.
  std::span<const DoubleDouble> at(double t, const std::function<bool()>& keep_going);
  /// Whether the motion ended where the equations have no series, such as √q³ at q = 0; another method may go on.
  bool lost() const { return lost_; }
  /// Whether the motion ended where a formula changes and either side leads back to the other, as where friction holds
  /// a body that has come to rest: the equations have no solution from there on.
  bool stuck() const { return stuck_; }

 private:
  /// Further rows of coefficients of a node; none where it needs none.
  struct Rows {
    tape::Index weighted = tape::none;  ///< k times the coefficient k
    tape::Index helper = tape::none;  ///< of sin the row of cos, of tan that of 1 + tan², of atan that of 1 + a² …
  };
  DoubleDouble* row(tape::Index i) { return rows_.data() + static_cast<std::size_t>(i) * (order_ + 1); }
  const DoubleDouble* row(tape::Index i) const { return rows_.data() + static_cast<std::size_t>(i) * (order_ + 1); }
  /// A choice between two formulas by the sign of a value.
  struct Choice {
    tape::Index by = tape::none;  ///< the value that decides
    bool first = false;           ///< the value is negative: the first formula holds
    int turns = 0;                ///< how often the side has been changed at the current expansion point
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
  std::vector<std::size_t> choice_of_;                      ///< by node of Op::select: its choice
  std::vector<Rows> rows_of_;                               ///< by node
  std::vector<tape::Index> made_;                           ///< nodes whose orders a rule computes
  std::vector<std::pair<tape::Index, tape::Index>> given_;  ///< other nodes with a weighted row, and that row
  tape::Index time_ = tape::none;
  double tolerance_, least_size_ = 1;
  std::size_t order_;
  Held held_{};  ///< for the rows
  std::vector<DoubleDouble> inverses_, reciprocals_, rows_, x_, asked_;
  std::vector<DoubleDouble> ahead_, slopes_;  ///< state at the end of the step, and its slopes by the polynomials
  double bound_ = 0;                          ///< to which order 0 of steep functions is clamped
  bool begun_ = false;                        ///< order 0 of all nodes is known at x_, or at `ahead_`
  DoubleDouble t_{};                          ///< the expansion point
  double unit_ = 1, length_ = 0;              ///< unit of time; length of the step in units, 0: there is no series yet
  double free_ = 0;                           ///< the length that it would have if no formula changed
  double longest_ = 0;                        ///< bound of the next step
  double start_ = 0;
  int short_ = 0;                                        ///< steps in a row of negligible length
  bool lost_ = false, stuck_ = false, chooses_ = false;  ///< chooses_: order 0 sets the sides
};

/// The states of two motions of the same equations at increasing times, one after the other, as far as each motion
/// goes.
struct SideBySide {
  std::array<std::vector<DoubleDouble>, 2> states;
  /// Whether one motion came to a place without a series, no later than the other one ended. Then `states` is empty.
  bool lost = false;
};
/// Runs both motions to these times on two threads. keep_going() is called on the calling thread alone, and no more
/// once it has returned false.
SideBySide side_by_side(TrueMotion& one, TrueMotion& other, std::span<const double> times,
                        const std::function<bool()>& keep_going);

}  // namespace least
