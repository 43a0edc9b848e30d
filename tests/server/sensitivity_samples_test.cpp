// Derivatives at the samples of runs that do not reach their end, over HTTP.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/server/fixture.hpp"
#include "tests/support/runs.hpp"

namespace least::server::test {
namespace {

class SensitivitySamples : public Asking {
 protected:
  static Json at_samples(Json request) {
    request["sensitivities"] = {{"by", {"/initial/x"}}, {"at", "samples"}};
    return request;
  }
  /// The derivatives of a run that stops, at its samples, are those of one that ends at the last of them.
  static void expect_those_until(double last, Json request, std::size_t count) {
    const Json stopped = answer(at_samples(request))["sensitivities"];
    ASSERT_EQ(stopped["samples"].size(), count) << stopped;
    EXPECT_TRUE(stopped["final"].is_null()) << stopped;
    EXPECT_TRUE(stopped.contains("reason"));
    ASSERT_TRUE(stopped["uncertainty"].is_number()) << stopped;
    EXPECT_LT(stopped["uncertainty"], 1e-8);
    request["until"] = last;
    request.erase("limits");
    request.erase("events");
    const Json whole = answer(at_samples(request))["sensitivities"];
    ASSERT_EQ(whole["samples"].size(), count);
    for (std::size_t k = 0; k < count; ++k) EXPECT_EQ(stopped["samples"][k], whole["samples"][k]) << k;
  }
};

// From rest at x₀ a body falls into the centre: x = x₀ cos²η, t √2 = x₀^{3/2} (η + sin η cos η), so that at a fixed
// time ∂x/∂x₀ = cos²η + 3/2 (η + sin η cos η) tan η.
TEST_F(SensitivitySamples, OfAFallIntoTheCentreAreToldAsFarAsItIsFollowed) {
  runs::problem_called("kepler");
  const Json made = answer(at_samples({{"problem", "kepler"},
                                       {"initial", {{"x", 1}, {"y", 0}, {"px", 0}, {"py", 0}}},
                                       {"until", 5},
                                       {"scheme", "taylor"},
                                       {"record", {{"samples", 101}}}}));
  const Json found = made["sensitivities"], &times = made["trajectory"]["t"];
  EXPECT_EQ(made["status"], "stopped");
  EXPECT_TRUE(found["final"].is_null());
  EXPECT_TRUE(found.contains("reason"));
  ASSERT_GE(found["samples"].size(), 22) << found;
  for (std::size_t k = 0; k < 22; ++k) {
    const double t = times[k];
    double eta = 0;  // by bisection
    for (double step = std::acos(-1.0) / 4; step > 1e-17; step /= 2)
      if (const double next = eta + step; next + std::sin(next) * std::cos(next) <= t * std::sqrt(2.0)) eta = next;
    const double slope = std::cos(eta) * std::cos(eta) + 1.5 * (eta + std::sin(eta) * std::cos(eta)) * std::tan(eta);
    EXPECT_NEAR(found["samples"][k][0][0], slope, 1e-11 * slope) << t;
  }
}

TEST_F(SensitivitySamples, OfAMapAreToldUpToTheStepWhereTheRunStops) {
  runs::problem_called("lorenz");
  const Json run{{"problem", "lorenz"},
                 {"until", 50},
                 {"scheme", {{"id", "runge_kutta_4"}, {"step", 0.0078125}}},
                 {"record", {{"every", 10}}}};
  Json limited = run, ended = run;
  limited["limits"] = {{"steps", 100}};
  expect_those_until(100 * 0.0078125, limited, 11);
  ended["events"] = Json::array({{{"name", "k"}, {"expression", "z - 30"}, {"stop", true}}});
  const std::size_t count = answer(ended)["trajectory"]["t"].size();
  expect_those_until(10 * 0.0078125 * static_cast<double>(count - 1), ended, count);
}

// The time that derivatives at samples need is no column of the request: limits.samples has room for as many rows, and
// for as many points of a section, as without derivatives.
TEST_F(SensitivitySamples, LeaveTheRowsAndTheSectionOfTheRunAsTheyAre) {
  runs::problem_called("harmonic_oscillator");
  const Json run{
      {"problem", "harmonic_oscillator"}, {"until", 100},     {"scheme", {{"id", "leapfrog"}, {"step", 0.0625}}},
      {"record", {{"samples", 15}}},      {"columns", {"q"}}, {"section", {{"expression", "q"}}},
      {"limits", {{"samples", 30}}}};
  Json asked = run;
  asked["sensitivities"] = {{"by", {"/initial/q"}}, {"at", "samples"}};
  const Json alone = answer(run), with = answer(asked);
  EXPECT_EQ(with["sensitivities"]["samples"].size(), 15) << with;
  for (const char* part : {"section", "trajectory", "warnings"}) EXPECT_EQ(with[part], alone[part]);
}

}  // namespace
}  // namespace least::server::test
