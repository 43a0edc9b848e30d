// A run that is worthless by its own evidence warns, and one that is not does not.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/extremes/asking.hpp"

namespace {

using namespace least;
using namespace asking;

std::string codes_of(const Request& request) {
  std::string codes;
  for (const Warning& warning : go(request).outcome.warnings) codes += std::string(warning.code) + ' ';
  return codes;
}
// ── energy ──────────────────────────────────────────────────────────────────────────────────────────────────────────

// The warning does not depend on the scheme or the request; it is from the largest energy error, not from the last
// state.
TEST(Silence, EnergyThatLeavesItsLevelIsSpokenOf) {
  int left = 0;
  for (const std::string_view problem : {"kepler", "henon_heiles", "pendulum", "double_pendulum"})
    for (const std::size_t index : runs::problem_card(problem).schemes)
      for (const double coarse : {1.0, 8.0, 40.0}) {
        Request request = of(problem, {schemes()[index].id}, {});
        for (std::size_t i = 0; i < scheme_of(request).parameters.size(); ++i)
          if (!scheme_of(request).parameters[i].suggested.empty() || is_adaptive(request)) {
            request.settings[i] *= is_adaptive(request) ? std::pow(coarse, 4) : coarse;
            request.settings[i] = std::min(request.settings[i], 0.1 * (is_adaptive(request) ? 1 : 1e4));
          }
        const auto result = go(columns(ask(request, {"energy"}), {"t", "energy"}));
        const double level = number(result, "energy/initial"), now = number(result, "energy/final");
        if (result.outcome.stop.reason != ReturnCode::completed) continue;
        const bool off = std::abs(now - level) > 2 * std::abs(level) && std::abs(now - level) > 2;
        left += off;
        if (off) {
          EXPECT_TRUE(warned(result, "off_energy_level"))
              << name(request) << ' ' << coarse << ": " << level << ' ' << now;
        }
        if (number(result, "energy/max_abs_error") < 0.01 * std::abs(level)) {
          EXPECT_FALSE(warned(result, "off_energy_level")) << name(request) << ' ' << coarse;
        }
      }
  EXPECT_GT(left, 5) << "nothing was looked at";
}

// A run whose energy left its level and came back was worthless in between.
TEST(Silence, TheLargestExcursionCounts) {
  const Request beat = steps(of("harmonic_oscillator", {"leapfrog", {{"step", 1.99}}}, {}), 2000);
  int back = 0;
  for (std::int64_t n = 1900; n < 1950; ++n) {
    const auto result = go(ask(steps(beat, n), {"energy"}));
    back += std::abs(number(result, "energy/final") - 0.5) < 0.01;
    EXPECT_TRUE(warned(result, "off_energy_level")) << n;
  }
  EXPECT_GT(back, 0);
}

// ── growth ──────────────────────────────────────────────────────────────────────────────────────────────────────────

TEST(Silence, WhatGrowsAtEveryStepSaysSo) {
  for (const std::string_view scheme : {"explicit_euler", "explicit_midpoint"}) {
    EXPECT_TRUE(warned(go(of("harmonic_oscillator", {scheme, {{"step", 1}}}, {})), "grows_at_every_step")) << scheme;
    EXPECT_FALSE(warned(go(of("harmonic_oscillator", {scheme, {{"step", 1e-3}}}, {})), "grows_at_every_step") &&
                 scheme == "explicit_midpoint")
        << "not where it has hardly grown";
    EXPECT_TRUE(warned(go(of("driven_oscillator", {scheme, {{"step", 1}}}, {{"damping", 0}})), "grows_at_every_step"))
        << scheme << ": no energy is kept";
    const auto orbit = go(of("kepler", {scheme, {{"step", 0.05}}}, {}));
    EXPECT_TRUE(warned(orbit, "grows_at_every_step")) << scheme;
    EXPECT_FALSE(
        warned(go(of("damped_oscillator", {scheme, {{"step", 1}}}, {{"damping", 1.5}})), "grows_at_every_step"))
        << scheme << ": the damping is stronger";
  }
  for (const std::string_view scheme : {"runge_kutta_4", "leapfrog"})
    EXPECT_FALSE(warned(go(of("harmonic_oscillator", {scheme, {{"step", 1}}}, {})), "grows_at_every_step")) << scheme;
}

// ── damping ─────────────────────────────────────────────────────────────────────────────────────────────────────────

TEST(Silence, StrongDampingIsSpokenOf) {
  const auto strong = [](Scheme scheme, double alpha) { return of("damped_oscillator", scheme, {{"damping", alpha}}); };
  for (const double stages : {1, 2, 3}) {
    const Scheme gauss{"contact_gauss", {{"step", 0.5}, {"stages", stages}}};
    EXPECT_EQ(codes_of(strong(gauss, 3.9)).find("stiff_step"), std::string::npos) << stages;
    const std::string codes = codes_of(strong(gauss, 1000));
    EXPECT_NE(codes.find(stages == 2 ? "stiff_step" : "damping_sign"), std::string::npos) << stages << codes;
  }
  // Where λ changes its sign: with one stage at αh = 2, with three at 4.644.
  for (const auto& [stages, flip] : {std::pair{1.0, 2.0}, {3.0, 4.644370709252171}})
    for (const double side : {-1e-3, 1e-3}) {
      Request request =
          at(strong({"contact_gauss", {{"step", 0.5}, {"stages", stages}}}, 2 * (flip + side)), {{"q", 0}, {"p", 1}});
      runs::set(request, "stiffness", 1e-12);
      const auto result = go(steps(request, 1));
      EXPECT_EQ(value(request, result.rows[1], "p") < 0, side > 0) << stages;
      EXPECT_EQ(warned(result, "damping_sign"), side > 0) << stages;
    }
  EXPECT_TRUE(warned(go(strong({"contact_galerkin_4", {{"step", 0.01}}}, 250)), "stiff_step"));
  EXPECT_FALSE(warned(go(strong({"contact_galerkin_4", {{"step", 0.01}}}, 150)), "stiff_step"));
  const Request splitting = strong({"contact_splitting", {{"step", 0.5}}}, 1000);
  EXPECT_TRUE(warned(go(choose(splitting, {{"splitting", "plain"}})), "stiff_step"));
  EXPECT_FALSE(warned(go(choose(splitting, {{"splitting", "merged"}})), "stiff_step"));
  EXPECT_FALSE(warned(go(splitting), "stiff_step")) << "automatic is merged here";
}

TEST(Silence, AnActionThatDampsFasterThanAStepIsSpokenOf) {
  for (const std::string_view scheme : {"runge_kutta_4", "explicit_midpoint", "explicit_euler"}) {
    const auto with = [&](double s) {
      return steps(
          at(of("cosmological_oscillator", {scheme, {{"step", 0.05}}}, {{"gamma", 2}, {"R", -0.1}}), {{"s", s}}), 10);
    };
    EXPECT_TRUE(warned(go(with(11)), "stiff_step")) << scheme;
    EXPECT_FALSE(warned(go(with(9)), "stiff_step")) << scheme;
  }
}

TEST(Silence, ThermostatsTurnAsFastAsBetaSays) {
  for (const double beta : {100.0, 1000.0})
    for (const double step : {0.4, 0.6})
      EXPECT_EQ(
          warned(go(steps(of("thermostat", {"contact_splitting", {{"step", step / beta}}}, {{"beta", beta}}), 50)),
                 "stiff_step"),
          step > 0.5)
          << beta;
}

}  // namespace
