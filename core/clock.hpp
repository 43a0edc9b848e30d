// The clock that costs and deadlines are read from.
#pragma once

#include <chrono>

namespace least {

inline double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Seconds from some time on, never fewer than before. A test puts a clock of its own here, which it turns by itself,
/// so that what it says of deadlines does not depend on how fast a machine is.
inline double (*read_clock)() = steady_seconds;

}  // namespace least
