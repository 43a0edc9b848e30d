// Events of the caller's own: zeros of expressions along a run. From states at equal distances it is decided cheaply
// whether an expression may vanish between the last two; if it may, the dense output of the step is searched.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/run/diagnostics/zero_search.hpp"
#include "core/run/outcome.hpp"
#include "core/run/request.hpp"

namespace least {

/// Zero is the time of a zero, and the index of the expression.
struct Zero {
  double t;
  std::size_t which;
};

/// Watch searches the zeros that a request asks for. Signs has one bit for each expression, set where it is negative.
class Watch {
 public:
  using Signs = ZeroSearch::Bits;
  /// Observes states at times between two states.
  using ObserveAt = ZeroSearch::ObserveAt;

  /// Looks holds the last states that were looked at, as `observe` writes them.
  struct Looks {
    static constexpr std::size_t together = 8, most = 16;
    std::vector<double> observed;  ///< one row for each
    std::array<double, most> t;
    std::size_t last = 0;     ///< index of the last row
    std::size_t waiting = 0;  ///< number of states that were collected, but not settled

    Looks() { t.fill(unknown); }
    double t_last() const { return t[last]; }
  };

  /// Unresolved counts what searches have left unresolved so far. After a few such steps a run is searched less
  /// closely.
  struct Unresolved {
    Signs which = 0;
    double at = unknown;     ///< the end of the first such step
    std::int64_t steps = 0;  ///< number of such steps
  };

  explicit Watch(const Request& request);

  bool empty() const { return measures_.empty(); }
  const Measures& measures() const { return measures_; }
  /// The signs at the state that was observed at t.
  Signs signs(const double* observed, double t) const;
  /// Whether a change of sign between two states is one that is asked for.
  bool crossed(Signs was, Signs is) const { return changed(was, is) != 0; }
  /// Looks at the next state, observed at t; returns the expressions that may vanish between the last state and this
  /// one.
  Signs look(Looks& looks, const double* observed, double t) const;
  /// The same for several states together, which costs less: true if something may vanish between some of them.
  bool collect(Looks& looks, const double* observed, double t) const;
  /// The same for those that have been collected, but not looked at.
  bool settle(Looks& looks) const;
  /// Whether something may vanish between two states, from states within so many pieces.
  bool may_vanish(const double* left, double from, const double* right, double to, const ObserveAt& observe_at,
                  int pieces) const;

  /// The zeros after the state observed at `from`, up to the one at `to`: in order of time, up to the first that ends
  /// the run, with all that are at the same time up to round-off. A start on a zero does not count, nor does a pole,
  /// where the sign changes as well. `pieces`: number of pieces into which the step is divided at first.
  std::vector<Zero> locate(const double* left, double from, const double* right, double to, const ObserveAt& observe_at,
                           int pieces);
  /// Whether anything may end the run.
  bool may_end() const { return halting_ != 0; }
  /// The expressions that reach zero from above exactly at the end of a run, from the last state before it: a change of
  /// sign that no further step shows.
  std::vector<std::size_t> reached(const double* left, double from, const double* right, double to) const;
  void warn(std::vector<Warning>& warnings) const;
  /// The unresolved searches of the current run; a caller that watches several runs in turn sets them when it changes
  /// to another run.
  const Unresolved& unresolved() const { return unresolved_; }
  void turn_to(const Unresolved& unresolved) { unresolved_ = unresolved; }
  /// Whether the run ends, or restarts, at a zero of this expression.
  bool ends(std::size_t which) const { return (halting_ >> which & 1) != 0; }
  /// To be called when the run restarts at t after acts at zeros of these expressions: zeros of these right there are
  /// due to that and do not count.
  void begin_anew(double t, Signs which) {
    soon_ = t + 4 * (t - start_);
    start_ = t;
    acted_ = which;
  }
  const std::string& name(std::size_t which) const { return measures_.list[which].card.name; }
  /// The time of an event of any kind.
  static double time(const Report& event);
  /// The event of a zero. `state`: the variables by the scene's card; non-finite ones are left out.
  Report event(const Zero& zero, const ProblemCard& problem, const std::vector<double>& state) const;
  /// The part of an event with the state after its act.
  static Report after(const ProblemCard& problem, const std::vector<double>& state);

 private:
  std::vector<Zero> search(const double* left, double from, const double* right, double to, const ObserveAt& observe_at,
                           int pieces);
  void note(Looks& looks, const double* observed, double t) const;
  bool may_vanish(const Looks& looks, std::size_t back, std::size_t count) const;
  /// The same for `count` steps, the last of which ended `back` looks ago.
  Signs look_back(const Looks& looks, std::size_t back, std::size_t count) const;
  using Values = std::array<double, most_watched>;
  Signs signs(const Values& values) const;
  Signs all() const { return static_cast<Signs>((std::uint64_t{1} << measures_.size()) - 1); }
  Signs changed(Signs was, Signs is) const { return (was & ~is & up_) | (is & ~was & down_); }

  const Measures& measures_;
  double start_;
  Signs acted_ = 0;  ///< expressions whose zeros made the run restart at start_
  double soon_ = 0;  ///< after an act: a time by which the next one is expected, from the time since the last restart
  Signs up_ = 0, down_ = 0;        ///< expressions whose rising, and falling, zeros are asked for
  Signs halting_ = 0;              ///< expressions whose zeros end the run
  std::vector<std::size_t> read_;  ///< indices of the variables that expressions read
  Unresolved unresolved_;
};

}  // namespace least
