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

/// The grid of a run of fixed steps. `tail` is what is left to the end after the last whole step, 0 where nothing is.
struct Grid {
  static constexpr double most = 9.0e15;  ///< steps; beyond it n + 1 and n are the same double

  double start = 0, step = 0, end = 0, tail = 0;
  std::int64_t steps = 0;

  double time(std::int64_t n) const { return start + static_cast<double>(n) * step; }

  Grid(const Request& request, double h) : start(request.start), step(h) {
    if (request.until_steps) {
      steps = request.steps;
      end = time(steps);
      return;
    }
    end = request.end;
    constexpr double slack = 4 * std::numeric_limits<double>::epsilon();
    const double whole = std::floor((end - start) / h * (1 + slack));
    steps =
        whole > 0 ? static_cast<std::int64_t>(std::min(whole, most)) : 0;  // NaN (h = 0 over nothing) counts as none
    tail = std::max(end - time(steps), 0.0);
    if (steps > 0 && !(tail > slack * std::abs(h) * static_cast<double>(steps))) tail = 0;
  }
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
    double t = grid_.end;
    if (!uniform) {
      t = record_.times[static_cast<std::size_t>(index_)];
    } else if (index_ + 1 < count) {
      t = grid_.start + (grid_.end - grid_.start) * (static_cast<double>(index_) / static_cast<double>(count - 1));
    }
    // The grid is the truth: the quotient is off by one step at most, unless the clock does not resolve the step.
    const double guess = std::floor((t - grid_.start) / grid_.step);
    step_ = guess >= 0 ? std::min(static_cast<std::int64_t>(std::min(guess, Grid::most)), grid_.steps) : 0;
    if (step_ < grid_.steps && grid_.time(step_ + 1) <= t) ++step_;
    if (step_ > 0 && grid_.time(step_) > t) --step_;
    rest_ = std::max(t - grid_.time(step_), 0.0);
    if (t >= grid_.end) rest_ = step_ == grid_.steps ? grid_.tail : rest_;  // the end is the final state, to the bit
  }

  const Record& record_;
  const Grid& grid_;
  std::int64_t index_ = 0, step_ = 0;
  double rest_ = 0;
};

}  // namespace least
