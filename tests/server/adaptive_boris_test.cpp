// adaptive_boris over HTTP: a scheme that chooses its own steps, on a scene as text.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/server/client.hpp"
#include "tests/server/faults.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

class AdaptiveBorisHttp : public Asking {
 protected:
  static Json arenstorf() {
    return Json::parse(R"~({"problem":{"id":"custom","variables":["x","y"],"parameters":{"mu":0.012277471,"c":0},
      "lagrangian":
      "((vx-y)^2+(vy+x)^2)/2 + (1-mu)/sqrt((x+mu)^2+y^2) + mu/sqrt((x-1+mu)^2+y^2) + c*cos(t)"},
      "initial":{"x":0.994,"vy":-2.0015851063790824},"until":17.065216560157964,
      "scheme":{"id":"adaptive_boris","step":0.0005,"composition":"kahan_li_8"},"record":{"every":0}})~");
  }
  /// The scene without the term that may depend on time.
  static Json still() {
    Json request = arenstorf();
    request["problem"]["lagrangian"] =
        "((vx-y)^2+(vy+x)^2)/2 + (1-mu)/sqrt((x+mu)^2+y^2) + mu/sqrt((x-1+mu)^2+y^2) + 0*c";
    return request;
  }
};

TEST_F(AdaptiveBorisHttp, TheOrbitCloses) {
  Json request = still();
  request["diagnostics"] = {"energy", "error", "structure"};
  request["record"] = {{"samples", 64}};
  request["columns"] = {"t", "x", "step_size"};
  const Json made = answer(request);
  EXPECT_EQ(made["status"], "completed");
  EXPECT_EQ(made["trajectory"]["x"].size(), 64U);
  for (const char* name : {"x", "y", "px", "py"}) EXPECT_NEAR(made["final"][name], made["initial"][name], 1e-4) << name;
  EXPECT_EQ(made["diagnostics"]["structure"]["kind"], "none");
  EXPECT_LT(made["diagnostics"]["energy"]["max_abs_error"], 1e-4);
  const auto& steps = made["trajectory"]["step_size"];
  double longest = 0;
  for (const Json& step : steps)
    if (step.is_number()) longest = std::max(longest, step.get<double>());
  EXPECT_GT(longest, 0.05) << "a hundred times as long as at the start";
}

TEST_F(AdaptiveBorisHttp, StandsInEveryListGoesBackwardAndMeetsEvents) {
  const Json scheme = Json::parse(ask(port(), get("/v1/schemes/adaptive_boris")).body);
  EXPECT_EQ(scheme["own_clock"], true);
  EXPECT_EQ(scheme["structure"], "none");
  EXPECT_EQ(scheme["keeps_volume"], true);
  EXPECT_NE(Json::parse(ask(port(), get("/v1/openapi.json")).body).dump().find("\"adaptive_boris\""),
            std::string::npos);
  EXPECT_NE(std::string(fault_of(arenstorf())["detail"]).find("H depends on time"), std::string::npos)
      << fault_of(arenstorf());

  Json half = still();
  half["until"] = 5;
  expect_there_and_back(half, 1e-4);

  Json request = still();
  request["until"] = 8;
  request["events"] = {{{"name", "wall"}, {"expression", "x+0.5"}, {"direction", "down"}, {"set", {{"vx", "-vx"}}}}};
  request["section"] = {{"expression", "y"}, {"direction", "up"}};
  request["columns"] = {"t", "x"};
  Json truth = request;
  truth["scheme"] = "taylor";
  const Json acted = answer(request), known = answer(truth);
  EXPECT_GE(known["acts"][0]["count"], 1);
  EXPECT_EQ(acted["acts"][0]["count"], known["acts"][0]["count"]);
  EXPECT_EQ(acted["section"]["t"].size(), known["section"]["t"].size());
  EXPECT_NEAR(acted["events"][0]["t"], known["events"][0]["t"], 1e-5);
}

TEST_F(AdaptiveBorisHttp, IsStudied) {
  Json study = still();
  for (const char* key : {"record", "scheme"}) study.erase(key);
  study["until"] = 6;
  study["schemes"] = {{{"id", "adaptive_boris"}, {"composition", "kahan_li_8"}}, "taylor"};
  study["budget_seconds"] = 3;
  const Json made = answer(study, "/v1/work-precision");
  ASSERT_EQ(made["curves"].size(), 2U);
  double best = 1;
  for (const Json& point : made["curves"][0]["points"])
    if (point["error"].is_number()) best = std::min(best, point["error"].get<double>());
  EXPECT_LT(best, 1e-7);
  Json ensemble = still();
  ensemble.erase("record");
  ensemble["members"] = {{"count", 2}, {"vary", {{"/initial/x", {{"values", {0.994, 0.995}}}}}}};
  ensemble["keep"] = {"final"};
  ensemble["columns"] = {"x"};
  EXPECT_FALSE(fault_of(ensemble, "/v1/ensemble").is_null()) << "ensembles take steps of equal length";
}

}  // namespace
}  // namespace least::server::test
