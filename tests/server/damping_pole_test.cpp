// Runs that come to a time at which the damping is infinite stop before it and say when it is, by every scheme.
#include <gtest/gtest.h>

#include <cmath>

#include "server/decode/json_parse.hpp"
#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

class DampingPole : public Serving {
 protected:
  static Json scene(const std::string& damping) {
    return {{"id", "custom"},
            {"variables", {"x"}},
            {"parameters", {{"c", 2}}},
            {"potential", "x^2/2"},
            {"damping", damping}};
  }
  Json answer(const std::string& damping, const Json& scheme, double start, double until) {
    const Json request{{"problem", scene(damping)},
                       {"initial", {{"t", start}, {"x", 1}}},
                       {"scheme", scheme},
                       {"until", until},
                       {"record", {{"every", 0}}}};
    const Reply reply = ask(port(), post("/v1/simulate", request.dump()));
    EXPECT_EQ(reply.status, 200) << reply.body;
    return Json::parse(reply.body);
  }
};

const std::vector<Json> schemes{
    {{"id", "contact_leapfrog"}, {"step", 0.03}},
    {{"id", "contact_splitting"}, {"step", 0.03}, {"composition", "kahan_li_6"}},
    {{"id", "contact_gauss"}, {"step", 0.03}},
    {{"id", "contact_symplectic_euler"}, {"step", 0.03}},
    {{"id", "explicit_euler"}, {"step", 0.03}},
    {{"id", "runge_kutta_4"}, {"step", 0.03}},
    "dormand_prince_5",
    "bulirsch_stoer",
    "taylor",
};

// Poles with and without a change of sign, with a motion that rests there and one that grows without bound, and on the
// way backward. Near a pole of second order steps of a set tolerance become ever shorter.
TEST_F(DampingPole, StopsEveryScheme) {
  struct Case {
    const char* damping;
    double start, until, pole;
  };
  const std::vector<Case> cases{{"1/(c-t)", 0, 5, 2},     {"1/(t-c)", 0, 5, 2}, {"tan(t)", 0, 5, std::asin(1)},
                                {"1/(c-t)^2", 0, 5, 2},   {"2/t", -1, 3, 0},    {"2/t", 1, -3, 0},
                                {"(c-t)^(-1.5)", 0, 5, 2}};
  for (const auto& [damping, start, until, pole] : cases)
    for (const Json& scheme : schemes) {
      const Json run = answer(damping, scheme, start, until);
      ASSERT_EQ(run["status"], "stopped") << damping << scheme;
      EXPECT_EQ(run["stop"]["reason"], "singular") << damping << scheme;
      ASSERT_TRUE(run["stop"]["singular_at"].is_number()) << damping << scheme << run["stop"];
      EXPECT_NEAR(run["stop"]["singular_at"], pole, 1e-14) << damping << scheme;
      EXPECT_NE(run["stop"]["detail"].get<std::string>().find("the damping becomes infinite at t = "),
                std::string::npos)
          << run["stop"];
      const double left = run["stop"]["t"].get<double>() - pole;
      EXPECT_LT(left * (until - start), 0) << damping << scheme;
      EXPECT_LT(std::abs(left), 0.05) << damping << scheme;
      EXPECT_EQ(run["final"]["t"], run["stop"]["t"]) << damping << scheme;
    }
}

// The end of the run is the pole itself: the shorter last step would reach it.
TEST_F(DampingPole, StopsARunThatEndsThere) {
  for (const Json& scheme : schemes) {
    const Json run = answer("1/(c-t)", scheme, 0, 2);
    EXPECT_EQ(run["stop"]["singular_at"], 2) << scheme << run["stop"];
    EXPECT_GT(run["stop"]["t"], 1.9) << scheme;
    EXPECT_LT(run["stop"]["t"], 2) << scheme;
  }
}

// A damping that is infinite at a moment but can be integrated, or that is only large, is none.
TEST_F(DampingPole, IsNoneWhereTheMotionGoesOn) {
  for (const char* damping : {"log(abs(c+0.003-t))", "0.1/((t-c)^2+1e-3)", "sin(7*t)", "atan(1e9*(t-c))"})
    for (const char* scheme : {"contact_leapfrog", "runge_kutta_4", "dormand_prince_5"})
      EXPECT_EQ(answer(damping, scheme, 0, 5)["status"], "completed") << damping << scheme;
  for (const Json& scheme : schemes)
    EXPECT_EQ(answer("1/(c-t)", scheme, 0, 1.99)["status"], "completed") << scheme << "the pole lies behind the end";
}

// The pole of some members, not of the first: those stop, and the others are what they are alone.
TEST_F(DampingPole, StopsMembersOfAnEnsemble) {
  for (const char* scheme : {"contact_leapfrog", "runge_kutta_4"}) {
    const Json request{{"problem", scene("1/(c-t)")},
                       {"initial", {{"x", 1}}},
                       {"scheme", scheme},
                       {"until", 3},
                       {"keep", {"final"}},
                       {"members", {{"vary", {{"/problem/c", {{"values", {4, 3.5, 2}}}}}}}}};
    const Reply reply = ask(port(), post("/v1/ensemble", request.dump()));
    ASSERT_EQ(reply.status, 200) << reply.body;
    const Json made = Json::parse(reply.body);
    EXPECT_EQ(made["completed"], 2) << scheme;
    EXPECT_EQ(made["stopped"], (Json{{"singular", 1}})) << scheme;
    EXPECT_EQ(made["final"]["index"], (Json{0, 1})) << scheme;
  }
}

}  // namespace
}  // namespace least::server::test
