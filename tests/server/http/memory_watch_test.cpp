// Memory that nobody counted is taken from the budget that requests share.
#include "server/http/memory_watch.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <new>
#include <vector>

#include "server/http/workers.hpp"
#include "tests/server/http/scarce_memory.hpp"

namespace least::server::test {
namespace {

constexpr std::size_t mebibyte = std::size_t{1} << 20, tolerated = MemoryWatch::tolerated;

// A watch over a process whose resident memory is what the test says.
class MemoryWatchTest : public testing::Test {
 protected:
  MemoryWatchTest() { workers_.start(1); }

  MemoryBudget memory_{100 * mebibyte};
  std::size_t resident_ = 10 * mebibyte;
  Workers workers_;
  MemoryWatch watch_{workers_, [this] { return resident_; }};
};

TEST_F(MemoryWatchTest, TakesWhatNobodyCounts) {
  Held request(&memory_);
  request.add(20 * mebibyte);
  resident_ += request.bytes() + tolerated;
  watch_.look(&memory_);
  EXPECT_EQ(memory_.held(), request.bytes()) << "so much lies between";
  resident_ += 30 * mebibyte;
  watch_.look(&memory_);
  EXPECT_EQ(memory_.held(), request.bytes() + 30 * mebibyte);
  EXPECT_FALSE(memory_.take(51 * mebibyte));
  resident_ -= 10 * mebibyte;
  watch_.look(&memory_);
  EXPECT_EQ(memory_.held(), request.bytes() + 20 * mebibyte);
  request.shrink_to(0);
  watch_.look(&memory_);
  EXPECT_EQ(memory_.held(), 0) << "nobody asks";
}

TEST_F(MemoryWatchTest, TakesNoMoreThanThereIs) {
  Held request(&memory_);
  request.add(95 * mebibyte);
  resident_ += request.bytes() + tolerated + 50 * mebibyte;
  watch_.look(&memory_);
  EXPECT_EQ(memory_.held(), memory_.most());
  resident_ += 100 * mebibyte;
  request.shrink_to(mebibyte);
  watch_.look(&memory_);
  EXPECT_EQ(memory_.held(), request.bytes() + 75 * mebibyte) << "a part is left to requests";
}

TEST_F(MemoryWatchTest, LearnsWhatTheServiceKeeps) {
  constexpr std::size_t kept = 40 * mebibyte;
  Held request(&memory_);
  const auto looks_of_a_request = [&] {
    request.add(mebibyte);
    watch_.look(&memory_);
    const std::size_t held = memory_.held() - request.bytes();
    request.shrink_to(0);
    return held;
  };
  resident_ += kept;
  EXPECT_EQ(looks_of_a_request(), kept - tolerated - mebibyte);
  for (int i = 0; i < 10; ++i) watch_.look(&memory_);
  EXPECT_EQ(looks_of_a_request(), kept - tolerated - mebibyte) << "what heaps hold is not known from what is kept";
  for (int i = 0; i < 30; ++i) watch_.look(&memory_);
  EXPECT_EQ(looks_of_a_request(), 0);
}

// Heaps are trimmed by a worker. Where there is no memory to give it that task, a later look does so.
TEST(MemoryWatch, TrimsHeapsOnceThereIsMemoryForTheTask) {
  MemoryBudget memory(100 * mebibyte);
  Workers idle;  // so that its queue holds all tasks
  MemoryWatch watch(idle);
  // has_room_for_tasks() fills the room that the queue has without more memory, and tells whether there was any.
  const auto has_room_for_tasks = [&] {
    int posted = 0;
    allocations_left = 0;
    try {
      for (;; ++posted) idle.post(Effort::brief, [] {});
    } catch (const std::bad_alloc&) {
    }
    allocations_left = -1;
    return posted > 0;
  };
  Held request(&memory);
  request.add(20 * mebibyte);
  watch.look(&memory);
  request.shrink_to(0);
  has_room_for_tasks();
  bool failed = false;
  allocations_left = 0;
  try {
    watch.look(&memory);
  } catch (const std::bad_alloc&) {
    failed = true;
  }
  allocations_left = -1;
  EXPECT_FALSE(failed);
  EXPECT_FALSE(has_room_for_tasks());
  watch.look(&memory);
  EXPECT_TRUE(has_room_for_tasks()) << "the queue took memory for the task";
}

TEST_F(MemoryWatchTest, SeesWhatIsInMemory) {
  const std::size_t before = MemoryWatch::resident_bytes();
  EXPECT_GT(before, mebibyte);
  const std::vector<double> piece(4 * mebibyte, 1.5);
  EXPECT_GT(MemoryWatch::resident_bytes(), before + 24 * mebibyte);
  EXPECT_EQ(piece.back(), 1.5);
}

}  // namespace
}  // namespace least::server::test
