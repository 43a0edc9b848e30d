#include "core/text/large_scene_turn.hpp"

#include <malloc.h>

#include <chrono>

#include "core/number/asked_by_thread.hpp"

namespace least::text {

LargeSceneTurn::~LargeSceneTurn() {
  current() = before_;
#if defined(__GLIBC__)
  // The allocator would keep freed memory for this thread, in addition to what the next thread takes.
  if (lock_.owns_lock()) malloc_trim(0);
#endif
}

void LargeSceneTurn::take() {
  static std::timed_mutex one_at_a_time;
  constexpr auto look = std::chrono::milliseconds(20);
  LargeSceneTurn* const reading = current();
  if (!reading || reading->lock_.owns_lock()) return;
  if (reading->before_ && reading->before_->lock_.owns_lock()) return;
  reading->lock_ = std::unique_lock(one_at_a_time, std::defer_lock);
  while (!reading->lock_.try_lock_for(look) && AskedByThread::goes_on()) {
  }
}

}  // namespace least::text
