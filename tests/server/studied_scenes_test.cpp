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

}  // namespace
}  // namespace least::server::test
