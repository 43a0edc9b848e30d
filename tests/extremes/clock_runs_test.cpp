// Schemes that choose their own steps: settings of any size, motions at rest and nearly at rest, budgets, and samples
// within a step.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/extremes/asking.hpp"

namespace {

using namespace least;
using namespace asking;

/// for_each_clock() calls f for every pair of a problem and a scheme that chooses its own steps. No motion leaves its
/// domain: the star is Plummer's, which has no surface.
template <class F>
void for_each_clock(F&& f) {
  for (const ProblemCard& problem : runs::problem_cards())
    for (const std::size_t index : problem.schemes) {
      if (!schemes()[index].own_clock) continue;
      Request request = of(problem.id, {schemes()[index].id}, {});
      f(problem.id == "lane_emden" ? set(request, {{"n", 5}}) : request);
    }
}

// ── settings ────────────────────────────────────────────────────────────────────────────────────────────────────────

TEST(ClockSettings, OfAnySizeEndInAStatus) {
  for_each_clock([](const Request& plain) {
    const auto& parameters = scheme_of(plain).parameters;
    for (std::size_t i = 0; i < parameters.size(); ++i)
      for (const double x : {0.0, 5e-324, 1e-300, 1e-12, 30.0, 1e12, 1e300, 1.7e308}) {
        if (parameters[i].kind != Kind::number) continue;
        Request request = everything(plain, false);
        request.settings[i] = x;
        request.limits.steps = 30;
        go(request);
        go(steps(request, 20));
      }
  });
}

// Such a step takes no time, or must have no error at all, so that the run cannot advance: it ends at once, with the
// start as the last good state.
TEST(ClockSettings, AStepOfNoLengthIsFoundOut) {
  for_each_clock([](const Request& plain) {
    Request request = plain;
    request.settings[0] = 0;
    if (problem_of(request).id == "lane_emden") {  // its own start is singular, and left along a series
      runs::scene(request).start = 1;
      runs::scene(request).initial = {0.9, -0.2, 0};
    }
    if (scheme_of(request).id == "jacobi_maupertuis") request = set(request, {{"critical_kinetic_energy", null}});
    const auto result = go(request);
    const ReturnCode why = result.outcome.stop.reason;
    EXPECT_TRUE(why == ReturnCode::singular ||
                (!is_adaptive(request) && (why == ReturnCode::not_finite || why == ReturnCode::unstable_step)))
        << name(request);
    EXPECT_EQ(result.outcome.stop.step, 0) << name(request);
    EXPECT_EQ(known(result.outcome.final), start_of_motion(request)) << name(request);
    EXPECT_EQ(reason(steps(plain, 20)), ReturnCode::completed) << name(request);
  });
}

TEST(ClockSettings, WhatTurnsALittleTooMuchIsHalvedAsOftenAsItTakes) {
  for (const double alpha : {1e-6, 1e-4, 1.0}) {
    const Scheme scheme{"jacobi_maupertuis", {{"alpha_max", alpha}, {"critical_kinetic_energy", 0.1}}};
    const auto result = go(ask(steps(of("kepler_3d", scheme, {}), 2000), {"energy"}));
    EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << alpha;
    EXPECT_LT(number(result, "energy/max_abs_error"), 1e-6) << alpha;
    EXPECT_GT(result.outcome.t, 100 * alpha * 1e-2) << alpha;
  }
  const Scheme tiny{"jacobi_maupertuis", {{"alpha_max", 1e-12}, {"critical_kinetic_energy", 0.1}}};
  EXPECT_EQ(reason(of("kepler_3d", tiny, {})), ReturnCode::parameter_step_underflow);
}

TEST(ClockSettings, AnyGravityIsTheSameOrbit) {  // lengths fixed, times scaled by 1/√μ
  for (const double mu : {1e-30, 1e-12, 1.0, 1e12, 1e30}) {
    const double w = std::sqrt(mu), period = 2 * pi / w, p = std::sqrt(0.4 / 1.6) * w;
    for (const Scheme& scheme :
         {Scheme{"jacobi_maupertuis", {{"step", 0.01 / w}, {"critical_kinetic_energy", 0.3 * mu}}},
          Scheme{"time_transformed", {{"sigma", 0.01 * w}, {"kappa", null}}},
          Scheme{"adaptive_verlet", {{"step", 0.01 / w}}}}) {
      Request request = at(of("kepler", scheme, {{"mu", mu}}), {{"x", 0}, {"y", -1.6}, {"px", -p}, {"py", 0}});
      const auto result = go(until(request, period));
      EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << scheme.id << ' ' << mu;
      EXPECT_NEAR(result.outcome.final[0], 0, 2e-4) << scheme.id << ' ' << mu;
      EXPECT_NEAR(result.outcome.final[1], -1.6, 2e-4) << scheme.id << ' ' << mu;
    }
  }
}

/// reads_time() says whether the equations of motion depend on time.
bool reads_time(const Request& request) {
  static constexpr std::string_view scenes[] = {"driven_oscillator", "modulated_oscillator", "perturbed_kepler",
                                                "spin_orbit", "lane_emden"};
  return std::ranges::find(scenes, problem_of(request).id) != std::end(scenes);
}

// ── scenes ──────────────────────────────────────────────────────────────────────────────────────────────────────────

TEST(ClockAtRest, AnEquilibriumStays) {
  int still = 0, scenes = 0;
  for_each_clock([&](const Request& plain) {
    // Left out: scenes that are singular at 0, that are driven, and heat at temperature zero.
    for (const std::string_view id : {"kepler", "kepler_3d", "perturbed_kepler", "damped_kepler", "lane_emden",
                                      "driven_oscillator", "spin_orbit", "generic_oscillator"})
      if (problem_of(plain).id == id) return;
    ++scenes;
    Request request = plain;
    std::ranges::fill(runs::scene(request).initial, 0.0);
    const auto result = go(everything(request));
    EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << name(request);
    for (std::size_t i = 0; i < runs::scene(request).initial.size(); ++i) {
      const auto& variable = problem_of(request).variables[i];
      if (variable.name == "s" || variable.optional) continue;  // moves on, or is no part of the motion
      EXPECT_EQ(result.outcome.final[i], 0) << name(request) << ' ' << variable.name;
      ++still;
    }
  });
  EXPECT_GT(scenes, 15);
  EXPECT_GE(still, 2 * scenes);
}

TEST(ClockAtRest, OnASummitOrNextToIt) {
  for (const std::string_view scheme : {"jacobi_maupertuis", "time_transformed", "adaptive_verlet"})
    for (const double p : {0.0, 1e-300, 1e-9, 1e-3, 0.1}) {
      const auto fall = [&](const Scheme& with) {
        return go(everything(until(at(of("pendulum", with, {}), {{"q", pi}, {"p", p}}), 5)));
      };
      const auto result = fall({scheme});
      EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << scheme << ' ' << p;
      EXPECT_LT(number(result, "error/final"), 0.01) << scheme << ' ' << p;
      for (const double threshold : {0.0, 1e-300, 1e-30})
        if (scheme == "jacobi_maupertuis") fall({scheme, {{"critical_kinetic_energy", threshold}}});
    }
}

TEST(ClockAtRest, FromATurningPoint) {
  for (const std::string_view id : {"pendulum", "harmonic_oscillator", "henon_heiles", "double_pendulum"})
    for (const std::string_view scheme : {"jacobi_maupertuis", "time_transformed", "adaptive_verlet"}) {
      if (id == "double_pendulum" && scheme == "adaptive_verlet") continue;
      Request request = of(id, {scheme}, {});
      if (id == "henon_heiles") runs::scene(request).initial = {0.3, 0.2, 0, 0};
      const auto result = go(everything(until(request, 5)));
      EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << id << ' ' << scheme;
      EXPECT_LT(number(result, "error/max"), 0.05) << id << ' ' << scheme;
    }
}

TEST(ClockAtRest, AlongTheSeparatrix) {  // to the summit, which it takes for ever to reach
  for (const std::string_view scheme : {"jacobi_maupertuis", "time_transformed", "adaptive_verlet"}) {
    const auto result = go(until(at(of("pendulum", {scheme}, {}), {{"q", 0}, {"p", 2}}), 5));
    EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << scheme;
    EXPECT_NEAR(result.outcome.final[0], 4 * std::atan(std::exp(5.0)) - pi, 0.2) << scheme;
  }
}

TEST(ClockRunaway, OverTheSaddleOfHenonHeilesIsStopped) {
  for (const std::string_view scheme : {"jacobi_maupertuis", "time_transformed", "adaptive_verlet", "dormand_prince_5",
                                        "fehlberg_78", "bulirsch_stoer", "taylor"}) {
    Request request = at(of("henon_heiles", {scheme}, {}), {{"x", 0}, {"y", 1.2}, {"px", 0}, {"py", 0.5}});
    const auto result = go(request);
    EXPECT_NE(result.outcome.stop.reason, ReturnCode::completed) << scheme;
    EXPECT_GT(result.outcome.t, 2.5) << scheme;
    EXPECT_LT(result.outcome.t, 3.06) << scheme << ": the orbit is at infinity at t = 3.05";
    EXPECT_EQ(reason(until(request, 1)), ReturnCode::completed) << scheme;
  }
}

// ── budgets ─────────────────────────────────────────────────────────────────────────────────────────────────────────

TEST(ClockBudget, OfTimeIsKept) {
  const runs::TurnedClock clock(1e-3);
  for_each_clock([](const Request& plain) {
    if (problem_of(plain).id == "lane_emden") return;  // comes to rest, in ever longer steps
    Request request = until(plain, 1e9);
    runs::only_final(request);
    const bool kept = !is_adaptive(request) && problem_of(plain).keeps_energy;  // else it drifts, or there is none
    if (kept) request = ask(request, {"energy"});
    request.limits = {kept ? 0.03 : 0.005, 1'000'000'000'000, 1'000'000};
    const auto result = go(request);
    EXPECT_EQ(result.outcome.stop.reason, ReturnCode::deadline) << name(request);
    EXPECT_GT(result.outcome.stop.step, 10) << name(request);
    EXPECT_LE(result.outcome.cost.seconds, request.limits.seconds + 4e-3) << name(request);
    if (kept && scheme_of(request).id != "energy_momentum") {  // which leaves its level where it finds no length
      EXPECT_LT(std::abs(number(result, "energy/final") - number(result, "energy/initial")), 0.01) << name(request);
    }
  });
}

TEST(ClockBudget, OfStepsAndSamplesIsKept) {
  for_each_clock([](const Request& plain) {
    const auto whole = go(plain);
    Request request = plain;
    const std::int64_t few = std::min<std::int64_t>(17, whole.outcome.cost.steps / 2);
    request.limits.steps = few;
    const auto stopped = go(request);
    EXPECT_EQ(stopped.outcome.stop.reason, ReturnCode::step_limit) << name(request);
    EXPECT_EQ(stopped.outcome.stop.step, few) << name(request);
    EXPECT_EQ(stopped.rows.size(), static_cast<std::size_t>(few) + 1) << name(request);
    request = plain;
    const std::size_t five = std::min<std::size_t>(5, whole.rows.size() - 1);
    request.limits.samples = static_cast<std::int64_t>(five * request.columns.size());
    const auto kept = go(request);
    EXPECT_EQ(kept.outcome.stop.reason, ReturnCode::completed) << name(request);
    EXPECT_EQ(kept.rows.size(), five) << name(request);
    EXPECT_TRUE(warned(kept, "samples_truncated")) << name(request);
    EXPECT_FALSE(warned(whole, "samples_truncated")) << name(request);
    EXPECT_EQ(known(whole.outcome.final), known(kept.outcome.final)) << name(request);
  });
}

// ── samples ─────────────────────────────────────────────────────────────────────────────────────────────────────────

TEST(ClockSamples, LieOnTheMotionHoweverManyAStepHolds) {
  for_each_clock([](const Request& plain) {
    Request request = until(plain, 3);
    const auto whole = go(request);
    std::vector<double> times{0};
    for (int k = 0; k < 100; ++k) times.push_back(1 + 1e-5 * k);  // within a step, or two
    times.push_back(3);
    Request dense = ask(request, {"error"});
    runs::at_times(dense, times);
    const auto result = go(dense);
    EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << name(request);
    EXPECT_EQ(known(result.outcome.final), known(whole.outcome.final))
        << name(request) << ": recording changes nothing";
    EXPECT_EQ(result.outcome.cost.steps, whole.outcome.cost.steps) << name(request);
    EXPECT_EQ(result.outcome.cost.force_evaluations, whole.outcome.cost.force_evaluations) << name(request);
    ASSERT_EQ(result.rows.size(), times.size()) << name(request);
    for (std::size_t k = 0; k < times.size(); ++k) EXPECT_EQ(result.rows[k][0], times[k]) << name(request);
    const auto start = start_of_motion(request), end = known(result.outcome.final);
    for (std::size_t i = 0; i < start.size(); ++i) {
      EXPECT_EQ(result.rows[0][i + 1], start[i]) << name(request);
      EXPECT_EQ(result.rows.back()[i + 1], end[i]) << name(request);
      for (std::size_t k = 2; k < 99; ++k) {  // a straight line within 1e-5
        const double bend = result.rows[k][i + 1] - (result.rows[k - 1][i + 1] + result.rows[k + 1][i + 1]) / 2;
        EXPECT_NEAR(bend, 0, 2e-8) << name(request) << ' ' << k;
      }
    }
  });
}

TEST(ClockSamples, OfBothEndsAndWithoutAny) {
  for_each_clock([](const Request& plain) {
    Request request = until(plain, 2.345);
    request.record = {Record::Mode::samples, 2, {}};
    const auto ends = go(request);
    ASSERT_EQ(ends.rows.size(), 2U) << name(request);
    EXPECT_EQ(ends.rows[0][0], 0) << name(request);
    EXPECT_EQ(ends.rows[1][0], 2.345) << name(request);
    EXPECT_EQ(ends.outcome.t, 2.345) << name(request);
    runs::only_final(request);
    const auto none = go(request);
    EXPECT_TRUE(none.rows.empty());
    EXPECT_EQ(known(none.outcome.final), known(ends.outcome.final)) << name(request);
  });
}

TEST(ClockSamples, OfAGivenNumberOfSteps) {
  for_each_clock([](const Request& plain) {
    Request request = steps(plain, 40);
    request.record.count = 7;
    const auto result = go(request);
    EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << name(request);
    EXPECT_EQ(result.outcome.cost.steps, 40) << name(request);
    ASSERT_EQ(result.rows.size(), 6U) << name(request);
    EXPECT_GT(result.outcome.t, result.rows.back()[0]) << name(request);
    request.record = {Record::Mode::times, 1, {0, result.outcome.t / 2, 2 * result.outcome.t}};
    const auto timed = go(request);
    EXPECT_EQ(timed.rows.size(), 2U) << name(request) << ": the last one is never reached";
    EXPECT_EQ(known(timed.outcome.final), known(result.outcome.final)) << name(request);
  });
}

TEST(ClockSamples, FarFromTheTimeZero) {
  for_each_clock([](const Request& plain) {
    if (reads_time(plain)) return;  // another motion at another time
    for (const double start : {1e3, -1e6, 1e10}) {
      Request request = until(plain, 5), late = request;
      runs::scene(late).start = start;
      late.end = start + 5;
      const auto here = go(request), there = go(late);
      EXPECT_EQ(there.outcome.stop.reason, ReturnCode::completed) << name(request);
      EXPECT_EQ(there.outcome.t, start + 5) << name(request);
      const auto far = known(there.outcome.final), near = known(here.outcome.final);
      // The time of an adaptive step is rounded in every step.
      const double slack = is_adaptive(request) ? 1e3 * std::abs(std::nextafter(start, 0) - start) : 0;
      for (std::size_t i = 0; i < near.size(); ++i)
        EXPECT_NEAR(far[i], near[i], 1e-5 + slack) << name(request) << ' ' << start;
    }
  });
}

TEST(ClockSamples, ATimeTooLargeToAdvanceEndsInAStatus) {
  for_each_clock([](const Request& plain) {
    Request request = plain;
    runs::scene(request).start = 1e300;
    request.end = 1e301;
    request.limits.steps = 1000;
    // An adaptive scheme cannot step where the time does not change. Other schemes sum their steps apart from the time;
    // where the scene depends on time the motion is another one and may end earlier.
    const ReturnCode why = reason(request);
    if (is_adaptive(request)) {
      EXPECT_EQ(why, ReturnCode::singular) << name(request);
    } else if (why != ReturnCode::step_limit) {
      EXPECT_TRUE(why == ReturnCode::singular || why == ReturnCode::left_domain) << name(request);
      EXPECT_TRUE(reads_time(request)) << name(request);
    }
  });
}

// ── what went wrong is said ─────────────────────────────────────────────────────────────────────────────────────────

/// expect_said() expects a run that has gone wrong to have stopped or, at least, to warn.
void expect_said(const Request& request) {
  const auto result = go(ask(request, {"energy"}));
  const double defect = number(result, "energy/max_abs_error") / std::abs(number(result, "energy/initial"));
  const bool wrong = !(defect < 10) && result.outcome.stop.reason == ReturnCode::completed;
  EXPECT_FALSE(wrong && result.outcome.warnings.empty()) << "not said: energy off by " << defect;
  EXPECT_FALSE(wrong && warned(result, "steps_in_time")) << "not stopped: energy off by " << defect;
}

// After a step in time the body may be far away; ωh is 300 before that step.
TEST(ClockRun, AFirstStepInTimeOutOfTheDepthOfAWellIsSeen) {
  const Scheme scheme{"jacobi_maupertuis", {{"critical_kinetic_energy", null}}};
  const Request deep = at(of("kepler", scheme, {}), {{"x", 1e-3}, {"y", 0}, {"px", 0}, {"py", 20}});
  expect_said(deep);
  EXPECT_EQ(reason(deep), ReturnCode::unstable_step);
  EXPECT_EQ(reason(at(of("kepler", {"leapfrog"}, {}), {{"x", 1e-3}, {"y", 0}, {"px", 0}, {"py", 20}})),
            ReturnCode::unstable_step);
}

TEST(ClockRun, AStepThatStandsInIsWatchedLikeOneInTime) {
  const Scheme scheme{"jacobi_maupertuis", {{"theta", 1e3}, {"alpha_max", null}}};
  const Request request = until(at(of("kepler", scheme, {}), {{"x", 0}, {"y", -1.99}, {"px", -0.0709}, {"py", 0}}), 6);
  expect_said(request);
}

// The density of steps oscillates from step to step and no longer says anything about the motion.
TEST(ClockRun, ADensityThatSwingsEndsTheRun) {
  const Scheme scheme{"adaptive_verlet", {{"monitor", 0}}};
  const Request request = until(at(of("kepler", scheme, {}), {{"x", 0}, {"y", -1.999}, {"px", -0.0224}, {"py", 0}}), 6);
  expect_said(request);
  EXPECT_EQ(reason(request), ReturnCode::singular);
}

// By the parameter rules of the plane the parameter coordinate may move at any speed.
TEST(ClockRun, StepControlKnowsHowFastTheParameterIs) {
  const auto off = [](double rule) {
    const Scheme scheme{"jacobi_maupertuis", {{"parameter_rule", rule}}};
    Request request = at(of("kepler", scheme, {}), {{"x", 3}, {"y", -1}, {"px", -0.3}, {"py", 0.1}});
    const auto result = go(ask(until(request, 12), {"error"}));
    return result.outcome.stop.reason == ReturnCode::completed ? number(result, "error/final") : 0;
  };
  EXPECT_LT(off(2), 0.1);  // a slow parameter lets L drift: the fall misses the centre, and is nowhere near it nonsense
  EXPECT_LT(off(0), 1e-2);
}

}  // namespace
