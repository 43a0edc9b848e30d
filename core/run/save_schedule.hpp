// The times of a run: the grid t₀ + n·h of whole steps with the shorter step to the end, and the times of the samples.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/run/request.hpp"

namespace least {

/// The largest step number: beyond it n + 1 and n are the same double.
inline constexpr double most_steps = 9.0e15;

/// whole_steps returns the number of whole steps h > 0 between two times; a last step that is short only by rounding
/// counts as whole.
inline std::int64_t whole_steps(double start, double end, double h) {
  constexpr double slack = 4 * std::numeric_limits<double>::epsilon();
  const double whole = std::floor((end - start) / h * (1 + slack));
  return whole > 0 ? static_cast<std::int64_t>(std::min(whole, most_steps)) : 0;  // NaN counts as none
}

/// Grid is the grid of a run of equal steps; step number `first` ends at `start`. `tail` is the length of the shorter
/// step from the last whole step to the end, 0 if there is none.
struct Grid {
  double start = 0, step = 0, end = 0, tail = 0;
  std::int64_t first = 0, steps = 0;

  double time(std::int64_t n) const { return start + static_cast<double>(n - first) * step; }
  /// The number of the last whole step at or before the time t.
  std::int64_t step_before(double t) const {
    if (!(t < time(steps))) return steps;
    // The grid is the truth; the quotient is off by one step at most.
    std::int64_t n = std::clamp<std::int64_t>(first + whole_steps(start, t, step), first, steps);
    if (n < steps && time(n + 1) <= t) ++n;
    if (n > first && time(n) > t) --n;
    return n;
  }

  /// The number of the first whole step at or after the time t, or of the last step.
  std::int64_t step_after(double t) const {
    const std::int64_t n = step_before(t);
    return n < steps && time(n) < t ? n + 1 : n;
  }

  Grid(const Request& request, double h) : Grid(request, h, request.scene->start, 0) {}
  /// The grid of the rest of a run that restarts at the time t, after n steps.
  Grid(const Request& request, double h, double t, std::int64_t n) : start(t), step(h), first(n) {
    if (request.until_steps) {
      steps = request.steps;
      end = time(steps);
      return;
    }
    end = request.end;
    const std::int64_t whole = whole_steps(start, end, h);
    steps = first + whole;
    const double span = end - start, left = span - static_cast<double>(whole) * step;
    if (whole == 0 || left > 4 * std::numeric_limits<double>::epsilon() * span) tail = std::max(left, 0.0);
  }
};

/// SaveSchedule lists the samples that a run keeps before its end: every so many steps, or by time.
class SaveSchedule {
 public:
  static constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();

  /// `end` of the run; infinite if a number of self-timed steps determines it.
  SaveSchedule(const Request& request, double end) : record_(request.record), start_(request.scene->start), end_(end) {}

  /// The step of the next sample; `never` where samples go by time.
  std::int64_t step() const {
    if (record_.mode != Record::Mode::every || record_.count == 0) return never;
    return index_ * record_.count;
  }
  /// The time of the next sample; infinite if there is none, or samples go by steps. The last one is exactly the end.
  double time() const {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    if (record_.mode == Record::Mode::every || record_.mode == Record::Mode::curve || index_ >= count())
      return infinite;
    if (record_.mode == Record::Mode::times) return record_.times[static_cast<std::size_t>(index_)];
    if (index_ + 1 == count()) return end_;
    return start_ + (end_ - start_) * (static_cast<double>(index_) / static_cast<double>(count() - 1));
  }
  void next() { ++index_; }
  /// Changes the end of the run, at the time `now`: the remaining samples are spread evenly up to the new end.
  void move_end(double now, double end) {
    if (end_ > now) start_ = now + (start_ - now) * ((end - now) / (end_ - now));
    end_ = end;
  }

 private:
  std::int64_t count() const {
    return record_.mode == Record::Mode::times ? static_cast<std::int64_t>(record_.times.size()) : record_.count;
  }

  const Record& record_;
  double start_, end_;
  std::int64_t index_ = 0;
};

}  // namespace least
