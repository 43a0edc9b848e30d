// A motion and its derivatives, followed from the start of a run to its end through the events that act in between.
#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/variations/event_slopes.hpp"
#include "core/variations/run_events.hpp"
#include "core/variations/sensitivities.hpp"
#include "core/variations/start.hpp"

namespace least::variations {

/// Followed is the motion with its derivatives along some directions, as far as it was followed.
struct Followed {
  std::vector<double> state;  ///< at the end
  /// At each sample, then at the end: ∂x/∂θ, direction by direction; fewer entries where the end was not reached
  std::vector<std::vector<double>> slopes;
  std::vector<std::vector<double>> time_slopes;  ///< by event that was asked for: ∂t/∂θ, one per direction
  std::vector<double> second;                    ///< second derivatives at the end, pair by pair
  /// The control's derivative at the times of `slopes`; fewer entries: it did not reach the end
  std::vector<std::vector<double>> control;
  int order = 0;
  std::string reason;  ///< why the end was not reached; empty where it was
};

/// Question is what to follow: from where to where, through which events, and along which directions.
struct Question {
  const SensitivitiesAsked& asked;
  double began, end;
  std::vector<double> times;  ///< ascending times of samples
  const KeepGoing& keep_going;
  Start start;
  std::vector<double> state;  ///< at `began`
  const std::vector<RunEvent>& events;
  const EventSlopes& slopes_of_events;
  std::vector<Direction> directions{};
  std::vector<std::vector<double>> slopes{};
  std::vector<double> weights{};  ///< weights of the directions in the control's direction; empty: no control
};

/// order_of_control returns the order of the control's series beside series of this order.
int order_of_control(int order);

/// follow_all follows all directions, in as few groups as have short enough equations.
Followed follow_all(const Question& question, double tolerance, int order);

/// follow_pairs returns second derivatives at the end, pair by pair: all computed together, or one pair after the other
/// where that would be too long.
std::variant<std::vector<double>, std::string> follow_pairs(
    const Question& question, const std::vector<std::pair<std::size_t, std::size_t>>& pairs, double tolerance,
    int order);

}  // namespace least::variations
