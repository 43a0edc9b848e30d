// Counts of what the service does, in the text form that Prometheus reads.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

namespace least::server {

/// What stands still is not counted but looked at, when it is asked for.
struct Gauges {
  unsigned running = 0, waiting = 0;
  std::size_t bytes_held = 0;
  std::uint64_t dropped_log_lines = 0;
  std::string_view version{};
};

/// Safe from any thread.
class Metrics {
 public:
  /// `route` lives on; all paths of a kind share one, so that their number is bounded.
  void answered(std::string_view route, int status);
  void ran(double seconds) { runs_.add(seconds); }
  void waited(double seconds) { waits_.add(seconds); }
  /// A run whose client went away.
  void cancelled() { ++cancelled_; }
  /// Who came to compute and did not get a turn.
  void rejected() { ++rejected_; }

  /// Version 0.0.4 of the text form.
  std::string text(const Gauges& gauges) const;

 private:
  class Histogram {
   public:
    void add(double seconds);
    void write(std::string& out, std::string_view name, std::string_view help) const;

   private:
    static constexpr std::array<double, 10> bounds{0.0001, 0.001, 0.005, 0.025, 0.1, 0.5, 1, 5, 10, 60};
    mutable std::mutex mutex_;
    std::array<std::uint64_t, bounds.size() + 1> counts_{};
    double sum_ = 0;
  };

  mutable std::mutex mutex_;
  std::map<std::pair<std::string_view, int>, std::uint64_t> answers_;
  Histogram runs_, waits_;
  std::atomic<std::uint64_t> cancelled_{0}, rejected_{0};
};

}  // namespace least::server
