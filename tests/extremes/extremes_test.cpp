// The extremes of all settings and starts: always a status, never a hang, never a number that is not finite; and beside
// each extreme a benign twin that completes, so that a test cannot pass by refusing everything.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/extremes/asking.hpp"

namespace {

using namespace least;
using namespace asking;

Request with_step(std::string_view problem, std::string_view scheme, double h) {
  Request request = runs::defaults(problem, scheme);
  request.settings[0] = h;
  request.limits.seconds = 2;
  request.limits.steps = 20'000;
  return request;
}

template <class F>
void for_each_pair(F&& f) {
  for (const auto& problem : runs::problem_cards())
    for (const std::size_t scheme : problem.schemes) f(problem, schemes()[scheme]);
}

TEST(Step, ZeroIsTheIdentityAndEnds) {
  for_each_pair([](const ProblemCard& problem, const SchemeCard& scheme) {
    if (scheme.own_clock) return;  // ClockSettings.AStepOfNoLengthIsFoundOut
    Request request = with_step(problem.id, scheme.id, 0);
    if (problem.id == "lane_emden") {  // its own start is singular
      runs::scene(request).start = 1;
      runs::scene(request).initial = {0.9, -0.2, 0};
    }
    request.until_steps = true;
    request.steps = 100;
    auto start = runs::scene(request).initial;
    for (std::size_t i = 0; i < start.size(); ++i)
      if (problem.variables[i].optional) start[i] = std::nan("");
    runs::drop_unknown(start);
    auto still = go(request);
    runs::drop_unknown(still.outcome.final);
    EXPECT_EQ(still.outcome.stop.reason, ReturnCode::completed) << problem.id << ' ' << scheme.id;
    EXPECT_EQ(still.outcome.final, start) << problem.id << ' ' << scheme.id;

    request.until_steps = false;  // the run never reaches its end
    auto stuck = go(request);
    runs::drop_unknown(stuck.outcome.final);
    EXPECT_EQ(stuck.outcome.stop.reason, ReturnCode::step_limit) << problem.id << ' ' << scheme.id;
    EXPECT_EQ(stuck.outcome.final, start);

    request.settings[0] = problem.suggested[0].second;
    request.end = runs::scene(request).start + 100 * request.settings[0];
    EXPECT_EQ(reason(request), ReturnCode::completed) << problem.id << ' ' << scheme.id;
  });
}

TEST(Step, HugeEndsInAStatus) {
  const runs::TurnedClock clock(1e-3);
  for_each_pair([](const ProblemCard& problem, const SchemeCard& scheme) {
    if (is_adaptive(scheme)) return;  // Tolerance
    for (const double h : {1e3, 1e10, 1e100, 1e300, 1.7e308}) {
      Request request = with_step(problem.id, scheme.id, h);
      request.until_steps = true;
      request.steps = 50;
      request.limits.seconds = 0.005;
      request = everything(request, h == 1e3);
      const auto result = go(request);
      // An implicit step may have a solution however long it is (the midpoint rule rotates by almost π), and so has an
      // exact rotation.
      EXPECT_TRUE(h <= 1e10 || scheme.implicit || problem.id == "generic_oscillator" ||
                  result.outcome.stop.reason != ReturnCode::completed)
          << problem.id << ' ' << scheme.id;
      request.until_steps = false;
      request.end = std::numeric_limits<double>::max();
      go(request);
    }
  });
}

TEST(Step, TinyIsStoppedByItsBudget) {
  Request request = with_step("kepler", "leapfrog", 1e-300);
  EXPECT_EQ(reason(request), ReturnCode::step_limit);
  request.settings[0] = 0.01;
  EXPECT_EQ(reason(request), ReturnCode::completed);
}

// Leapfrog on the harmonic oscillator is stable iff ωh < 2: the run stops only beyond, and warns from half of that on.
TEST(StabilityBound, OfLeapfrogOnTheOscillator) {
  const auto at = [](double h) {
    Request request = with_step("harmonic_oscillator", "leapfrog", h);
    request.until_steps = true;
    request.steps = 1000;
    request.diagnostics = {0};
    return go(request);
  };
  const auto benign = at(0.9);
  EXPECT_EQ(benign.outcome.stop.reason, ReturnCode::completed);
  EXPECT_TRUE(benign.outcome.warnings.empty());
  const auto close = at(1.9);
  EXPECT_EQ(close.outcome.stop.reason, ReturnCode::completed);
  ASSERT_EQ(close.outcome.warnings.size(), 2U);
  EXPECT_EQ(close.outcome.warnings[0].code, "step_near_stability_bound");
  EXPECT_EQ(close.outcome.warnings[1].code, "off_energy_level") << "p swings by a third of what it should";
  EXPECT_LT(runs::number(close.outcome.diagnostics, "energy/max_abs_error"), 10) << "bounded below the bound";
  EXPECT_EQ(at(2).outcome.stop.reason, ReturnCode::completed)
      << "on the bound it grows, but only in proportion to time";
  const auto beyond = at(2.001);
  EXPECT_EQ(beyond.outcome.stop.reason, ReturnCode::unstable_step);
  EXPECT_EQ(beyond.outcome.stop.step, 0);
  EXPECT_EQ(beyond.rows.size(), 1U) << "the start is a good state";
}

TEST(StabilityBound, IsTheSchemesOwn) {
  const auto at = [](std::string_view scheme, double h, std::size_t composition = 0) {
    Request request = with_step("harmonic_oscillator", scheme, h);
    if (request.settings.size() > 1) request.settings[1] = static_cast<double>(composition);
    request.until_steps = true;
    request.steps = 1000;
    return reason(request);
  };
  EXPECT_EQ(at("runge_kutta_4", 2.8), ReturnCode::completed);
  EXPECT_EQ(at("runge_kutta_4", 2.9), ReturnCode::unstable_step);
  EXPECT_EQ(at("leapfrog", 1.5, 1), ReturnCode::completed);  // yoshida_4: 1.573
  EXPECT_EQ(at("leapfrog", 1.7, 1), ReturnCode::unstable_step);
  EXPECT_EQ(at("galerkin_4", 2.8), ReturnCode::completed);  // 2√2
  EXPECT_EQ(at("galerkin_4", 2.9), ReturnCode::unstable_step);
  EXPECT_EQ(at("variational_midpoint", 50), ReturnCode::completed);  // none
  EXPECT_EQ(at("explicit_euler", 0.1), ReturnCode::completed);       // a control: it grows at every step
}

TEST(StabilityBound, OfAFrequencyThatGrowsOnTheWay) {  // free fall towards the centre passes it in between
  Request request = with_step("kepler", "leapfrog", 0.05);
  runs::scene(request).initial = {0, -4, -0.02, 0};
  const auto result = go(request);
  EXPECT_EQ(result.outcome.stop.reason, ReturnCode::unstable_step);
  EXPECT_GT(result.outcome.stop.step, 50);
  ASSERT_EQ(result.rows.size(), static_cast<std::size_t>(result.outcome.stop.step) + 1) << "all samples before it kept";
  EXPECT_EQ(std::vector<double>(result.rows.back().begin() + 1, result.rows.back().end()), result.outcome.final);
  runs::scene(request).initial = {0, -4, -0.5, 0};
  EXPECT_EQ(reason(request), ReturnCode::completed);
}

TEST(Parameters, AtTheEndsOfTheirRanges) {
  const runs::TurnedClock clock(1e-3);
  for_each_pair([](const ProblemCard& problem, const SchemeCard& scheme) {
    for (std::size_t i = 0; i < problem.parameters.size(); ++i)
      for (const double value : {problem.parameters[i].range.low, problem.parameters[i].range.high, 1e300, 1e-300,
                                 5e-324, std::numeric_limits<double>::max()}) {
        Request request = everything(with_step(problem.id, scheme.id, problem.suggested[0].second), false);
        runs::scene(request).parameters[i] = value;
        request.limits.steps = 300;
        request.limits.seconds = 0.01;
        go(request);  // without `error`: the reference of an impossible scene only costs time
      }
  });
  Request twin = runs::defaults("harmonic_oscillator", "leapfrog");
  runs::scene(twin).parameters = {2, 3};
  EXPECT_EQ(reason(twin), ReturnCode::completed);
}

TEST(Start, Extreme) {
  for_each_pair([](const ProblemCard& problem, const SchemeCard& scheme) {
    for (std::size_t i = 0; i < problem.variables.size(); ++i)
      for (const double value : {0.0, 1e-300, 5e-324, 1e10, 1e160, 1e300, -std::numeric_limits<double>::max()}) {
        Request request = everything(with_step(problem.id, scheme.id, problem.suggested[0].second), false);
        runs::scene(request).initial[i] = value;
        request.limits.steps = 300;
        const runs::TurnedClock clock(1e-5);
        go(request);
        // The search for the cause of an end, such as the time of a singularity, costs no more than a run.
        EXPECT_LT(clock.looks(), 2000) << problem.id << ' ' << scheme.id << ' ' << i << ' ' << value;
      }
  });
}

TEST(Start, AtTheSingularity) {
  for (const std::string_view id : {"kepler", "kepler_3d"}) {
    for (const std::size_t index : runs::problem_card(id).schemes) {
      const SchemeCard& scheme = schemes()[index];
      Request request = with_step(id, scheme.id, 0.01);
      const std::size_t n = runs::scene(request).initial.size() / 2;
      for (std::size_t i = 0; i < n; ++i) runs::scene(request).initial[i] = 0;
      request = everything(request);
      const auto result = go(request);
      EXPECT_EQ(result.outcome.stop.reason, ReturnCode::singular) << scheme.id;
      EXPECT_EQ(result.outcome.stop.singular_at, 0.0);
      EXPECT_EQ(result.outcome.stop.step, 0);
      EXPECT_TRUE(result.rows.empty());
      EXPECT_EQ(result.outcome.final, runs::scene(request).initial);
      for (const std::string_view path :
           {"energy/initial", "energy/max_abs_error", "structure/max_defect", "error/max", "orbit/revolutions"})
        EXPECT_TRUE(std::isnan(runs::number(result.outcome.diagnostics, path))) << path << ": nothing was measured";
    }
  }
  EXPECT_EQ(reason(with_step("kepler", "leapfrog", 0.01)), ReturnCode::completed);
}

TEST(Start, RadialFallIsStoppedOrWarnedOf) {  // a fixed step can jump over the centre; never without a word
  for (const std::size_t index : runs::problem_card("kepler").schemes) {
    const SchemeCard& scheme = schemes()[index];
    if (scheme.own_clock) continue;  // ClockCollision
    Request request = with_step("kepler", scheme.id, 1e-3);
    runs::scene(request).initial = {1, 0, 0, 0};  // reaches r = 0 at t = π/√8 = 1.11
    request.end = 3;
    const auto result = go(request);
    EXPECT_TRUE(result.outcome.stop.reason == ReturnCode::unstable_step || !result.outcome.warnings.empty())
        << scheme.id;
    request.end = 0.5;
    const auto benign = go(request);
    EXPECT_EQ(benign.outcome.stop.reason, ReturnCode::completed) << scheme.id;
    EXPECT_TRUE(benign.outcome.warnings.empty()) << scheme.id;
  }
}

TEST(Eccentricity, NearlyOne) {
  for (const auto& [e, steps, expected] :
       {std::tuple{0.9999, 20'000, ReturnCode::unstable_step}, std::tuple{0.5, 20'000, ReturnCode::completed}}) {
    Request request =
        with_step("kepler", "leapfrog", 4 * std::acos(-1.0) / steps);  // two periods, a = 1, from apoapsis
    runs::scene(request).initial = {0, -(1 + e), -std::sqrt((1 - e) / (1 + e)), 0};
    request.end = 4 * std::acos(-1.0);
    request = everything(request);
    const auto result = go(request);
    EXPECT_EQ(result.outcome.stop.reason, expected) << e;
    EXPECT_GT(result.rows.size(), 1000U) << "what was computed before is kept";
  }
  // A step that resolves the periapsis, where ω = 1e6, passes it.
  Request request = with_step("kepler", "leapfrog", 2e-8);
  runs::scene(request).initial = {0, -1e-4, std::sqrt(1.9999 / 1e-4), 0};
  request.end = 2e-4;
  const auto passed = go(request);
  EXPECT_EQ(passed.outcome.stop.reason, ReturnCode::completed);
  EXPECT_TRUE(passed.outcome.warnings.empty());
}

TEST(Solver, FailsByNameAndKeepsWhatItHas) {
  for (const std::string_view scheme : {"variational_midpoint", "galerkin_4"}) {
    Request request = with_step("double_pendulum", scheme, 0.02);
    runs::scene(request).initial = {2, 2.5, 0, 0};
    request.end = 10;
    EXPECT_EQ(reason(request), ReturnCode::completed) << scheme;
    request.settings[0] = 5;
    request.end = 1000;
    const auto result = go(request);
    EXPECT_EQ(result.outcome.stop.reason, ReturnCode::solver_failed) << scheme;
    EXPECT_EQ(result.rows.size(), static_cast<std::size_t>(result.outcome.stop.step) + 1);
  }
}

// A force that depends on q is not known more accurately than q itself, however small the velocity: libration far from
// q = 0.
TEST(Solver, SucceedsFarFromTheOrigin) {
  for (const std::string_view scheme : {"variational_midpoint", "galerkin_4"})
    for (const double turns : {0.0, 10.0, 1e3, 1e6})
      for (const double p : {1e-3, 0.1, 1e-320}) {
        Request request = with_step("pendulum", scheme, 0.1);
        runs::scene(request).initial = {turns * 2 * std::acos(-1.0), p};
        request.until_steps = true;
        request.steps = 20'000;
        request.record.count = 0;
        EXPECT_EQ(reason(request), ReturnCode::completed) << scheme << ' ' << turns << ' ' << p;
      }
}

TEST(Escape, OverTheSaddleOfHenonHeiles) {
  for (const std::string_view scheme : {"leapfrog", "runge_kutta_4", "variational_midpoint", "explicit_euler"}) {
    Request request = with_step("henon_heiles", scheme, 0.02);
    runs::scene(request).initial = {0, 1.2, 0, 0.5};  // beyond the saddle at y = 1: runs off to infinity in finite time
    request = everything(request);
    const auto result = go(request);
    EXPECT_NE(result.outcome.stop.reason, ReturnCode::completed) << scheme;
    EXPECT_GT(result.outcome.stop.step, 10);
    EXPECT_EQ(result.rows.size(), static_cast<std::size_t>(result.outcome.stop.step) + 1);
    runs::scene(request).initial = {0, 0.1, 0.49, 0};
    request.end = 10;
    EXPECT_EQ(reason(request), ReturnCode::completed) << scheme;
  }
}

TEST(Growth, OfExplicitEulerIsStoppedWhereEnergiesOverflow) {
  Request request = with_step("harmonic_oscillator", "explicit_euler", 1);
  request.until_steps = true;
  request.steps = 5000;
  request.record.count = 1;
  const auto result = go(request);
  EXPECT_EQ(result.outcome.stop.reason, ReturnCode::not_finite);
  EXPECT_NEAR(static_cast<double>(result.outcome.stop.step), 75 / std::log10(std::sqrt(2.0)), 10);
  request.steps = 400;
  EXPECT_EQ(reason(request), ReturnCode::completed);
}

// Where a block of steps is undone, the last good state is the one that single steps reach.
TEST(TakenBack, BlocksEndWhereSingleStepsEnd) {
  Request request = with_step("henon_heiles", "leapfrog", 0.001);
  runs::scene(request).initial = {0, 1.2, 0, 0.5};
  request.diagnostics = {0};
  request.record.count = 1;
  const auto fine = go(request);
  request.record.count = 0;
  const auto coarse = go(request);
  EXPECT_NE(fine.outcome.stop.reason, ReturnCode::completed);
  EXPECT_EQ(fine.outcome.stop.reason, coarse.outcome.stop.reason);
  EXPECT_EQ(fine.outcome.stop.step, coarse.outcome.stop.step);
  EXPECT_EQ(fine.outcome.final, coarse.outcome.final);
  EXPECT_EQ(fine.outcome.cost.force_evaluations, coarse.outcome.cost.force_evaluations);
  EXPECT_EQ(runs::number(fine.outcome.diagnostics, "energy/max_abs_error"),
            runs::number(coarse.outcome.diagnostics, "energy/max_abs_error"));
}

}  // namespace
