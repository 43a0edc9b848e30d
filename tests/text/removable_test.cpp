// Formulas that are 0/0 on the way, such as sin(x)/x at x = 0: near such a point rounding destroys their terms,
// although the motion is smooth.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/texts.hpp"

namespace removable {
namespace {

using namespace texts;

constexpr auto typed_v = Definition::Kind::potential;

/// a Σ (−r x²)ᵏ b!/(2k + b)!: the same functions as series, which lose no digits in this range.
std::string even_series(double a, double r, int b) {
  std::string text;
  double c = a;
  for (int k = 0; k < 20; ++k) {
    text += fmt::format("{}({})*x^{}", k > 0 ? " + " : "", c, 2 * k);
    c *= -r / ((2 * k + b + 1) * (2 * k + b + 2));
  }
  return text;
}

struct Removable {
  std::string text, series;
  double nearest = 1e-12;  ///< the smallest |x| for which doubled precision suffices
};
std::vector<Removable> all_of_them() {
  return {{"sin(x)/x", even_series(1, 1, 1)},
          {"-sin(x)/x", even_series(-1, 1, 1)},
          {"-sin(x)^2/x^2", even_series(-1, 4, 2)},
          {"(1 - cos(x))/x^2", even_series(0.5, 1, 2), 1e-6},
          {"-(1 - cos(x))/x^2", even_series(-0.5, 1, 2), 1e-6},
          {"(sin(x) - x)/x^3", even_series(-1.0 / 6, 1, 3), 1e-6}};
}

TEST(Removable, IsPassedByTaylorAsIfItWereNone) {
  for (const Removable& one : all_of_them()) {
    const auto typed = mechanics_of(of(typed_v, {"x"}, {}, one.text));
    const auto smooth = mechanics_of(of(typed_v, {"x"}, {}, one.series));
    for (const auto& [x, v, end] : {std::tuple{-0.7, 0.9, 3.0},
                                    {1e-2, 0.0, 6.0},
                                    {0.5, 0.0, 6.0},
                                    {1e-3, 0.0, 3.0},
                                    {1e-3, 1.0, 3.0},
                                    {1e-6, 1.0, 3.0},
                                    {-1e-6, 0.3, 3.0},
                                    {1e-9, -1.0, 3.0},
                                    {1e-12, 1.0, 3.0}}) {
      if (std::abs(x) < one.nearest) continue;
      const Request request = request_by("taylor", typed, std::vector{x, v}, end);
      const auto right = final_of(request_by("taylor", smooth, std::vector{x, v}, end));
      const auto outcome = runs::go(request).outcome;
      const std::string what = fmt::format("{} from {}, {}", one.text, x, v);
      ASSERT_EQ(outcome.stop.reason, ReturnCode::completed) << what;
      EXPECT_LT(outcome.cost.steps, 150) << what;
      EXPECT_NEAR(outcome.final[0], right[0], 1e-10) << what;
      EXPECT_NEAR(outcome.final[1], right[1], 1e-10) << what;
      EXPECT_TRUE(outcome.warnings.empty()) << what;
    }
  }
}

// So near to 0 that doubled precision does not suffice.
TEST(Removable, IsWarnedOfWhereNoDigitsAreLeft) {
  const auto typed = mechanics_of(of(typed_v, {"x"}, {}, "(sin(x) - x)/x^3"));
  for (const double x : {1e-12, 1e-11}) {
    const auto outcome = runs::go(request_by("taylor", typed, std::vector{x, 1.0}, 3)).outcome;
    EXPECT_EQ(std::ranges::count(outcome.warnings, "digits_lost", &Warning::code), 1) << x;
  }
}

// Formulas of time alone: sin(t)/t has no pole, 1/t has one, however small its factor.
TEST(Removable, IsPassedInTime) {
  constexpr double si_1 = 0.946083070367183015;
  const auto over_zero = [](const char* rate) {
    Request request = request_by("taylor", mechanics_of(flow({"x"}, {}, {{"x", rate}})), std::vector{0.0}, 1);
    runs::scene(request).start = -1;
    return runs::go(request).outcome;
  };
  const auto passed = over_zero("sin(t)/t");
  EXPECT_EQ(passed.stop.reason, ReturnCode::completed);
  EXPECT_NEAR(passed.final[0], 2 * si_1, 1e-14);
  EXPECT_LT(passed.cost.steps, 100);
  EXPECT_NE(over_zero("1e-20/t").stop.reason, ReturnCode::completed);
  EXPECT_NE(over_zero("sin(t)/t + 1e-14/t").stop.reason, ReturnCode::completed);
}

}  // namespace
}  // namespace removable
