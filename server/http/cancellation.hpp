// Ends a computation that nobody waits for any more: a thread beside it that sets what the core looks at.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <limits>
#include <mutex>
#include <thread>
#include <utility>

namespace least::server {

class CancellationWatch {
 public:
  /// Watches until its own end: for the end of the service, the client that goes away (never, where `gone` is empty)
  /// and the time that the computation may take.
  CancellationWatch(const std::atomic<bool>& ended, std::function<bool()> gone,
                    double seconds = std::numeric_limits<double>::infinity())
      : watching_([this, &ended, gone = std::move(gone), seconds](const std::stop_token& stop) {
          watch(stop, ended, gone, seconds);
        }) {}

  const std::atomic<bool>& cancelled() const { return cancelled_; }
  /// Whether it was cancelled because its time was over.
  bool timed_out() const { return timed_out_; }

 private:
  using Clock = std::chrono::steady_clock;

  void watch(const std::stop_token& stop, const std::atomic<bool>& ended, const std::function<bool()>& gone,
             double seconds) {
    const auto start = Clock::now();
    std::unique_lock lock(mutex_);
    for (;;) {
      wake_.wait_for(lock, stop, glance, [] { return false; });
      if (stop.stop_requested()) return;
      const bool late = std::chrono::duration<double>(Clock::now() - start).count() > seconds;
      if (late || ended || (gone && gone())) {
        timed_out_ = late;
        cancelled_ = true;
        return;
      }
    }
  }

  // The first look comes after one as well: most computations are over by then, and are answered whoever waits.
  static constexpr std::chrono::milliseconds glance{50};
  std::atomic<bool> cancelled_{false}, timed_out_{false};
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread watching_;  // last: it uses the others
};

}  // namespace least::server
