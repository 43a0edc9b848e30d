// Ends a computation that nobody waits for any more: sets what the computation looks at.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <limits>

namespace least::server {

class CancellationWatch {
 public:
  /// Watches until its own end: for the end of the service, the client that goes away (never, where `gone` is empty)
  /// and the time that the computation may take. What is over within 50 ms is not looked at.
  CancellationWatch(const std::atomic<bool>& ended, std::function<bool()> gone,
                    double seconds = std::numeric_limits<double>::infinity());
  ~CancellationWatch();
  CancellationWatch(const CancellationWatch&) = delete;
  /// To be called every 50 ms by whoever is `Attended`; while nobody is, a thread of its own sees to it.
  static void look_at_all();
  struct Attended {
    Attended();
    ~Attended();
    Attended(const Attended&) = delete;
    Attended& operator=(const Attended&) = delete;
  };

  CancellationWatch& operator=(const CancellationWatch&) = delete;

  const std::atomic<bool>& cancelled() const { return cancelled_; }
  /// Whether it was cancelled because its time was over.
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
