// The clock that measures costs and deadlines.
#pragma once

#include <chrono>

namespace least {

inline double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// read_clock() returns the seconds since some fixed time and never decreases. A test may set it to a clock that it
/// advances itself, so that what it checks of deadlines does not depend on the speed of the machine.
inline double (*read_clock)() = steady_seconds;

}  // namespace least
