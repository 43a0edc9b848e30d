// A clock that advances by being read, so that deadlines are met at the same step on every machine.
#pragma once

#include "core/clock.hpp"

namespace runs {

/// While a TurnedClock lives, every reading of the core's clock advances it by `tick` seconds.
class TurnedClock {
 public:
  explicit TurnedClock(double tick) {
    tick_ = tick;
    now_ = 0;
    looks_ = 0;
    least::read_clock = [] {
      ++looks_;
      return now_ += tick_;
    };
  }
  ~TurnedClock() { least::read_clock = least::steady_seconds; }
  TurnedClock(const TurnedClock&) = delete;
  TurnedClock& operator=(const TurnedClock&) = delete;

  double now() const { return now_; }
  int looks() const { return looks_; }

 private:
  inline static double tick_ = 0, now_ = 0;
  inline static int looks_ = 0;
};

}  // namespace runs
