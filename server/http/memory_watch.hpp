// What the process really has in memory, held against what its requests say they hold. Small pieces that they gave
// back, as the events of a run or the tape of a scene, stay in a heap, where they count for nobody and yet take what
// others may hold: heaps are trimmed. What nobody counted, whatever it is, the service itself takes of the memory that
// all requests share, so that those have the less: the memory of the process is bounded by that and a little more.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

#include "server/http/workers.hpp"
#include "server/shared/memory_budget.hpp"

namespace least::server {

class MemoryWatch {
 public:
  /// So much may be in memory that nobody counts, beside what the service has when nobody asks: what threads free and
  /// take again lies between.
  static constexpr std::size_t tolerated = std::size_t{16} << 20;

  /// `resident`: bytes that the process has in memory. Where it is empty, nothing is known but what requests hold; it
  /// is to be so where others work in this process, too.
  explicit MemoryWatch(Workers& workers, std::function<std::size_t()> resident = {})
      : workers_(workers), resident_(std::move(resident)), idle_(resident_ ? resident_() : 0) {}

  /// To be called now and then, by one thread. `memory` may be null: then nothing is known.
  void look(MemoryBudget* memory);

  /// Bytes that this process has in memory and no file stands behind; 0 where the system does not say.
  static std::size_t resident_bytes();

 private:
  void count_uncounted(MemoryBudget& memory);
  void learn_what_is_idle(std::size_t resident);
  void trim();

  Workers& workers_;
  const std::function<std::size_t()> resident_;
  std::size_t idle_;      ///< resident where no request holds anything
  std::size_t most_ = 0;  ///< held since the last time that less of it made it worth to trim
  int quiet_looks_ = 0;   ///< since a request held something
  int looks_since_trim_ = 0;
  Held uncounted_{};  ///< by the service, on behalf of nobody
  std::atomic<bool> at_work_{false};
};

}  // namespace least::server
