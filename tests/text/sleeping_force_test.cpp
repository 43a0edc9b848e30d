// Forces that the series at the start does not show: taylor notices them in time, at every tolerance.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/texts.hpp"

namespace {

using namespace texts;

struct Sleeper {
  const char* name;
  Definition definition;
  double end, right;  ///< the first variable at the end, from rest at 0
  double start = 0;
};

TEST(SleepingForce, IsSeenByTheTaylorSeries) {
  constexpr double pi = std::numbers::pi;
  const double pulse = std::sqrt(pi) / 2;
  const Sleeper all[] = {
      {"power", flow({"x"}, {}, {{"x", "t^20"}}), 1.5, std::pow(1.5, 21) / 21},
      {"decay", flow({"x"}, {}, {{"x", "-t^9*x"}}), 1.4, std::exp(-std::pow(1.4, 10) / 10), 1},
      {"sine", flow({"x"}, {}, {{"x", "sin(t)^20"}}), pi, pi * 184756 / 1048576},
      {"pulse", flow({"x"}, {}, {{"x", "exp(-4*(t-6)^2)"}}), 12, pulse},
      {"pushed", flow({"x", "v"}, {}, {{"x", "v"}, {"v", "-x + exp(-4*(t-6)^2)"}}), 12,
       pulse * std::exp(-1.0 / 16) * std::sin(6.0)},
  };
  for (const Sleeper& one : all)
    for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12}) {
      Request request = typed_as(runs::defaults("damped_oscillator", "taylor"), mechanics_of(one.definition));
      auto& scene = runs::scene(request);
      std::fill(scene.initial.begin(), scene.initial.end(), 0);
      scene.initial[0] = one.start;
      scene.start = 0;
      request.end = one.end;
      runs::set(request, "tolerance", tolerance);
      runs::only_final(request);
      const auto outcome = runs::go(request).outcome;
      ASSERT_EQ(outcome.stop.reason, ReturnCode::completed) << one.name << " " << outcome.stop.detail;
      EXPECT_NEAR(outcome.final[0], one.right, 100 * tolerance * std::max(1.0, one.right))
          << one.name << " at " << tolerance << ", " << outcome.cost.steps << " steps";
      EXPECT_LT(outcome.cost.steps, 300) << one.name << " at " << tolerance;
    }
}

}  // namespace
