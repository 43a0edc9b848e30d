// Events of the caller's own: where expressions vanish along a run. Between steps only values are looked at; the zeros
// of a step in which one changed its sign, or seems to have come back from one, are then located by its dense output.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

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
  using Signs = std::uint32_t;
  /// Writes what `observe` says of the state at a time between those of the two states; false: there is none.
  using ObserveAt = std::function<bool(double t, double* observed)>;

  /// The last states that were looked at.
  struct Looks {
    using Values = std::array<double, most_events>;
    Values before{}, last{};
    double t_before = unknown, t_last = unknown;
    Signs signs = 0;  ///< of the last
  };

  explicit Watch(const Request& request);

  bool empty() const { return measures_.empty(); }
  const Measures& measures() const { return measures_; }
  /// Of the state that was observed at t.
  Signs signs(const double* observed, double t) const;
  /// Whether what changed between two states is to be located.
  bool crossed(Signs was, Signs is) const { return changed(was, is) != 0; }
  /// Looks at the next state, which was observed at t: what is to be located between the last one and this.
  Signs look(Looks& looks, const double* observed, double t) const;

  /// The zeros after the state that was observed at `from` up to the one at `to`, in the order of their times and up to
  /// the first that ends the run. A start that lies on a zero is none; neither is a pole, where the sign changes too.
  std::vector<Zero> locate(const double* left, double from, const double* right, double to,
                           const ObserveAt& observe_at) const;
  /// Whether anything may end the run.
  bool may_end() const { return halting_ != 0; }
  /// Which of them a run reaches from above exactly at its end, from the last state before it: a change of sign that no
  /// step ahead is going to show.
  std::vector<std::size_t> reached(const double* left, double from, const double* right, double to) const;
  bool ends(std::size_t which) const { return (halting_ >> which & 1) != 0; }
  const std::string& name(std::size_t which) const { return measures_.list[which].card.name; }
  /// Of an event of any kind.
  static double time(const Report& event);
  /// The event of a zero. `state`: the variables by the scene's card; what is not finite is left out.
  Report event(const Zero& zero, const ProblemCard& problem, const std::vector<double>& state) const;

 private:
  Signs signs(const Looks::Values& values) const;
  Signs changed(Signs was, Signs is) const { return (was & ~is & up_) | (is & ~was & down_); }

  const Measures& measures_;
  const double start_;
  Signs up_ = 0, down_ = 0;  ///< which are looked for where they rise, and where they fall
  Signs halting_ = 0;        ///< which end the run
};

}  // namespace least
