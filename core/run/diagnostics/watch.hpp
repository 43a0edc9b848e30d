// Events of the caller's own: where expressions vanish along a run. From states that lie evenly it is told cheaply
// where nothing can vanish between the last two; where something may, the dense output of the step is searched.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/run/diagnostics/zero_search.hpp"
#include "core/run/outcome.hpp"
#include "core/run/request.hpp"

namespace least {

/// A zero: when, and of which of the expressions.
struct Zero {
  double t;
  std::size_t which;
};

/// What a request watches for. Whether an expression was negative is a bit of Signs, the i-th of the i-th.
class Watch {
 public:
  using Signs = ZeroSearch::Bits;
  /// Of times between those of the two states.
  using ObserveAt = ZeroSearch::ObserveAt;

  /// The last states that were looked at, as `observe` says them.
  struct Looks {
    static constexpr std::size_t together = 8, most = 16;
    std::vector<double> observed;  ///< a row for each
    std::array<double, most> t;
    std::size_t last = 0;     ///< row
    std::size_t waiting = 0;  ///< how many have been collected, and not been settled

    Looks() { t.fill(unknown); }
    double t_last() const { return t[last]; }
  };

  /// What searches have left unresolved so far. After a few such steps a run is searched less closely.
  struct Unresolved {
    Signs which = 0;
    double at = unknown;     ///< where the first such step ended
    std::int64_t steps = 0;  ///< how many there were
  };

  explicit Watch(const Request& request);

  bool empty() const { return measures_.empty(); }
  const Measures& measures() const { return measures_; }
  /// Of the state that was observed at t.
  Signs signs(const double* observed, double t) const;
  /// Whether what changed between two states is to be located.
  bool crossed(Signs was, Signs is) const { return changed(was, is) != 0; }
  /// Looks at the next state, which was observed at t: what may vanish between the last one and this.
  Signs look(Looks& looks, const double* observed, double t) const;
  /// The same of some states together, which costs less: true where something may vanish between some of them.
  bool collect(Looks& looks, const double* observed, double t) const;
  /// Of those that have been collected and not been looked at.
  bool settle(Looks& looks) const;
  /// Whether something may vanish between two states, from states within as many pieces.
  bool may_vanish(const double* left, double from, const double* right, double to, const ObserveAt& observe_at,
                  int pieces) const;

  /// The zeros after the state that was observed at `from` up to the one at `to`, in the order of their times and up to
  /// the first that ends the run, with all that round-off does not tell from its instant. A start that lies on a zero
  /// is none; neither is a pole, where the sign changes too. `pieces`: into how many the way is divided at first.
  std::vector<Zero> locate(const double* left, double from, const double* right, double to, const ObserveAt& observe_at,
                           int pieces);
  /// Whether anything may end the run.
  bool may_end() const { return halting_ != 0; }
  /// Which of them a run reaches from above exactly at its end, from the last state before it: a change of sign that no
  /// step ahead is going to show.
  std::vector<std::size_t> reached(const double* left, double from, const double* right, double to) const;
  void warn(std::vector<Warning>& warnings) const;
  /// Of the run that is searched: who watches many runs in turn says what it was when he turns to one.
  const Unresolved& unresolved() const { return unresolved_; }
  void turn_to(const Unresolved& unresolved) { unresolved_ = unresolved; }
  /// Whether the run ends at a zero of this one, or begins anew.
  bool ends(std::size_t which) const { return (halting_ >> which & 1) != 0; }
  /// The run has begun anew at the time t, from what zeros of these made of it: what vanishes right there vanishes
  /// because of that.
  void begin_anew(double t, Signs which) {
    soon_ = t + 4 * (t - start_);
    start_ = t;
    acted_ = which;
  }
  const std::string& name(std::size_t which) const { return measures_.list[which].card.name; }
  /// Of an event of any kind.
  static double time(const Report& event);
  /// The event of a zero. `state`: the variables by the scene's card; what is not finite is left out.
  Report event(const Zero& zero, const ProblemCard& problem, const std::vector<double>& state) const;
  /// What an event made of the state, as a part of it.
  static Report after(const ProblemCard& problem, const std::vector<double>& state);

 private:
  std::vector<Zero> search(const double* left, double from, const double* right, double to, const ObserveAt& observe_at,
                           int pieces);
  void note(Looks& looks, const double* observed, double t) const;
  bool may_vanish(const Looks& looks, std::size_t back, std::size_t count) const;
  /// Of so many steps, the last of which ended at the look before so many others.
  Signs look_back(const Looks& looks, std::size_t back, std::size_t count) const;
  using Values = std::array<double, most_watched>;
  Signs signs(const Values& values) const;
  Signs all() const { return static_cast<Signs>((std::uint64_t{1} << measures_.size()) - 1); }
  Signs changed(Signs was, Signs is) const { return (was & ~is & up_) | (is & ~was & down_); }

  const Measures& measures_;
  double start_;
  Signs acted_ = 0;                ///< the run began there by what zeros of these did
  double soon_ = 0;                ///< after an act: by then the next one comes, if it takes as long as the last
  Signs up_ = 0, down_ = 0;        ///< which are looked for where they rise, and where they fall
  Signs halting_ = 0;              ///< which end the run
  std::vector<std::size_t> read_;  ///< which variables
  Unresolved unresolved_;
};

}  // namespace least
