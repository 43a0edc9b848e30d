// The threads that do what takes its time. None of their tasks waits for a client to send or for a turn.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "server/http/effort.hpp"

namespace least::server {

class Workers {
 public:
  using Task = std::function<void()>;
  using Clock = std::chrono::steady_clock;

  /// A task that waits for longer goes before those of less effort: they cannot keep it waiting for ever.
  static constexpr std::chrono::milliseconds patience{50};

  /// Throws where a thread cannot be had.
  void start(std::size_t threads) {
    for (std::size_t i = 0; i < threads; ++i) threads_.emplace_back([this] { work(); });
  }
  ~Workers() { finish(); }

  /// The least effort first, of the same in the order in which they come. A task may not throw.
  void post(Effort effort, Task task) {
    {
      const std::lock_guard lock(mutex_);
      tasks_[static_cast<std::size_t>(effort)].push_back({std::move(task), Clock::now()});
    }
    came_.notify_one();
  }

  /// Does what was posted, and ends.
  void finish() {
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
    }
    came_.notify_all();
    threads_.clear();
  }

 private:
  struct Posted {
    Task task;
    Clock::time_point since;
  };
  using Queue = std::deque<Posted>;

  // The queue whose first task is next; none where nothing is left.
  Queue* next() {
    Queue* chosen = nullptr;
    const auto late = Clock::now() - patience;
    for (Queue& queue : tasks_) {
      if (queue.empty()) continue;
      if (!chosen || queue.front().since < std::min(late, chosen->front().since)) chosen = &queue;
    }
    return chosen;
  }

  void work() {
    std::unique_lock lock(mutex_);
    for (;;) {
      Queue* queue = nullptr;
      came_.wait(lock, [&] { return (queue = next()) != nullptr || ended_; });
      if (!queue) return;
      Task task = std::move(queue->front().task);
      queue->pop_front();
      lock.unlock();
      task();
      task = nullptr;  // what it holds is let go outside of the lock, too
      lock.lock();
    }
  }

  std::mutex mutex_;
  std::condition_variable came_;
  std::array<Queue, 3> tasks_;  // by effort
  bool ended_ = false;
  std::vector<std::jthread> threads_;  // last: they use the others
};

}  // namespace least::server
