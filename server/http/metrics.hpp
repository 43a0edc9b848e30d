// Counts of what the service does, in the text format of Prometheus.
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

/// Gauges are values that are read when they are asked for, not counted.
struct Gauges {
  unsigned running = 0, waiting = 0, parked = 0;
  std::size_t connections = 0, bytes_held = 0;
  unsigned most_running = 0, most_waiting = 0, most_connections = 0;
  std::size_t most_bytes = 0;
  std::uint64_t dropped_log_lines = 0;
  std::string_view version{};
};

/// ProcessGauges are what the system reports of this process.
struct ProcessGauges {
  double cpu_seconds = 0, start_seconds = 0;  ///< start_seconds: since the epoch
  std::uint64_t resident_bytes = 0, descriptors = 0;
  static ProcessGauges now();
};

/// Metrics may be used from any thread.
class Metrics {
 public:
  /// `route` must have static lifetime; all paths of a kind share one, so that their number is bounded.
  void answered(std::string_view route, int status);
  /// computed: a computation was answered; `scheme` is one of the catalogue, or "several".
  void computed(std::string_view endpoint, const std::string& scheme);
  void ran(double seconds) { runs_.add(seconds); }
  void waited(double seconds) { waits_.add(seconds); }
  /// cancelled(): the client of a run is gone.
  void cancelled() { ++cancelled_; }
  /// rejected(): a request to compute did not get a turn.
  void rejected() { ++rejected_; }

  /// text returns version 0.0.4 of the text format.
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
  std::map<std::pair<std::string_view, std::string>, std::uint64_t> runs_by_scheme_;
  Histogram runs_, waits_;
  std::atomic<std::uint64_t> cancelled_{0}, rejected_{0};
};

}  // namespace least::server
