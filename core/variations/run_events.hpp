// The events of a finished run, in the form that derivatives need.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/run/mechanics.hpp"
#include "core/run/outcome.hpp"
#include "core/run/request.hpp"

namespace least::variations {

/// RunEvent is an event of a finished run.
struct RunEvent {
  std::string name;
  double t = 0;
  std::optional<std::size_t>
      asked{};  ///< its number among the events of the request; none: an event of the scheme itself
  bool ends_run = false;
};

/// events_read_action tells whether events of the request, or what they set, depend on s: directly, or by the energy of
/// a contact scene.
bool events_read_action(const Request& request);

/// events_of returns the events in the order of the run.
std::vector<RunEvent> events_of(const Request& request, const Solution& outcome);

/// move_to_motion replaces the times of the events of a run by those of the true motion, as derivatives are evaluated
/// along the motion. `end` is the end of the run and becomes that of the motion. Returns nothing, or why it cannot.
std::optional<std::string> move_to_motion(const Request& request, const Solution& outcome,
                                          std::vector<RunEvent>& events, double& end, const KeepGoing& keep_going);

}  // namespace least::variations
