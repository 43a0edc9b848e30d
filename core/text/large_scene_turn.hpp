// Large scenes are read and derived one at a time: the temporary memory that this takes would add up between threads.
#pragma once

#include <mutex>
#include <utility>

namespace least::text {

/// LargeSceneTurn marks its thread as reading a scene. If the scene turns out to be large the thread takes the turn,
/// and keeps it until the LargeSceneTurn is destroyed.
class LargeSceneTurn {
 public:
  LargeSceneTurn() : before_(std::exchange(current(), this)) {}
  ~LargeSceneTurn();
  LargeSceneTurn(const LargeSceneTurn&) = delete;
  LargeSceneTurn& operator=(const LargeSceneTurn&) = delete;

  /// take() is called once the scene that this thread reads is known to be large. It waits for the turn, but only as
  /// long as the thread's computation is still wanted.
  static void take();

 private:
  static LargeSceneTurn*& current() {
    thread_local LargeSceneTurn* reading = nullptr;
    return reading;
  }

  LargeSceneTurn* before_;
  std::unique_lock<std::timed_mutex> lock_;
};

}  // namespace least::text
