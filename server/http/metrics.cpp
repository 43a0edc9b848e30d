#include "server/http/metrics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace least::server {
namespace {

void write_head(std::string& out, std::string_view name, std::string_view type, std::string_view help) {
  fmt::format_to(std::back_inserter(out), "# HELP leastaction_{0} {2}\n# TYPE leastaction_{0} {1}\n", name, type, help);
}

template <class Number>
void write_one(std::string& out, std::string_view name, std::string_view type, std::string_view help, Number value) {
  write_head(out, name, type, help);
  fmt::format_to(std::back_inserter(out), "leastaction_{} {}\n", name, value);
}

}  // namespace

void Metrics::Histogram::add(double seconds) {
  const auto bucket = std::lower_bound(bounds.begin(), bounds.end(), seconds) - bounds.begin();
  const std::lock_guard lock(mutex_);
  ++counts_[static_cast<std::size_t>(bucket)];
  sum_ += seconds;
}

void Metrics::Histogram::write(std::string& out, std::string_view name, std::string_view help) const {
  const std::lock_guard lock(mutex_);
  write_head(out, name, "histogram", help);
  std::uint64_t total = 0;
  for (std::size_t i = 0; i <= bounds.size(); ++i) {
    total += counts_[i];
    const std::string bound = i < bounds.size() ? fmt::format("{}", bounds[i]) : "+Inf";
    fmt::format_to(std::back_inserter(out), "leastaction_{}_bucket{{le=\"{}\"}} {}\n", name, bound, total);
  }
  fmt::format_to(std::back_inserter(out), "leastaction_{0}_sum {1}\nleastaction_{0}_count {2}\n", name, sum_, total);
}

void Metrics::answered(std::string_view route, int status) {
  const std::lock_guard lock(mutex_);
  ++answers_[{route, status}];
}

std::string Metrics::text(const Gauges& gauges) const {
  std::string out;
  write_head(out, "build_info", "gauge", "The version that runs.");
  fmt::format_to(std::back_inserter(out), "leastaction_build_info{{version=\"{}\"}} 1\n", gauges.version);
  write_head(out, "requests_total", "counter", "Answers by route and status.");
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [key, count] : answers_) {
      fmt::format_to(std::back_inserter(out), "leastaction_requests_total{{route=\"{}\",status=\"{}\"}} {}\n",
                     key.first, key.second, count);
    }
  }
  runs_.write(out, "run_seconds", "Time that a request held its place to compute.");
  waits_.write(out, "queue_seconds", "Time that a request waited for its place.");
  write_one(out, "running", "gauge", "Requests that compute now.", gauges.running);
  write_one(out, "waiting", "gauge", "Requests that wait for their turn to compute.", gauges.waiting);
  write_one(out, "cancelled_total", "counter", "Computations ended because their client went away.", cancelled_.load());
  write_one(out, "rejected_total", "counter", "Requests that did not get a turn to compute.", rejected_.load());
  write_one(out, "held_bytes", "gauge", "Bytes held for requests and answers.", gauges.bytes_held);
  write_one(out, "dropped_log_lines_total", "counter", "Log lines that nobody took in time.", gauges.dropped_log_lines);
  return out;
}

}  // namespace least::server
