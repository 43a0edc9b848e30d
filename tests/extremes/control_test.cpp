// The control run: runs that are far from another scheme's motion warn, and hardly any others do.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/extremes/asking.hpp"
#include "tests/support/coarse_runs.hpp"

namespace {

using namespace least;
using namespace asking;

Request controlled(Request request) {
  request.control = true;
  return request;
}

TEST(Control, WhatIsFarBeyondResolutionSaysSo) {
  const auto coarse = [](std::string_view scheme, double step) {
    return controlled(of("harmonic_oscillator", {scheme, {{"step", step}}}, {}));
  };
  for (const std::string_view scheme : {"variational_midpoint", "leapfrog"}) {
    EXPECT_TRUE(warned(go(coarse(scheme, 1.9)), "large_error")) << scheme;
    EXPECT_TRUE(go(coarse(scheme, 0.05)).outcome.warnings.empty()) << scheme;
    EXPECT_FALSE(warned(go(of("harmonic_oscillator", {scheme, {{"step", 1.9}}}, {})), "large_error"))
        << "not asked for";
  }
  // The control does not change the run.
  const auto with = go(coarse("leapfrog", 0.5)),
             without = go(of("harmonic_oscillator", {"leapfrog", {{"step", 0.5}}}, {}));
  EXPECT_EQ(with.outcome.final, without.outcome.final);
  EXPECT_EQ(with.outcome.cost.force_evaluations, without.outcome.cost.force_evaluations);
}

// Adaptive steps pass a collision as if it were elastic; stiff motion is slow, not singular.
TEST(Control, WhatGoesOnBeyondASingularitySaysSo) {
  const auto warns = [](Request request, double end) {
    request.end = end;
    const auto result = go(controlled(request));
    EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << name(request);
    return warned(result, "beyond_singularity");
  };
  const Request falls = at(of("kepler", {"time_transformed"}, {}), {{"px", 0}, {"py", 0}});
  const double collision = std::sqrt(8.0) * pi;  // π (r/2)^(3/2) from rest at r = 4
  EXPECT_TRUE(warns(falls, 1.1 * collision));
  EXPECT_FALSE(warns(falls, 0.9 * collision));
  EXPECT_FALSE(warns(at(falls, {{"px", 0.01}}), 1.1 * collision));
  for (const double damping : {1e3, 1e6, 1e12})
    EXPECT_FALSE(warns(set(of("damped_oscillator", {"contact_splitting"}, {}), {{"damping", damping}}), 50)) << damping;
  for (const double epsilon : {10., 1e3})
    EXPECT_FALSE(
        warns(set(of("van_der_pol", {"contact_splitting", {{"step", 0.001}}}, {}), {{"epsilon", epsilon}}), 20))
        << epsilon;
}

// The control is by the same pair as one of the schemes: it must not repeat the steps of a run by that scheme, however
// chaotic the motion.
TEST(Control, IsNoRunOfTheSameSteps) {
  Request chaos = of("lorenz", {"dormand_prince_5"}, {});
  chaos.end = 30;
  for (const double tolerance : {1e-8, 1e-9, 1e-6}) {
    const auto found = go(controlled(set(chaos, {{"tolerance", tolerance}})));
    EXPECT_TRUE(warned(found, "large_error") || warned(found, "sensitive_end")) << tolerance;
  }
}

/// preset() returns the request of a preset, if it runs under this scheme.
Request preset(const ProblemCard& problem, const SchemeCard& scheme, const PresetCard* with) {
  Request request = of(problem.id, {scheme.id}, {});
  if (!with) return request;
  for (const auto& [name, value] : with->parameters) runs::set(request, name, value);
  for (const auto& [name, value] : with->initial) runs::begin(request, name, value);
  for (const auto& [name, value] : with->suggested)
    for (std::size_t i = 0; i < scheme.parameters.size(); ++i)
      if (scheme.parameters[i].suggested == name) request.settings[i] = value;
  if (with->span > 0) request.end = runs::scene(request).start + with->span;
  return request;
}

// Every scene with its defaults and presets: runs that are right to 1 % hardly ever warn, and runs wrong by 30 % do.
TEST(Control, ScenesOfTheCatalogueSayWhatTheyAreWorth) {
  int runs = 0, right = 0, alarmed = 0, wrong = 0, silent = 0;
  for (const ProblemCard& problem : runs::problem_cards())
    for (const std::size_t index : problem.schemes) {
      std::vector<const PresetCard*> scenes{nullptr};
      for (const PresetCard& card : problem.presets) scenes.push_back(&card);
      for (const PresetCard* with : scenes) {
        const Request request = coarse::watched(preset(problem, schemes()[index], with));
        const auto [known, completed, error, said] = coarse::judge(request);
        if (!known || !completed) continue;
        ++runs;
        const std::string label = name(request) + ' ' + (with ? with->name : "");
        // A warning about how steps were taken does not count.
        const bool warned = !said.empty() && said != "steps_in_time";
        if (error < 0.01) {
          ++right;
          alarmed += warned;
          if (warned) std::printf("right to %.2g: %s: %s\n", error, label.c_str(), said.c_str());
        }
        if (error > 0.3) {
          ++wrong;
          silent += !warned;
          if (!warned) std::printf("silent: %s is wrong by %.2g\n", label.c_str(), error);
        }
      }
    }
  std::printf("%d runs, %d right, %d of them warned of; %d wrong, %d of them silent\n", runs, right, alarmed, wrong,
              silent);
  EXPECT_GT(right, 200);
  EXPECT_GT(wrong, 10);
  EXPECT_LE(50 * alarmed, right);
  EXPECT_LE(100 * silent, runs);
}

// The same rule on a sample of random runs; the benchmark takes ten times as many.
TEST(Control, OfRandomCoarseRunsHardlyOneIsWrongWithoutAWord) {
  const coarse::Count count = coarse::sample(200);
  std::printf("%d runs, %d completed, %d wrong, %d of them silent; %d right, %d of them warned of\n", count.runs,
              count.completed, count.wrong, count.silent, count.right, count.alarmed);
  EXPECT_GT(count.runs, 120);
  EXPECT_GT(count.wrong, 20);
  EXPECT_LE(count.silent, 1);
  EXPECT_LE(20 * count.alarmed, count.right);
}

}  // namespace
