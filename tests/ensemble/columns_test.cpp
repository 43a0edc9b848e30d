// The caller's own columns of members: the expressions of single runs, with varied parameters as variables.
#include <gtest/gtest.h>

#include <cmath>

#include "core/ensemble/member_starts.hpp"
#include "tests/support/ensembles.hpp"
#include "tests/support/texts.hpp"

namespace {

using namespace least;

/// add_own_columns() adds columns, given by name and expression.
void add_own_columns(EnsemblePlan& plan, std::initializer_list<std::pair<const char*, const char*>> own) {
  MemberReader reader(*plan.request.scene, plan.members.vary);
  for (const auto& [name, expression] : own) {
    if (const auto fault = reader.read(name, expression)) throw std::invalid_argument(fault->detail);
    plan.request.columns.push_back(plan.request.scene->card().columns.size() + reader.made().size() - 1);
  }
  plan.request.measures = reader.made();
}
std::size_t parameter(const EnsemblePlan& plan, std::string_view name) {
  const auto& all = plan.request.scene->card().parameters;
  return static_cast<std::size_t>(std::ranges::find(all, name, &ParameterCard::name) - all.begin());
}
EnsemblePlan orbits_of_masses() {
  EnsemblePlan plan = test::ensemble_of("kepler", "leapfrog", 3);
  test::setting(plan, "step") = 0.01;
  Scene scene = *plan.request.scene;
  scene.initial = {1, 0, 0, 0.55};
  plan.request.scene = std::make_shared<const Scene>(scene);
  test::set_members(plan, 6,
                    {{Varied::parameter, parameter(plan, "mu"), Spread::values, {0.5, 0.2, 2}},
                     {Varied::variable, 0, Spread::grid, {-1.2, 1, 2}}});
  test::set_columns(plan, {"y", "x"});
  return plan;
}
void expect_same_numbers(const std::vector<double>& a, const std::vector<double>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    EXPECT_TRUE(a[i] == b[i] || (std::isnan(a[i]) && std::isnan(b[i]))) << i << ": " << a[i] << ", " << b[i];
}

TEST(OwnColumns, AreThoseOfTheRunsOfTheMembers) {
  EnsemblePlan plan = orbits_of_masses();
  add_own_columns(plan,
                  {{"r", "sqrt(x^2+y^2)"}, {"e", "(px^2+py^2)/2 - mu/sqrt(x^2+y^2) - energy"}, {"late", "2*t+mu"}});
  const std::atomic<bool> never{false};
  const Harvest alone = test::alone(plan);
  for (const LaneUnit& unit : lane_units()) {
    const auto lanes = test::in_lanes(plan, unit);
    ASSERT_TRUE(lanes) << unit.name;
    expect_same_numbers(lanes->final, test::in_lanes(plan, lane_units().back())->final);
    for (const Harvest& all : {*lanes, alone}) {
      ASSERT_EQ(all.final.size(), 6u * 5u);
      for (std::size_t m = 0; m < 6; ++m) {
        const double* const row = &all.final[5 * m];
        EXPECT_NEAR(row[2], std::hypot(row[0], row[1]), 1e-15 * row[2]) << m;
        EXPECT_NEAR(row[3], 0, 1e-14) << m;
        EXPECT_NEAR(row[4], 6 + (m < 2 ? 0.5 : m < 4 ? 0.2 : 2), 1e-15) << m;
        Request run = plan.request;
        run.scene = MemberStarts(plan).scene(static_cast<std::int64_t>(m));
        MeasureReader reader(*run.scene);
        reader.read("r", "sqrt(x^2+y^2)");
        run.measures = reader.made();
        run.columns = {run.scene->card().columns.size()};
        run.record = {Record::Mode::times, 0, {3}};
        Samples rows;
        run.scene->mechanics->run(run, rows, never);
        EXPECT_NEAR(row[2], rows.values.at(0), 1e-14) << m;
      }
    }
  }
}

// A value that is undefined for one member is NaN for that member and no other; a power whose exponent varies has each
// member's exponent.
TEST(OwnColumns, WhatDoesNotExistIsUnknownInItsPlace) {
  EnsemblePlan plan = orbits_of_masses();
  add_own_columns(plan, {{"a", "sqrt(mu-1/3)+0*x"}, {"b", "x^mu"}, {"c", "1/(mu-0.5)"}, {"d", "x"}});
  plan.histograms = {{4, -10, 10, 1}};
  for (const Harvest& all : {test::alone(plan), *test::in_lanes(plan, lane_units().back())}) {
    ASSERT_EQ(all.final.size(), 6u * 6u);
    for (std::size_t m = 0; m < 6; ++m) {
      const double mu = m < 2 ? 0.5 : m < 4 ? 0.2 : 2, x = all.final[6 * m + 1];
      const double* const own = &all.final[6 * m + 2];
      EXPECT_EQ(std::isnan(own[0]), mu < 1 / 3.0) << m;
      if (mu > 1 / 3.0) {
        EXPECT_NEAR(own[0], std::sqrt(mu - 1 / 3.0), 1e-15) << m;
      }
      EXPECT_EQ(std::isnan(own[1]), x < 0 && mu != 2) << m;
      if (x > 0 || mu == 2) {
        EXPECT_NEAR(own[1], std::pow(x, mu), 1e-15 * own[1]) << m;
      }
      EXPECT_EQ(std::isnan(own[2]), mu == 0.5) << m;
      EXPECT_EQ(own[3], x) << m;
    }
  }
  const Harvest all = test::harvest_of(plan);
  EXPECT_EQ(all.columns[2].count, 4);
  EXPECT_EQ(all.histograms[0].below + all.histograms[0].above + all.histograms[0].counts[0], 4);
}

TEST(Histograms, CountWhatIsFinite) {
  Histogram of{{0, 0}};
  for (const double x : {0.5, -2.0, 3.0, 7.0, HUGE_VAL, -HUGE_VAL, std::nan("")}) of.count({0, -1, 1, 2}, x);
  EXPECT_EQ(of.counts, (std::vector<std::int64_t>{0, 1}));
  EXPECT_EQ(of.below, 1);
  EXPECT_EQ(of.above, 2);
}

TEST(OwnColumns, SectionsHaveThem) {
  for (const char* const plane : {"y", "y+0*energy"}) {  // in lanes, and by runs alone
    EnsemblePlan plan = orbits_of_masses();
    plan.request.end = 30;
    test::set_plane(plan, plane, 1);
    add_own_columns(plan, {{"twice", "2*x + mu"}});
    const Harvest all = test::harvest_of(plan);
    ASSERT_GT(all.section.t.size(), 6u);
    for (std::size_t i = 0; i < all.section.t.size(); ++i) {
      const double mu = std::array{0.5, 0.2, 2.0}[static_cast<std::size_t>(all.section.member[i]) / 2];
      EXPECT_NEAR(all.section.values[3 * i + 2], 2 * all.section.values[3 * i + 1] + mu, 1e-14) << plane << i;
    }
  }
}

// A plane whose expression is never defined for one of the members is still met by the others.
TEST(OwnColumns, APlaneThatDoesNotExistIsNotMet) {
  EnsemblePlan plan = orbits_of_masses();
  plan.request.end = 30;
  test::set_plane(plan, "y+0*sqrt(mu-1/3)", 1);
  const Harvest all = test::harvest_of(plan);
  EXPECT_EQ(std::ranges::count_if(all.section.member, [](std::int64_t m) { return m == 2 || m == 3; }), 0);
  EXPECT_GT(all.section.t.size(), 4u);
  EXPECT_EQ(all.ended[0], 6);
}

TEST(OwnColumns, OfATextThereMayBeNoOthers) {
  const auto mechanics =
      texts::mechanics_of(texts::of(text::Definition::Kind::potential, {"x"}, {{"k", 2}}, "k*x^2/2"));
  const ProblemCard& card = mechanics->card();
  Scene scene{mechanics, {2}, std::vector<double>(card.variables.size(), 0.0), 0};
  scene.initial[0] = 1;
  EnsemblePlan plan;
  plan.request.scene = std::make_shared<const Scene>(scene);
  plan.request.scheme = *find_scheme("leapfrog");
  for (const auto& setting : schemes()[plan.request.scheme].parameters) plan.request.settings.push_back(setting.value);
  plan.request.end = 1;
  test::set_members(plan, 5, {{Varied::parameter, 0, Spread::grid, {1, 2, 5}}});
  for (const char* const only : {"x*k", "k", "3", "t"}) {
    plan.request.columns.clear();
    add_own_columns(plan, {{"only", only}});
    const Harvest all = test::harvest_of(plan), alone = test::alone(plan);
    ASSERT_EQ(all.columns.size(), 1u) << only;
    EXPECT_EQ(all.columns[0].count, 5) << only;
    EXPECT_EQ(Moments::of(alone.final).mean, all.columns[0].mean) << only;
  }
}

}  // namespace
