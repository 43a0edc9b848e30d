// Requests in SI units: nothing is refused for its unit, and the echo has defaults that follow from the scene.
#include <gtest/gtest.h>

#include <cmath>

#include "core/exact/elements.hpp"
#include "server/decode/json_parse.hpp"
#include "tests/server/client.hpp"
#include "tests/server/faults.hpp"
#include "tests/server/fixture.hpp"
#include "tests/support/runs.hpp"

namespace least::server::test {
namespace {

using UnitsHttp = Serving;

/// comet() is a comet of the sun, in SI units.
Json comet(const Json& scheme, double speed = 500) {
  runs::problem_called("kepler");
  return {{"problem", {{"id", "kepler"}, {"mu", 1.327e20}}},
          {"initial", {{"x", 4e12}, {"y", 0}, {"px", 0}, {"py", speed}}},
          {"until", {{"t", 3.2e9}}},
          {"record", {{"every", 0}}},
          {"scheme", scheme}};
}
Json answer(int port, const Json& request) {
  const Reply reply = ask(port, post("/v1/simulate", request.dump()));
  EXPECT_EQ(reply.status, 200) << request << reply.body;
  return reply.status == 200 ? Json::parse(reply.body) : Json::object();
}

// As many steps as in natural units, to the same end.
TEST_F(UnitsHttp, ACometOfTheSunRunsByEverySchemeAsInNaturalUnits) {
  const double speed = 2000, length = 1e12, time = std::sqrt(length * length * length / 1.327e20);
  for (const std::size_t scheme : runs::problem_card("kepler").schemes) {
    const std::string id(schemes()[scheme].id);
    Json natural = comet(id, speed);
    natural["problem"]["mu"] = 1;
    natural["initial"] = {{"x", 4}, {"y", 0}, {"px", 0}, {"py", speed * time / length}};
    natural["until"] = {{"t", 3.2e9 / time}};
    const Json here = answer(port(), comet(id, speed)), there = answer(port(), natural);
    EXPECT_EQ(here["status"], there["status"]) << id << here.value("stop", Json());
    const double ratio = here["cost"]["steps"].get<double>() / there["cost"]["steps"].get<double>();
    EXPECT_GT(ratio, 0.5) << id;
    EXPECT_LT(ratio, 2) << id;
  }
}

// The orbit is exact, except for time, with some nine hundred steps.
TEST_F(UnitsHttp, ThePresetOfKeplerOrbitsIsExactInSIUnits) {
  const Json run = answer(port(), comet({{"id", "time_transformed"}, {"preset", "kepler"}}));
  EXPECT_EQ(run["status"], "completed");
  EXPECT_LT(run["cost"]["steps"], 2000);
  EXPECT_LT(run["diagnostics"]["energy"]["max_rel_error"], 1e-12);
  Json again = comet(run["scheme"]);
  EXPECT_EQ(answer(port(), again)["final"], run["final"]) << "the echo says the step that was taken";
}

TEST_F(UnitsHttp, NothingIsRefusedForItsUnit) {
  for (const char* id : {"leapfrog", "runge_kutta_4", "adaptive_verlet", "jacobi_maupertuis"})
    EXPECT_EQ(answer(port(), comet({{"id", id}, {"step", 86400}}))["scheme"]["step"], 86400) << id;
  Json galaxy = comet("leapfrog");
  galaxy["problem"]["mu"] = 1.3e32;
  galaxy["initial"] = {{"x", 2.5e20}, {"y", 0}, {"px", 0}, {"py", 2e5}};
  galaxy["until"] = {{"t", 3e16}};
  EXPECT_EQ(answer(port(), galaxy)["status"], "completed");
  Json electron = comet("leapfrog");  // of hydrogen, on a circle
  electron["problem"]["mu"] = 253.27;
  electron["initial"] = {{"x", 5.29177e-11}, {"y", 0}, {"px", 0}, {"py", 2.18769e6}};
  electron["until"] = {{"t", 1.5198e-16}};
  const Json run = answer(port(), electron);
  EXPECT_EQ(run["status"], "completed");
  EXPECT_NEAR(run["final"]["x"], 5.29177e-11, 1e-14);
  EXPECT_NEAR(run["cost"]["steps"], 1889, 20) << "as many as of the default orbit in its period";
}

// A run without a given end has one in the scene's own units.
TEST_F(UnitsHttp, TheDefaultSpanIsThatOfTheScene) {
  Json request = comet("leapfrog");
  request.erase("until");
  const Json run = answer(port(), request);
  EXPECT_EQ(run["status"], "completed");
  EXPECT_GT(run["until"]["t"], 1e9);
  EXPECT_LT(run["until"]["t"], 1e10);
}

}  // namespace
}  // namespace least::server::test
