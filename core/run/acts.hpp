// What events do to the state of a run: at a zero of the event's expression variables are set to other values, and the
// motion goes on from there. Neighbouring motions change by the saltation matrix
//   S = G + (f₊ − G f₋ − g_t) hᵀ/(hᵀf₋ + h_t),   G = ∂g/∂x of the act x → g(x, t), f₋ and f₊ the rates before and after
// it, h = ∂/∂x of the expression that vanishes. An act conserves the symplectic form, or the contact form, if S does.
// Source: Leine, Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical Systems, 2004, chapter 7.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/run/backend.hpp"
#include "core/run/outcome.hpp"
#include "core/run/request.hpp"

namespace least {

/// Setting is one variable, or the velocity of one coordinate, that an event sets.
struct Setting {
  std::string name, text;
  std::size_t index = 0;  ///< among the card's variables; of a velocity: among the coordinates
  bool velocity = false;
};

/// Act is all that one event does. The values of all its settings are computed before any of them is set.
struct Act {
  std::vector<Setting> settings;
  Measures values;        ///< the expressions of the new values, in the order of `settings`
  std::int64_t most = 0;  ///< how often the event may act before the run ends; 0: no bound
};

/// Acts applies the acts of the events of one run.
class Acts {
 public:
  /// The arguments have to outlive it.
  Acts(const RunBackend& backend, const Request& request);

  bool any() const { return any_; }
  enum class Effect : std::uint8_t {
    goes_on,
    completes,   ///< the event has acted as often as it may: the run ends
    not_finite,  ///< the new state is not finite
    piles_up,    ///< its acts accumulate at the time limit()
    rests        ///< it leaves the motion at rest where it acts, and would have to act again at once
  };
  /// act applies the act of an event to x.
  Effect act(std::size_t event, RunState& x);
  double limit() const { return limit_; }
  std::int64_t count(std::size_t event) const { return done_[event].count; }
  /// reports returns for each event that has acted: name, count, keeps and defect.
  std::vector<Report> reports() const;

 private:
  struct Done {
    std::int64_t count = 0;
    std::vector<double> times;  ///< of the last acts, latest last
    double rate = unknown;      ///< time derivative of the event's expression right after its last act
    double defect = 0;
  };
  bool has_piled_up(std::size_t event, const RunState& after);
  /// comes_to_rest returns whether the act has left the event's expression and its rate at zero, and the motion from
  /// there drives the expression on in the direction in which it came: as of a ball that loses all its speed and lies
  /// on the floor.
  bool comes_to_rest(std::size_t event, const RunState& before, const RunState& after);
  /// rates_at returns ẋ; rate_of the rate of the event's expression along the motion.
  std::vector<double> rates_at(const RunState& x) const;
  double rate_of(std::size_t event, const RunState& x) const;
  double value_of(std::size_t event, const RunState& x) const;
  /// rounding_of returns the width of the interval of values that the event's expression has within the rounding of x.
  double rounding_of(std::size_t event, const RunState& x) const;
  /// rounding_in_time returns how far the rounding of x moves the time at which the event's expression vanishes.
  double rounding_in_time(std::size_t event, const RunState& x) const;
  double defect_of(std::size_t event, const RunState& before, const RunState& after) const;

  const RunBackend& backend_;
  const Request& request_;
  bool any_ = false;
  std::vector<Done> done_;
  double limit_ = unknown;
};

}  // namespace least
