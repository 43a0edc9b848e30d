// Lanes: a member has the same bits as alone, whatever runs beside it and whatever the instruction set.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/support/ensembles.hpp"

namespace {

using namespace least;

using test::alone, test::in_lanes;

TEST(LaneMembers, HaveTheBitsOfAloneInEveryUnit) {
  std::set<std::string_view> seen;
  test::for_each_pair([&](EnsemblePlan& plan, const std::string& name) {
    const auto wide = in_lanes(plan, lane_units().front());
    ASSERT_TRUE(wide) << name;
    ASSERT_EQ(wide->ended[0], 37) << name;
    for (const LaneUnit& unit : lane_units()) {
      const auto other = in_lanes(plan, unit);
      ASSERT_TRUE(other) << name << " in " << unit.name;
      EXPECT_EQ(other->final, wide->final) << name << " in " << unit.name;
      EXPECT_EQ(other->cost.steps, 37 * 61) << name;
      seen.insert(unit.name);
    }
    const std::size_t columns = plan.request.columns.size();
    for (const std::int64_t i : {0, 7, 36}) {
      EnsemblePlan one = plan;
      one.first = i;
      one.last = i + 1;
      const auto row = wide->final.begin() + i * static_cast<std::int64_t>(columns);
      EXPECT_EQ(in_lanes(one, lane_units().front())->final,
                std::vector<double>(row, row + static_cast<std::int64_t>(columns)))
          << name;
    }
  });
  EXPECT_EQ(seen.size(), lane_units().size());
}

/// Single runs use the C library's elementary functions: members without any have the same bits as a run, others nearly
/// so.
TEST(LaneMembers, AreTheRunsOfTheService) {
  const std::set<std::string> arithmetic{"harmonic_oscillator", "henon_heiles", "kepler", "kepler_3d"};
  int exact = 0;
  test::for_each_pair([&](EnsemblePlan& plan, const std::string& name) {
    plan.last = 3;
    const Harvest lone = alone(plan), wide = in_lanes(plan, lane_units().front()).value();
    ASSERT_EQ(lone.ended, wide.ended) << name;
    ASSERT_EQ(lone.final.size(), wide.final.size()) << name;
    if (arithmetic.contains(plan.request.scene->card().id)) {
      EXPECT_EQ(lone.final, wide.final) << name;
      ++exact;
    }
    for (std::size_t i = 0; i < lone.final.size(); ++i)
      EXPECT_NEAR(lone.final[i], wide.final[i], 1e-11 * (1 + std::abs(lone.final[i]))) << name;
    EXPECT_EQ(lone.cost.steps, wide.cost.steps) << name;
    EXPECT_EQ(lone.cost.force_evaluations, wide.cost.force_evaluations) << name;
  });
  EXPECT_GT(exact, 0);
}

TEST(LaneMembers, CarryMoreWhereItIsAskedForAndMoveTheSame) {
  for (const char* problem : {"perturbed_kepler", "damped_pendulum", "damped_oscillator"}) {
    if (!find_problem(problem)) continue;
    EnsemblePlan plan = test::about_start(problem, *find_scheme("contact_splitting"), 20, 100);
    const Harvest without = in_lanes(plan, lane_units().front()).value();
    const std::size_t columns = plan.request.columns.size();
    const auto& cards = plan.request.scene->card().columns;
    const auto energy = std::ranges::find(cards, "energy", &ColumnCard::name) - cards.begin();
    plan.request.columns.push_back(static_cast<std::size_t>(energy));
    const Harvest with = in_lanes(plan, lane_units().back()).value(), lone = alone(plan);
    for (std::size_t m = 0; m < 20; ++m) {
      for (std::size_t k = 0; k < columns; ++k)
        EXPECT_EQ(with.final[m * (columns + 1) + k], without.final[m * columns + k]);
      EXPECT_NEAR(with.final[m * (columns + 1) + columns], lone.final[m * (columns + 1) + columns], 1e-11);
    }
  }
}

/// expect_same_endings() checks a group of members that end for different reasons at different times.
void expect_same_endings(const EnsemblePlan& plan, ReturnCode reason) {
  const Harvest lone = alone(plan);
  EXPECT_GT(lone.ended[0], 0);
  EXPECT_GT(lone.ended[static_cast<std::size_t>(reason)], 0);
  for (const LaneUnit& unit : lane_units()) {
    const Harvest wide = in_lanes(plan, unit).value();
    EXPECT_EQ(wide.ended, lone.ended) << unit.name;
    EXPECT_EQ(wide.final_member, lone.final_member) << unit.name;
    EXPECT_EQ(wide.cost.steps, lone.cost.steps) << unit.name;
    ASSERT_EQ(wide.final.size(), lone.final.size());
    for (std::size_t i = 0; i < lone.final.size(); ++i)
      EXPECT_NEAR(wide.final[i], lone.final[i], 1e-9 * (1 + std::abs(lone.final[i])));
  }
}
TEST(LaneMembers, EndEachForItself) {
  EnsemblePlan plan = test::ensemble_of("kepler", "leapfrog", 30);
  test::setting(plan, "step") = 0.05;
  test::set_members(plan, 100, {{Varied::variable, 2, Spread::grid, {-0.4, -0.005, 100}}});
  expect_same_endings(plan, ReturnCode::unstable_step);
  plan.request.limits.steps = 10;
  EXPECT_EQ(in_lanes(plan, lane_units().front())->ended[static_cast<std::size_t>(ReturnCode::step_limit)], 100);
  plan = test::ensemble_of("henon_heiles", "leapfrog", 30);
  test::set_members(plan, 100, {{Varied::variable, 1, Spread::grid, {0, 1.3, 100}}});
  const Harvest escapes = in_lanes(plan, lane_units().front()).value();
  EXPECT_EQ(escapes.ended, alone(plan).ended);
  EXPECT_GT(escapes.ended[0], 0);
  EXPECT_LT(escapes.ended[0], 100);
  if (find_problem("cosmological_oscillator")) {
    plan = test::ensemble_of("cosmological_oscillator", "contact_splitting", 5);
    test::set_members(plan, 60, {{Varied::variable, 2, Spread::grid, {-3, 0, 60}}});
    expect_same_endings(plan, ReturnCode::singular);
    plan = test::ensemble_of("cosmological_oscillator", "explicit_euler", 1);  // has no pole of a part at γsh = −2
    test::setting(plan, "step") = 0.1;
    test::set_members(plan, 60, {{Varied::variable, 2, Spread::grid, {-40, 0, 60}}});
    expect_same_endings(plan, ReturnCode::completed);
  }
  if (find_problem("lane_emden")) {
    plan = test::ensemble_of("lane_emden", "contact_splitting", 4.5);
    auto scene = std::make_shared<Scene>(*plan.request.scene);
    scene->start = 2;
    plan.request.scene = scene;
    test::set_members(plan, 60, {{Varied::variable, 1, Spread::grid, {-0.6, 0, 60}}});
    expect_same_endings(plan, ReturnCode::left_domain);
  }
}

TEST(LaneMembers, OfASweepEndEachForItself) {
  EnsemblePlan plan = test::ensemble_of("kepler", "leapfrog", 30);
  test::setting(plan, "step") = 0.05;
  test::set_members(plan, 100, {{Varied::parameter, 0, Spread::grid, {0.5, 4000, 100}}});
  expect_same_endings(plan, ReturnCode::unstable_step);
  test::set_members(plan, 100, {{Varied::parameter, 0, Spread::grid, {0.5, 8, 100}}});
  expect_same_endings(plan, ReturnCode::unstable_step);
  if (find_problem("harmonic_oscillator")) {
    plan = test::ensemble_of("harmonic_oscillator", "leapfrog", 5);
    test::setting(plan, "step") = 0.05;
    test::set_members(plan, 100, {{Varied::parameter, 1, Spread::grid, {1, 3000, 100}}});
    expect_same_endings(plan, ReturnCode::unstable_step);
  }
  if (find_problem("cosmological_oscillator")) {
    plan = test::ensemble_of("cosmological_oscillator", "contact_splitting", 5);
    Scene scene = *plan.request.scene;
    scene.initial[2] = -2;
    plan.request.scene = std::make_shared<const Scene>(scene);
    const auto& parameters = scene.card().parameters;
    const auto gamma = std::ranges::find(parameters, "gamma", &ParameterCard::name) - parameters.begin();
    test::set_members(plan, 60, {{Varied::parameter, static_cast<std::size_t>(gamma), Spread::grid, {0, 1, 60}}});
    expect_same_endings(plan, ReturnCode::singular);
  }
  if (find_problem("lane_emden")) {
    plan = test::ensemble_of("lane_emden", "contact_splitting", 4.5);
    Scene scene = *plan.request.scene;
    scene.start = 2;
    scene.initial[1] = -0.3;
    plan.request.scene = std::make_shared<const Scene>(scene);
    test::set_members(plan, 60, {{Varied::parameter, 0, Spread::grid, {0, 5, 60}}});
    expect_same_endings(plan, ReturnCode::left_domain);
  }
}

TEST(LaneMembers, MeetStroboscopicSectionsAsAlone) {
  EnsemblePlan plan = test::about_start("henon_heiles", *find_scheme("leapfrog"), 70, 500);
  plan.request.section = Section{false, 1.5, 0.25};
  const Harvest lone = alone(plan);
  ASSERT_GT(lone.section.t.size(), 70 * 5u);
  for (const LaneUnit& unit : lane_units()) {
    const Harvest wide = in_lanes(plan, unit).value();
    EXPECT_EQ(wide.section.member, lone.section.member);
    EXPECT_EQ(wide.section.crossing, lone.section.crossing);
    EXPECT_EQ(wide.section.t, lone.section.t);
    EXPECT_EQ(wide.section.values, lone.section.values);
    EXPECT_EQ(wide.final, in_lanes(
                              [&] {
                                EnsemblePlan without = plan;
                                without.request.section.reset();
                                return without;
                              }(),
                              unit)
                              ->final)
        << "a section does not change the run";
  }
}

TEST(LaneMembers, MeetPlanesWhereTheyLie) {
  EnsemblePlan plan = test::ensemble_of("harmonic_oscillator", "leapfrog", 20);
  test::setting(plan, "step") = 0.01;
  test::setting(plan, "composition") = 4;
  test::set_members(plan, 40, {{Varied::variable, 0, Spread::grid, {1, 2, 40}}});
  test::set_columns(plan, {"t", "q", "p"});
  for (const int direction : {1, -1, 0}) {
    test::set_plane(plan, "q - 0.5", direction);
    const Harvest met = in_lanes(plan, lane_units().front()).value();
    EXPECT_EQ(in_lanes(plan, lane_units().back())->section.values, met.section.values);
    std::size_t at = 0;
    for (int m = 0; m < 40; ++m) {  // q = a cos t
      const double a = 1 + m / 39.0, down = std::acos(0.5 / a), turn = 2 * 3.141592653589793;
      std::vector<double> times;
      for (int k = 0; k < 4; ++k) {
        if (direction <= 0) times.push_back(down + k * turn);
        if (direction >= 0) times.push_back(turn - down + k * turn);
      }
      for (std::size_t k = 0; k < times.size() && times[k] < 20; ++k, ++at) {
        ASSERT_LT(at, met.section.t.size());
        EXPECT_EQ(met.section.member[at], m);
        EXPECT_EQ(met.section.crossing[at], static_cast<std::int64_t>(k));
        EXPECT_NEAR(met.section.t[at], times[k], 1e-11);
        EXPECT_EQ(met.section.values[3 * at], met.section.t[at]);
        EXPECT_NEAR(met.section.values[3 * at + 1], 0.5, 1e-14);
      }
    }
    EXPECT_EQ(at, met.section.t.size());
  }
  plan.request.limits.samples = 11 * 3;  // numbers: t, q and p of eleven points
  const Harvest few = in_lanes(plan, lane_units().front()).value();
  EXPECT_TRUE(few.truncated);
  EXPECT_EQ(few.section.member, (std::vector<std::int64_t>{0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1}));
}

// At a turning point an oscillator passes a plane and comes back, mostly within one step; so does the momentum of a
// pendulum that just gets over the top. Both do so in their first step as well.
TEST(LaneMembers, MeetPlanesTheyPassTwiceWithinAStep) {
  for (const auto& [problem, start, from, to, plane, times] :
       {std::tuple{"harmonic_oscillator", std::vector{0.9995, 0.03}, 0.9995, 0.9996, "q - 0.9998", 48},
        {"harmonic_oscillator", {0.9995, 0.03}, 0.9995, 0.9996, "q + 1e-9*sin(t) - 0.9998", 48},
        {"pendulum", {3.121592, 0.5}, 3.121592, 3.121593, "p - 0.4998", 55}}) {
    EnsemblePlan plan = test::ensemble_of(problem, "leapfrog", 300);
    test::setting(plan, "step") = 0.1;
    test::setting(plan, "composition") = 4;
    Scene scene = *plan.request.scene;
    scene.initial = start;
    plan.request.scene = std::make_shared<const Scene>(scene);
    test::set_members(plan, 37, {{Varied::variable, 0, Spread::grid, {from, to, 37}}});
    test::set_plane(plan, plane, -1);
    const SectionPoints lone = alone(plan).section;
    EXPECT_EQ(lone.t.size(), 37U * times) << plane;  // once a turn
    for (const LaneUnit& unit : lane_units()) {
      const SectionPoints met = in_lanes(plan, unit)->section;
      EXPECT_EQ(met.member, lone.member) << plane << " in " << unit.name;
      EXPECT_EQ(met.crossing, lone.crossing) << plane << " in " << unit.name;
      ASSERT_EQ(met.t.size(), lone.t.size()) << plane << " in " << unit.name;
      for (std::size_t i = 0; i < met.t.size(); ++i) EXPECT_NEAR(met.t[i], lone.t[i], 1e-8) << plane;
    }
  }
}

TEST(LaneMembers, MeetPlanesAsAlone) {
  for (const auto& [problem, scheme, expression] : {std::tuple{"pendulum", "leapfrog", "q"},
                                                    {"henon_heiles", "leapfrog", "x*px + y*py - 0.01"},
                                                    {"henon_heiles", "leapfrog", "x - y"},
                                                    {"damped_pendulum", "contact_splitting", "sin(q) - 0.1*t/(1 + t)"},
                                                    {"henon_heiles", "ruth_3", "x - 0.02"},
                                                    {"damped_pendulum", "contact_leapfrog", "p + 0.1"},
                                                    {"damped_oscillator", "contact_splitting", "s + 1e-3"}}) {
    EnsemblePlan plan = test::about_start(problem, *find_scheme(scheme), 21, 900);
    test::set_plane(plan, expression, 0);
    const SectionPoints lone = alone(plan).section;
    ASSERT_GT(lone.t.size(), 21u) << expression;
    const auto first = in_lanes(plan, lane_units().back());
    ASSERT_TRUE(first) << expression;
    for (const LaneUnit& unit : lane_units()) {
      const auto lanes = in_lanes(plan, unit);
      ASSERT_TRUE(lanes) << expression << " in " << unit.name;
      const SectionPoints& met = lanes->section;
      EXPECT_EQ(met.t, first->section.t) << expression << " in " << unit.name;
      EXPECT_EQ(met.values, first->section.values) << expression << " in " << unit.name;
      EXPECT_EQ(met.member, lone.member) << expression;
      EXPECT_EQ(met.crossing, lone.crossing) << expression;
      ASSERT_EQ(met.t.size(), lone.t.size()) << expression;
      for (std::size_t i = 0; i < lone.t.size(); ++i) EXPECT_NEAR(met.t[i], lone.t[i], 1e-10) << expression;
      for (std::size_t i = 0; i < lone.values.size(); ++i)
        EXPECT_NEAR(met.values[i], lone.values[i], 1e-10) << expression;
    }
  }
  // Lanes compute neither the energy nor expressions that differ between members: such members run alone.
  EnsemblePlan plan = test::about_start("kepler", *find_scheme("leapfrog"), 3, 10);
  test::set_plane(plan, "energy + 0.2", 0);
  EXPECT_FALSE(in_lanes(plan, lane_units().back()));
  test::set_plane(plan, "x - mu", 0);
  EXPECT_TRUE(in_lanes(plan, lane_units().back()));
  plan.members.vary.push_back({Varied::parameter, 0, Spread::uniform, {0.9, 1.1}});
  EXPECT_FALSE(in_lanes(plan, lane_units().back()));
}

// A plane whose expression oscillates a hundred million times within a step; the first member is so near the origin
// that its expression does not.
TEST(LaneMembers, SayWhereTheirSearchEndsUnresolved) {
  EnsemblePlan plan = test::ensemble_of("harmonic_oscillator", "leapfrog", 3);
  test::set_members(plan, 3, {{Varied::variable, 0, Spread::values, {1e-9, 1, 2}}});
  test::set_plane(plan, "sin(1e9*q) - 0.5", 0);
  plan.request.limits.samples = 100;
  const auto expect_told = [](const Harvest& found, const std::string& what) {
    EXPECT_EQ(found.unresolved, 2) << what;
    EXPECT_EQ(found.first_unresolved, 1) << what;
  };
  expect_told(test::alone(plan), "alone");
  for (const LaneUnit& unit : lane_units())
    if (const auto lanes = test::in_lanes(plan, unit)) expect_told(*lanes, std::string(unit.name));
  Harvest sum;
  sum.add(test::alone(plan), 100);
  sum.add(test::alone(plan), 100);
  EXPECT_EQ(sum.unresolved, 4);
  EXPECT_EQ(sum.first_unresolved, 1);
  test::set_plane(plan, "q - 0.5", 0);
  EXPECT_EQ(test::alone(plan).unresolved, 0);
}

}  // namespace
