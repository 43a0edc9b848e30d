// lifted_splitting over HTTP for equations alone: in every kind of request that takes a scheme of equal steps, and
// refusals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/server/client.hpp"
#include "tests/server/faults.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

class FlowLiftHttp : public Asking {
 protected:
  static Json lorenz() {
    return Json::parse(R"~({"problem":{"id":"custom","variables":["x","y","z"],
      "parameters":{"sigma":10,"rho":28,"beta":2.6666666666666665},
      "equations":{"x":"sigma*(y-x)","y":"x*(rho-z)-y","z":"x*y-beta*z"}},"initial":{"x":1,"y":1,"z":1},"until":2.01,
      "scheme":{"id":"lifted_splitting","step":0.002,"composition":"suzuki_4"},"record":{"every":0}})~");
  }
  static std::string detail_of(const Json& request) { return fault_of(request)["detail"]; }
};

TEST_F(FlowLiftHttp, RunsAndStandsInTheList) {
  const Json made = answer(lorenz());
  EXPECT_EQ(made["status"], "completed");
  EXPECT_EQ(made["cost"]["steps"], 1005);
  Json truth = lorenz();
  truth["scheme"] = "taylor";
  const Json end = answer(truth)["final"];
  for (const auto& [name, value] : end.items()) EXPECT_NEAR(made["final"][name], value, 1e-5) << name;
  const Json card = answer({{"problem", lorenz()["problem"]}}, "/v1/problems");
  EXPECT_EQ(std::ranges::count(card["schemes"], Json("lifted_splitting")), 1) << card["schemes"];
  Json echoed;
  for (const char* key : {"problem", "initial", "scheme", "until", "record", "columns", "limits", "norm"})
    echoed[key] = made[key];
  EXPECT_EQ(answer(echoed)["final"], made["final"]);
}

TEST_F(FlowLiftHttp, GoesBackwardAndMeetsEvents) {
  Json there = lorenz();
  there["until"] = 0.5;
  expect_there_and_back(there, 1e-9);
  Json request = lorenz();
  request["columns"] = {"t", "x", {{"name", "r"}, {"expression", "sqrt(x^2+y^2)"}}};
  request["record"] = {{"samples", 21}};
  request["section"] = {{"expression", "z-27"}, {"direction", "up"}};
  request["events"] = {{{"name", "wall"}, {"expression", "x-15"}, {"direction", "up"}, {"set", {{"x", "14"}}}}};
  Json truth = request;
  truth["scheme"] = "taylor";
  const Json acted = answer(request), known = answer(truth);
  EXPECT_EQ(acted["trajectory"]["r"].size(), 21U);
  EXPECT_GE(known["acts"][0]["count"], 1);
  EXPECT_EQ(acted["acts"][0]["count"], known["acts"][0]["count"]);
  EXPECT_EQ(acted["section"]["t"].size(), known["section"]["t"].size());
  EXPECT_NEAR(acted["final"]["x"], known["final"]["x"], 1e-4);
}

TEST_F(FlowLiftHttp, IsStudiedVariedAndRefusedByName) {
  Json study = lorenz();
  for (const char* key : {"record", "scheme"}) study.erase(key);
  study["until"] = 1;
  study["schemes"] = {"lifted_splitting", {{"id", "lifted_splitting"}, {"composition", "suzuki_4"}}};
  study["budget_seconds"] = 2;
  const Json curves = answer(study, "/v1/work-precision")["curves"];
  EXPECT_NEAR(curves[0]["observed_order"], 2, 0.2);
  EXPECT_NEAR(curves[1]["observed_order"], 4, 0.3);

  expect_bits_of_a_run(lorenz(), "y", {0.9, 1, 1.1});

  Json derived = lorenz();
  derived["until"] = 0.5;
  derived["sensitivities"] = {{"by", {"/problem/sigma", "/initial/x"}}, {"of", "scheme"}};
  for (const char* lift : {"automatic", "midpoint", "extrapolation"}) {
    derived["scheme"]["lift"] = lift;
    const Json found = answer(derived)["sensitivities"];
    EXPECT_EQ(found["of"], "scheme");
    ASSERT_TRUE(found["final"].is_array() && found["uncertainty"].is_number()) << lift << found;
    EXPECT_LT(found["uncertainty"], 1e-8) << lift << found;
    EXPECT_NEAR(found["final"][0][0], -1.8984, 1e-3) << lift;
  }
  Json diagnosed = lorenz();
  diagnosed["diagnostics"] = {"lyapunov", "error"};
  EXPECT_LT(answer(diagnosed)["diagnostics"]["error"]["max"], 1e-4);

  Json exact = lorenz();
  exact["scheme"]["lift"] = "exact";
  EXPECT_NE(detail_of(exact).find("linear in the momenta"), std::string::npos) << detail_of(exact);
}

}  // namespace
}  // namespace least::server::test
