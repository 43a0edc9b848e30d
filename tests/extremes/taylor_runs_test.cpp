// Runs by Taylor series on every problem, against true states for tolerances over more than six decades.
#include <gtest/gtest.h>

#include <cmath>

#include "core/study/error_study.hpp"
#include "tests/extremes/asking.hpp"
#include "tests/support/turned_clock.hpp"

namespace {

using namespace least;
using namespace asking;

// The allowed error of a step grows along the motion as differences of the start do.
TEST(TaylorRuns, AreWithinTheToleranceOfTrueStates) {
  for (const ProblemCard& problem : runs::problem_cards()) {
    Request plain = of(problem.id, {"taylor"}, {});
    plain.end = std::min(plain.end, runs::scene(plain).start + 10);
    const auto always = [] { return true; };
    const auto known = conditioning(*plain.scene, plain.end, always);
    if (known->ends) plain.end = known->reached - 1e-3;
    const auto truth = least::truth(*plain.scene, {plain.end}, always);
    const std::vector<double>& state = truth->states.front();
    for (const double tolerance : {1e-6, 1e-8, 1e-10, 1e-12, 1e-14}) {
      Request request = set(plain, {{"tolerance", tolerance}});
      runs::only_final(request);
      const auto result = go(request);
      ASSERT_EQ(result.outcome.stop.reason, ReturnCode::completed) << problem.id << ' ' << tolerance;
      EXPECT_LT(state_error(result.outcome.final, state, state.size()), 50 * tolerance * known->most_growth)
          << problem.id << ' ' << tolerance;
    }
  }
}

// The action has twice the frequency of the motion, so that a series that is just accurate enough for the motion is not
// for the action: its error was millions of times too large.
TEST(TaylorRuns, CarryWhatTheMotionDoesNotNeedAsAccurately) {
  int examined = 0;
  for (const ProblemCard& problem : runs::problem_cards()) {
    const auto& variables = problem.variables;
    const auto s = static_cast<std::size_t>(std::ranges::find(variables, "s", &VariableCard::name) - variables.begin());
    if (s == variables.size() || !variables[s].optional || problem.id == "lane_emden") continue;
    const auto action = [&](std::string_view scheme, double tolerance, double end) {
      Request request = until(set(of(problem.id, {scheme}, {}), {{"tolerance", tolerance}}), end);
      runs::show_all(request);
      const auto result = go(request);
      EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << problem.id;
      return result.outcome.final[s];
    };
    ++examined;
    const double start = runs::scene(of(problem.id, {"taylor"}, {})).start;
    const auto known = conditioning(*of(problem.id, {"taylor"}, {}).scene, start + 20, [] { return true; });
    for (const double end : {start + 3.7, start + 20}) {
      const double right = action("bulirsch_stoer", 1e-13, end);
      for (const double tolerance : {1e-3, 1e-5, 1e-8, 1e-12})
        EXPECT_NEAR(action("taylor", tolerance, end), right,
                    100 * tolerance * known->most_growth * std::max(1.0, std::abs(right)))
            << problem.id << " to " << end << ", " << tolerance;
    }
  }
  EXPECT_GT(examined, 0);
}

// From a time about which the motion is symmetric half of the coefficients vanish; at low orders these are the last
// ones.
TEST(TaylorRuns, BeginWhereTheNewestCoefficientsVanish) {
  const std::vector<Request> symmetric{
      until(at(of("henon_heiles", {"taylor"}, {}), {{"x", 0}, {"y", 0.5}, {"px", 0}, {"py", 0}}), 3),
      until(at(of("pendulum", {"taylor"}, {}), {{"q", pi / 2}, {"p", 0}}), 3)};
  for (const Request& plain : symmetric) {
    const auto always = [] { return true; };
    const auto growth = conditioning(*plain.scene, plain.end, always)->most_growth;
    const auto truth = least::truth(*plain.scene, {plain.end}, always);
    for (const double order : {4, 5, 6, 9, 0}) {
      const auto result = go(set(plain, {{"tolerance", 1e-6}, {"order", order}}));
      EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed);
      EXPECT_LT(state_error(result.outcome.final, truth->states.front(), truth->states.front().size()),
                50 * 1e-6 * growth)
          << plain.scene->card().id << ' ' << order;
    }
  }
}

// Nothing is computed beyond the end: the last step is as long as the rest of the span, and is the last row.
TEST(TaylorRuns, EndWithTheirLastStep) {
  for (const char* problem : {"kepler", "damped_oscillator", "van_der_pol"}) {
    const Request plain = until(of(problem, {"taylor"}, {}), 7.3);
    const auto whole = go(until(plain, 9));
    const auto result = go(plain);
    ASSERT_EQ(result.outcome.t, 7.3);
    ASSERT_EQ(result.rows.back().front(), 7.3) << problem;
    EXPECT_EQ(result.rows.size(), result.outcome.cost.steps + 1);
    const auto reached = [](const auto& row) { return row.front() < 7.3; };
    EXPECT_EQ(std::ranges::count_if(whole.rows, reached), result.outcome.cost.steps) << problem;
    for (std::size_t k = 0; k + 1 < result.rows.size(); ++k) EXPECT_EQ(result.rows[k], whole.rows[k]) << problem;
  }
}

// Over a thousand periods the energy drifts as the tolerance allows, although sums are compensated.
TEST(TaylorRuns, KeepNoStructureButTheirTolerance) {
  Request orbit = until(of("kepler", {"taylor"}, {}), 2e3 * pi);
  orbit = at(ask(orbit, {"energy"}), {{"x", 0.4}, {"y", 0}, {"px", 0}, {"py", 2}});
  runs::only_final(orbit);
  double last = 1;
  for (const double tolerance : {1e-4, 1e-7, 1e-10}) {
    const double off = number(go(set(orbit, {{"tolerance", tolerance}})), "energy/max_abs_error");
    EXPECT_LT(off, 1e4 * tolerance);
    EXPECT_LT(off, 0.03 * last);
    EXPECT_GT(off, 1e-3 * tolerance) << "as one that keeps it would be";
    last = off;
  }
}

TEST(TaylorRuns, GoOnWhereTheMotionIsSlowInLongSteps) {
  const auto steps = [](double epsilon) {
    return static_cast<double>(go(until(of("van_der_pol", {"taylor"}, {{"epsilon", epsilon}}), 40)).outcome.cost.steps);
  };
  EXPECT_LT(steps(10), 600);
  Request eccentric = until(of("kepler", {"taylor"}, {}), 20 * pi);
  eccentric = at(ask(eccentric, {"error"}), {{"x", 1e-4}, {"y", 0}, {"px", 0}, {"py", std::sqrt(1.9999e4)}});
  const auto result = go(eccentric);  // e = .9999
  EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed);
  const auto known = conditioning(*eccentric.scene, eccentric.end, [] { return true; });
  EXPECT_LT(number(result, "error/max"), 50 * 1e-12 * known->most_growth);
  EXPECT_LT(result.outcome.cost.steps, 3000);
}

// Steps of length 3e5 from an almost vanishing start, each with as many poles of the slope. Carrying the slope needs a
// series for each pole, and the run ends in its time all the same.
TEST(TaylorRuns, LookAtTheClockWhileTheyCarry) {
  const runs::TurnedClock clock(1e-3);
  Request request = set(of("van_der_pol", {"taylor"}, {}), {{"order", 5}});
  request = steps(ask(at(request, {{"x", 1e-300}}), {"poles"}), 8);
  request.limits.seconds = 0.05;
  EXPECT_EQ(go(request).outcome.stop.reason, ReturnCode::deadline);
  EXPECT_LT(clock.looks(), 100);
}

}  // namespace
