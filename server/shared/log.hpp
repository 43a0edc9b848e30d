// The log: lines of an event with its fields, as text or as JSON, which never block the writer.
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

/// LogLine is one line, written by its destructor: `LogLine(spdlog::level::info, "start").with("url", url);` gives
/// `start url=http://…` as text, and `{"time": …, "level": …, "event": "start", "url": …}` as JSON.
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

/// log_directly logs to standard error, at once; for commands that answer one request.
void log_directly(const std::string& level);

/// LogQueue logs to a file descriptor, by a thread of its own, while it lives. A limited number of lines wait if they
/// cannot be written; further ones are dropped and counted. Throws where no thread can be started.
class LogQueue {
 public:
  LogQueue(int descriptor, const std::string& level, LogFormat format, std::size_t most_lines = 10'000);
  /// Writes the waiting lines, but gives up on a reader that takes nothing for half a second.
  ~LogQueue();

 private:
  class Sink;
  std::shared_ptr<Sink> sink_;
};

/// dropped_log_lines() returns how many lines have been dropped so far.
std::uint64_t dropped_log_lines();

}  // namespace least::server
