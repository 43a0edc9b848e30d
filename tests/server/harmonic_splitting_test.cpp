// harmonic_splitting over HTTP: chains and small oscillations, in every kind of request that takes a scheme of equal
// steps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/server/client.hpp"
#include "tests/server/faults.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

class HarmonicSplittingHttp : public Asking {
 protected:
  static Json chain() {
    return Json::parse(R"~({"problem":{"id":"custom","variables":["x[n]"],"parameters":{"n":12,"a":0.25,"k":1},
      "definitions":{"at(i)":"if(i == 0 or i > n, 0, x[i])","spring(i)":"at(i+1) - at(i)"},
      "potential":"sum(i=0..n, k*spring(i)^2/2 + a*spring(i)^3/3)"},
      "initial":{"x":[0.2,0.4,0.6,0.7,0.8,0.9,0.9,0.8,0.7,0.6,0.4,0.2]},"until":100,
      "scheme":{"id":"harmonic_splitting","step":0.5,"splitting":"aba_864"},"record":{"every":0},
      "diagnostics":["energy","structure"]})~");
  }
  static std::string detail_of(const Json& request) { return fault_of(request)["detail"]; }
};

TEST_F(HarmonicSplittingHttp, RunsAChainAndSaysWhatItKeeps) {
  const Json made = answer(chain());
  EXPECT_EQ(made["status"], "completed");
  EXPECT_EQ(made["cost"]["steps"], 200);
  EXPECT_EQ(made["cost"]["force_evaluations"], 7 * 200);
  EXPECT_EQ(made["diagnostics"]["structure"]["kind"], "symplectic");
  EXPECT_LT(made["diagnostics"]["structure"]["max_defect"], 1e-12);
  EXPECT_LT(made["diagnostics"]["energy"]["max_rel_error"], 1e-7);
  Json truth = chain();
  truth["scheme"] = "taylor";
  truth["diagnostics"] = Json::array();
  const Json end = answer(truth)["final"];
  for (const auto& [name, value] : end.items()) EXPECT_NEAR(made["final"][name], value, 1e-5) << name;
  Json echoed;
  for (const char* key : {"problem", "initial", "scheme", "until", "record", "columns", "limits", "norm"})
    echoed[key] = made[key];
  EXPECT_EQ(answer(echoed)["final"], made["final"]);
}

TEST_F(HarmonicSplittingHttp, StandsInEveryListAndIsRefusedByName) {
  const Json scheme = Json::parse(ask(port(), get("/v1/schemes/harmonic_splitting")).body);
  EXPECT_EQ(scheme["structure"], "symplectic");
  const Json schema = Json::parse(ask(port(), get("/v1/openapi.json")).body);
  EXPECT_NE(schema.dump().find("\"harmonic_splitting\""), std::string::npos);
  const Json card = answer({{"problem", chain()["problem"]}}, "/v1/problems");
  EXPECT_EQ(std::ranges::count(card["schemes"], Json("harmonic_splitting")), 1) << card["schemes"];
  Json slack = chain();
  slack["problem"]["k"] = 0;
  EXPECT_NE(detail_of(slack).find("no quadratic part"), std::string::npos) << detail_of(slack);
  Json composed = chain();
  composed["scheme"]["composition"] = "kahan_li_6";
  EXPECT_NE(detail_of(composed).find("goes with the splitting strang"), std::string::npos) << detail_of(composed);
  Json catalogue = chain();
  catalogue["problem"] = "damped_oscillator";
  catalogue["initial"] = Json::object();
  EXPECT_NE(detail_of(catalogue).find("harmonic_splitting cannot run damped_oscillator"), std::string::npos);
}

TEST_F(HarmonicSplittingHttp, GoesBackwardIsStudiedAndVaried) {
  expect_there_and_back(chain(), 1e-11);

  Json small = Json::parse(R"~({"problem":{"id":"custom","variables":["x","y"],"parameters":{"e":0.1},
      "potential":"(x^2+y^2)/2 + e*y*(x^2-y^2/3)"},"initial":{"x":0.3,"vy":0.4},"until":20,
      "schemes":["harmonic_splitting",{"id":"harmonic_splitting","splitting":"aba_864"}],"budget_seconds":2})~");
  const Json made = answer(small, "/v1/work-precision");
  EXPECT_NEAR(made["curves"][0]["observed_order"], 2, 0.2);
  EXPECT_EQ(made["curves"][1]["expected_order"], 4);

  Json events = small;
  events.erase("schemes");
  events.erase("budget_seconds");
  events["scheme"] = {{"id", "harmonic_splitting"}, {"step", 0.1}, {"composition", "kahan_li_6"}};
  events["events"] = {{{"name", "wall"}, {"expression", "x-0.25"}, {"direction", "up"}, {"set", {{"vx", "-vx"}}}}};
  events["section"] = {{"expression", "y"}, {"direction", "up"}};
  Json truth = events;
  truth["scheme"] = "taylor";
  const Json acted = answer(events), known = answer(truth);
  EXPECT_GE(known["acts"][0]["count"], 1);
  EXPECT_EQ(acted["acts"][0]["count"], known["acts"][0]["count"]);
  EXPECT_NEAR(acted["final"]["x"], known["final"]["x"], 1e-5);

  Json varied = events;
  for (const char* key : {"events", "section"}) varied.erase(key);
  expect_bits_of_a_run(varied, "py", {0.3, 0.4, 0.5});
}

}  // namespace
}  // namespace least::server::test
