// The clock of a run: it measures the cost, and checks the deadline and the cancellation between blocks of steps.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <utility>

#include "core/clock.hpp"
#include "core/status.hpp"

namespace least {

class Budget {
 public:
  /// `report` is called a few times a second; false ends the run as cancelled.
  Budget(double seconds, const std::atomic<bool>& cancelled, std::function<bool()> report)
      : end_(read_clock() + std::max(seconds, 0.0)), cancelled_(cancelled), report_(std::move(report)) {}

  /// Starts to measure the cost. What came before was preparation: it counts for the deadline, but not as cost.
  /// `weight` says how many times as long as those of a small scene steps may take.
  void start(std::int64_t weight = 1) {
    block_ = std::max<std::int64_t>(first_block / weight, 1);
    start_ = read_clock();
  }
  double seconds() const { return read_clock() - start_; }

  const std::atomic<bool>& cancelled() const { return cancelled_; }

  /// block returns how many steps may pass before the clock is read again: about a millisecond's worth.
  std::int64_t block() const { return block_; }

  /// To be called after every block with its number of steps. Returns `completed` while the run may go on, else why
  /// not.
  ReturnCode passed(std::int64_t steps) {
    unseen_ += steps;
    return unseen_ < block_ ? ReturnCode::completed : look();
  }
  ReturnCode look() {
    const double now = seconds();
    if (now - last_ < 5e-4 && unseen_ >= block_) block_ = std::min<std::int64_t>(2 * block_, 1 << 20);
    if (now - last_ > 4e-3) block_ = std::max<std::int64_t>(block_ / 2, 1);
    last_ = now;
    unseen_ = 0;
    if (cancelled_.load(std::memory_order_relaxed)) return ReturnCode::cancelled;
    if (now - reported_ > between_reports) {
      reported_ = now;
      if (!report_()) return ReturnCode::cancelled;
    }
    return start_ + now > end_ ? ReturnCode::deadline : ReturnCode::completed;
  }

  /// in_time is for computations within a step: true until the deadline. It does not call `report`, which might throw.
  std::function<bool()> in_time() const { return until(end_); }
  /// shortly is for checks of a finished run: true until 0.1 s after the deadline.
  std::function<bool()> shortly() const {
    constexpr double beyond = 0.1;  // in seconds
    return until(end_ + beyond);
  }
  /// half is for what follows the run: true for half of the time that is left now.
  std::function<bool()> half() {
    return
        [this, until = 0.5 * (read_clock() + end_)] { return read_clock() < until && look() == ReturnCode::completed; };
  }

 private:
  std::function<bool()> until(double end) const {
    return [this, end] { return !cancelled_.load(std::memory_order_relaxed) && read_clock() < end; };
  }

  static constexpr double between_reports = 0.2;  // in seconds
  static constexpr std::int64_t first_block = 16;
  double start_ = 0, last_ = 0, reported_ = 0;
  const double end_;
  std::int64_t block_ = first_block, unseen_ = 0;
  const std::atomic<bool>& cancelled_;
  const std::function<bool()> report_;
};

}  // namespace least
