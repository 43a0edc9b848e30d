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

/// A state of a run as far as the motion needs it.
struct SeenState {
  double t = 0;
  std::vector<double> x;
  double speed = 0;  ///< of Landmark
};

struct LargestError {
  double last = std::numeric_limits<double>::quiet_NaN();  ///< at the final state
  double most = last;                                      ///< the largest of all
  double at = last;                                        ///< the time of that
  double uncertainty = last;                               ///< of the truth
  std::size_t times = 0;                                   ///< states that were held against it
  std::string_view how;                                    ///< it came about
  std::string_view missing{};                              ///< as of Truth
  bool complete = false;                                   ///< false: it was not found, nor is anything else known
};

/// What a run has left for what follows it.
struct TimeLeft {
  KeepGoing keep_going;             ///< asked now and then; false: no time is left, or nobody waits
  std::function<double()> seconds;  ///< until then
  const std::atomic<bool>& cancelled;
};

/// Looks at these states, in the order of their times, the final one last; where the run took few steps, between
/// them, too; where steps are so long that the motion may be fast between them (`sparse`), also at where the
/// true motion is; then around the largest errors. What no step ended at comes by dense output: for that the run is
/// made again. Where no time is left, what was found until then.
LargestError largest_error(const Request& request, std::vector<SeenState> seen, bool sparse, bool few,
                           const TimeLeft& left);

}  // namespace least
