// Members that differ in parameters: in lanes each is the same as alone.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/support/ensembles.hpp"

namespace {

using namespace least;

using test::alone, test::in_lanes, test::for_each_pair;

TEST(Sweeps, OfAllParametersAreAsAlone) {
  for_each_pair([&](EnsemblePlan& plan, const std::string& name) {
    const ProblemCard& card = plan.request.scene->card();
    for (std::size_t k = 0; k < card.parameters.size(); ++k) {
      const ParameterCard& parameter = card.parameters[k];
      if (parameter.kind != Kind::number) continue;
      const double at = parameter.value, change = 0.01 * (std::abs(at) > 0 ? std::abs(at) : 1);
      const double other = parameter.range.contains(at + change) ? at + change : at - change;
      plan.members.vary.push_back({Varied::parameter, k, Spread::uniform, {std::min(at, other), std::max(at, other)}});
    }
    plan.last = 5;
    const Harvest lone = alone(plan);
    const auto lanes = in_lanes(plan, lane_units().back());
    ASSERT_TRUE(lanes) << name;
    ASSERT_EQ(lone.ended, lanes->ended) << name;
    ASSERT_EQ(lone.final.size(), lanes->final.size()) << name;
    for (std::size_t i = 0; i < lone.final.size(); ++i)
      EXPECT_NEAR(lone.final[i], lanes->final[i], 1e-11 * (1 + std::abs(lone.final[i]))) << name;
  });
}

/// values_about() returns values of a parameter near its own, and 0 and its opposite where they are allowed, because
/// formulas may branch there.
std::vector<double> values_about(const ParameterCard& parameter, double at) {
  std::vector<double> values{at};
  for (const double other : {1.01 * at, 0.99 * at, 0.0, -at})
    if (parameter.range.contains(other) && std::ranges::find(values, other) == values.end()) values.push_back(other);
  return values;
}

TEST(Sweeps, OfEveryParameterAreAsAlone) {
  std::set<ReturnCode> endings;
  int sweeps = 0;
  for_each_pair([&](EnsemblePlan& plan, const std::string& name) {
    const auto composition = schemes()[plan.request.scheme].find("composition");
    if (composition && plan.request.settings[*composition] != 0) return;
    const ProblemCard& card = plan.request.scene->card();
    for (std::size_t k = 0; k < card.parameters.size(); ++k) {
      if (card.parameters[k].kind != Kind::number) continue;
      const auto values = values_about(card.parameters[k], plan.request.scene->parameters[k]);
      test::set_members(plan, static_cast<std::int64_t>(values.size()),
                        {{Varied::parameter, k, Spread::values, values}});
      const std::string what = name + ", " + card.parameters[k].name;
      const Harvest lone = alone(plan), wide = in_lanes(plan, lane_units().front()).value();
      ++sweeps;
      for (std::size_t i = 0; i < lone.ended.size(); ++i)
        if (lone.ended[i] > 0) endings.insert(static_cast<ReturnCode>(i));
      EXPECT_EQ(wide.ended, lone.ended) << what;
      EXPECT_EQ(wide.final_member, lone.final_member) << what;
      EXPECT_EQ(wide.cost.steps, lone.cost.steps) << what;
      const bool all = lone.ended[0] == static_cast<std::int64_t>(values.size());
      if (all) {  // in lanes, forces of a failed step belong to no member
        EXPECT_EQ(wide.cost.force_evaluations, lone.cost.force_evaluations) << what;
      }
      ASSERT_EQ(wide.final.size(), lone.final.size()) << what;
      for (std::size_t i = 0; i < lone.final.size(); ++i)
        EXPECT_NEAR(wide.final[i], lone.final[i], 1e-9 * (1 + std::abs(lone.final[i]))) << what;
      for (const LaneUnit& unit : lane_units())
        EXPECT_EQ(in_lanes(plan, unit)->final, wide.final) << what << " in " << unit.name;
    }
  });
  EXPECT_GT(sweeps, 0);
  EXPECT_TRUE(endings.contains(ReturnCode::completed));
}

}  // namespace
