// lifted_splitting over HTTP: in every kind of request that takes a scheme of equal steps, and refusals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

class LiftedSplittingHttp : public Asking {
 protected:
  static Json three_bodies() {
    return custom(R"~({"variables":["x","y"],"parameters":{"mu":0.012277471},"lagrangian":
      "((vx - y)^2 + (vy + x)^2)/2 + (1 - mu)/sqrt((x + mu)^2 + y^2) + mu/sqrt((x - 1 + mu)^2 + y^2)"})~");
  }
  static Json friction() {
    return custom(R"~({"variables":["q"],"parameters":{"c":0.3},"hamiltonian":
      "p^2/2 + 1 - cos(q) + c*p*s*sin(q) + 0.2*s + 0.1*s^2*cos(q)"})~");
  }
  static Json run_of(const Json& problem) {
    const bool plane = problem["variables"].size() == 2;
    Json request{{"problem", problem},
                 {"initial", plane ? Json{{"x", 0.5}, {"vy", 0.7}} : Json{{"q", 1}, {"p", 0.5}, {"s", 0.2}}},
                 {"scheme", {{"id", "lifted_splitting"}, {"step", 0.02}, {"composition", "kahan_li_6"}}},
                 {"until", {{"t", 5.5}}},
                 {"diagnostics", {"energy", "structure"}}};
    return request;
  }
};

TEST_F(LiftedSplittingHttp, RunsAndSaysWhatItKeeps) {
  const Json made = answer(run_of(three_bodies()));
  EXPECT_EQ(made["status"], "completed");
  EXPECT_EQ(made["scheme"]["lift"], "automatic");
  EXPECT_EQ(made["diagnostics"]["structure"]["kind"], "symplectic");
  EXPECT_LT(made["diagnostics"]["structure"]["max_defect"], 1e-12);
  EXPECT_LT(made["diagnostics"]["energy"]["max_abs_error"], 1e-6);
  Json same = run_of(three_bodies());
  same["scheme"] = "taylor";
  const Json truth = answer(same)["final"];
  for (const char* name : {"x", "y", "px", "py"}) EXPECT_NEAR(made["final"][name], truth[name], 1e-6) << name;

  const Json contact = answer(run_of(friction()));
  EXPECT_EQ(contact["diagnostics"]["structure"]["kind"], "contact");
  EXPECT_LT(contact["diagnostics"]["structure"]["max_defect"], 1e-12);
}

TEST_F(LiftedSplittingHttp, StandsInEveryList) {
  const Json scheme = Json::parse(ask(port(), get("/v1/schemes/lifted_splitting")).body);
  EXPECT_EQ(scheme["structure"], "contact");
  EXPECT_EQ(scheme["implicit"], false);
  EXPECT_NE(scheme["references"].dump().find("2605.09103"), std::string::npos);
  const Json schema = Json::parse(ask(port(), get("/v1/openapi.json")).body);
  EXPECT_NE(schema.dump().find("lifted_splitting"), std::string::npos);
  const Json card = answer({{"problem", three_bodies()}}, "/v1/problems");
  EXPECT_TRUE(std::ranges::count(card["schemes"], Json("lifted_splitting")) == 1) << card["schemes"];
}

// Backward, with an event that acts, a section, and columns: the run returns to its start.
TEST_F(LiftedSplittingHttp, GoesBackwardAndMeetsEvents) {
  for (const Json& problem : {three_bodies(), friction()}) {
    Json request = run_of(problem);
    const Json there = answer(request);
    Json back = request;
    back["initial"] = there["final"];
    back["until"] = {{"t", 0}};
    const Json came = answer(back);
    EXPECT_EQ(came["status"], "completed");
    const std::string q = problem["variables"].size() == 2 ? "x" : "q";
    EXPECT_NEAR(came["final"][q], there["initial"][q], 1e-11);
  }
  Json request = run_of(three_bodies());
  request["until"]["t"] = 20;
  request["columns"] = {"t", "x", {{"name", "r"}, {"expression", "sqrt(x^2+y^2)"}}};
  request["events"] = {{{"name", "bounce"},
                        {"expression", "sqrt(x^2+y^2) - 0.4"},
                        {"direction", "down"},
                        {"set", {{"px", "-px"}, {"py", "-py"}}}}};
  request["section"] = {{"expression", "y"}, {"direction", "up"}};
  const Json acted = answer(request);
  EXPECT_EQ(acted["status"], "completed") << acted["stop"];
  EXPECT_FALSE(acted["section"]["t"].empty());
  Json exact = request;
  exact["scheme"] = "taylor";
  const Json truth = answer(exact);
  ASSERT_EQ(acted["events"].size(), truth["events"].size());
  for (std::size_t i = 0; i < std::min<std::size_t>(4, truth["events"].size()); ++i)
    EXPECT_NEAR(acted["events"][i]["t"], truth["events"][i]["t"], 1e-5);
}

TEST_F(LiftedSplittingHttp, IsStudied) {
  Json study{{"problem", three_bodies()},
             {"initial", {{"x", 0.5}, {"vy", 0.7}}},
             {"until", {{"t", 3}}},
             {"budget_seconds", 2},
             {"schemes", {"lifted_splitting", {{"id", "lifted_splitting"}, {"composition", "suzuki_4"}}}}};
  const Json curves = answer(study, "/v1/work-precision")["curves"];
  EXPECT_NEAR(curves[0]["observed_order"], 2, 0.2);
  EXPECT_NEAR(curves[1]["observed_order"], 4, 0.3);
  Json limits{{"problem", custom(R"({"variables":["x","y"],"hamiltonian":
      "(px^2+py^2)/2 + 0.5*(y*px - x*py) + (x^2+y^2)/2"})")},
              {"initial", {{"x", 1}, {"py", 0.3}}},
              {"schemes", {"lifted_splitting"}}};
  const Json limit = answer(limits, "/v1/stability")["limits"][0];
  EXPECT_NEAR(limit["step"], 2, 0.05) << "that of leapfrog: the turn commutes with the rest";
  Json chosen = run_of(three_bodies());
  chosen["scheme"] = {{"id", "auto"}, {"accuracy", 1e-4}, {"keep", {"structure"}}};
  chosen["limits"] = {{"seconds", 10}};
  const Json choice = answer(chosen);
  EXPECT_EQ(choice["scheme"]["id"], "lifted_splitting") << choice["choice"];
}

// Derivatives of the scheme's own map by the start and by parameters of every part: of V, of the rotation, of the mass.
TEST_F(LiftedSplittingHttp, HasSensitivities) {
  const Json turning = custom(R"~({"variables":["x","y"],"parameters":{"m":1.5,"omega":0.7,"k":2,"c":0.1},"hamiltonian":
      "(px^2+py^2)/(2*m) + omega*(y*px - x*py) + k*x^4/4 + y^2/2 + c*s"})~");
  Json request{{"problem", turning},
               {"initial", {{"x", 1}, {"py", 0.3}}},
               {"scheme", {{"id", "lifted_splitting"}, {"step", 0.1}, {"composition", "suzuki_4"}}},
               {"until", {{"t", 2.05}}},
               {"sensitivities", {{"by", {"/initial/x", "/problem/m", "/problem/omega", "/problem/k", "/problem/c"}}}}};
  for (const char* lift : {"exact", "midpoint", "extrapolation"}) {
    request["scheme"]["lift"] = lift;
    const Json found = answer(request)["sensitivities"];
    EXPECT_EQ(found["of"], "scheme");
    ASSERT_TRUE(found["final"].is_array()) << found;
    EXPECT_LT(found["uncertainty"], 1e-8) << lift;
  }
}

TEST_F(LiftedSplittingHttp, IsRefusedByName) {
  Json request = run_of(three_bodies());
  request["problem"] = custom(R"({"variables":["x","y"],"hamiltonian":"px^2*(1+x^2)/2 + py^2/2 + y*px"})");
  request["initial"] = {{"x", 0.5}, {"py", 0.7}};
  Json fault = fault_of(request);
  EXPECT_TRUE(says(fault, "coefficient of px^2 depends on the place (contact_gauss takes that)")) << fault;
  EXPECT_NE(fault["allowed"].dump().find("contact_gauss"), std::string::npos);
  request = run_of(friction());
  request["scheme"]["lift"] = "exact";
  fault = fault_of(request);
  EXPECT_EQ(fault["pointer"], "/scheme/lift");
  EXPECT_TRUE(says(fault, "linear in the coordinates and s")) << fault;
  Json many = run_of(three_bodies());
  many.erase("diagnostics");
  many["members"] = {{"count", 3}, {"seed", 1}, {"vary", {{"/initial/x", {{"uniform", {0.4, 0.6}}}}}}};
  const Reply ensemble = reply(many, "/v1/ensemble");
  EXPECT_EQ(ensemble.status, 200) << ensemble.body;
  EXPECT_EQ(Json::parse(ensemble.body)["completed"], 3);
}

}  // namespace
}  // namespace least::server::test
