// Where a run stops to look: the grid t₀ + n·h of whole steps, the shorter step to the end, and the marks at which
// samples are taken.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/run/request.hpp"

namespace least {

/// Steps beyond which n + 1 and n are the same double.
inline constexpr double most_steps = 9.0e15;

/// How many whole steps h > 0 stand between two times; a last one that rounding has cut short counts as whole.
inline std::int64_t whole_steps(double start, double end, double h) {
  constexpr double slack = 4 * std::numeric_limits<double>::epsilon();
  const double whole = std::floor((end - start) / h * (1 + slack));
  return whole > 0 ? static_cast<std::int64_t>(std::min(whole, most_steps)) : 0;  // NaN counts as none
}

/// The grid of a run of fixed steps. `tail` is what is left to the end after the last whole step, 0 where nothing is.
struct Grid {
  double start = 0, step = 0, end = 0, tail = 0;
  std::int64_t steps = 0;

  double time(std::int64_t n) const { return start + offset(n); }
  /// Time since the start: not rounded to the resolution of a large t.
  double offset(std::int64_t n) const { return static_cast<double>(n) * step; }

  Grid(const Request& request, double h) : start(request.start), step(h) {
    if (request.until_steps) {
      steps = request.steps;
      end = time(steps);
      return;
    }
    end = request.end;
    steps = whole_steps(start, end, h);
    const double span = end - start, left = span - offset(steps);
    if (steps == 0 || left > 4 * std::numeric_limits<double>::epsilon() * span) tail = std::max(left, 0.0);
  }
};

/// The samples of a run that has no grid: its times, or every so many steps. The end is left to the final state.
class Times {
 public:
  static constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();

  Times(const Request& request, double end) : record_(request.record), start_(request.start), end_(end) {}

  /// The next sample's step; `never` where samples go by time.
  std::int64_t step() const {
    if (record_.mode != Record::Mode::every || record_.count == 0) return never;
    return index_ * record_.count;
  }
  /// The next sample's time; infinite where there is none, or samples go by steps.
  double time() const {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    if (record_.mode == Record::Mode::every || index_ >= count()) return infinite;
    if (record_.mode == Record::Mode::times) return record_.times[static_cast<std::size_t>(index_)];
    if (index_ + 1 == count()) return end_;
    return start_ + (end_ - start_) * (static_cast<double>(index_) / static_cast<double>(count() - 1));
  }
  void next() { ++index_; }

 private:
  std::int64_t count() const {
    return record_.mode == Record::Mode::times ? static_cast<std::int64_t>(record_.times.size()) : record_.count;
  }

  const Record& record_;
  double start_, end_;
  std::int64_t index_ = 0;
};

/// Samples asked for, one after the other: each after grid step `step`, plus `rest` in time.
class Marks {
 public:
  static constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();

  Marks(const Record& record, const Grid& grid) : record_(record), grid_(grid) { find(); }

  std::int64_t step() const { return step_; }
  double rest() const { return rest_; }
  void next() {
    ++index_;
    find();
  }

 private:
  void find() {
    rest_ = 0;
    step_ = never;
    if (record_.mode == Record::Mode::every) {
      if (record_.count > 0 && index_ <= grid_.steps / record_.count) step_ = index_ * record_.count;
      return;
    }
    const bool uniform = record_.mode == Record::Mode::samples;
    const auto count = uniform ? record_.count : static_cast<std::int64_t>(record_.times.size());
    if (index_ >= count) return;
    double ahead = grid_.end - grid_.start;
    if (!uniform) {
      ahead = record_.times[static_cast<std::size_t>(index_)] - grid_.start;
    } else if (index_ + 1 < count) {
      ahead *= static_cast<double>(index_) / static_cast<double>(count - 1);
    }
    if (ahead >= grid_.end - grid_.start) {  // the end is the final state, to the bit
      step_ = grid_.steps;
      rest_ = grid_.tail;
      return;
    }
    // The grid is the truth; the quotient is off by one step at most.
    const double guess = std::floor(ahead / grid_.step);
    step_ = guess >= 0 ? std::min(static_cast<std::int64_t>(std::min(guess, most_steps)), grid_.steps) : 0;
    if (step_ < grid_.steps && grid_.offset(step_ + 1) <= ahead) ++step_;
    if (step_ > 0 && grid_.offset(step_) > ahead) --step_;
    rest_ = std::max(ahead - grid_.offset(step_), 0.0);
  }

  const Record& record_;
  const Grid& grid_;
  std::int64_t index_ = 0, step_ = 0;
  double rest_ = 0;
};

}  // namespace least
