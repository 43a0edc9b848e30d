// Members that end leave their lanes to others, and nobody's bits tell.
#include <gtest/gtest.h>

#include "tests/support/ensembles.hpp"
#include "tests/support/texts.hpp"

namespace {

using namespace least;

/// Starts of which some end early, at times of their own, and some do not.
struct Leaving {
  const char *problem, *scheme;
  double step;
  std::vector<Variation> vary;
};
/// Hénon and Heiles' members escape where their energy suffices; orbits that plunge towards the centre find the step
/// too long there.
std::vector<Leaving> all_that_leave() {
  return {{"henon_heiles", "leapfrog", 0.05, {{false, 1, Spread::uniform, {-0.3, 0.6}}}},
          {"henon_heiles", "runge_kutta_4", 0.05, {{false, 1, Spread::uniform, {-0.3, 0.6}}}},
          {"perturbed_kepler", "contact_leapfrog", 0.02, {{false, 3, Spread::uniform, {0.1, 1.6}}}},
          {"perturbed_kepler", "contact_splitting", 0.02, {{false, 3, Spread::uniform, {0.1, 1.6}}}},
          // The first ones begin beyond the saddle: of whole groups nobody is left.
          {"henon_heiles", "leapfrog", 0.05, {{false, 1, Spread::grid, {1.6, -0.3, 700}}}}};
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
  plan.section = Section{false, 31.4, 0.1};
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

TEST(EnsembleRanks, ClosingThemChangesNoBit) {
  for (const Leaving& leaving : all_that_leave()) {
    const EnsemblePlan plan = ensemble_leaving(leaving);
    const std::string name = std::string(leaving.problem) + " by " + leaving.scheme;
    const Harvest still = *test::in_lanes(plan, lane_units().back());  // where each member keeps its lane
    EXPECT_GT(still.ended[0], 70) << name;
    EXPECT_LT(still.ended[0], 630) << name;
    for (const LaneUnit& unit : lane_units().first(lane_units().size() - 1))
      expect_the_same(*test::in_lanes(plan, unit), still, name + ", " + std::string(unit.name));
  }
}

// Of programs members change their lanes in every unit: against others that they meet there, and against a run.
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
      plan.members.vary.push_back({true, 0, Spread::uniform, {0.9, 1.1}});
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
