// Columns that follow from a scene's form: elements of an orbit, and angles reduced to one turn.
#include "core/run/columns.hpp"

#include <cmath>
#include <numbers>

#include "tests/core/asking.hpp"

namespace {

using namespace least;
using namespace asks;

/// with_columns() runs the request with the columns of these names and returns every row.
std::vector<std::vector<double>> with_columns(Request request, std::initializer_list<std::string_view> names) {
  request.columns.clear();
  request.record.count = 1;
  for (const auto name : names)
    request.columns.push_back(
        runs::position(runs::card(request).columns, name, [](const auto& column) { return column.name; }));
  return runs::go(request).rows;
}
constexpr double pi = std::numbers::pi;

// L = L₀ exp(−∫α sin Ωt dt), whatever the orbit; the ellipse grows and shrinks with L.
TEST(Columns, SayTheElementsOfAnOrbitWithDrag) {
  Request request = runs::defaults("perturbed_kepler", "contact_splitting");
  runs::set(request, "composition", "kahan_li_8");
  const auto rows = with_columns(request, {"t", "angular_momentum", "semi_major_axis", "eccentricity", "periapsis"});
  EXPECT_NEAR(rows[0][2], 1, 1e-15);
  EXPECT_NEAR(rows[0][3], 0.5, 1e-15);
  EXPECT_NEAR(rows[0][4], 0, 1e-15);
  double most = 0;
  for (const auto& row : rows) {
    const double kept = std::sqrt(3.0) / 2 * std::exp(-0.01 / pi * (1 - std::cos(pi * row[0])));
    EXPECT_NEAR(row[1], kept, 1e-9) << row[0];
    EXPECT_NEAR(row[1] * row[1], row[2] * (1 - row[3] * row[3]), 1e-12) << "L² = μ a (1 − e²)";
    most = std::max(most, std::abs(row[2] - 1));
  }
  EXPECT_GT(most, 1e-3) << "the axis changes";
  Request orbit = asking("perturbed_kepler", "contact_splitting", "orbit");
  runs::set(orbit, "composition", "kahan_li_8");
  EXPECT_NEAR(ask(orbit, "orbit/semi_major_axis"), rows.back()[2], 1e-12);
  EXPECT_NEAR(ask(orbit, "orbit/angular_momentum"), rows.back()[1], 1e-12);
  EXPECT_GE(ask(orbit, "orbit/revolutions"), 7);
  runs::set(orbit, "alpha", 0);
  EXPECT_LT(std::abs(ask(orbit, "orbit/apsidal_rotation")), 1e-9);
  runs::set(orbit, "composition", "none");
  EXPECT_GT(std::abs(ask(orbit, "orbit/apsidal_rotation")), 1e-4) << "the scheme's";
  runs::set(orbit, "gamma", 1);
  for (const char* part : {"revolutions", "semi_major_axis", "eccentricity", "apsidal_rotation"})
    EXPECT_TRUE(std::isnan(ask(orbit, std::string("orbit/") + part))) << part << " where nothing attracts";
  EXPECT_TRUE(std::isnan(with_columns(orbit, {"semi_major_axis"}).front()[0]));
}

TEST(Columns, SayTheElementsInSpaceAndNoPeriapsisOfACircle) {
  Request space = runs::defaults("kepler_3d", "leapfrog");
  runs::scene(space).initial = {1, 0, 0, 0, 0.6, 0.8};
  const auto row = with_columns(space, {"angular_momentum", "semi_major_axis", "eccentricity"}).front();
  EXPECT_NEAR(row[0], 1, 1e-15);
  EXPECT_NEAR(row[1], 1, 1e-15);
  EXPECT_NEAR(row[2], 0, 1e-15);
  Request plane = runs::defaults("kepler", "leapfrog");
  runs::scene(plane).initial = {1, 0, 0, 1};
  EXPECT_TRUE(std::isnan(with_columns(plane, {"periapsis"}).front()[0]));
  runs::scene(plane).initial = {0, 1, 1.2, 0};
  EXPECT_NEAR(with_columns(plane, {"periapsis"}).front()[0], pi / 2, 1e-15);
}

TEST(Columns, BringAnglesIntoOneTurn) {
  Request request = runs::defaults("pendulum", "leapfrog");
  runs::scene(request).initial = {0, 3};  // the pendulum rotates
  const auto rows = with_columns(request, {"q", "q_wrapped"});
  EXPECT_GT(rows.back()[0], 50);
  for (const auto& row : rows) {
    EXPECT_GE(row[1], -pi);
    EXPECT_LT(row[1], pi);
    const double turns = (row[0] - row[1]) / (2 * pi);
    EXPECT_NEAR(turns, std::round(turns), 1e-13);
  }
  EXPECT_EQ(wrapped(pi), -pi);
  EXPECT_EQ(wrapped(-pi), -pi);
  EXPECT_EQ(wrapped(3 * pi), -pi);
  EXPECT_EQ(wrapped(0.5), 0.5);
  for (const char* id : {"pendulum", "damped_pendulum", "double_pendulum", "spin_orbit"}) {
    const auto& card = runs::problem_card(id);
    EXPECT_TRUE(card.variables.front().angle) << id;
    EXPECT_FALSE(card.variables.back().angle) << id;
    EXPECT_EQ(card.columns[1].name + "_wrapped",
              card.columns[runs::position(card.columns, card.columns[1].name + "_wrapped",
                                          [](const auto& c) { return c.name; })]
                  .name);
  }
}

}  // namespace
