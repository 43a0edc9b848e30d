// Schemes that choose their steps by an error estimate: tolerances at the ends of their range, scenes that are stiff or
// long, and events within their long steps. These schemes run on every problem, so that they take part in most other
// tests of extremes as well.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/extremes/asking.hpp"

namespace {

using namespace least;
using namespace asking;

template <class F>
void for_each_adaptive(F&& f) {
  for (const ProblemCard& problem : runs::problem_cards())
    for (const std::string_view scheme : adaptive) f(of(problem.id, {scheme}, {}));
}
Request at_tolerance(const Request& request, double tolerance) { return set(request, {{"tolerance", tolerance}}); }
Request lane_emden(std::string_view scheme, double n, std::string_view after_zero = "stop") {
  return choose(of("lane_emden", {scheme}, {{"n", n}}), {{"after_zero", after_zero}});
}

// ── tolerances ──────────────────────────────────────────────────────────────────────────────────────────────────────

TEST(Tolerance, RunOnEveryProblem) {
  for_each_adaptive([](const Request& request) {
    EXPECT_TRUE(is_adaptive(request)) << name(request);
    const auto& known = problem_of(request).schemes;
    EXPECT_NE(std::ranges::find(known, request.scheme), known.end()) << name(request);
  });
}

TEST(Tolerance, AtTheLowEndOfItsRangeIsTheMotionToRoundOff) {
  for_each_adaptive([](const Request& plain) {
    const auto& range = scheme_of(plain).parameters[0].range;
    const double low = range.low_open ? std::nextafter(range.low, 1) : range.low;
    ASSERT_TRUE(range.contains(low) && !range.contains(std::nextafter(low, 0))) << name(plain);
    const bool star = problem_of(plain).id == "lane_emden";
    Request request = at_tolerance(star ? set(plain, {{"n", 5}}) : plain, low);
    request.end = std::min(request.end, runs::scene(request).start + 5);
    const auto result = go(ask(request, {"error"}));
    ASSERT_EQ(result.outcome.stop.reason, ReturnCode::completed) << name(request) << ": " << result.outcome.stop.detail;
    EXPECT_LT(runs::number(result.outcome.diagnostics, "error/max"), 1e-10) << name(request);
  });
}

TEST(Tolerance, AtTheHighEndOfItsRangeEndsInAStatus) {
  for_each_adaptive([](const Request& plain) {
    const auto& range = scheme_of(plain).parameters[0].range;
    ASSERT_TRUE(range.contains(range.high) && !range.contains(std::nextafter(range.high, 1))) << name(plain);
    Request request = everything(at_tolerance(plain, range.high), false);
    if (problem_of(plain).id == "lane_emden") {  // its energy at t = 0 is not defined
      runs::scene(request).start = 0.1;
      runs::scene(request).initial = *runs::regular_start(request, 0.1);
    }
    const auto result = go(request);  // however wrong the run is, its numbers are finite
    const ReturnCode why = result.outcome.stop.reason;
    // An energy error that accumulates may unbind an orbit, or use up all heat.
    const bool lost = why == ReturnCode::singular || why == ReturnCode::not_finite;
    EXPECT_TRUE(why == ReturnCode::completed || why == ReturnCode::left_domain || lost) << name(request);
    if (why == ReturnCode::completed) {
      EXPECT_EQ(result.outcome.t, request.end) << name(request);
    }
  });
}

// ── budgets ─────────────────────────────────────────────────────────────────────────────────────────────────────────

TEST(AdaptiveBudget, OfALongSpanAtTheLowestToleranceIsKept) {
  const runs::TurnedClock clock(1e-3);
  for (const std::string_view problem : {"kepler", "lorenz", "driven_oscillator", "generic_oscillator"})
    for (const std::string_view scheme : adaptive) {
      Request request = at_tolerance(until(of(problem, {scheme}, {}), 1e9), std::nextafter(1e-15, 1));
      request.record = {Record::Mode::samples, 1000, {}};
      request.limits = {0.02, 1'000'000'000'000, 1'000'000};
      const auto result = go(request);
      EXPECT_EQ(result.outcome.stop.reason, ReturnCode::deadline) << name(request);
      EXPECT_GT(result.outcome.stop.step, 10) << name(request);
      EXPECT_LE(result.outcome.cost.seconds, 0.024) << name(request);
      request.limits = {2, 500, 1'000'000};
      EXPECT_EQ(reason(request), ReturnCode::step_limit) << name(request);
    }
}

// On the slow branch, x ≈ 2, stability alone limits steps of any tolerance to a few 1/(ε (x² − 1)).
TEST(AdaptiveBudget, OfAStiffSceneIsKept) {
  const runs::TurnedClock clock(1e-3);
  for (const std::string_view scheme : adaptive)
    for (const double tolerance : {1e-12, 1e-8, 1e-4}) {
      const Request stiff = at_tolerance(of("van_der_pol", {scheme}, {{"epsilon", 1000}}), tolerance);
      Request request = until(stiff, 1);
      const auto whole = go(request);
      EXPECT_EQ(whole.outcome.stop.reason, ReturnCode::completed) << scheme << ' ' << tolerance;
      EXPECT_GT(whole.outcome.cost.steps, 200) << scheme << ' ' << tolerance;
      EXPECT_NEAR(whole.outcome.final[0], 2 - 2.0 / 3000, 1e-4) << scheme << ' ' << tolerance;
      request.limits.steps = 100;
      EXPECT_EQ(reason(request), ReturnCode::step_limit) << scheme << ' ' << tolerance;
      request = until(stiff, 1e6);
      runs::only_final(request);
      request.limits = {0.01, 1'000'000'000'000, 1'000'000};
      const auto stopped = go(request);
      EXPECT_EQ(stopped.outcome.stop.reason, ReturnCode::deadline) << scheme << ' ' << tolerance;
      EXPECT_LE(stopped.outcome.cost.seconds, 0.014) << scheme << ' ' << tolerance;
    }
}

// ── within a step ───────────────────────────────────────────────────────────────────────────────────────────────────

TEST(WithinAStep, ZerosPolesAndCyclesAreFound) {
  for (const std::string_view scheme : adaptive)
    for (const double tolerance : {1e-12, 1e-8}) {
      const Request sine = ask(at_tolerance(until(lane_emden(scheme, 1, "continue"), 40), tolerance), {"zeros"});
      const auto zeros = runs::list(go(sine).outcome.diagnostics, "zeros");  // of sin t/t
      ASSERT_EQ(zeros.size(), 12U) << scheme << ' ' << tolerance;
      for (std::size_t k = 0; k < zeros.size(); ++k)
        EXPECT_NEAR(zeros[k], pi * static_cast<double>(k + 1), 200 * tolerance) << scheme << ' ' << tolerance;
      const auto last = runs::list(go(until(sine, 3.15)).outcome.diagnostics, "zeros");
      ASSERT_EQ(last.size(), 1U) << scheme << ' ' << tolerance << ": in the step that ends the run";
      EXPECT_NEAR(last[0], pi, 200 * tolerance) << scheme << ' ' << tolerance;
      EXPECT_TRUE(runs::list(go(until(sine, 3.14)).outcome.diagnostics, "zeros").empty())
          << scheme << ": beyond the end";
      const Request cycles = ask(at_tolerance(of("van_der_pol", {scheme}, {}), tolerance), {"cycle", "poles"});
      const auto reports = go(cycles).outcome.diagnostics;
      EXPECT_NEAR(runs::number(reports, "cycle/period"), 6.6632868593231, 200 * tolerance) << scheme;
      EXPECT_NEAR(runs::number(reports, "cycle/amplitude"), 2.0086198608748, 200 * tolerance) << scheme;
      const auto& poles = runs::list(reports, "poles");  // the start is one, and every half cycle has one
      ASSERT_GE(poles.size(), 9U) << scheme;
      for (std::size_t k = 5; k < poles.size(); ++k)
        EXPECT_NEAR(poles[k] - poles[k - 1], 6.6632868593231 / 2, 1e-6) << scheme << ' ' << k;
    }
}

/// sin t/t, 1 − t²/6 and n = 3 have their surfaces at π, √6 and 6.897: these ends lie before them, but in the steps
/// that cross them.
TEST(WithinAStep, AnEndBeforeTheSurfaceIsReached) {
  struct Row {
    double n, end, q;
  };
  for (const auto& [n, end, q] : {Row{1, 3.1, std::sin(3.1) / 3.1}, Row{1, 3.1415, std::sin(3.1415) / 3.1415},
                                  Row{0, 2.4, 1 - 2.4 * 2.4 / 6}, Row{0, 0.6, 1 - 0.06}, Row{3, 6.89, 2.908741e-4}})
    for (const std::string_view scheme : adaptive) {
      Request request = until(lane_emden(scheme, n), end);
      request.record = {Record::Mode::samples, 50, {}};
      const auto result = go(request);
      const std::string what = std::string(scheme) + ' ' + std::to_string(n) + ' ' + std::to_string(end);
      ASSERT_EQ(result.outcome.stop.reason, ReturnCode::completed) << what;
      EXPECT_EQ(result.outcome.t, end) << what;
      EXPECT_NEAR(result.outcome.final[0], q, 1e-7) << what;
      ASSERT_EQ(result.rows.size(), 50U) << what;
      for (std::size_t k = 0; n == 0 && k < result.rows.size(); ++k) {
        const auto& row = result.rows[k];
        EXPECT_NEAR(row[1], 1 - row[0] * row[0] / 6, 1e-9) << what << ' ' << row[0];
      }
      request.record = {};
      const auto stepped = go(request);
      const int ends = scheme == "taylor" ? 1 : 0;  // the last step of `taylor` ends there, those of the others beyond
      EXPECT_EQ(stepped.rows.size(), static_cast<std::size_t>(stepped.outcome.cost.steps + ends)) << what;
      EXPECT_EQ(stepped.outcome.final[0], result.outcome.final[0]) << what;
    }
}

// A step at a loose tolerance may cross the boundary of the domain and come back: no row shows a state outside.
TEST(WithinAStep, NoStateIsOutsideTheDomain) {
  int stopped = 0;
  for (const std::string_view scheme : adaptive)
    for (const double n : {0.0, 0.5, 1.0, 1.5, 2.0, 3.0})
      for (const double start : {0.0, 1e-20, 1e-3, 0.02, 0.05, 0.1})
        for (const std::int64_t samples : {0, 2, 200}) {
          Request request = at_tolerance(lane_emden(scheme, n), 0.1);
          runs::scene(request).start = start;
          runs::scene(request).initial[1] =
              -start / 3;  // close to the regular solution and not on it: no series stands in
          if (samples > 0) request.record = {Record::Mode::samples, samples, {}};
          const auto result = go(request);
          const std::string what = std::string(scheme) + ' ' + std::to_string(n) + ' ' + std::to_string(start);
          EXPECT_GE(result.outcome.final[0], 0) << what;
          for (const auto& row : result.rows) EXPECT_GE(row[1], 0) << what << ' ' << row[0];
          const Termination& stop = result.outcome.stop;
          if (stop.reason == ReturnCode::completed) continue;
          ++stopped;
          EXPECT_EQ(stop.reason, ReturnCode::left_domain) << what;
          EXPECT_GT(stop.singular_at.value_or(0), stop.t) << what;
          if (samples == 0) {
            EXPECT_EQ(result.rows.size(), static_cast<std::size_t>(stop.step) + 1) << what;
          }
        }
  EXPECT_GT(stopped, 200);
}

// At a loose tolerance a fall may miss the centre and come out with any energy: only then is there a warning.
TEST(Tolerance, WhatLeapsOverACollisionIsSaid) {
  int leapt = 0;
  for (const std::string_view scheme : adaptive)
    for (const double tolerance : {1e-1, 1e-2, 1e-3}) {
      Request fall = ask(at_tolerance(of("kepler", {scheme}, {}), tolerance), {"energy"});
      fall = until(at(fall, {{"x", 1}, {"y", 0}, {"px", 0}, {"py", 0}}), 20);
      const auto result = go(fall);
      if (result.outcome.stop.reason != ReturnCode::completed) continue;
      const double off = std::abs(runs::number(result.outcome.diagnostics, "energy/final") + 1);
      EXPECT_TRUE(off < 10 || warned(result, "off_energy_level")) << scheme << ' ' << tolerance << ": " << off;
      leapt += off > 10;
    }
  EXPECT_GT(leapt, 0);
  for (const auto& problem : runs::problem_cards())
    for (const std::string_view scheme : adaptive)
      if (problem.keeps_energy && runs::fits(problem.id, scheme)) {
        EXPECT_FALSE(warned(go(of(problem.id, {scheme}, {})), "off_energy_level")) << problem.id << ' ' << scheme;
      }
}

// The last step may be a large part of the run: the samples in it are given.
TEST(WithinAStep, SamplesReachToTheSurface) {
  const double surface = std::sqrt(6.0);  // θ = 1 − ξ²/6
  for (const std::string_view scheme : adaptive) {
    Request request = at_tolerance(lane_emden(scheme, 0), 1e-8);
    std::vector<double> times;
    for (int k = 1; k <= 250; ++k) times.push_back(0.01 * k);
    runs::at_times(request, times);
    const auto result = go(request);
    EXPECT_EQ(result.outcome.stop.reason, ReturnCode::left_domain) << scheme;
    EXPECT_NEAR(result.outcome.stop.singular_at.value_or(0), surface, 1e-6) << scheme;
    ASSERT_EQ(result.rows.size(), 244U) << scheme;  // to 2.44
    for (const auto& row : result.rows) EXPECT_NEAR(row[1], 1 - row[0] * row[0] / 6, 1e-6) << scheme << ' ' << row[0];
  }
}

// ── estimates that are blind ────────────────────────────────────────────────────────────────────────────────────────

TEST(BlindEstimate, OfFehlbergsPairIsSeenThrough) {
  for (const double tolerance : {1e-6, 1e-8, 1e-10, 1e-12}) {
    const Scheme scheme{"fehlberg_78", {{"tolerance", tolerance}}};
    for (const double frequency : {0.3, 1.0471975511965976, 6.283185307179586, 25.0}) {  // q̈ = A cos(Ωt + φ)
      const Request free = ask(
          of("driven_oscillator", scheme, {{"stiffness", 1e-12}, {"damping", 0}, {"frequency", frequency}}), {"error"});
      EXPECT_LT(number(go(free), "error/max"), 500 * tolerance) << frequency << ' ' << tolerance;
    }
    for (const double n : {1.0, 1.5, 3.0}) {  // a force that ends at the surface
      const Request star = ask(choose(of("lane_emden", scheme, {{"n", n}}), {{"after_zero", "clamp"}}), {"error"});
      EXPECT_LT(number(go(star), "error/max"), 100 * std::pow(tolerance, 0.8)) << n << ' ' << tolerance;
    }
  }
}

}  // namespace
