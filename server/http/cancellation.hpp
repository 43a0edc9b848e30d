// Ends a computation that nobody waits for any more, by setting the flag that the computation polls.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <limits>

namespace least::server {

/// CancellationWatch watches one computation, from its construction to its destruction.
class CancellationWatch {
 public:
  /// Cancels when the service has `ended`, when the client is `gone` (never if that is empty), or after so many
  /// seconds. Computations of less than 50 ms are not watched.
  CancellationWatch(const std::atomic<bool>& ended, std::function<bool()> gone,
                    double seconds = std::numeric_limits<double>::infinity());
  ~CancellationWatch();
  CancellationWatch(const CancellationWatch&) = delete;
  /// look_at_all() must be called every 50 ms by a thread that holds an Attended; without one, a thread of the class
  /// does it.
  static void look_at_all();
  struct Attended {
    Attended();
    ~Attended();
    Attended(const Attended&) = delete;
    Attended& operator=(const Attended&) = delete;
  };

  CancellationWatch& operator=(const CancellationWatch&) = delete;

  const std::atomic<bool>& cancelled() const { return cancelled_; }
  /// timed_out() tells whether it was cancelled because its time was over.
  bool timed_out() const { return timed_out_; }

 private:
  class Watcher;
  using Clock = std::chrono::steady_clock;

  void look();

  const std::atomic<bool>& ended_;
  const std::function<bool()> gone_;
  const double seconds_;
  const Clock::time_point start_ = Clock::now();
  std::atomic<bool> cancelled_{false}, timed_out_{false};
};

}  // namespace least::server
