// What studies find out about scenes given as text.
#include <cmath>

#include "tests/server/fixture.hpp"
#include "tests/support/runs.hpp"

namespace least::server::test {
namespace {

class StudiedScenes : public Asking {
 protected:
  static Json limit(const Json& problem, const Json& initial, const char* scheme) {
    Json request{{"problem", problem}, {"schemes", {scheme}}, {"budget_seconds", 50}};
    if (!initial.is_null()) request["initial"] = initial;
    return answer(request, "/v1/stability")["limits"][0];
  }
};

// The amplitude of an undamped oscillation grows by sqrt(1 + h²) at every step of explicit_euler, by sqrt(1 + h⁴/4) at
// every step of explicit_midpoint, whatever form it is typed in.
TEST_F(StudiedScenes, WhatIsNotDampedGrowsAtEveryStepOfSomeSchemes) {
  const std::pair<Json, Json> scenes[] = {
      {custom(R"({"variables":["x"],"potential":"x^2/2"})"), {{"x", 1}}},
      {custom(R"({"variables":["x","v"],"equations":{"x":"v","v":"-x"}})"), {{"x", 1}}},
      {custom(R"({"variables":["x","v","y","w"],
                  "equations":{"x":"v","v":"-x+y/4","y":"w","w":"-2*y+x/4"}})"),
       {{"x", 1}}},
      {custom(R"~({"variables":["x","y"],"lagrangian":"(vx^2+vy^2)/2+(x*vy-y*vx)/4-(x^2+y^2)/2"})~"), {{"x", 1}}},
      {"foucault", nullptr},
      {"charged_particle", nullptr},
      {"restricted_three_body", nullptr},
      {"rigid_body", nullptr}};
  for (const auto& [problem, initial] : scenes)
    for (const char* scheme : {"explicit_euler", "explicit_midpoint"}) {
      const Json found = limit(problem, initial, scheme);
      EXPECT_EQ(found["step"], 0) << problem << found;
      EXPECT_EQ(found["failure"], "energy_growth") << problem << found;
    }
}

// Their divergence, 1 - v + u - 1, vanishes only in the mean of a turn about the centre.
TEST_F(StudiedScenes, TheEquationsOfLotkaAndVolterraAreUndamped) {
  const Json prey = custom(R"~({"variables":["u","v"],"equations":{"u":"u*(1-v)","v":"v*(u-1)"}})~");
  for (const double start : {2.0, 1.01}) {
    const Json found = limit(prey, {{"u", start}, {"v", 1}}, "explicit_euler");
    EXPECT_EQ(found["step"], 0) << start << found;
    EXPECT_EQ(found["failure"], "energy_growth") << start << found;
  }
  EXPECT_GT(limit(prey, {{"u", 2}, {"v", 1}}, "runge_kutta_4")["step"], 1);
}

// Damped, stable where |1 + hλ| <= 1: λ = -0.5 ± i sqrt(0.75), h <= 1. A saddle grows by itself; its other direction
// is stable up to h = 2. Undamped, but stable: Runge and Kutta's up to 2 sqrt(2).
TEST_F(StudiedScenes, OtherEquationsHaveAStep) {
  const Json damped = custom(R"({"variables":["x","v"],"equations":{"x":"v","v":"-x-v"}})"),
             circle = custom(R"({"variables":["x","v"],"equations":{"x":"v","v":"-x"}})"),
             saddle = custom(R"({"variables":["x","y"],"equations":{"x":"x","y":"-y"}})");
  EXPECT_NEAR(limit(damped, {{"x", 1}}, "explicit_euler")["step"], 1, 0.05);
  EXPECT_NEAR(limit(circle, {{"x", 1}}, "runge_kutta_4")["step"], 2 * std::sqrt(2.0), 0.05);
  const Json found = limit(saddle, {{"x", 1}, {"y", 1}}, "explicit_euler");
  EXPECT_TRUE(found["step"].is_null() || found["step"] > 0.1) << found;
}

TEST_F(StudiedScenes, ThatRestSaySo) {
  const Json spring = custom(R"({"variables":["x"],"potential":"50*x^2"})");
  const Json schemes{"explicit_euler", "runge_kutta_4"};
  const Json stability = answer({{"problem", spring}, {"schemes", schemes}}, "/v1/stability");
  for (const Json& limit : stability["limits"]) {
    EXPECT_TRUE(limit["step"].is_null()) << limit;
    EXPECT_NE(limit["why"].get<std::string>().find("nothing moves"), std::string::npos) << limit;
  }
  const Json study = answer({{"problem", spring}, {"schemes", schemes}}, "/v1/work-precision");
  ASSERT_EQ(study["left_out"].size(), 1U) << study;
  EXPECT_NE(study["left_out"][0].get<std::string>().find("nothing moves"), std::string::npos);
  for (const Json& curve : study["curves"]) EXPECT_TRUE(curve["points"].empty()) << curve;
  EXPECT_EQ(limit(spring, {{"x", 1}}, "explicit_euler")["step"], 0);
  EXPECT_NEAR(limit(spring, {{"x", 1}}, "runge_kutta_4")["step"], 0.2 * std::sqrt(2.0), 1e-3);
  // From 0 by a force, or by time alone, there is a motion.
  for (const char* potential : {"50*x^2 - x", "50*x^2 - x*sin(t)"}) {
    const Json moves{{"id", "custom"}, {"variables", {"x"}}, {"potential", potential}};
    EXPECT_NEAR(limit(moves, nullptr, "runge_kutta_4")["step"], 0.2 * std::sqrt(2.0), 0.02) << potential;
  }
}

// In a chaotic motion errors stay as large as the motion until steps are short enough to follow it to the end.
TEST_F(StudiedScenes, CurvesOfAChaoticMotionGoDownToRoundOff) {
  runs::problem_called("lorenz");
  const Json study =
      answer({{"problem", "lorenz"}, {"schemes", {"taylor", "runge_kutta_4"}}, {"until", 30}, {"budget_seconds", 20}},
             "/v1/work-precision");
  EXPECT_TRUE(study["chaotic"]);
  for (const Json& curve : study["curves"]) {
    double best = 1;
    for (const Json& point : curve["points"])
      if (point["error"].is_number()) best = std::min(best, point["error"].get<double>());
    EXPECT_LT(best, 1e-3) << curve;
  }
}

}  // namespace
}  // namespace least::server::test
