// Equations of motion that are singular on the way.
#include <gtest/gtest.h>

#include "tests/support/texts.hpp"

namespace {

using namespace texts;

// x = √(1 − 2t) ends at t = 1/2. Steps of equal length hardly ever meet the one place where its rate is none.
TEST(SingularMotion, IsWarnedOfWhereARunGoesOnBeyond) {
  const auto mechanics = mechanics_of(flow({"x"}, {}, {{"x", "-1/x"}}));
  for (const char* scheme : {"explicit_euler", "explicit_midpoint", "runge_kutta_4"})
    for (const double end : {0.4, 1.0}) {
      Request request = typed_as(runs::defaults("kepler", scheme), mechanics);
      runs::scene(request).initial = {1};
      request.end = end;
      request.control = true;
      runs::only_final(request);
      const auto outcome = runs::go(request).outcome;
      ASSERT_EQ(outcome.stop.reason, ReturnCode::completed) << scheme;
      EXPECT_EQ(std::ranges::count(outcome.warnings, "beyond_singularity", &Warning::code), end > 0.5) << scheme;
    }
}

}  // namespace
