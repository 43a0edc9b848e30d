// A clock that stands still while others have the processor, so that what a thread measures by it does not depend on
// other work of the machine.
#pragma once

#include <ctime>

#include "core/clock.hpp"

namespace runs {

/// While a ProcessorClock lives, the core's clock counts the processor seconds of the thread that reads it.
class ProcessorClock {
 public:
  ProcessorClock() {
    least::read_clock = [] {
      timespec now{};
      clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
      return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
    };
  }
  ~ProcessorClock() { least::read_clock = least::steady_seconds; }
  ProcessorClock(const ProcessorClock&) = delete;
  ProcessorClock& operator=(const ProcessorClock&) = delete;
};

}  // namespace runs
