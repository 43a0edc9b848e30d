// Bytes of an answer between the thread that makes them and the loop that sends them: so many at most, whatever the
// client's pace.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <string>
#include <utility>

namespace least::server {

class Outbox {
 public:
  /// `came` is called when there is something to take.
  explicit Outbox(std::function<void()> came) : came_(std::move(came)) {}

  /// Waits while more than a bound is still to be sent: who sends keeps the clock. False: nobody takes it any more.
  bool put(std::string bytes) {
    {
      std::unique_lock lock(mutex_);
      taken_.wait(lock, [this] { return closed_ || bytes_.size() < bound; });
      if (closed_) return false;
      const bool told = !bytes_.empty();
      bytes_.empty() ? bytes_.swap(bytes) : (void)bytes_.append(bytes);
      if (told) return true;
    }
    came_();
    return true;
  }
  /// There is no more after `last`; `whole`: the answer has its end. Does not wait.
  void finish(bool whole, std::string last = {}) {
    {
      const std::lock_guard lock(mutex_);
      bytes_.empty() ? bytes_.swap(last) : (void)bytes_.append(last);
      ended_ = true;
      whole_ = whole;
    }
    came_();
  }
  /// Whether `put` would not wait.
  bool has_room() {
    const std::lock_guard lock(mutex_);
    return closed_ || bytes_.size() < bound;
  }

  enum class State { open, whole, broken };
  /// Puts what there is in the place of `bytes`, and says whether more may come.
  State take(std::string& bytes) {
    const std::lock_guard lock(mutex_);
    bytes.clear();
    bytes.swap(bytes_);
    taken_.notify_one();
    return !ended_ ? State::open : whole_ ? State::whole : State::broken;
  }
  /// Nobody takes any more.
  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    bytes_ = {};
    taken_.notify_one();
  }

 private:
  static constexpr std::size_t bound = 256 * 1024;

  const std::function<void()> came_;
  std::mutex mutex_;
  std::condition_variable taken_;
  std::string bytes_;
  bool ended_ = false, whole_ = false, closed_ = false;
};

}  // namespace least::server
