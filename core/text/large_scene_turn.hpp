// Of large scenes one is read and derived at a time: what that takes on its way, beside what stays, would add
// up.
#pragma once

#include <mutex>
#include <utility>

namespace least::text {

/// While it lives, its thread reads a scene. Once that shows to be large the thread has the turn, up to the end.
class LargeSceneTurn {
 public:
  LargeSceneTurn() : before_(std::exchange(current(), this)) {}
  ~LargeSceneTurn();
  LargeSceneTurn(const LargeSceneTurn&) = delete;
  LargeSceneTurn& operator=(const LargeSceneTurn&) = delete;

  /// The scene that the thread reads is large: waits for the turn, as long as the computation of the thread is to go
  /// on.
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
