// Compares the resident memory of the process with what its requests hold. Small blocks that requests have freed, such
// as events of a run or the tape of a scene, stay in the heap, where they are charged to nobody and yet take memory
// that others may hold: heaps are trimmed. Memory that nobody was charged for is charged to the service itself, in the
// budget that all requests share, so that requests get less and the memory of the process stays close to that budget.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

#include "server/http/workers.hpp"
#include "server/shared/memory_budget.hpp"

namespace least::server {

/// MemoryWatch is driven by look().
class MemoryWatch {
 public:
  /// Uncharged memory that is tolerated, beyond what the service has when idle: threads free and allocate this much all
  /// the time.
  static constexpr std::size_t tolerated = std::size_t{16} << 20;

  /// `resident` returns the resident bytes of the process. If it is empty only charges are known; it has to be empty
  /// where others run in this process, too.
  explicit MemoryWatch(Workers& workers, std::function<std::size_t()> resident = {})
      : workers_(workers), resident_(std::move(resident)), idle_(resident_ ? resident_() : 0) {}

  /// look is to be called regularly, by one thread. `memory` may be null: then nothing is done.
  void look(MemoryBudget* memory);

  /// resident_bytes() returns the resident bytes without files; 0 where the system does not tell.
  static std::size_t resident_bytes();

 private:
  void count_uncounted(MemoryBudget& memory);
  void learn_what_is_idle(std::size_t resident);
  /// trim lets a worker give the system what heaps do not use. False: one does so already, or there is no memory for
  /// the task; a later look tries again.
  bool trim();

  Workers& workers_;
  const std::function<std::size_t()> resident_;
  std::size_t idle_;      ///< resident bytes while no request holds anything
  std::size_t most_ = 0;  ///< the most that was held since the last trim
  int quiet_looks_ = 0;   ///< looks since a request held something
  int looks_since_trim_ = 0;
  Held uncounted_{};  ///< charged to the service, on behalf of nobody
  std::atomic<bool> at_work_{false};
};

}  // namespace least::server
