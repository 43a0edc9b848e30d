#include "server/shared/log.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <deque>
#include <iterator>
#include <mutex>
#include <thread>
#include <utility>

#include "server/shared/json_writer.hpp"

namespace least::server {
namespace {

std::atomic<LogFormat> current_format{LogFormat::text};
std::atomic<std::uint64_t> dropped{0};

void use(std::shared_ptr<spdlog::logger> logger, const std::string& level, LogFormat format) {
  spdlog::set_default_logger(std::move(logger));
  spdlog::set_pattern(format == LogFormat::text ? "%Y-%m-%dT%H:%M:%S.%e%z %l %v"
                                                : R"({"time":"%Y-%m-%dT%H:%M:%S.%e%z","level":"%l",%v})");
  spdlog::set_level(spdlog::level::from_str(level));
  current_format = format;
}

// Such a value could not be told from the next field, or from the next line
bool needs_quotes(std::string_view value) {
  return value.empty() || std::any_of(value.begin(), value.end(), [](char c) {
           return static_cast<unsigned char>(c) <= 0x20 || c == '"' || c == '=' || c == 0x7F;
         });
}

}  // namespace

LogLine::LogLine(spdlog::level::level_enum level, std::string_view event)
    : level_(level), wanted_(spdlog::default_logger_raw()->should_log(level)) {
  if (!wanted_) return;
  if (current_format == LogFormat::json) {
    text_ = "\"event\":";
    append_string(text_, event);
  } else {
    text_ = event;
  }
}

LogLine::~LogLine() {
  if (wanted_) spdlog::default_logger_raw()->log(level_, text_);
}

LogLine& LogLine::with(std::string_view name, const Value& value) {
  if (!wanted_) return *this;
  const bool json = current_format == LogFormat::json;
  fmt::format_to(std::back_inserter(text_), fmt::runtime(json ? ",\"{}\":" : " {}="), name);
  if (const auto* word = std::get_if<std::string>(&value)) {
    if (json || needs_quotes(*word)) {
      append_string(text_, *word);
    } else {
      text_ += *word;
    }
  } else if (const auto* number = std::get_if<double>(&value)) {
    append_number(text_, *number);
  } else {
    append_number(text_, std::get<std::int64_t>(value));
  }
  return *this;
}

class LogQueue::Sink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  Sink(int descriptor, std::size_t most) : descriptor_(descriptor), most_(most) {}

  void close() {
    {
      const std::lock_guard lock(queue_mutex_);
      closing_ = true;
    }
    came_.notify_all();
    if (thread_.joinable()) thread_.join();
  }

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t line;
    formatter_->format(message, line);
    {
      const std::lock_guard lock(queue_mutex_);
      if (closing_ || lines_.size() >= most_) {
        ++dropped;
        return;
      }
      lines_.emplace_back(line.data(), line.size());
      if (lines_.size() > 1) return;  // the thread is writing already
    }
    came_.notify_one();
  }
  void flush_() override {}

 private:
  void work() {
    std::unique_lock lock(queue_mutex_);
    for (;;) {
      came_.wait(lock, [this] { return closing_ || !lines_.empty(); });
      if (lines_.empty()) return;
      const std::string line = std::move(lines_.front());
      lines_.pop_front();
      lock.unlock();
      const bool written = write(line);
      lock.lock();
      if (written) continue;
      // There is no reader, or it reads nothing while the service ends
      dropped += 1 + std::exchange(lines_, {}).size();
    }
  }

  // Writes pieces that a pipe takes entirely or not at all, so that `write` never blocks.
  bool write(std::string_view text) {
    constexpr std::size_t piece = 4096;
    constexpr int glance = 100, patience = 5;  // milliseconds; and a number of glances, while it ends
    for (int tries = 0; !text.empty();) {
      pollfd entry{descriptor_, POLLOUT, 0};
      const int ready = ::poll(&entry, 1, glance);
      if (ready == 0 || (ready < 0 && errno == EINTR)) {
        const std::lock_guard lock(queue_mutex_);
        if (closing_ && ++tries >= patience) return false;
        continue;
      }
      const auto n = ::write(descriptor_, text.data(), std::min(text.size(), piece));
      if (n < 0 && errno != EAGAIN && errno != EINTR) return false;
      text.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(n, 0)));
    }
    return true;
  }

  const int descriptor_;
  const std::size_t most_;
  std::mutex queue_mutex_;
  std::condition_variable came_;
  std::deque<std::string> lines_;
  bool closing_ = false;
  std::thread thread_{[this] { work(); }};  // last, as the thread uses the other members
};

LogQueue::LogQueue(int descriptor, const std::string& level, LogFormat format, std::size_t most_lines)
    : sink_(std::make_shared<Sink>(descriptor, most_lines)) {
  use(std::make_shared<spdlog::logger>("leastaction", sink_), level, format);
}
LogQueue::~LogQueue() { sink_->close(); }

void log_directly(const std::string& level) {
  use(std::make_shared<spdlog::logger>("leastaction", std::make_shared<spdlog::sinks::stderr_sink_mt>()), level,
      LogFormat::text);
}

std::uint64_t dropped_log_lines() { return dropped; }

}  // namespace least::server
