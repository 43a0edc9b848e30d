#include "core/memory_budget.hpp"

#include <chrono>
#include <thread>

#include "core/clock.hpp"
#include "core/number/asked_by_thread.hpp"

namespace least {

bool MemoryBudget::gives_up(double waited) {
  constexpr double patience = 0.5, moment = 0.05;  // in seconds
  const double now = steady_seconds();
  double last = gave_up_;
  return waited > patience && now - last > moment && gave_up_.compare_exchange_strong(last, now);
}

void Held::add_soon(std::size_t bytes) {
  using namespace std::chrono_literals;
  for (const double from = steady_seconds(); !grow_by(bytes); std::this_thread::sleep_for(1ms))
    if (bytes_ + bytes > budget_->most() || budget_->gives_up(steady_seconds() - from) || !AskedByThread::goes_on())
      throw MemoryShortage();
}

}  // namespace least
