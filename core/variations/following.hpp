// A motion followed with its derivatives from the start of a run to its end, through the events that act on its way.
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

/// The motion with some of its directions.
struct Followed {
  std::vector<double> state;                     ///< at the end
  std::vector<std::vector<double>> slopes;       ///< at samples, and at last at the end; direction by direction
  std::vector<std::vector<double>> time_slopes;  ///< of each event that was asked for, by direction
  std::vector<double> second;                    ///< the second ones, at the end: pair by pair
  std::vector<std::vector<double>> control;      ///< where slopes are, in one direction; fewer: not to the end
  int order = 0;
};

/// What is asked of a motion: where it began and ends, what it comes by, and along which directions it is varied.
struct Question {
  const SensitivitiesAsked& asked;
  double began, end;
  std::vector<double> times;  ///< of samples, that do not decrease
  const KeepGoing& keep_going;
  Start start;
  std::vector<double> state;  ///< where it began
  const std::vector<RunEvent>& events;
  const EventSlopes& slopes_of_events;
  std::vector<Direction> directions{};
  std::vector<std::vector<double>> slopes{};
  std::vector<double> weights{};  ///< of the directions in that of a control beside them; none: there is none
};

/// That of the series of a control, beside series of this one.
int order_of_control(int order);

/// All directions, in as few parts as are short enough; or why they were not followed to the end.
std::variant<Followed, std::string> follow_all(const Question& question, double tolerance, int order);

/// Second derivatives at the end: all at once, or pair by pair where that is too long.
std::variant<std::vector<double>, std::string> follow_pairs(
    const Question& question, const std::vector<std::pair<std::size_t, std::size_t>>& pairs, double tolerance,
    int order);

}  // namespace least::variations
