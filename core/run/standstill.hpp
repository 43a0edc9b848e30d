// Where a motion ends: at a place where its rates are infinite or not defined, which steps with error control approach
// and never reach. What short steps alone say is not enough: a stiff motion has them, too, as has a fast one, or a time
// so large that rounding moves it. So Dormand–Prince 5(4) at other tolerances than the run's is asked.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "core/run/backend.hpp"
#include "core/run/mechanics.hpp"
#include "core/run/request.hpp"
#include "core/status.hpp"

namespace least {

/// Watches for steps that no longer advance a run: one too short to bring it to its end within a million steps, and not
/// on the way to a singularity either, where each step is shorter than all before it.
class StandstillWatch {
 public:
  /// `span`: of the whole run, 0 where it is not known beforehand.
  StandstillWatch(double start, double span) : start_(start), span_(span) {}

  /// Of a step h from the time t. True: it is time to ask whether the motion goes on at all.
  bool see(double t, double h) {
    constexpr double little = 1e-6;
    if (!(h < little * std::max(t - start_, span_))) {
      count_ = 0;
      shortest_ = std::numeric_limits<double>::infinity();
      return false;
    }
    count_ += h >= shortest_;
    shortest_ = std::min(shortest_, h);
    return count_ >= patience_;
  }
  /// It does go on: the question is worth its price again after twice as many such steps.
  void go_on() {
    count_ = 0;
    patience_ *= 2;
  }

 private:
  double start_, span_;
  std::int64_t count_ = 0, patience_ = 1000;
  double shortest_ = std::numeric_limits<double>::infinity();
};

/// Whether the motion from x goes on for so long. A closer run that takes the time of a few dozen steps of the run in a
/// bounded number of its own has gone through, and so has one whose rates have risen and fallen again. One that does
/// not is before a singularity if it ends, or if its rates grow and its steps shrink the closer it looks. Where they do
/// not, as with friction that turns over with the velocity or a fast oscillation, it is only slow.
bool goes_on(const RunBackend& backend, RunState x, double duration);

/// When the motion of a request becomes singular, where a run of it stopped at `now` after so many force evaluations:
/// as two control runs say that come to a standstill together; of steps of a clock of their own the run may be one of
/// the two. `step`: of a run of equal steps, else 0. Unknown where it is not known to 1e-4 of the time until then, or
/// does not lie within a few steps, or a tenth of the way, of where the run stopped: then it stopped for another
/// reason. Not before the last state of a run of a clock of its own, where that is as exact as what is known. Not asked
/// where it was an equation of the step that had no solution.
double singular_time(const RunBackend& backend, const Request& request, StepStatus status, double now, double step,
                     std::int64_t forces, const KeepGoing& keep_going);

}  // namespace least
