// Forces so weak that high coefficients of a Taylor series underflow, and series that end: then the last coefficients
// do not determine the length of a step.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "tests/support/texts.hpp"

namespace {

using namespace texts;

Request moving(const Definition& definition, const std::vector<double>& start, double end, std::string_view scheme) {
  Request request = typed_as(runs::defaults("damped_oscillator", scheme), mechanics_of(definition));
  auto& scene = runs::scene(request);
  std::ranges::copy(start, scene.initial.begin());
  scene.start = 0;
  request.end = end;
  runs::only_final(request);
  return request;
}
Definition potential(std::string formula) { return of(Definition::Kind::potential, {"x"}, {}, std::move(formula)); }

// From x = 1, p = 1 in V = k x²/2, over a small part of a radian and over many of them, while |x| stays below 1e75, up
// to which energies are numbers.
TEST(WeakForce, OfASpringIsFollowedByTheTaylorSeries) {
  struct Case {
    const char* stiffness;
    double end;
  };
  for (const auto& [stiffness, end] :
       {Case{"1e-40", 1e12}, Case{"1e-40", 3e21}, Case{"1e-80", 1e12}, Case{"1e-80", 1e41}, Case{"1e-95", 3e48},
        Case{"1e-120", 1e61}, Case{"1e-140", 3e70}, Case{"1e-150", 1e12}, Case{"1e-150", 1e74}, Case{"1e-300", 1e12},
        Case{"1e-300", 1e74}, Case{"1e-310", 1e74}}) {
    const double omega = std::sqrt(std::strtod(stiffness, nullptr)), angle = omega * end;
    const auto run = runs::go(moving(potential(std::string(stiffness) + "*x^2/2"), {1, 1}, end, "taylor")).outcome;
    const std::string what = std::string(stiffness) + " until " + std::to_string(end);
    ASSERT_EQ(run.stop.reason, ReturnCode::completed) << what << ' ' << run.stop.detail;
    const double x = std::cos(angle) + std::sin(angle) / omega;
    EXPECT_NEAR(run.final[0], x, 1e-9 / omega * std::min(1.0, angle) + 1e-9) << what;
    EXPECT_NEAR(run.final[1], std::cos(angle) - omega * std::sin(angle), 1e-9) << what;
    EXPECT_LT(run.cost.steps, 20'000) << what;
  }
}

TEST(WeakForce, OfAnyShapeLeavesFreeMotionFree) {
  for (const char* formula : {"1e-40*x", "1e-300*x", "1e-80*x^4/4", "1e-300*x^4/4", "-1e-40/x", "-1e-300/x",
                              "1e-40*exp(-x)", "1e-300*exp(-x)", "1e-40*x*exp(-x)"}) {
    const auto run = runs::go(moving(potential(formula), {1, 1}, 1e12, "taylor")).outcome;
    ASSERT_EQ(run.stop.reason, ReturnCode::completed) << formula << ' ' << run.stop.detail;
    EXPECT_NEAR(run.final[0], 1e12, 10) << formula;
    EXPECT_NEAR(run.final[1], 1, 1e-12) << formula;
    EXPECT_LT(run.cost.steps, 1000) << formula;
  }
}

// The series of free fall and of rest are exact, so that their steps may have any length.
TEST(WeakForce, EndsASeriesThatIsExact) {
  const auto fall = runs::go(moving(potential("1e-40*x"), {1, 1}, 1e42, "taylor")).outcome;
  ASSERT_EQ(fall.stop.reason, ReturnCode::completed) << fall.stop.detail;
  EXPECT_NEAR(fall.final[0] / (1e42 - 0.5e44), 1, 1e-12);
  EXPECT_LT(fall.cost.steps, 100);
  const auto rest = runs::go(moving(potential("x^2/2"), {0, 0}, 1e15, "taylor")).outcome;
  ASSERT_EQ(rest.stop.reason, ReturnCode::completed) << rest.stop.detail;
  EXPECT_EQ(rest.final[0], 0);
  EXPECT_LT(rest.cost.steps, 10);
}

// x = t, y = t⁷/7, z = t⁴³/(43·7⁶): all coefficients of z up to the order 42 are zero.
TEST(WeakForce, MaySleepBehindTwoOthers) {
  Request request = moving(flow({"x", "y", "z"}, {}, {{"x", "1"}, {"y", "x^6"}, {"z", "y^6"}}), {0, 0, 0}, 2, "taylor");
  runs::set(request, "order", 5);
  const auto run = runs::go(request).outcome;
  ASSERT_EQ(run.stop.reason, ReturnCode::completed) << run.stop.detail;
  EXPECT_NEAR(run.final[2] / (std::pow(2.0, 43) / (43 * std::pow(7.0, 6))), 1, 1e-9);
}

}  // namespace
