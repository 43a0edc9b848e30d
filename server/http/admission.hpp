// Bounds how many runs compute at once and how many wait for their turn.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <utility>

namespace least::server {

class Admission {
 public:
  /// `running` runs at once, `waiting` more in the queue.
  Admission(unsigned running, unsigned waiting) : running_(running), waiting_(waiting) {}

  /// The right to compute, given back at its end.
  class Pass {
   public:
    explicit Pass(Admission& admission) : admission_(&admission) {}
    Pass(Pass&& other) noexcept : admission_(std::exchange(other.admission_, nullptr)) {}
    Pass& operator=(Pass&&) = delete;
    ~Pass() {
      if (admission_) admission_->leave();
    }

   private:
    Admission* admission_;
  };

  /// Waits at most `patience` for a turn. Nothing: the queue is full, the patience over, or it is closed.
  std::optional<Pass> enter(std::chrono::milliseconds patience) {
    std::unique_lock lock(mutex_);
    if (running_ == 0) {
      if (waiting_ == 0) return std::nullopt;
      --waiting_;
      turn_.wait_for(lock, patience, [&] { return running_ > 0 || closed_; });
      ++waiting_;
    }
    if (running_ == 0 || closed_) return std::nullopt;
    --running_;
    return std::optional<Pass>(std::in_place, *this);
  }

  /// Nobody enters any more; those who wait leave with nothing.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    turn_.notify_all();
  }

 private:
  void leave() {
    {
      const std::lock_guard lock(mutex_);
      ++running_;
    }
    turn_.notify_one();
  }

  std::mutex mutex_;
  std::condition_variable turn_;
  unsigned running_, waiting_;  // places left
  bool closed_ = false;
};

}  // namespace least::server
