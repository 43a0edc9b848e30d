// The memory that blocks of members hold: it is counted before it is allocated, and blocks are cut to the memory left.
#include <gtest/gtest.h>

#include <numeric>

#include "tests/support/ensembles.hpp"

namespace {

using namespace least;

EnsemblePlan section_of(std::int64_t members, double period) {
  EnsemblePlan plan = test::ensemble_of("harmonic_oscillator", "leapfrog", 10);
  test::setting(plan, "step") = 0.1;
  test::set_members(plan, members, {{Varied::variable, 0, Spread::uniform, {-1, 1}}});
  test::set_columns(plan, {"q", "p"});
  plan.request.section = Section{false, period, 0};
  plan.final = true;
  return plan;
}

struct Ran {
  ReturnCode reason;
  Harvest all;
};
Ran run_with(const EnsemblePlan& plan, MemoryBudget& memory, unsigned threads) {
  const std::atomic<bool> never{false};
  Ran ran{};
  ran.reason = run_ensemble(
      plan, {}, threads, never,
      [&](const Block& block) {
        EXPECT_GE(memory.held(), block.held.bytes());
        EXPECT_GE(block.held.bytes(),
                  sizeof(double) * (block.harvest.section.values.size() + block.harvest.final.size()));
        ran.all.add(block.harvest, static_cast<std::size_t>(plan.request.limits.samples));
        return true;
      },
      {}, &memory);
  return ran;
}

// A block of these members takes 16 MB, so that four threads compute the blocks one by one.
TEST(HeldByEnsembles, BlocksAreCutToWhatIsLeft) {
  const EnsemblePlan plan = section_of(5 * block_size, 0.1);
  const Harvest all = test::harvest_of(plan);
  MemoryBudget memory(60'000'000);
  const auto [reason, cut] = run_with(plan, memory, 4);
  EXPECT_EQ(reason, ReturnCode::completed);
  EXPECT_EQ(cut.section.values, all.section.values);
  EXPECT_EQ(cut.section.crossing, all.section.crossing);
  EXPECT_EQ(cut.final, all.final);
  EXPECT_EQ(memory.held(), 0U);
}

TEST(HeldByEnsembles, WhereNoBlockHasRoomTheyEnd) {
  for (const std::size_t bytes : {std::size_t{1000}, std::size_t{2'000'000}}) {
    MemoryBudget memory(bytes);
    const auto [reason, all] = run_with(section_of(5 * block_size, 0.1), memory, 2);
    EXPECT_EQ(reason, ReturnCode::memory) << bytes;
    EXPECT_EQ(std::accumulate(all.ended.begin(), all.ended.end(), std::int64_t{0}), 0) << bytes;
    EXPECT_EQ(memory.held(), 0U) << bytes;
  }
}

// Members that run one by one, because their scheme has no steps in lanes.
TEST(HeldByEnsembles, MembersOneByOneAreHeld) {
  EnsemblePlan plan = section_of(300, 0.001);
  plan.request.limits.samples = 5'000'000;
  plan.members.vary.clear();
  MemoryBudget memory(2'000'000);
  Block block{0, 0, 300, {}};
  block.held = Held(&memory);
  const HeldByThread held(&memory);
  const std::atomic<bool> never{false};
  EXPECT_THROW(run_lone_members(plan, {plan.request, plan.members.vary}, block, never), MemoryShortage);
  block = {};
  EXPECT_EQ(memory.held(), 0U);
}

// Sorting a large section takes a while: where nobody waits for the answer any more it is left unsorted.
TEST(HeldByEnsembles, PointsAreSortedPieceByPiece) {
  SectionPoints points;
  Held held;
  for (std::int64_t crossing = 0; crossing < 3; ++crossing)
    for (std::int64_t member = 12; member-- > 10;) {
      points.make_room(points.t.size() + 1, 2, held);
      points.member.push_back(member);
      points.crossing.push_back(crossing);
      points.t.push_back(static_cast<double>(crossing));
      points.values.insert(points.values.end(), {static_cast<double>(member), static_cast<double>(crossing)});
    }
  SectionPoints left = points;
  int looks = 0;
  left.sort(10, 2, 4, held, [&] { return ++looks < 1; });
  EXPECT_EQ(looks, 1);
  looks = 0;
  points.sort(10, 2, 4, held, [&] { return ++looks > 0; });
  EXPECT_EQ(looks, 5) << "at its order and at each of its lists";
  EXPECT_EQ(points.member, (std::vector<std::int64_t>{10, 10, 10, 11}));
  EXPECT_EQ(points.crossing, (std::vector<std::int64_t>{0, 1, 2, 0}));
  EXPECT_EQ(points.values, (std::vector<double>{10, 0, 10, 1, 10, 2, 11, 0}));
}

}  // namespace
