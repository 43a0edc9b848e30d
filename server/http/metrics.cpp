#include "server/http/metrics.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>

namespace least::server {
namespace {

// Metrics of the process have standard names, without a prefix.
std::string_view prefix_of(std::string_view name) { return name.starts_with("process_") ? "" : "leastaction_"; }

void write_head(std::string& out, std::string_view name, std::string_view type, std::string_view help) {
  fmt::format_to(std::back_inserter(out), "# HELP {3}{0} {2}\n# TYPE {3}{0} {1}\n", name, type, help, prefix_of(name));
}

template <class Number>
void write_one(std::string& out, std::string_view name, std::string_view type, std::string_view help, Number value) {
  write_head(out, name, type, help);
  fmt::format_to(std::back_inserter(out), "{}{} {}\n", prefix_of(name), name, value);
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

void Metrics::computed(std::string_view endpoint, const std::string& scheme) {
  const std::lock_guard lock(mutex_);
  ++runs_by_scheme_[{endpoint, scheme}];
}

ProcessGauges ProcessGauges::now() {
  ProcessGauges gauges;
  std::ifstream statm("/proc/self/statm"), stat("/proc/self/stat"), boot("/proc/stat");
  std::uint64_t pages = 0;
  if (statm >> pages >> pages) gauges.resident_bytes = pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  for (const timeval& part : {used.ru_utime, used.ru_stime})
    gauges.cpu_seconds += static_cast<double>(part.tv_sec) + 1e-6 * static_cast<double>(part.tv_usec);
  std::string word, text{std::istreambuf_iterator<char>(stat), {}};
  std::istringstream fields(text.substr(std::min(text.rfind(')') + 1, text.size())));  // the name may contain blanks
  constexpr int start_field = 20;  // counted behind the name; in clock ticks since boot
  for (int i = 0; i < start_field; ++i) fields >> word;
  for (std::string key; boot >> key;) {
    double since = 0;
    if (key != "btime" || !(boot >> since)) continue;
    gauges.start_seconds = since + std::strtod(word.c_str(), nullptr) / static_cast<double>(::sysconf(_SC_CLK_TCK));
    break;
  }
  std::error_code error;
  for (std::filesystem::directory_iterator it("/proc/self/fd", error), end; !error && it != end; it.increment(error))
    ++gauges.descriptors;
  return gauges;
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
  write_head(out, "runs_total", "counter", "Computations answered, by endpoint and scheme.");
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [key, count] : runs_by_scheme_) {
      fmt::format_to(std::back_inserter(out), "leastaction_runs_total{{endpoint=\"{}\",scheme=\"{}\"}} {}\n", key.first,
                     key.second, count);
    }
  }
  runs_.write(out, "run_seconds", "Time that a request held its place to compute.");
  waits_.write(out, "queue_seconds", "Time that a request waited for its place.");
  write_one(out, "running", "gauge", "Requests that compute now.", gauges.running);
  write_one(out, "waiting", "gauge", "Requests that wait for their turn to compute.", gauges.waiting);
  write_one(out, "parked", "gauge", "Runs that wait for their client to read, and hold no place.", gauges.parked);
  write_one(out, "connections", "gauge", "Connections that are open.", gauges.connections);
  write_one(out, "max_running", "gauge", "Requests that compute at most, --threads.", gauges.most_running);
  write_one(out, "max_waiting", "gauge", "Requests that wait at most, --queue.", gauges.most_waiting);
  write_one(out, "max_connections", "gauge", "Connections at most, --connections.", gauges.most_connections);
  write_one(out, "cancelled_total", "counter", "Computations ended because their client went away.", cancelled_.load());
  write_one(out, "rejected_total", "counter", "Requests that did not get a turn to compute.", rejected_.load());
  write_one(out, "held_bytes", "gauge", "Bytes held for requests and answers, and what is in memory besides.",
            gauges.bytes_held);
  write_one(out, "max_held_bytes", "gauge", "Bytes held at most: --max-memory, or what the largest answer needs.",
            gauges.most_bytes);
  write_one(out, "dropped_log_lines_total", "counter", "Log lines that nobody took in time.", gauges.dropped_log_lines);
  const auto process = ProcessGauges::now();  // with the names that all exporters use
  write_one(out, "process_resident_memory_bytes", "gauge", "Resident memory.", process.resident_bytes);
  write_one(out, "process_cpu_seconds_total", "counter", "Processor time of all threads.", process.cpu_seconds);
  write_one(out, "process_open_fds", "gauge", "Open descriptors.", process.descriptors);
  write_one(out, "process_start_time_seconds", "gauge", "When it started, since 1970.", process.start_seconds);
  return out;
}

}  // namespace least::server
