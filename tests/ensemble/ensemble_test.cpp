// Ensembles: members move as they do alone, and the distribution of the work changes no bit.
#include <gtest/gtest.h>

#include <thread>

#include "core/ensemble/member_starts.hpp"
#include "tests/support/ensembles.hpp"

namespace {

using namespace least;
using test::ensemble_of;
using test::harvest_of;

constexpr std::int64_t some = 9000;  // of three blocks

EnsemblePlan kepler_members() {
  EnsemblePlan plan = ensemble_of("kepler", "leapfrog", 3);
  test::set_members(plan, some,
                    {{Varied::variable, 0, Spread::uniform, {0.8, 1.2}},
                     {Varied::variable, 1, Spread::normal, {0, 0.1}},
                     {Varied::variable, 3, Spread::uniform, {0.7, 1.3}}});
  test::setting(plan, "step") = 0.05;
  test::set_columns(plan, {"t", "x", "y", "energy"});
  plan.final = true;
  plan.histograms = {{1, -2, 2, 10}};
  return plan;
}
void expect_same(const Harvest& a, const Harvest& b) {
  EXPECT_EQ(a.ended, b.ended);
  ASSERT_EQ(a.columns.size(), b.columns.size());
  for (std::size_t k = 0; k < a.columns.size(); ++k) {
    EXPECT_EQ(a.columns[k].mean, b.columns[k].mean);
    EXPECT_EQ(a.columns[k].squares, b.columns[k].squares);
  }
  ASSERT_EQ(a.histograms.size(), b.histograms.size());
  for (std::size_t k = 0; k < a.histograms.size(); ++k) EXPECT_EQ(a.histograms[k].counts, b.histograms[k].counts);
  EXPECT_EQ(a.final_member, b.final_member);
  EXPECT_EQ(a.final, b.final);
  EXPECT_EQ(a.section.t, b.section.t);
  EXPECT_EQ(a.section.values, b.section.values);
}

TEST(Ensemble, AMemberIsTheRunOfItsScene) {
  EnsemblePlan plan = kepler_members();
  const Harvest all = harvest_of(plan);
  ASSERT_EQ(all.final_member.size(), std::size_t{some});
  const std::atomic<bool> never{false};
  for (const std::int64_t i : {0, 4095, 4096, 8999}) {
    Request alone = plan.request;
    alone.scene = MemberStarts(plan).scene(i);
    alone.record.count = 0;
    Samples none;
    const Solution run = alone.scene->mechanics->run(alone, none, never);
    const auto row = all.final.begin() + i * 4;
    EXPECT_EQ(row[0], 3);
    EXPECT_EQ(row[1], run.final[0]) << i;
    EXPECT_EQ(row[2], run.final[1]) << i;
  }
}

TEST(Ensemble, ThreadsChangeNoBit) {
  const EnsemblePlan plan = kepler_members();
  expect_same(harvest_of(plan), harvest_of(plan, 3));
}

TEST(Ensemble, ShardsAddUpToTheWhole) {
  const EnsemblePlan plan = kepler_members();
  const std::atomic<bool> never{false};
  std::vector<Block> blocks(3);
  for (std::int64_t shard = 0; shard < 2; ++shard)
    run_ensemble(plan, {shard, 2}, 1, never, [&](Block& block) {
      EXPECT_EQ(block.index % 2, shard);
      blocks[static_cast<std::size_t>(block.index)] = std::move(block);
      return true;
    });
  Harvest sum;
  for (const Block& block : blocks) sum.add(block.harvest, 1000000);
  expect_same(sum, harvest_of(plan));
}

TEST(Ensemble, ARangeIsThePartOfTheMembersItNames) {
  EnsemblePlan plan = kepler_members();
  const Harvest all = harvest_of(plan);
  plan.first = 4000;
  plan.last = 4200;  // of two blocks
  const Harvest part = harvest_of(plan);
  EXPECT_EQ(part.ended[0], 200);
  EXPECT_EQ(part.final_member.front(), 4000);
  EXPECT_EQ(part.final, std::vector<double>(all.final.begin() + 4000 * 4, all.final.begin() + 4200 * 4));
}

TEST(Ensemble, WhatStopsIsCountedAndLeftOut) {
  EnsemblePlan plan = ensemble_of("kepler", "leapfrog", 2);
  test::setting(plan, "step") = 0.05;
  // A start at rest and near falls into the centre, where its steps are too long. A start at rest and far has no
  // trouble.
  test::set_members(plan, 2, {{Varied::variable, 0, Spread::values, {0.3, 50}}});
  plan.request.scene = [&] {
    auto scene = std::make_shared<Scene>(*plan.request.scene);
    scene->initial = {0, 0, 0, 0};
    return scene;
  }();
  const Harvest all = harvest_of(plan);
  EXPECT_EQ(all.ended[static_cast<std::size_t>(ReturnCode::completed)], 1);
  EXPECT_EQ(all.ended[static_cast<std::size_t>(ReturnCode::unstable_step)], 1);
  ASSERT_EQ(all.columns.size(), plan.request.columns.size());
  EXPECT_EQ(all.columns[1].count, 1);
  EXPECT_GT(all.columns[1].minimum, 49);
}

TEST(Ensemble, EndsWithItsTimeAndWhenToldTo) {
  EnsemblePlan plan = kepler_members();
  plan.request.end = 1e4;
  plan.request.limits.seconds = 0.05;
  const std::atomic<bool> never{false}, now{true};
  const auto nothing = [](const Block&) { return true; };
  EXPECT_EQ(run_ensemble(plan, {}, 2, never, nothing), ReturnCode::deadline);
  EXPECT_EQ(run_ensemble(plan, {}, 2, now, nothing), ReturnCode::cancelled);
  plan.request.limits.seconds = 10;
  plan.request.end = 1;
  int seen = 0;
  EXPECT_EQ(run_ensemble(plan, {}, 2, never, [&](const Block&) { return ++seen < 2; }), ReturnCode::cancelled);
  EXPECT_EQ(seen, 2);
}

// The receiver of blocks may be slow; what was computed in time is complete however late the last block is received.
TEST(Ensemble, IsCompleteHoweverLateItsLastBlockIsReceived) {
  EnsemblePlan plan = kepler_members();
  plan.request.end = 1;
  plan.request.limits.seconds = 1e6;
  const std::atomic<bool> never{false};
  const std::int64_t last = plan.end_block() - 1;
  const auto late = [&](const Block& block) {
    if (block.index == last) least::read_clock = [] { return 1e12; };
    return true;
  };
  EXPECT_EQ(run_ensemble(plan, {}, 2, never, late), ReturnCode::completed);
  least::read_clock = least::steady_seconds;
}

TEST(Ensemble, AStroboscopicSectionIsTakenAtItsTimes) {
  EnsemblePlan plan = ensemble_of("harmonic_oscillator", "leapfrog", 10);
  test::setting(plan, "step") = 0.01;
  test::set_members(plan, 3, {{Varied::variable, 0, Spread::grid, {1, 3, 3}}});
  test::set_columns(plan, {"q", "p"});
  plan.request.section = Section{false, 3, 0.5};
  const Harvest all = harvest_of(plan);
  EXPECT_EQ(all.section.t, (std::vector<double>{0.5, 3.5, 6.5, 9.5, 0.5, 3.5, 6.5, 9.5, 0.5, 3.5, 6.5, 9.5}));
  EXPECT_EQ(all.section.member, (std::vector<std::int64_t>{0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2}));
  EXPECT_EQ(all.section.crossing, (std::vector<std::int64_t>{0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3}));
  for (std::size_t i = 0; i < all.section.t.size(); ++i) {
    const double size = 1 + static_cast<double>(all.section.member[i]);
    EXPECT_NEAR(all.section.values[2 * i], size * std::cos(all.section.t[i]), 1e-4 * size);
    EXPECT_NEAR(all.section.values[2 * i + 1], -size * std::sin(all.section.t[i]), 1e-4 * size);
  }
  plan.request.limits.samples = 7 * 3 + 2;  // numbers: t, q and p of seven points
  const Harvest few = harvest_of(plan);
  EXPECT_TRUE(few.truncated);
  EXPECT_EQ(few.section.t.size(), 7u);
  EXPECT_EQ(few.section.values.size(), 14u);
  EXPECT_FALSE(all.truncated);
}

std::vector<std::string> codes_of(const std::vector<Warning>& warnings) {
  std::vector<std::string> codes;
  for (const Warning& warning : warnings) codes.emplace_back(warning.code);
  return codes;
}

/// An ensemble warns of what runs alone warn of; it examines a few members, whatever they are.
TEST(Ensemble, WarnsOfWhatItsMembersWarnOf) {
  const std::atomic<bool> never{false};
  EnsemblePlan plan = kepler_members();
  test::setting(plan, "step") = 0.005;
  EXPECT_EQ(codes_of(warnings_of_few(plan, never)), std::vector<std::string>{});
  plan.request.end = 100;
  test::setting(plan, "step") = 0.5;
  const auto warnings = warnings_of_few(plan, never);
  const auto codes = codes_of(warnings);
  ASSERT_EQ(std::ranges::count(codes, "large_error"), 1) << "each once";
  const auto& large = warnings[static_cast<std::size_t>(std::ranges::find(codes, "large_error") - codes.begin())];
  EXPECT_EQ(large.detail, "large_error: said by 8 of 8 members that were run alone, too; the first is member 0");
  const auto again = warnings_of_few(plan, never);
  ASSERT_EQ(again.size(), warnings.size());
  for (std::size_t i = 0; i < again.size(); ++i) EXPECT_EQ(again[i].detail, warnings[i].detail);

  // Only the last members are bad: their step is too long for their close approach.
  plan.request.end = 20;
  test::setting(plan, "step") = 0.02;
  plan.members.vary = {{Varied::variable, 3, Spread::grid, {1, 0.1, 5}}};
  plan.members.count = plan.last = 5;
  const auto some_of_them = warnings_of_few(plan, never);
  ASSERT_FALSE(some_of_them.empty());
  EXPECT_NE(some_of_them.back().detail.text().find(" of 5 members that were run alone, too; "), std::string::npos);
  EXPECT_EQ(some_of_them.back().detail.text().find("said by 5 of 5"), std::string::npos) << some_of_them.back().detail;

  // The same for runs of any length.
  plan.request.until_steps = true;
  plan.request.steps = plan.request.limits.steps = 10'000'000'000;
  test::setting(plan, "step") = 0.5;
  EXPECT_FALSE(warnings_of_few(plan, never).empty());
}

}  // namespace
