// The memory that requests share: what is taken, and how those that find no room wait.
#include "core/memory_budget.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <latch>
#include <thread>
#include <vector>

#include "core/clock.hpp"
#include "core/number/asked_by_thread.hpp"

namespace least {
namespace {

using namespace std::chrono_literals;

TEST(MemoryBudget, IsNotInTheWayWhereSomebodyAsksForTooMuch) {
  MemoryBudget budget(100);
  std::atomic<bool> over{false};
  std::jthread greedy([&] {
    while (!over) EXPECT_FALSE(budget.take(101));
  });
  int failed = 0;
  for (int i = 0; i < 200'000; ++i) {
    if (budget.take(60))
      budget.give_back(60);
    else
      ++failed;
  }
  over = true;
  EXPECT_EQ(failed, 0);
}

TEST(MemoryBudget, IsWaitedForUntilOthersGiveBack) {
  MemoryBudget budget(100);
  Held other(&budget), held(&budget);
  other.add(80);
  std::jthread later([&] {
    std::this_thread::sleep_for(50ms);
    other.shrink_to(20);
  });
  held.add_soon(60);
  EXPECT_EQ(held.bytes(), 60U);
}

TEST(MemoryBudget, IsNotWaitedForInVain) {
  MemoryBudget budget(100);
  Held other(&budget), held(&budget);
  other.add(80);
  double from = steady_seconds();
  EXPECT_THROW(held.add_soon(101), MemoryShortage);
  EXPECT_LT(steady_seconds() - from, 0.2) << "there never is so much";
  const AskedByThread asked([] { return false; });
  from = steady_seconds();
  EXPECT_THROW(held.add_soon(60), MemoryShortage);
  EXPECT_LT(steady_seconds() - from, 0.2) << "nobody waits for it";
}

// A deadlock: each thread holds what another waits for. One gives up, and then all others get what they want.
TEST(MemoryBudget, LetsOneGiveUpForAllOthers) {
  constexpr int many = 32;
  MemoryBudget budget(10 * many);
  std::latch all_hold(many);
  std::atomic<int> failed{0};
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < many; ++i)
      threads.emplace_back([&] {
        Held held(&budget);
        held.add(10);
        all_hold.arrive_and_wait();
        try {
          held.add_soon(10);
          std::this_thread::sleep_for(10ms);  // longer than the others would wait without progress
        } catch (const MemoryShortage&) {
          ++failed;
        }
      });
  }
  EXPECT_GE(failed, 1);
  EXPECT_LE(failed, many / 4) << "more than one only where threads do not run for a while";
  EXPECT_EQ(budget.held(), 0U);
}

}  // namespace
}  // namespace least
