// Turns where memory runs out: no request is forgotten, and no place is lost.
#include "server/http/admission.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <new>
#include <optional>
#include <utility>
#include <vector>

#include "server/http/metrics.hpp"
#include "tests/server/http/scarce_memory.hpp"

namespace least::server::test {
thread_local int allocations_left = -1;
}
using least::server::test::allocations_left;

void* operator new(std::size_t size) {
  if (allocations_left == 0) throw std::bad_alloc();
  if (allocations_left > 0) --allocations_left;
  if (void* const memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t& /*kind*/) noexcept {
  return allocations_left == 0 ? nullptr : std::malloc(size);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t /*size*/) noexcept { std::free(memory); }

namespace least::server {
namespace {

using Pass = std::optional<Admission::Pass>;

TEST(Turns, SurviveThatMemoryIsOut) {
  const std::string names[] = {"one of the clients, by a long name", "another of them, by a longer one"};
  bool all_were_taken = false;
  for (int memory = 0; memory < 60; ++memory) {
    Metrics metrics;
    Admission admission(2, 10, &metrics);
    int taken = 0, called = 0;
    std::vector<Pass> granted;
    granted.reserve(10);
    const Admission::Turn turn = [&](Pass pass) {
      ++called;
      if (pass) granted.push_back(std::move(pass));
    };
    allocations_left = memory;
    for (int i = 0; i < 6; ++i) {
      try {
        if (auto pass = admission.enter(names[i % 2])) {
          granted.push_back(std::move(pass));
        } else {
          admission.wait(std::make_shared<Account>(names[i % 2]), std::chrono::seconds(10), {}, turn);
          ++taken;
        }
      } catch (const std::bad_alloc&) {
      }
    }
    allocations_left = 0;
    admission.look();
    while (!granted.empty()) {
      const Pass over = std::move(granted.back());
      granted.pop_back();
    }
    allocations_left = -1;
    EXPECT_EQ(called, taken) << memory;
    EXPECT_EQ(admission.load().running, 0U) << memory;
    EXPECT_EQ(admission.load().waiting, 0U) << memory;
    const Pass first = admission.enter("a"), second = admission.enter("b");
    EXPECT_TRUE(first && second) << memory;
    all_were_taken = taken == 4;
  }
  EXPECT_TRUE(all_were_taken) << "with memory enough";
}

}  // namespace
}  // namespace least::server
