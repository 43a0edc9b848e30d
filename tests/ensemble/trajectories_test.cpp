// Trajectories of members, in lanes and alone: the same rows, also beside a section, and for members that stop.
#include <gtest/gtest.h>

#include "tests/support/ensembles.hpp"

namespace {

using namespace least;

/// Orbits of which some fall so near to the centre that their steps fail, and some end at once.
EnsemblePlan orbits(Record record) {
  EnsemblePlan plan = test::ensemble_of("kepler", "leapfrog", 6.02);
  test::setting(plan, "step") = 0.05;
  test::set_columns(plan, {"t", "x", "energy"});
  test::set_members(plan, 50, {{Varied::variable, 0, Spread::grid, {0, 1.5, 50}}});
  auto scene = std::make_shared<Scene>(*plan.request.scene);
  scene->initial = {0, 0.4, 0, 1};
  plan.request.scene = std::move(scene);
  plan.request.record = std::move(record);
  plan.trajectories = true;
  return plan;
}

TEST(MemberTrajectories, AreTheSameInLanesAndAlone) {
  for (const Record& record : {Record{Record::Mode::every, 1, {}}, Record{Record::Mode::every, 7, {}},
                               Record{Record::Mode::samples, 9, {}}, Record{Record::Mode::times, 0, {0, 1.23, 6.02}}}) {
    EnsemblePlan plan = orbits(record);
    for (int kind = 0; kind < 3; ++kind) {
      if (kind == 1) plan.request.section = Section{false, 0.7, 0.1};
      if (kind == 2) test::set_plane(plan, "y - 0.01*x", 0);
      const Harvest lone = test::alone(plan);
      ASSERT_EQ(lone.trajectories.member.size(), 50U);
      ASSERT_EQ(lone.trajectories.rows.back(), static_cast<std::int64_t>(row_count(plan)));
      ASSERT_EQ(kind > 0, !lone.section.t.empty());
      for (const LaneUnit& unit : lane_units()) {
        const auto wide = test::in_lanes(plan, unit);
        ASSERT_TRUE(wide) << unit.name << ", kind " << kind;
        EXPECT_EQ(wide->trajectories.member, lone.trajectories.member);
        EXPECT_EQ(wide->trajectories.rows, lone.trajectories.rows);
        EXPECT_EQ(wide->trajectories.values, lone.trajectories.values);
        EXPECT_EQ(wide->section.values, lone.section.values);
        EXPECT_EQ(wide->final, lone.final);
      }
    }
  }
}

// The last row of a grid that ends where the run does is the final state.
TEST(MemberTrajectories, EndInTheFinalState) {
  EnsemblePlan plan = orbits({Record::Mode::every, 1, {}});
  plan.request.end = 0.3;  // six times the step, up to rounding
  for (const Harvest& all : {test::alone(plan), test::in_lanes(plan, lane_units().back()).value()}) {
    ASSERT_EQ(all.trajectories.rows.back(), 7);
    const auto& rows = all.trajectories.values;
    EXPECT_EQ(std::vector<double>(rows.end() - 3, rows.end()),
              std::vector<double>(all.final.end() - 3, all.final.end()));
    EXPECT_EQ(rows.end()[-3], 0.3);
  }
}

TEST(MemberTrajectories, EndWithTheirSteps) {
  EnsemblePlan plan = orbits({Record::Mode::every, 10, {}});
  plan.request.limits.steps = 35;
  EXPECT_EQ(row_count(plan), 4U);
  const Harvest lone = test::alone(plan), wide = test::in_lanes(plan, lane_units().back()).value();
  EXPECT_EQ(lone.trajectories.rows.back(), 4);
  EXPECT_EQ(wide.trajectories.values, lone.trajectories.values);
}

}  // namespace
