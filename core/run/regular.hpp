// The regular solution from a time at which the equations of motion are singular: it stands in for the steps as far as
// its series reaches.
#pragma once

#include <algorithm>

#include "core/run/engine.hpp"
#include "core/run/schedule.hpp"

namespace least {

template <class P, class X>
class RegularStart {
 public:
  /// Whether a run from x goes along it: not where the scheme has a first step of its own.
  void start(const P& problem, const Engine<P, X>& engine, const X& x, const Grid& grid) {
    if constexpr (HasSeries<P>) {
      active_ = !engine.starts_at_singularity() && starts_series(problem, x);
      if (active_) steps_ = std::min(whole_steps(grid.start, P::series_until, grid.step), grid.steps);
    }
  }
  bool active() const { return active_; }
  /// Whether the n-th state and what follows until t is on the series, the rest of a first step being the scheme's.
  bool covers(std::int64_t n, double t) const { return active_ && (n == 0 || t <= reach()); }
  /// Whether step n is to be taken along it, and whether it was the last such.
  bool takes(std::int64_t n) const { return active_ && (n == 0 || n < steps_); }
  bool ends(std::int64_t n) const { return n >= steps_; }

  /// x at the time t, which lies no further than a step beyond the series.
  Status go(const P& problem, const Engine<P, X>& engine, X& x, double t) const {
    if constexpr (HasSeries<P>) {
      const double until = std::min(t, reach());
      x = series_state<X>(problem, until);
      const Status status = t > until ? engine.leap(x, t - until) : Status::ok;
      x.t = t;
      return status;
    }
    return Status::ok;
  }

  /// At the singular time and at rest: the solution from there is regular.
  static bool at_rest(const X& x) {
    if constexpr (HasSeries<P>) return x.t == 0 && dot(x.p, x.p) == 0;
    return false;
  }

 private:
  static constexpr double reach() {
    if constexpr (HasSeries<P>) return P::series_until;
    return 0;
  }

  bool active_ = false;
  std::int64_t steps_ = 0;
};

}  // namespace least
