// Memory that requests gave back goes back to the system. Large pieces do so by themselves; small ones, as the events
// of a run or the tape of a scene, stay in the heap of the thread that made them, where they count for nobody and yet
// take what others may hold.
#pragma once

#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <cstddef>

#include "server/http/workers.hpp"
#include "server/shared/memory_budget.hpp"

namespace least::server {

class HeapTrim {
 public:
  explicit HeapTrim(Workers& workers) : workers_(workers) {}

  /// To be called now and then, by one thread: where much less is held than lately, a worker trims the heaps. `memory`
  /// may be null: then nothing is known.
  void look(const MemoryBudget* memory) {
    if (!memory || at_work_) return;
    constexpr std::size_t much = 16 << 20;
    const std::size_t worth_it = std::min(much, memory->most() / 8);
    const std::size_t held = memory->held();
    most_ = std::max(most_, held);
    if (most_ - held < worth_it) return;
    most_ = held;
    at_work_ = true;
    workers_.post(Effort::brief, [this] {
      ::malloc_trim(0);
      at_work_ = false;
    });
  }

 private:
  Workers& workers_;
  std::size_t most_ = 0;  ///< held since the last time
  std::atomic<bool> at_work_{false};
};

}  // namespace least::server
