// Steps whose own error estimates are small although the error is large: over poles that can be integrated, and where a
// scheme preserves a stiff component that should decay. A run that is off by far more than its tolerance warns.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "tests/extremes/asking.hpp"
#include "tests/support/texts.hpp"

namespace blind_estimates {  // other files may share the translation unit
namespace {

using namespace texts;
using namespace asking;

Request typed(const Definition& definition, const std::vector<double>& start, std::string_view scheme, double end) {
  Request request = typed_as(runs::defaults("harmonic_oscillator", scheme), mechanics_of(definition));
  auto& initial = runs::scene(request).initial;  // has room for variables that the equations do not use
  std::ranges::fill(initial, 0);
  std::ranges::copy(start, initial.begin());
  request.end = end;
  request.limits.seconds = 5;
  request.control = true;
  runs::only_final(request);
  return request;
}
std::string text(const char* form, double a, double b, double w) {
  char all[160];
  std::snprintf(all, sizeof all, form, a, b, w);
  return all;
}

struct Integral {
  std::string rate;
  double right;  ///< the integral from 0 to 2
};
/// drawn() draws the rate |t − a|^p + cos(w t) or 2 log|t − a| + cos(w t), and its integral.
Integral drawn(std::mt19937& bits, double least_power) {
  const auto draw = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(bits()) / static_cast<double>(std::mt19937::max());
  };
  const double a = draw(0.3, 1.7), p = draw(least_power, 1), w = draw(0.5, 5), b = 2 - a, wave = std::sin(2 * w) / w;
  if (draw(0, 1) < 0.3)
    return {text("log((t-(%.17g))^2) + %.17g*cos(%.17g*t)", a, 1, w),
            2 * (a * std::log(a) - a + b * std::log(b) - b) + wave};
  return {text("((t-(%.17g))^2)^(%.17g) + cos(%.17g*t)", a, p / 2, w),
          (std::pow(a, p + 1) + std::pow(b, p + 1)) / (p + 1) + wave};
}

// Over a pole the error estimate of some step vanishes by chance: the scheme does not trust it at once.
TEST(BlindEstimates, OfStepsOverAPole) {
  std::mt19937 bits(36);
  for (const std::string_view scheme : {"fehlberg_78", "bulirsch_stoer"}) {
    constexpr double tolerance = 1e-8;
    std::vector<double> errors;
    for (int k = 0; k < 150; ++k) {
      const Integral one = drawn(bits, -0.4);
      const auto result = runs::go(typed(flow({"x"}, {}, {{"x", one.rate}}), {0}, scheme, 2));
      if (result.outcome.stop.reason != ReturnCode::completed) {  // the rate is infinite there
        EXPECT_EQ(result.outcome.stop.reason, ReturnCode::singular) << one.rate;
        continue;
      }
      errors.push_back(std::abs(result.outcome.final[0] - one.right) / tolerance);
      EXPECT_TRUE(errors.back() < 1e4 || !result.outcome.warnings.empty())
          << scheme << ' ' << one.rate << ": " << errors.back() << " tolerances";
    }
    ASSERT_GT(errors.size(), 100U) << scheme;
    std::ranges::sort(errors);
    EXPECT_LT(errors[errors.size() / 2], 100) << scheme;
    EXPECT_LT(errors[errors.size() * 95 / 100], 2000) << scheme;
  }
}

// y(40) by Radau's method, as published.
TEST(BlindEstimates, OfRobertsonsProblem) {
  const auto robertson =
      flow({"a", "b", "c"}, {}, {{"a", "-0.04*a+1e4*b*c"}, {"b", "0.04*a-1e4*b*c-3e7*b^2"}, {"c", "3e7*b^2"}});
  for (const std::string_view scheme : adaptive)
    for (const double tolerance : {1e-7, 1e-8, 1e-9, 1e-10}) {
      Request request = typed(robertson, {1, 0, 0}, scheme, 40);
      runs::set(request, "tolerance", tolerance);
      const auto outcome = runs::go(request).outcome;
      ASSERT_EQ(outcome.stop.reason, ReturnCode::completed) << scheme << tolerance;
      const double right[] = {0.7158270688, 9.185534765e-6, 0.2841637457};
      for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(outcome.final[i], right[i], 300 * tolerance + 2e-10) << scheme << ' ' << tolerance;
    }
}

// x = e^{−t}, and a deviation from it grows like e^t. Where the deviation is more than the tolerance allows there is a
// warning; where it is not, or the run is right, there is none.
TEST(BlindEstimates, AreToldByTheControl) {
  const auto warned_of = [](const char* rate, std::string_view scheme, double tolerance) {
    Request request = typed(flow({"x"}, {}, {{"x", rate}}), {1}, scheme, 14);
    runs::set(request, "tolerance", tolerance);
    const auto result = runs::go(request);
    EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed);
    return warned(result, "estimate_blind");
  };
  EXPECT_TRUE(warned_of("x - 2*exp(-t)", "dormand_prince_5", 1e-7));
  for (const std::string_view scheme : {"dormand_prince_5", "fehlberg_78", "bulirsch_stoer"}) {
    EXPECT_FALSE(warned_of("x - 2*exp(-t)", scheme, 1e-13)) << scheme;
    EXPECT_FALSE(warned_of("-x + cos(3*t)", scheme, 1e-8)) << scheme;
    EXPECT_FALSE(warned_of("-x + cos(3*t)", scheme, 1e-4)) << scheme << ": no more than it was allowed";
  }
}

}  // namespace
}  // namespace blind_estimates
