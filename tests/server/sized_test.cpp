// Scenes of more coordinates than any compiled class has, over HTTP.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/server/client.hpp"
#include "tests/server/faults.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

class ManyCoordinates : public Asking {
 protected:
  /// Seven stars: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, 1993, II.10.
  static Json pleiades() {
    return Json::parse(R"~({"problem":{"id":"custom","variables":["x[7]","y[7]"],
      "potential":"-sum(i=1..7, j=i+1..7, i*j/sqrt((x[i]-x[j])^2 + (y[i]-y[j])^2))","masses":{"x[i]":"i","y[i]":"i"}},
      "initial":{"x":[3,3,-1,-3,2,-2,2],"y":[3,-3,2,0,0,-4,4],"vx[6]":1.75,"vx[7]":-1.5,"vy[4]":-1.25,"vy[5]":1},
      "until":3,"scheme":"taylor","diagnostics":["energy","momenta","structure"],"record":{"samples":11},
      "columns":["t","x[*]","y[*]","energy",{"name":"px","expression":"sum(i=1..7, px[i])"}]})~");
  }
  static Json chain(int n) {
    const std::string count = std::to_string(n);
    return {{"problem",
             {{"id", "custom"},
              {"variables", {"q[" + count + "]"}},
              {"definitions", {{"at(i)", "if(i < 1 or i > " + count + ", 0, q[i])"}}},
              {"potential", "sum(i=0.." + count + ", (at(i+1) - at(i))^2/2 + (at(i+1) - at(i))^3/12)"}}}};
  }
};

TEST_F(ManyCoordinates, MoveAsIsKnown) {
  const Json made = answer(pleiades());
  EXPECT_EQ(made["status"], "completed");
  EXPECT_EQ(made["until"]["t"], 3) << "a bare number is a time";
  EXPECT_NEAR(made["final"]["x[1]"], 0.3706139143970502, 1e-9);
  EXPECT_NEAR(made["final"]["x[7]"], -0.7003092922212495, 1e-9);
  EXPECT_EQ(made["trajectory"]["y[7]"].size(), 11U);
  EXPECT_EQ(made["initial"]["py[4]"], -5) << "of a mass of 4";
  EXPECT_LT(made["diagnostics"]["energy"]["max_rel_error"], 1e-12);
  for (const Json& momentum : made["trajectory"]["px"]) EXPECT_NEAR(momentum, 0, 1e-12);
  EXPECT_TRUE(made["warnings"].empty()) << made["warnings"];

  Json echoed;
  for (const char* key : {"problem", "initial", "scheme", "until", "record", "columns", "limits", "norm"})
    echoed[key] = made[key];
  EXPECT_EQ(answer(echoed)["trajectory"], made["trajectory"]);
}

TEST_F(ManyCoordinates, AreAskedInEveryWay) {
  Json request = chain(12);
  request["initial"] = {{"q[1]", 0.2}};
  request["until"] = 2;
  request["scheme"] = {{"id", "auto"}, {"accuracy", 1e-6}};
  Json made = answer(request);
  EXPECT_EQ(made["choice"]["met"], true) << made["choice"];

  request = pleiades();
  request["scheme"] = {{"id", "leapfrog"}, {"step", 0.001}};
  request["events"] = {{{"name", "meet"}, {"expression", "x[1] - 2"}, {"direction", "both"}}};
  made = answer(request);
  ASSERT_FALSE(made["events"].empty());
  EXPECT_NEAR(made["events"][0]["state"]["x[1]"], 2, 1e-12);

  request = chain(24);
  request["scheme"] = {{"id", "leapfrog"}, {"step", 0.05}};
  request["until"] = 5;
  request["members"] = {{"count", 3}, {"vary", {{"/initial/q[1]", {{"values", {0.1, 0.2, 0.3}}}}}}};
  request["members"].erase("count");
  request["columns"] = {"q[1]", "energy"};
  request["keep"] = {"final"};
  made = answer(request, "/v1/ensemble");
  EXPECT_EQ(made["completed"], 3);
  const Json energies = made["final"]["energy"];
  request.erase("members");
  request.erase("keep");
  request["initial"] = {{"q[1]", 0.2}};
  made = answer(request);
  EXPECT_NEAR(energies[1], made["diagnostics"]["energy"]["final"].get<double>(), 1e-15) << "as it runs alone";

  request = chain(24);
  request["initial"] = {{"q[1]", 0.2}};
  request["schemes"] = {"leapfrog", "runge_kutta_4", "taylor"};
  request["until"] = 10;
  request["budget_seconds"] = 6;
  made = answer(request, "/v1/work-precision");
  ASSERT_EQ(made["curves"].size(), 3U);
  EXPECT_NEAR(made["curves"][0]["observed_order"], 2, 0.05);
  EXPECT_NEAR(made["curves"][1]["observed_order"], 4, 0.1);
}

// Every kind of request works: systems of more than 64 equations and starts of more than 128 keys do not fit into
// storage of a fixed size.
TEST_F(ManyCoordinates, NoQuestionIsTooLarge) {
#ifdef __SANITIZE_ADDRESS__
  const std::vector<int> sizes{70};  // others take minutes in such a build
#else
  const std::vector<int> sizes{70, 150, 1024};
#endif
  for (const int n : sizes) {
    Json request = chain(n);
    const Json card = answer(request, "/v1/problems");
    request["initial"] = {{"q[1]", 0.3}};
    request["until"] = 0.1;
    request["limits"] = {{"seconds", 60}};
    request["record"] = {{"samples", 3}};
    request["diagnostics"] = card["diagnostics"];
    ASSERT_GE(card["diagnostics"].size(), 4U) << card["diagnostics"];
    for (const char* scheme : {"leapfrog", "taylor", "dormand_prince_5", "variational_midpoint", "galerkin_4"}) {
      request["scheme"] = scheme;
      const Json made = answer(request);
      EXPECT_EQ(made["status"], "completed") << n << " " << scheme << " " << made["stop"];
      EXPECT_EQ(made["diagnostics"].size(), card["diagnostics"].size());
      EXPECT_LT(made["diagnostics"]["energy"]["max_rel_error"], 1e-3);
      Json echoed;
      for (const char* key : {"problem", "initial", "scheme", "until", "record", "columns", "limits", "norm"})
        echoed[key] = made[key];
      EXPECT_EQ(answer(echoed)["final"], made["final"]) << "a start of so many keys is read";
    }
    request.erase("diagnostics");
    request.erase("limits");
    request.erase("record");
    request["budget_seconds"] = 0.3;
    request.erase("scheme");
    request["schemes"] = {"leapfrog", "taylor", "variational_midpoint"};
    answer(request, "/v1/work-precision");
    request.erase("until");
    answer(request, "/v1/stability");
    request = chain(n);
    request["scheme"] = {{"id", "auto"}, {"accuracy", 1e-6}};
    request["until"] = 0.1;
    request["limits"] = {{"seconds", 4}};
    request["columns"] = {"t", "q[1]"};
    answer(request);
  }
  const Json full = {{"problem",
                      {{"id", "custom"},
                       {"variables", {"a[70]"}},
                       {"lagrangian", "sum(i=1..70, va[i]^2/2 - a[i]^2/2) + va[1]*va[70]/3"}}},
                     {"initial", {{"va[1]", 1}}},
                     {"scheme", "leapfrog"},
                     {"until", 1}};
  EXPECT_LT(answer(full)["diagnostics"]["energy"]["max_rel_error"], 1e-3);
}

TEST_F(ManyCoordinates, AreDescribed) {
  const Json card = answer(chain(1024), "/v1/problems");
  EXPECT_EQ(card["variables"].size(), 2048U);
  EXPECT_EQ(card["form"]["kind"], "separable");
  EXPECT_EQ(card["variables"][1023]["name"], "q[1024]");
  EXPECT_EQ(card["language"]["limits"]["coordinates"], 1024);
  for (const char* function : {"sin", "min", "if", "atan2", "sum"}) {
    const Json& known = card["language"]["functions"];
    EXPECT_NE(std::find(known.begin(), known.end(), function), known.end()) << function;
  }
}

TEST_F(ManyCoordinates, AreRefusedByName) {
  Json request{{"problem",
                {{"id", "custom"}, {"variables", {"q[257]"}}, {"hamiltonian", "sum(i=1..257, (q[i]^2 + p[i]^2)^2)/8"}}},
               {"scheme", "contact_gauss"},
               {"until", 1}};
  Json faults = answer(request, "/v1/simulate", 422)["errors"];
  EXPECT_EQ(faults[0]["pointer"], "/scheme") << faults;
  EXPECT_NE(faults[0]["detail"].get<std::string>().find("more coordinates than"), std::string::npos) << faults;
  request = {{"problem",
              {{"id", "custom"},
               {"variables", {"q[257]"}},
               {"lagrangian", "sum(i=1..257, (1 + q[i]^2)*v[i]^2/2 - q[i]^2/2)"}}},
             {"scheme", "energy_momentum"},
             {"until", 1}};
  faults = answer(request, "/v1/simulate", 422)["errors"];
  EXPECT_NE(faults[0]["detail"].get<std::string>().find("more coordinates than the 256"), std::string::npos) << faults;
  request = chain(1025);
  faults = answer(request, "/v1/problems", 422)["errors"];
  EXPECT_EQ(faults[0]["pointer"], "/problem/variables/0") << faults;
  EXPECT_EQ(faults[0]["allowed"], "1 to 1024");
  request = {{"problem",
              {{"id", "custom"},
               {"variables", {"a[25]"}},
               {"lagrangian", "sum(i=1..25, va[i]^2/2 + va[i]^4) + sum(i=1..24, va[i]*va[i+1])/9"}}}};
  faults = answer(request, "/v1/problems", 422)["errors"];
  EXPECT_EQ(faults[0]["pointer"], "/problem/lagrangian") << faults;
  EXPECT_EQ(faults[0]["detail"], "couples the velocities of too many coordinates");

  request = chain(3);
  request["scheme"] = "leapfrog";
  request["initial"] = {{"q", {1, 2, 3}}, {"q[2]", 4}};
  faults = answer(request, "/v1/simulate", 422)["errors"];
  EXPECT_EQ(faults[0]["pointer"], "/initial/q/1") << faults;
  EXPECT_NE(faults[0]["detail"].get<std::string>().find("is given twice"), std::string::npos) << faults;
  request["initial"] = {{"q", {1, "x", 3}}};
  faults = answer(request, "/v1/simulate", 422)["errors"];
  EXPECT_EQ(faults[0]["pointer"], "/initial/q/1") << faults;
  EXPECT_EQ(faults.size(), 1U) << faults;
}

}  // namespace
}  // namespace least::server::test
