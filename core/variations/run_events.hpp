// The events of a finished run, as derivatives need them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/run/mechanics.hpp"
#include "core/run/outcome.hpp"
#include "core/run/request.hpp"

namespace least::variations {

/// An event of a run.
struct RunEvent {
  std::string name;
  double t = 0;
  std::optional<std::size_t>
      asked{};  ///< its number among the events of the request; none: an event of the scheme itself
  bool ends_run = false;
};

/// In the order in which the run came to them.
std::vector<RunEvent> events_of(const Request& request, const Solution& outcome);

/// Those of a run by a scheme that is not the motion, at the times at which the motion comes to them: what is made of a
/// zero elsewhere is neither the motion's nor the scheme's. `end`: where the run ends, and then the motion. Else why
/// not, in words.
std::optional<std::string> move_to_motion(const Request& request, const Solution& outcome,
                                          std::vector<RunEvent>& events, double& end, const KeepGoing& keep_going);

}  // namespace least::variations
