// The largest error along a run against that of all its steps, errors as a column, and the norms.
#include <cmath>
#include <numbers>

#include "core/state.hpp"
#include "core/state_error.hpp"
#include "tests/core/asking.hpp"

namespace {

using namespace least;
using namespace asks;

constexpr double turn = 2 * std::numbers::pi;

/// ellipse() requests a Kepler ellipse of semi-major axis 1 and eccentricity e from its periapsis.
Request ellipse(std::string_view scheme, double e, double end) {
  Request request = asking("kepler", scheme, "error");
  runs::scene(request).initial = {1 - e, 0, 0, std::sqrt((1 + e) / (1 - e))};
  request.end = end;
  return request;
}
Request with(Request request, std::string_view setting, double value, std::string_view composition = "none") {
  runs::set(request, setting, value);
  if (composition != "none") runs::set(request, "composition", composition);
  return request;
}

struct Brute {
  double most = 0, at = 0;
  std::size_t times = 0;
};
/// of_all_steps() compares every step with the true motion, and `between` states between every two steps.
Brute of_all_steps(Request request, int between = 0) {
  request.diagnostics.clear();
  request.record.count = 1;
  auto rows = runs::go(request).rows;
  std::vector<double> times;
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (int k = i > 0 ? -between : 0; k <= 0; ++k)
      times.push_back(rows[i][0] + (k < 0 ? k * (rows[i][0] - rows[i - 1][0]) / (between + 1) : 0));
  if (request.end > times.back()) times.push_back(request.end);  // the last step may not end there
  runs::at_times(request, times);
  rows = runs::go(request).rows;
  const Truth truth = request.scene->mechanics->truth(*request.scene, times, [] { return true; });
  Brute found;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double error =
        state_error(&rows[i][1], truth.states[i], truth.states[i].size(), truth.sizes_in(request.norm));
    if (error > found.most) found = {error, rows[i][0]};
  }
  found.times = rows.size();
  return found;
}

TEST(LargestError, IsThatOfAllSteps) {
  Request strong = with(asking("perturbed_kepler", "contact_splitting", "error"), "step", 0.005, "kahan_li_6");
  runs::scene(strong).initial = {0.1, 0, 0, std::sqrt(19.0), 0};
  strong.end = 8;
  Request driven = with(asking("driven_oscillator", "contact_splitting", "error"), "step", 0.02);
  runs::set(driven, "frequency", 5);
  Request star = with(asking("lane_emden", "contact_leapfrog", "error"), "step", 0.005);
  star.end = 6.5;
  Request swings = with(asking("harmonic_oscillator", "leapfrog", "error"), "step", 0.05);
  swings.end = 200;
  const Request fixed[] = {with(ellipse("leapfrog", 0.9, 2 * turn), "step", 0.004),
                           with(ellipse("leapfrog", 0.9, 3.3 * turn), "step", 0.005, "kahan_li_8"),
                           with(ellipse("leapfrog", 0.99, 1.2 * turn), "step", 0.0016, "kahan_li_8"),
                           strong,
                           driven,
                           star,
                           swings,
                           asking("perturbed_kepler", "contact_leapfrog", "error"),
                           asking("van_der_pol", "contact_splitting", "error")};
  const Request adaptive[] = {with(ellipse("fehlberg_78", 0.99, 15 * turn), "tolerance", 1e-10),
                              with(ellipse("dormand_prince_5", 0.99, 5 * turn), "tolerance", 1e-7),
                              with(ellipse("time_transformed", 0.99, 10 * turn), "sigma", 0.1, "kahan_li_6")};
  // A few steps a revolution, and none of them at the periapsis.
  const Request leaps = with(ellipse("time_transformed", 0.9, 20.4 * turn), "sigma", 1.2, "kahan_li_8");
  const auto check = [](const Request& request, int between) {
    const auto [most, at, times] = of_all_steps(request, between);
    const auto label = runs::card(request).id + " " + std::string(schemes()[request.scheme].id);
    ASSERT_GT(times, 300) << label;
    const double found = ask(request, "error/max");
    EXPECT_NEAR(found / most, 1, 0.04) << label << " at " << at << ", found at " << ask(request, "error/max_at");
    EXPECT_GT(ask(request, "error/times"), 64) << label;
    EXPECT_LT(ask(request, "error/times"), 1500) << label;
  };
  for (const Request& request : fixed) check(request, 0);
  for (const Request& request : adaptive) check(request, 3);
  check(leaps, 40);
}

Request error_column(Request request) {
  request.diagnostics.clear();
  const auto& columns = runs::card(request).columns;
  request.columns = {0, runs::position(columns, "error", [](const auto& column) { return column.name; })};
  return request;
}

// cos ω′t against cos t: the column has this error at every sample.
TEST(ErrorColumn, IsTheErrorAtEachSample) {
  Request request = error_column(runs::defaults("harmonic_oscillator", "leapfrog"));
  request.record = {Record::Mode::samples, 7, {}};
  runs::set(request, "step", 0.1);
  const auto rows = runs::go(request).rows;
  ASSERT_EQ(rows.size(), 7U);
  EXPECT_EQ(rows[0][1], 0);
  Request diagnosed = request;
  runs::ask(diagnosed, "error");
  for (const auto& row : rows) {
    if (row[0] == 0) continue;
    diagnosed.end = row[0];
    EXPECT_EQ(runs::number(runs::go(diagnosed).outcome.diagnostics, "error/final"), row[1]) << row[0];
  }
  for (const auto& problem : runs::problem_cards()) {  // on every scene
    Request any = error_column(runs::defaults(problem.id, "runge_kutta_4"));
    any.until_steps = true;
    any.steps = 3;
    for (const auto& row : runs::go(any).rows) EXPECT_LT(row[1], 1e-2) << problem.id;
  }
}

TEST(ErrorColumn, IsUnknownWhereTheTruthIs) {
  Request request = error_column(runs::defaults("henon_heiles", "leapfrog"));
  request.end = 100'000;
  request.limits.seconds = 0.5;
  const runs::TurnedClock clock(1e-4);
  const auto result = runs::go(request);
  ASSERT_GT(result.rows.size(), 100U);
  EXPECT_LT(result.rows[1][1], 1e-5) << "known at first";
  EXPECT_TRUE(std::isnan(result.rows.back()[1]));
  ASSERT_FALSE(result.outcome.warnings.empty());
  EXPECT_EQ(result.outcome.warnings.back().code, "reference_not_finished");
}

// States far below 1: the same motion a million times smaller has the same relative error.
TEST(Norm, RelativeIsForSmallStates) {
  for (const char* problem : {"harmonic_oscillator", "damped_pendulum"}) {
    Request request = asking(problem, "leapfrog", "error");
    if (std::string_view(problem) == "damped_pendulum") request = asking(problem, "contact_splitting", "error");
    request.end = 20;
    runs::scene(request).initial[0] = 1e-6;
    const double absolute = ask(request, "error/max");
    request.norm = Norm::relative;
    const double relative = ask(request, "error/max");
    EXPECT_LT(absolute, 1e-7) << problem;
    EXPECT_GT(relative, 1e-4) << problem;
    EXPECT_NEAR(relative, of_all_steps(request).most, 0.03 * relative) << problem;
    EXPECT_LT(ask(request, "error/uncertainty"), 1e-14) << problem;
    runs::scene(request).initial[0] = 1e-12;
    EXPECT_NEAR(ask(request, "error/max"), relative, 1e-3 * relative) << problem;
    EXPECT_LT(ask(request, "error/uncertainty"), 1e-14) << problem;
  }
}

// Each component is relative to the largest of its kind: coordinates with coordinates, momenta with momenta.
TEST(Norm, RelativeIsOfEachComponent) {
  ProblemCard card;
  for (const char* name : {"x1", "y1", "px1", "py1", "x_2", "z[3]", "theta1", "theta2", "ptheta1", "vx", "vy[2]", "p",
                           "q1", "s", "xi", "y"})
    card.variables.push_back({name, name, "1", "", 0});
  EXPECT_EQ(kinds_of(card), (std::vector<std::size_t>{0, 0, 2, 2, 0, 0, 6, 6, 8, 9, 9, 11, 12, 13, 14, 0}));

  ComponentSizes sizes(kinds_of(card), 4);
  for (const auto& state : {std::array{3.0, 0.0, 0.0, 0.0}, {-5.0, 1.0, 2e-9, -1e-9}}) sizes.see(state);
  const auto divisors = sizes.divisors();
  EXPECT_EQ(divisors, (std::vector{5.0, 5.0, 2e-9, 2e-9}));
  const std::array truth{1.0, 0.0, 1e-9, 0.0};
  EXPECT_EQ(state_error(std::array{1.0, 0.5, 1e-9, 0.0}, truth, 4, divisors), 0.1);
  EXPECT_NEAR(state_error(std::array{1.0, 0.0, 1e-9, 1e-9}, truth, 4, divisors), 0.5, 1e-15);
  EXPECT_TRUE(std::isnan(state_error(std::array{std::nan(""), 5.0, 0.0, 0.0}, truth, 4, divisors)));
  EXPECT_EQ(ComponentSizes(kinds_of(card), 2).divisors(), (std::vector{1.0, 1.0})) << "a kind that never leaves 0";
}

// The column agrees with the diagnostic, however few rows are kept.
TEST(ErrorColumn, IsThatOfTheDiagnosticInEitherNorm) {
  for (const Norm norm : {Norm::absolute, Norm::relative}) {
    Request request = asking("kepler", "leapfrog", "error");
    request.end = 30;
    request.norm = norm;
    const double final = ask(request, "error/final");
    Request column = error_column(request);
    column.record = {Record::Mode::samples, 2, {}};
    EXPECT_NEAR(runs::go(column).rows.back()[1], final, 0.02 * final);
  }
}

// The error oscillates between the kept states as much as at them.
TEST(LargestError, IsLookedForBetweenTheStatesThatWereKept) {
  for (const auto& [problem, scheme] :
       {std::pair{"modulated_oscillator", "dormand_prince_5"}, std::pair{"spin_orbit", "bulirsch_stoer"},
        std::pair{"driven_oscillator", "explicit_euler"}, std::pair{"pendulum", "symplectic_euler"}}) {
    Request request = asking(problem, scheme, "error");
    const Brute all = of_all_steps(request, 3);
    EXPECT_GT(ask(request, "error/max"), 0.9 * all.most) << problem << ", " << scheme << " at t = " << all.at;
  }
}

}  // namespace
