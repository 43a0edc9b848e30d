// The control run: what is far from another scheme's motion says so, and hardly anything else does.
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
  // It is no part of the run.
  const auto with = go(coarse("leapfrog", 0.5)),
             without = go(of("harmonic_oscillator", {"leapfrog", {{"step", 0.5}}}, {}));
  EXPECT_EQ(with.outcome.final, without.outcome.final);
  EXPECT_EQ(with.outcome.cost.force_evaluations, without.outcome.cost.force_evaluations);
}

TEST(Control, DefaultsOfTheCatalogueRaiseNoAlarm) {
  int looked = 0;
  for (const ProblemCard& problem : runs::problem_cards())
    for (const std::size_t index : problem.schemes) {
      Request request = ask(controlled(of(problem.id, {schemes()[index].id}, {})), {"error"});
      request.limits.steps = 200'000;
      request.end = runs::scene(request).start + 0.3 * (request.end - runs::scene(request).start);
      const auto result = go(request);
      if (!(number(result, "error/max") < 0.01)) continue;
      ++looked;
      EXPECT_FALSE(warned(result, "large_error")) << name(request);
      EXPECT_FALSE(warned(result, "off_energy_level")) << name(request);
      EXPECT_FALSE(warned(result, "grows_at_every_step")) << name(request);
    }
  EXPECT_GT(looked, 10);
}

// The rule for all, on a sample; the benchmark takes ten times as many.
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
