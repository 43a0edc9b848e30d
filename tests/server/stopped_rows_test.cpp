// A run that stops answers no row that lies behind its last good time.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/server/fixture.hpp"
#include "tests/support/runs.hpp"

namespace least::server::test {
namespace {

class StoppedRows : public Asking {
 protected:
  /// A body on the hill -x^4/4 runs away to infinity at about t = 1.
  static Json runaway(const std::string& scheme) {
    return {{"problem", {{"id", "custom"}, {"variables", {"x"}}, {"potential", "-x^4/4"}}},
            {"initial", {{"x", 1}, {"vx", 1}}},
            {"scheme", {{"id", scheme}, {"step", 0.3}}},
            {"until", 3},
            {"columns", {"t", "x", "energy"}}};
  }
  static void expect_none_behind(const Json& times, double last) {
    ASSERT_FALSE(times.empty());
    EXPECT_LE(times.back(), last);
  }
};

TEST_F(StoppedRows, EndWithTheLastGoodState) {
  for (const char* scheme : {"leapfrog", "variational_midpoint", "galerkin_4", "runge_kutta_4"}) {
    Json request = runaway(scheme);
    request["record"] = {{"samples", 301}};
    request["section"] = {{"period", 0.05}};
    const Json made = answer(request);
    ASSERT_EQ(made["status"], "stopped") << scheme;
    const double last = made["stop"]["t"];
    EXPECT_GT(last, 0.5) << scheme;
    expect_none_behind(made["trajectory"]["t"], last);
    expect_none_behind(made["section"]["t"], last);
    EXPECT_GE(made["trajectory"]["t"].size(), static_cast<std::size_t>(100 * last)) << scheme;
    // What ends the run does not depend on what is recorded
    request["record"] = {{"every", 1}};
    request.erase("section");
    EXPECT_EQ(answer(request)["stop"], made["stop"]) << scheme;
  }
}

TEST_F(StoppedRows, EndBeforeAStepThatALimitForbids) {
  Json request{{"problem", {{"id", "custom"}, {"variables", {"x"}}, {"potential", "x^2/2"}}},
               {"initial", {{"x", 1}}},
               {"scheme", {{"id", "leapfrog"}, {"step", 0.125}}},
               {"until", 20},
               {"limits", {{"steps", 5}}},
               {"record", {{"times", {0.0625, 0.5, 0.6875, 3}}}},
               {"columns", {"t", "x"}},
               {"sensitivities", {{"by", {"/initial/x"}}, {"of", "motion"}, {"at", "samples"}}}};
  const Json made = answer(request);
  EXPECT_EQ(made["stop"]["t"], 0.625);
  EXPECT_EQ(made["trajectory"]["t"], (std::vector<double>{0.0625, 0.5}));
  EXPECT_EQ(made["sensitivities"]["samples"].size(), 2) << made["sensitivities"];
}

// Members in lanes have the rows that they have alone.
TEST_F(StoppedRows, EndLikewiseInEnsembles) {
  Json request = runaway("leapfrog");
  request["columns"] = {"t", "x"};
  request["record"] = {{"samples", 301}};
  request["section"] = {{"period", 0.05}};
  Json members = request;
  members["members"] = {{"count", 3}, {"vary", {{"/initial/x", {{"values", {1, 0.5, 2}}}}}}};
  members["keep"] = {"trajectories", "section"};
  const Json all = answer(members, "/v1/ensemble");
  const Json& points = all["section"];
  std::vector<Json> of_section;
  for (std::size_t m = 0; m < 3; ++m) {
    request["initial"]["x"] = std::vector{1.0, 0.5, 2.0}[m];
    const Json alone = answer(request);
    ASSERT_EQ(alone["status"], "stopped");
    EXPECT_EQ(all["trajectories"]["t"][m], alone["trajectory"]["t"]) << m;
    EXPECT_EQ(all["trajectories"]["x"][m], alone["trajectory"]["x"]) << m;
    of_section.insert(of_section.end(), alone["section"]["t"].begin(), alone["section"]["t"].end());
  }
  EXPECT_EQ(points["t"], Json(of_section));
}

}  // namespace
}  // namespace least::server::test
