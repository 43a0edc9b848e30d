// The log: lines of an event and its fields, as text or as JSON, that never hold up who writes them.
#pragma once

#include <spdlog/common.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>

namespace least::server {

enum class LogFormat { text, json };

/// One line, written when it ends: `LogLine(spdlog::level::info, "start").with("url", url);`
/// As text `start url=http://…`, as JSON `{"time": …, "level": …, "event": "start", "url": …}`.
class LogLine {
 public:
  using Value = std::variant<std::string, double, std::int64_t>;

  LogLine(spdlog::level::level_enum level, std::string_view event);
  ~LogLine();
  LogLine(const LogLine&) = delete;
  LogLine& operator=(const LogLine&) = delete;

  LogLine& with(std::string_view name, const Value& value);

 private:
  const spdlog::level::level_enum level_;
  const bool wanted_;
  std::string text_;
};

/// To standard error, at once. For commands that answer one request.
void log_directly(const std::string& level);

/// To a file descriptor, by a thread of its own, as long as this lives. Lines that cannot be written yet wait, a
/// bounded number of them; those beyond are dropped and counted. Throws where no thread can be started.
class LogQueue {
 public:
  LogQueue(int descriptor, const std::string& level, LogFormat format, std::size_t most_lines = 10'000);
  /// Writes what waits, but gives up on a reader that takes nothing for half a second.
  ~LogQueue();

 private:
  class Sink;
  std::shared_ptr<Sink> sink_;
};

/// Lines that were dropped so far.
std::uint64_t dropped_log_lines();

}  // namespace least::server
