// Members that end give their lanes to others, which changes nobody's bits.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/ensembles.hpp"
#include "tests/support/texts.hpp"

namespace {

using namespace least;

/// Leaving describes starts of which some end early, at different times, and some do not.
struct Leaving {
  const char *problem, *scheme;
  double step;
  std::vector<Variation> vary;
};
/// Members of Hénon and Heiles escape where their energy suffices; for orbits that plunge towards the centre the step
/// is too long there.
std::vector<Leaving> all_that_leave() {
  return {{"henon_heiles", "leapfrog", 0.05, {{Varied::variable, 1, Spread::uniform, {-0.3, 0.6}}}},
          {"henon_heiles", "runge_kutta_4", 0.05, {{Varied::variable, 1, Spread::uniform, {-0.3, 0.6}}}},
          {"perturbed_kepler", "contact_leapfrog", 0.02, {{Varied::variable, 3, Spread::uniform, {0.1, 1.6}}}},
          {"perturbed_kepler", "contact_splitting", 0.02, {{Varied::variable, 3, Spread::uniform, {0.1, 1.6}}}},
          // Values that are derived from each member's own damping move with it to another lane.
          {"damped_kepler",
           "contact_splitting",
           0.02,
           {{Varied::variable, 0, Spread::values, {0.5}},
            {Varied::variable, 3, Spread::uniform, {0.1, 1.6}},
            {Varied::parameter, 1, Spread::uniform, {-1e-3, 1e-3}}}},
          // The first members begin beyond the saddle: whole groups end.
          {"henon_heiles", "leapfrog", 0.05, {{Varied::variable, 1, Spread::grid, {1.6, -0.3, 700}}}}};
}
EnsemblePlan ensemble_leaving(const Leaving& leaving) {
  EnsemblePlan plan = test::ensemble_of(leaving.problem, leaving.scheme, 1);
  test::setting(plan, "step") = leaving.step;
  plan.request.until_steps = true;
  plan.request.steps = 6000;
  if (plan.request.scene->card().id == "henon_heiles") {
    Scene scene = *plan.request.scene;
    scene.initial = {0, 0, 0.48, 0.1};
    plan.request.scene = std::make_shared<const Scene>(scene);
  }
  test::set_members(plan, 700, leaving.vary);
  plan.request.section = Section{false, 31.4, 0.1};
  return plan;
}
void expect_the_same(const Harvest& a, const Harvest& b, const std::string& name) {
  EXPECT_EQ(a.ended, b.ended) << name;
  EXPECT_EQ(a.final_member, b.final_member) << name;
  EXPECT_EQ(a.final, b.final) << name;
  EXPECT_EQ(a.section.member, b.section.member) << name;
  EXPECT_EQ(a.section.t, b.section.t) << name;
  EXPECT_EQ(a.section.values, b.section.values) << name;
  EXPECT_EQ(a.cost.steps, b.cost.steps) << name;
  EXPECT_EQ(a.cost.force_evaluations, b.cost.force_evaluations) << name;
}

/// in_small_blocks() runs the members in blocks so small that each keeps its lane.
Harvest in_small_blocks(EnsemblePlan plan, const LaneUnit& unit) {
  Harvest all;
  constexpr std::int64_t few = 8;
  for (const std::int64_t last = plan.last; plan.first < last; plan.first += few) {
    plan.last = std::min(plan.first + few, last);
    all.add(*test::in_lanes(plan, unit), static_cast<std::size_t>(plan.request.limits.samples));
  }
  return all;
}

TEST(EnsembleRanks, ClosingThemChangesNoBit) {
  for (const Leaving& leaving : all_that_leave()) {
    EnsemblePlan plan = ensemble_leaving(leaving);
    for (const char* plane : {"", "y - 0.2"}) {  // some pass it twice within a step
      if (*plane) test::set_plane(plan, plane, 0);
      const std::string name = std::string(leaving.problem) + " by " + leaving.scheme + " " + plane;
      const Harvest still = in_small_blocks(plan, lane_units().back());
      EXPECT_GT(still.ended[0], 70) << name;
      EXPECT_LT(still.ended[0], 630) << name;
      EXPECT_GT(still.section.t.size(), 700u) << name;
      for (const LaneUnit& unit : lane_units())
        expect_the_same(*test::in_lanes(plan, unit), still, name + ", " + std::string(unit.name));
    }
  }
}

// An anti-damped oscillator passes a plane twice within the first step after `until`, beside members that end at all
// times before `steps`. Where a block is repeated, and where lanes are given to others, the position of each member one
// step earlier must be kept.
void expect_passages(int until, int turns, std::int64_t steps) {
  EnsemblePlan plan = test::ensemble_of("damped_oscillator", "contact_leapfrog", 1);
  const double period = (until + 0.5) / turns, turn = 2 * 3.141592653589793 / period, growth = 0.02;
  test::setting(plan, "step") = 2 * std::sin(turn / 2);
  plan.request.until_steps = true;
  plan.request.steps = steps;
  Scene scene = *plan.request.scene;
  ASSERT_EQ(scene.card().parameters[1].name, "damping");
  scene.initial = {1, 0};
  scene.parameters = {1, -2 * growth / test::setting(plan, "step")};
  plan.request.scene = std::make_shared<const Scene>(scene);
  std::vector<double> starts;
  for (int i = 0; i < 140; ++i) {
    starts.push_back(1 + 1e-6 * i);
    const double leaves = 1e75 * std::exp(-growth * static_cast<double>(steps) * (i * 37 % 140) / 140);
    starts.push_back(i % 4 < 2 ? leaves : -leaves);
  }
  test::set_members(plan, static_cast<std::int64_t>(starts.size()), {{Varied::variable, 0, Spread::values, starts}});
  const double level = std::exp(growth * until) * (1 + std::cos(turn / 2)) / 2;
  test::set_plane(plan, "q - " + std::to_string(level), 0);
  const Harvest lone = test::alone(plan);
  EXPECT_GT(lone.ended[0], 140);
  EXPECT_LT(lone.ended[0], 250);
  const auto of = [](const Harvest& all) {
    std::vector<std::int64_t> crossings;
    for (std::size_t i = 0; i < all.section.t.size(); ++i)
      if (all.section.member[i] % 2 == 0) crossings.push_back(all.section.member[i]);
    return crossings;
  };
  EXPECT_GE(of(lone).size(), 280u);
  for (const LaneUnit& unit : lane_units()) EXPECT_EQ(of(*test::in_lanes(plan, unit)), of(lone)) << unit.name;
}
TEST(EnsembleRanks, WhereTheyAreClosedNoPassageIsMissed) {
  expect_passages(50, 8, 58);
  expect_passages(250, 40, 252);
}

// Members of scenes as text are programs: they are compared with members in other lanes, and with a run.
void expect_texts_to_be_alike(const Leaving& leaving) {
  EnsemblePlan plan = ensemble_leaving(leaving);
  const auto typed = texts::all();
  const auto found = std::ranges::find(typed, "henon_heiles", &texts::Typed::id);
  ASSERT_NE(found, typed.end());
  plan.request = texts::typed_as(plan.request, texts::mechanics_of(found->definition));
  test::set_columns(plan, {"x", "y", "px"});
  for (const bool mixed : {false, true}) {
    if (mixed) {
      const auto& cards = plan.request.scene->card().parameters;
      ASSERT_EQ(cards[0].name, "lambda");
      plan.members.vary.push_back({Varied::parameter, 0, Spread::uniform, {0.9, 1.1}});
    }
    const Harvest all = *test::in_lanes(plan, lane_units().front());
    EXPECT_GT(all.ended[0], 70);
    EXPECT_LT(all.ended[0], 630);
    for (const LaneUnit& unit : lane_units()) expect_the_same(*test::in_lanes(plan, unit), all, std::string(unit.name));
    const auto columns = static_cast<std::ptrdiff_t>(plan.request.columns.size());
    for (std::size_t k = 0; k < all.final_member.size(); k += 40) {
      EnsemblePlan one = plan;
      one.first = all.final_member[k];
      one.last = one.first + 1;
      const auto row = all.final.begin() + static_cast<std::ptrdiff_t>(k) * columns;
      EXPECT_EQ(test::alone(one).final, std::vector<double>(row, row + columns)) << k;
    }
  }
}
TEST(EnsembleRanks, OfTextsTheyAreClosed) {
  expect_texts_to_be_alike(all_that_leave().front());
  expect_texts_to_be_alike(all_that_leave().back());
}

}  // namespace
