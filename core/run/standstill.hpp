// The end of a motion: a point where its rates are infinite or undefined, which steps with error control approach and
// never reach. Short steps alone do not prove it: a stiff or a fast motion has them, too, and a time so large that
// rounding moves it. So it is checked by Dormand–Prince 5(4) with other tolerances than that of the run.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "core/run/backend.hpp"
#include "core/run/mechanics.hpp"
#include "core/run/request.hpp"
#include "core/status.hpp"

namespace least {

/// StandstillWatch watches for steps that no longer advance a run: too short to reach its end within a million steps,
/// and not on the way to a singularity, where each step is shorter than all before it.
class StandstillWatch {
 public:
  /// `span` of the whole run, 0 if it is not known beforehand.
  StandstillWatch(double start, double span) : start_(start), span_(span) {}

  /// To be called for each step h from the time t. True: check whether the motion goes on at all (`goes_on`).
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
  /// To be called if the motion goes on: the next check is due only after twice as many such steps.
  void go_on() {
    count_ = 0;
    patience_ *= 2;
  }

 private:
  double start_, span_;
  std::int64_t count_ = 0, patience_ = 1000;
  double shortest_ = std::numeric_limits<double>::infinity();
};

/// goes_on returns whether the motion from x goes on for this duration. It takes a control run of closer tolerance. The
/// motion goes on if that run reaches the end, or if its rates have risen and fallen again. It does not if the control
/// fails, or if its rates grow while its steps shrink. If neither is so within a bounded number of steps, as with
/// friction that changes with the sign of the velocity or a fast oscillation, the motion is only slow, and goes on.
bool goes_on(const RunBackend& backend, RunState x, double duration);

/// singular_time returns when the motion of a request becomes singular, for a run that stopped at `now` after so many
/// force evaluations. It is the time at which two control runs come to a standstill together; a run with its own clock
/// may replace one of the two. `step` is that of a run of equal steps, else 0. Unknown if the two differ by more than
/// 1e-5 of the time since the start, or the time does not lie within ten steps, or a tenth of the way, of `now`: then
/// the run stopped for another reason. For a run with its own clock it is not before `now` where the two agree. Unknown
/// as well for a probe, and where the equation of a step had no solution (status solver_failed).
double singular_time(const RunBackend& backend, const Request& request, StepStatus status, double now, double step,
                     std::int64_t forces, const KeepGoing& keep_going);

}  // namespace least
