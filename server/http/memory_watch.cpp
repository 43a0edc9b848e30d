#include "server/http/memory_watch.hpp"

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <new>

namespace least::server {
namespace {

constexpr std::size_t mebibyte = std::size_t{1} << 20;

}  // namespace

std::size_t MemoryWatch::resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::size_t all = 0, resident = 0, of_files = 0;
  if (!(statm >> all >> resident >> of_files) || resident < of_files) return 0;
  return (resident - of_files) * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

void MemoryWatch::look(MemoryBudget* memory) {
  if (!memory) return;
  if (resident_) count_uncounted(*memory);
  const std::size_t held = memory->held(), worth_it = std::min(16 * mebibyte, memory->most() / 8);
  most_ = std::max(most_, held);
  if (most_ - held >= worth_it && trim()) most_ = held;
}

// A request is charged for memory before it writes to it; until then this estimate is too low, and a later look
// corrects it.
void MemoryWatch::count_uncounted(MemoryBudget& memory) {
  constexpr int between_trims = 4;  // looks
  const std::size_t resident = resident_(), held = memory.held(), by_requests = held - uncounted_.bytes();
  if (resident == 0) return;  // the system did not say
  looks_since_trim_ = std::min(looks_since_trim_ + 1, between_trims + 1);
  if (by_requests == 0) {
    uncounted_.shrink_to(0);
    return learn_what_is_idle(resident);
  }
  quiet_looks_ = 0;
  // Requests keep a quarter of the budget in any case, as the memory that the service keeps for itself is known only
  // when it is idle.
  const std::size_t known = idle_ + by_requests + tolerated, most = memory.most() - memory.most() / 4;
  const std::size_t beyond = std::min(resident > known ? resident - known : 0, most);
  if (beyond <= uncounted_.bytes()) return uncounted_.shrink_to(beyond);
  if (looks_since_trim_ > between_trims) trim();
  // As much of it as the budget has.
  const std::size_t free = memory.most() - std::min(held, memory.most());
  uncounted_.grow_to(&memory, uncounted_.bytes() + std::min(beyond - uncounted_.bytes(), free));
}

// The resident memory a second after the last request, and after a trim, is the service's own, such as problems of the
// catalogue that were used.
void MemoryWatch::learn_what_is_idle(std::size_t resident) {
  constexpr int second = 20;  // looks
  idle_ = std::min(idle_, resident);
  if (quiet_looks_ > second) return;
  ++quiet_looks_;
  if (quiet_looks_ == second / 2 && resident > idle_ + mebibyte) trim();
  if (quiet_looks_ == second) idle_ = resident;
}

bool MemoryWatch::trim() {
  if (at_work_.exchange(true)) return false;
  try {
    workers_.post(Effort::brief, [this] {
      ::malloc_trim(0);
      at_work_ = false;
    });
  } catch (const std::bad_alloc&) {
    at_work_ = false;
    return false;
  }
  looks_since_trim_ = 0;
  return true;
}

}  // namespace least::server
