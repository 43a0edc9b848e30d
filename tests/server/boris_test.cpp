// boris over HTTP: charges in magnetic fields, in every kind of request that takes a scheme of equal steps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/server/client.hpp"
#include "tests/server/faults.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

class BorisHttp : public Asking {
 protected:
  static Json bottle() {
    return Json::parse(R"~({"problem":{"id":"custom","variables":["x","y","z"],"parameters":{"M":1,"B":1,"c":0},
      "definitions":{"r":"sqrt(x^2+y^2+z^2)"},
      "lagrangian":"(vx^2+vy^2+vz^2)/2 + c*vx*vy + (x*vy-y*vx)*(M/r^3+B/2) - z^2/50",
      "invariants":{"Lz":"x*py-y*px"}},
      "initial":{"x":1.5,"vy":0.5,"vz":0.1},"until":20,
      "scheme":{"id":"boris","step":0.05,"composition":"kahan_li_6"},"record":{"every":0}})~");
  }
  static std::string detail_of(const Json& request) { return fault_of(request)["detail"]; }
};

TEST_F(BorisHttp, RunsAndSaysWhatItKeeps) {
  Json request = bottle();
  request["diagnostics"] = {"energy", "structure", "momenta", "error", "lyapunov"};
  const Json made = answer(request);
  EXPECT_EQ(made["status"], "completed");
  EXPECT_EQ(made["cost"]["steps"], 400);
  EXPECT_EQ(made["cost"]["force_evaluations"], 9 * 400);
  EXPECT_EQ(made["diagnostics"]["structure"]["kind"], "none");
  EXPECT_GT(made["diagnostics"]["structure"]["max_defect"], 1e-13) << "it is not symplectic";
  EXPECT_LT(made["diagnostics"]["energy"]["max_rel_error"], 1e-6);
  EXPECT_LT(made["diagnostics"]["error"]["max"], 1e-5);
  EXPECT_EQ(made["diagnostics"]["lyapunov"]["derivative"], "scheme");
  EXPECT_TRUE(made["warnings"].empty()) << made["warnings"];
  Json echoed;
  for (const char* key : {"problem", "initial", "scheme", "until", "record", "columns", "limits", "norm"})
    echoed[key] = made[key];
  EXPECT_EQ(answer(echoed)["final"], made["final"]);
}

TEST_F(BorisHttp, StandsInEveryListAndIsRefusedByName) {
  const Json scheme = Json::parse(ask(port(), get("/v1/schemes/boris")).body);
  EXPECT_EQ(scheme["structure"], "none");
  EXPECT_EQ(scheme["keeps_volume"], true);
  EXPECT_EQ(scheme["symmetric"], true);
  EXPECT_NE(scheme["summary"].get<std::string>().find("volume"), std::string::npos);
  const Json schema = Json::parse(ask(port(), get("/v1/openapi.json")).body);
  EXPECT_NE(schema.dump().find("\"boris\""), std::string::npos);
  const Json card = answer({{"problem", bottle()["problem"]}}, "/v1/problems");
  EXPECT_EQ(std::ranges::count(card["schemes"], Json("boris")), 1) << card["schemes"];

  Json full = bottle();
  full["problem"]["c"] = 0.3;
  EXPECT_NE(detail_of(full).find("the kinetic energy has a term px*py"), std::string::npos) << detail_of(full);
  Json other = bottle();
  other["problem"] = "damped_oscillator";
  other["initial"] = Json::object();
  EXPECT_NE(detail_of(other).find("boris cannot run damped_oscillator"), std::string::npos) << detail_of(other);
}

TEST_F(BorisHttp, TheChargedParticleOfTheCatalogueGyrates) {
  Json request{{"problem", "charged_particle"},
               {"scheme", {{"id", "boris"}, {"composition", "kahan_li_8"}}},
               {"record", {{"every", 0}}},
               {"diagnostics", {"energy"}}};
  const Json made = answer(request);
  EXPECT_LT(made["diagnostics"]["energy"]["max_rel_error"], 1e-12) << "no work";
  request["scheme"] = "taylor";
  const Json truth = answer(request);
  for (const auto& [name, value] : truth["final"].items()) EXPECT_NEAR(made["final"][name], value, 1e-6) << name;
}

TEST_F(BorisHttp, GoesBackwardAndMeetsEvents) {
  expect_there_and_back(bottle(), 1e-11);

  // Bounces off one plane, and crossings of another.
  Json request = bottle();
  request["columns"] = {"t", "x", "energy", {{"name", "r"}, {"expression", "sqrt(x^2+y^2+z^2)"}}};
  request["record"] = {{"samples", 21}};
  request["section"] = {{"expression", "y"}, {"direction", "up"}};
  request["events"] = {{{"name", "wall"}, {"expression", "z-0.3"}, {"direction", "up"}, {"set", {{"vz", "-vz"}}}}};
  Json truth = request;
  truth["scheme"] = "taylor";
  const Json made = answer(request), known = answer(truth);
  EXPECT_EQ(made["trajectory"]["r"].size(), 21U);
  EXPECT_GE(known["acts"][0]["count"], 1);
  EXPECT_EQ(made["acts"][0]["count"], known["acts"][0]["count"]);
  ASSERT_EQ(made["section"]["t"].size(), known["section"]["t"].size());
  EXPECT_GE(known["section"]["t"].size(), 2U);
  for (std::size_t i = 0; i < known["section"]["t"].size(); ++i)
    EXPECT_NEAR(made["section"]["t"][i], known["section"]["t"][i], 1e-5);
  EXPECT_NEAR(made["final"]["x"], known["final"]["x"], 1e-5);
}

TEST_F(BorisHttp, IsStudiedAndVaried) {
  Json study = bottle();
  study.erase("record");
  study["schemes"] = {{{"id", "boris"}}, {{"id", "boris"}, {"composition", "suzuki_4"}}};
  study["budget_seconds"] = 2;
  study["until"] = 5;
  study.erase("scheme");
  const Json made = answer(study, "/v1/work-precision");
  EXPECT_NEAR(made["curves"][0]["observed_order"], 2, 0.2);
  EXPECT_NEAR(made["curves"][1]["observed_order"], 4, 0.3);

  Json varied = bottle();
  varied["initial"] = {{"x", 1.5}, {"py", 0.75}};
  expect_bits_of_a_run(varied, "py", {0.7, 0.75, 0.8});

  Json derived = bottle();
  derived["sensitivities"] = {{"by", {"/problem/M"}}, {"of", "motion"}};
  EXPECT_TRUE(answer(derived).contains("sensitivities"));

  Json cheapest = bottle();
  cheapest["scheme"] = {{"id", "auto"}, {"accuracy", 1e-6}};
  EXPECT_EQ(answer(cheapest)["choice"]["met"], true);
}

}  // namespace
}  // namespace least::server::test
