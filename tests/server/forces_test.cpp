// Forces beside a scene as text, over HTTP.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/server/client.hpp"
#include "tests/server/faults.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

class Forces : public Asking {
 protected:
  static Json drag() {
    return Json::parse(R"~({"problem":{"id":"custom","variables":["x"],"parameters":{"c":0.1},"potential":"x^2/2",
                                       "forces":{"x":"-c*vx*abs(vx)"}},
      "initial":{"x":2},"scheme":{"id":"leapfrog","composition":"suzuki_4"},"until":20,"record":{"samples":3},
      "diagnostics":["energy"]})~");
  }
};

// Steps of these schemes are long; what a polynomial makes of the energy and the work between their ends is no error of
// theirs.
TEST_F(Forces, AreBalancedByTheirWorkAtTheEndsOfLongSteps) {
  for (const char* scheme : {"bulirsch_stoer", "fehlberg_78", "dormand_prince_5", "taylor"}) {
    Json request = drag();
    request["scheme"] = {{"id", scheme}, {"tolerance", 1e-12}};
    const Json energy = answer(request)["diagnostics"]["energy"];
    EXPECT_LT(energy["work"], -1.5) << scheme;
    EXPECT_LT(energy["max_abs_error"], 1e-9) << scheme;
  }
}

TEST_F(Forces, AreBalancedByTheirWork) {
  const Json made = answer(drag());
  const Json& energy = made["diagnostics"]["energy"];
  EXPECT_LT(energy["work"], -1.5);
  EXPECT_LT(energy["max_abs_error"], 1e-7);
  EXPECT_NEAR(energy["final"].get<double>() - energy["initial"].get<double>(), energy["work"], 1e-7);
  EXPECT_EQ(made["final"].size(), 3U) << "t, x, px: " << made["final"];

  Json echoed;
  for (const char* key : {"problem", "initial", "scheme", "until", "record", "columns", "limits", "norm"})
    echoed[key] = made[key];
  EXPECT_EQ(echoed["problem"]["forces"], drag()["problem"]["forces"]);
  EXPECT_EQ(answer(echoed)["trajectory"], made["trajectory"]);

  Json other = drag();
  other["problem"].erase("forces");
  other["problem"]["dissipation"] = "c*vx^2/2";
  EXPECT_EQ(answer(other)["problem"]["dissipation"], "c*vx^2/2");
  other["problem"].erase("dissipation");
  EXPECT_FALSE(answer(other)["diagnostics"]["energy"].contains("work"));
}

TEST_F(Forces, StandOnTheCard) {
  const Json card = answer({{"problem", drag()["problem"]}}, "/v1/problems");
  const Json form{{"kind", "separable"}, {"autonomous", true}, {"keeps_energy", false}, {"forced", true}};
  EXPECT_EQ(card["form"], form);
  EXPECT_EQ(card["equations"]["px"], "-c*px*abs(px) - x");
  Json free = drag()["problem"];
  free.erase("forces");
  EXPECT_FALSE(answer({{"problem", free}}, "/v1/problems")["form"].contains("forced"));
}

TEST_F(Forces, AreAskedInEveryWay) {
  Json request = drag();
  request["scheme"] = {{"id", "auto"}, {"accuracy", 1e-6}};
  EXPECT_EQ(answer(request)["choice"]["met"], true);

  request = drag();
  request["events"] = {{{"name", "turn"}, {"expression", "px"}, {"direction", "both"}, {"stop", true}}};
  const Json stopped = answer(request);
  EXPECT_EQ(stopped["events"][0]["name"], "turn");
  EXPECT_NEAR(stopped["final"]["px"], 0, 1e-12);

  // An elastic floor does no work, so that the energy balance holds over bounces.
  request =
      Json::parse(R"~({"problem":{"id":"custom","variables":["x"],"potential":"9.81*x","forces":{"x":"-0.1*vx^3"}},
    "initial":{"x":1},"scheme":"taylor","until":3,"diagnostics":["energy"],
    "events":[{"name":"floor","expression":"x","direction":"down","set":{"vx":"-vx"}}]})~");
  const Json bounced = answer(request);
  EXPECT_GT(bounced["acts"][0]["count"], 3) << bounced["acts"];
  EXPECT_LT(bounced["diagnostics"]["energy"]["work"], -3);
  EXPECT_LT(bounced["diagnostics"]["energy"]["max_abs_error"], 1e-9);

  request = drag();
  for (const char* key : {"record", "diagnostics"}) request.erase(key);
  request["members"] = {{"vary", {{"/problem/c", {{"values", {0.0, 0.1, 0.2}}}}}}};
  request["columns"] = {"x", "energy"};
  request["keep"] = {"final"};
  const Json many = answer(request, "/v1/ensemble");
  EXPECT_EQ(many["completed"], 3);

  request = drag();
  for (const char* key : {"record", "diagnostics", "scheme"}) request.erase(key);
  request["until"] = 5;
  request["schemes"] = {"leapfrog", "variational_midpoint"};
  request["budget_seconds"] = 1;
  const Json study = answer(request, "/v1/work-precision");
  for (const Json& curve : study["curves"]) EXPECT_GT(curve["points"].size(), 3U);
}

// Where friction holds a mass the reference ends, and the answer says so, and not that its time was over.
TEST_F(Forces, ThatHoldWhatRestsEndTheReference) {
  Json request = Json::parse(R"~({"problem":{"id":"custom","variables":["x"],"potential":"x^2/2",
      "forces":{"x":"-0.3*sign(vx)"}},"initial":{"x":1},"scheme":"leapfrog","until":6,"record":{"every":0},
      "diagnostics":["error"]})~");
  EXPECT_LT(answer(request)["diagnostics"]["error"]["max"], 0.01);
  request["until"] = 8;
  const Json made = answer(request);
  EXPECT_TRUE(made["diagnostics"]["error"]["max"].is_null());
  bool told = false;
  for (const Json& warning : made["warnings"])
    told = told || (warning["code"] == "reference_not_finished" &&
                    warning["detail"].get<std::string>().find("friction holds") != std::string::npos);
  EXPECT_TRUE(told) << made["warnings"];
}

// Where friction holds a mass the control run stands still, which is not a singularity.
TEST_F(Forces, ThatHoldWhatRestsAreNoSingularity) {
  Json request = Json::parse(R"~({"problem":{"id":"custom","variables":["x"],"potential":"0*x",
      "forces":{"x":"-0.3*sign(vx)"}},"initial":{"vx":0.5},"scheme":"leapfrog","until":10,"record":{"every":0}})~");
  const Json made = answer(request);
  EXPECT_NEAR(made["final"]["x"], 0.25 / 0.6, 1e-4);
  for (const Json& warning : made["warnings"]) EXPECT_NE(warning["code"], "beyond_singularity") << warning;
  request["problem"] = {{"id", "custom"}, {"variables", {"x"}}, {"equations", {{"x", "-1/x"}}}};
  request["initial"] = {{"x", 1}};
  request["scheme"] = "runge_kutta_4";
  request["until"] = 1;
  const Json beyond = answer(request);  // x² = 1 − 2t
  EXPECT_TRUE(std::ranges::any_of(beyond["warnings"], [](const Json& warning) {
    return warning["code"] == "beyond_singularity";
  })) << beyond["warnings"];
}

// Backward in time friction adds the energy that it takes forward, and a force that is even in v does not change: a run
// there and back returns, and so does the work.
TEST_F(Forces, GoBackward) {
  struct Case {
    const char *scene, *scheme;
    bool gains;  ///< energy on the way there
  };
  const Case cases[] = {
      {R"~({"variables":["x"],"potential":"x^4/4","forces":{"x":"-0.1*vx^3"}})~", "leapfrog", true},
      {R"~({"variables":["x"],"potential":"x^4/4","forces":{"x":"0.3*cos(t + 1) - 0.2*vx^2"}})~", "leapfrog", false},
      {R"~({"variables":["x"],"potential":"x^2/2","dissipation":"(0.2 + 0.1*sin(t + 1))*vx^2/2"})~", "leapfrog", true},
      {R"~({"variables":["x"],"hamiltonian":"px^2/2 + x^2/2 + 0.1*x*px","dissipation":"0.1*vx^2 + 0.05*vx^4"})~",
       "variational_midpoint", true},
      {R"~({"variables":["x"],"hamiltonian":"px^2/2 + x^4/4","forces":{"x":"-0.2*px + 0.1*t"}})~", "leapfrog", false},
      {R"~({"variables":["x","y"],"lagrangian":"vx^2/2 + vy^2/2 + cos(x - y)*vx*vy/2 + 2*cos(x) + cos(y)",
            "dissipation":"0.2*(vy - vx)^2/2"})~",
       "galerkin_4", true},
      {R"~({"variables":["x[3]"],"potential":"sum(i=1..3, x[i]^4/4)",
            "dissipation":"sum(i=1..2, (vx[i+1] - vx[i])^2/9)"})~",
       "leapfrog", true}};
  for (const auto& [scene, own, gains] : cases)
    for (const char* scheme : {"taylor", own}) {
      SCOPED_TRACE(std::string(scene) + " by " + scheme);
      Json problem = Json::parse(scene);
      problem["id"] = "custom";
      const std::string name = problem["variables"][0] == "x[3]" ? "x[1]" : "x";
      const Json there = answer({{"problem", problem},
                                 {"initial", {{name, 0.9}}},
                                 {"until", {{"t", -2}}},
                                 {"scheme", scheme},
                                 {"diagnostics", {"energy"}}});
      const Json& gained = there["diagnostics"]["energy"];
      if (gains) {
        EXPECT_GT(gained["work"], 1e-3);
      }
      const Json back = answer({{"problem", there["problem"]},
                                {"initial", there["final"]},
                                {"until", {{"t", 0}}},
                                {"scheme", there["scheme"]},
                                {"diagnostics", {"energy", "error"}}});
      const Json& lost = back["diagnostics"]["energy"];
      for (const auto& [variable, value] : there["initial"].items())
        if (back["final"].contains(variable)) {
          EXPECT_NEAR(back["final"][variable], value, 1e-11) << variable;
        }
      EXPECT_NEAR(gained["work"].get<double>() + lost["work"].get<double>(), 0, 1e-10);
      if (std::string(scheme) != "taylor" || problem.contains("forces")) continue;
      EXPECT_LT(gained["max_abs_error"], 1e-11);
      EXPECT_NEAR(gained["final"].get<double>() - gained["initial"].get<double>(), gained["work"], 1e-11);
    }
}

TEST_F(Forces, ThatAreWrongAreNamed) {
  struct Wrong {
    const char *change, *pointer, *detail;
  };
  const Wrong all[] = {{R"~({"forces":{"x":"-k*vx"}})~", "/problem/forces/x", "nobody knows the name k"},
                       {R"~({"forces":{"y":"1"}})~", "/problem/forces/y", "no variable"},
                       {R"~({"forces":"x"})~", "/problem/forces", "must be an object of formulas"},
                       {R"~({"forces":{"x":[1]}})~", "/problem/forces/x", "must be a formula"},
                       {R"~({"dissipation":{"x":"1"}})~", "/problem/dissipation", "must be a formula"},
                       {R"~({"dissipation":"px^2"})~", "/problem/dissipation", "is a momentum"},
                       {R"~({"damping":"0.1"})~", "/problem/forces", "cannot stand beside damping"},
                       {R"~({"action_curvature":"0.1"})~", "/problem/forces", "cannot stand beside action_curvature"},
                       {R"~({"force":{"x":"1"}})~", "/problem/force", "forces"},
                       {R"~({"forces":{"x":"1/(x - 2)"}})~", "/problem/forces", "is not finite at the start"}};
  for (const auto& [change, pointer, detail] : all) {
    Json request = drag();
    request["problem"].update(Json::parse(change));
    const Json errors = answer(request, "/v1/simulate", 422)["errors"];
    EXPECT_EQ(errors[0]["pointer"], pointer) << errors;
    EXPECT_NE(errors[0]["detail"].get<std::string>().find(detail), std::string::npos) << errors;
  }
  Json request = drag();
  request["scheme"] = "jacobi_maupertuis";
  const std::string why = answer(request, "/v1/simulate", 422)["errors"][0]["detail"];
  EXPECT_NE(why.find("with forces beside it"), std::string::npos) << why;
}

}  // namespace
}  // namespace least::server::test
