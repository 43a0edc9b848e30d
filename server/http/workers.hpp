// The threads for long tasks. A task that waits, for its client or for its next turn, steps aside.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "server/http/effort.hpp"

namespace least::server {

/// Workers runs posted tasks on a fixed number of threads at once.
class Workers {
 public:
  using Task = std::function<void()>;
  using Clock = std::chrono::steady_clock;

  /// A task that has waited longer goes before tasks of less effort, so that these cannot keep it waiting for ever.
  static constexpr std::chrono::milliseconds patience{50};

  /// Limit of tasks that have stepped aside at once.
  static constexpr std::size_t most_aside = 32;

  /// start begins with so many threads. Throws where a thread cannot be created.
  void start(std::size_t threads) {
    at_once_ = made_ = threads;
    threads_.reserve(threads + most_aside);
    for (std::size_t i = 0; i < threads; ++i) threads_.emplace_back([this] { work(); });
  }
  ~Workers() { finish(); }

  /// post queues a task: least effort first, equal effort in the order of arrival. Tasks must not throw.
  void post(Effort effort, Task task) {
    {
      const std::lock_guard lock(mutex_);
      tasks_[static_cast<std::size_t>(effort)].push_back({std::move(task), Clock::now()});
    }
    came_.notify_one();
  }

  /// step_aside() is called by a task that is about to wait: another thread works in its place. False: there is none.
  bool step_aside() {
    {
      const std::lock_guard lock(mutex_);
      if (aside_ >= most_aside || ended_) return false;
      if (made_ < at_once_ + aside_ + 1) {
        try {
          threads_.emplace_back([this] { work(); });
        } catch (const std::system_error&) {
          return false;
        }
        ++made_;
      }
      ++aside_;
      --at_work_;
    }
    came_.notify_one();
    return true;
  }
  /// step_back(): the task goes on.
  void step_back() {
    const std::lock_guard lock(mutex_);
    --aside_;
    ++at_work_;
  }

  /// finish() runs all posted tasks, then ends.
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

  // The queue whose first task is next; null where all are empty.
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
      came_.wait(lock, [&] { return (at_work_ < at_once_ && (queue = next()) != nullptr) || ended_; });
      if (!queue && !(queue = next())) return;
      ++at_work_;
      Task task = std::move(queue->front().task);
      queue->pop_front();
      lock.unlock();
      task();
      task = nullptr;  // destroy what the task holds outside of the lock, too
      lock.lock();
      --at_work_;
      if (made_ > at_once_) came_.notify_one();  // a thread beyond the allowed number may be waiting
    }
  }

  std::mutex mutex_;
  std::condition_variable came_;
  std::array<Queue, 3> tasks_;  // by effort
  bool ended_ = false;
  std::size_t at_once_ = 0, made_ = 0, at_work_ = 0, aside_ = 0;
  std::vector<std::jthread> threads_;  // last, as the threads use the other members
};

}  // namespace least::server
