// The largest error along a run.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <limits>
#include <string_view>
#include <vector>

#include "core/run/landmarks.hpp"
#include "core/run/request.hpp"

namespace least {

/// SeenState is a state of a run with only the components that the motion needs.
struct SeenState {
  double t = 0;
  std::vector<double> x;
  double speed = 0;  ///< as in Landmark
};

struct LargestError {
  double last = std::numeric_limits<double>::quiet_NaN();  ///< error of the final state
  double most = last;                                      ///< the largest error
  double at = last;                                        ///< its time
  double uncertainty = last;                               ///< uncertainty of the truth
  std::size_t times = 0;                                   ///< number of states that were compared
  std::string_view how;                                    ///< how the truth was computed
  std::string_view missing{};                              ///< as in Truth
  bool complete = false;                                   ///< false: there is no truth, and nothing else is known
};

/// TimeLeft is the time that is left after a run.
struct TimeLeft {
  KeepGoing keep_going;             ///< false: no time is left, or nobody waits for the result
  std::function<double()> seconds;  ///< seconds until then
  const std::atomic<bool>& cancelled;
};

/// largest_error compares these states, in order of time, the final one last, with the true motion. If the run took few
/// steps (`few`) it compares states between them, too; if steps are so long that the motion may be fast between them
/// (`sparse`), also states at times where the true motion is fast; then states around the largest errors. States
/// between the ends of steps come from dense output, for which the run is repeated. If time runs out, it returns what
/// was found until then.
LargestError largest_error(const Request& request, std::vector<SeenState> seen, bool sparse, bool few,
                           const TimeLeft& left);

}  // namespace least
