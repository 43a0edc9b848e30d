// kepler_splitting over HTTP: the outer planets and a body about a fixed centre, in every kind of request that takes a
// scheme of equal steps.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/catalogue/custom.hpp"
#include "tests/server/client.hpp"
#include "tests/server/faults.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

class KeplerSplittingHttp : public Asking {
 protected:
  /// Hairer, Lubich, Wanner, Geometric Numerical Integration, 2006, I.2.4.
  static Json outer_planets() {
    return Json::parse(R"~({"problem":{"id":"custom","variables":["x[6]","y[6]","z[6]"],
      "parameters":{"G":2.95912208286e-4,
        "m":[1.00000597682,0.000954786104043,0.000285583733151,0.0000437273164546,0.0000517759138449,7.6923076923e-9]},
      "masses":{"x":"m","y":"m","z":"m"},
      "potential":"-G*sum(i=1..6, j=i+1..6, m[i]*m[j]/sqrt((x[i]-x[j])^2+(y[i]-y[j])^2+(z[i]-z[j])^2))",
      "invariants":{"turn":"sum(i=1..6, x[i]*py[i]-y[i]*px[i])","drive":"sum(i=1..6, px[i])"}},
      "initial":{"x":[0,-3.5023653,9.0755314,8.310142,11.4707666,-15.5387357],
        "y":[0,-3.8169847,-3.0458353,-16.2901086,-25.7294829,-25.2225594],
        "z":[0,-1.5507963,-1.6483708,-7.2521278,-10.8169456,-3.1902382],
        "vx":[0,0.00565429,0.00168318,0.00354178,0.0028893,0.00276725],
        "vy":[0,-0.0041249,0.00483525,0.00137102,0.00114527,-0.00170702],
        "vz":[0,-0.00190589,0.00192462,0.00055029,0.00039677,-0.00136504]},
      "scheme":{"id":"kepler_splitting","step":100},"until":200000,"record":{"every":0},
      "diagnostics":["energy","momenta"]})~");
  }
  /// A scene of few coordinates, which have a compiled class: a body about a fixed centre, and a tide.
  static Json tide() {
    return Json::parse(R"~({"problem":{"id":"custom","variables":["x","y"],"parameters":{"e":0.01,"soft":0},
      "potential":"-1/sqrt(x^2+y^2+soft) + e*x^2*(1+cos(t)/2)"},"initial":{"x":1,"vy":1.1},"until":40,
      "scheme":{"id":"kepler_splitting","step":0.2,"splitting":"aba_864"},"record":{"every":0}})~");
  }
  static std::string detail_of(const Json& request) { return fault_of(request)["detail"]; }
  static bool offers(const Json& card) {
    for (const Json& id : card["schemes"])
      if (id == "kepler_splitting") return true;
    return false;
  }
};

TEST_F(KeplerSplittingHttp, TheOuterPlanetsKeepTheirEnergy) {
  Json request = outer_planets();
  const auto energy = [&](const Json& made) { return double(made["diagnostics"]["energy"]["max_rel_error"]); };
  Json made = answer(request);
  EXPECT_EQ(made["status"], "completed");
  EXPECT_EQ(made["cost"]["steps"], 2000);
  EXPECT_EQ(made["cost"]["force_evaluations"], 4001) << "kicks, and motions along orbits";
  EXPECT_LT(energy(made), 2e-6);
  EXPECT_GT(energy(made), 1e-8);
  EXPECT_LT(made["diagnostics"]["momenta"]["turn"]["max_abs_error"], 1e-17) << "of 8e-5";
  EXPECT_TRUE(made["warnings"].empty()) << made["warnings"];
  Json echoed;
  for (const char* key : {"problem", "initial", "scheme", "until", "record", "columns", "limits", "norm"})
    echoed[key] = made[key];
  EXPECT_EQ(answer(echoed)["final"], made["final"]);

  request["scheme"] = {{"id", "kepler_splitting"}, {"step", 200}, {"splitting", "saba_2"}};
  EXPECT_LT(energy(answer(request)), 2e-8);
  request["scheme"] = {{"id", "kepler_splitting"}, {"step", 500}, {"splitting", "aba_1064"}};
  made = answer(request);
  EXPECT_LT(energy(made), 1e-10);
  EXPECT_NEAR(made["final"]["x[2]"], 2.611079570112905, 1e-6) << "published";
  request["scheme"]["coordinates"] = "heliocentric";
  EXPECT_LT(energy(answer(request)), 1e-10);
}

TEST_F(KeplerSplittingHttp, IsOfferedWhereItFits) {
  const auto card = [&](const Json& request) { return answer({{"problem", request["problem"]}}, "/v1/problems"); };
  EXPECT_TRUE(offers(card(outer_planets())));
  EXPECT_TRUE(offers(card(tide())));
  Json other = tide();
  other["problem"]["potential"] = "x^4 + y^2 + e + soft";
  EXPECT_FALSE(offers(card(other)));
  EXPECT_NE(detail_of(other).find("V has no term −k/r"), std::string::npos) << detail_of(other);
  // With these parameters the scene is not planetary any more.
  Json soft = tide();
  soft["problem"]["soft"] = 0.1;
  EXPECT_NE(detail_of(soft).find("V has no term −k/r"), std::string::npos) << detail_of(soft);
  Json catalogue = tide();
  catalogue["problem"] = "damped_oscillator";
  catalogue["initial"] = Json::object();
  EXPECT_NE(detail_of(catalogue).find("kepler_splitting cannot run damped_oscillator"), std::string::npos);
  Json composed = tide();
  composed["scheme"]["composition"] = "kahan_li_6";
  EXPECT_NE(detail_of(composed).find("goes with the splitting strang"), std::string::npos) << detail_of(composed);
}

TEST_F(KeplerSplittingHttp, GoesBackwardAndThereAndBack) {
  for (Json request : {tide(), outer_planets()}) {
    if (request["until"] == 200000) request["until"] = 20050;  // and a shorter step at the end
    expect_there_and_back(request, request["until"] == 40 ? 1e-12 : 1e-5);
  }
}

TEST_F(KeplerSplittingHttp, HasEventsThatActSectionsColumnsAndStructure) {
  Json request = tide();
  request["columns"] = {"t", "x", "energy", "error", {{"name", "r"}, {"expression", "hypot(x, y)"}}};
  request["record"] = {{"samples", 21}};
  request["diagnostics"] = {"energy", "structure", "error", "lyapunov"};
  request["events"] = {{{"name", "apsis"}, {"expression", "x*px+y*py"}, {"direction", "up"}}};
  request["section"] = {{"expression", "y"}, {"direction", "up"}};
  Json made = answer(request);
  EXPECT_EQ(made["trajectory"]["r"].size(), 21U);
  EXPECT_LT(made["diagnostics"]["structure"]["max_defect"], 1e-12);
  EXPECT_EQ(made["diagnostics"]["structure"]["kind"], "symplectic");
  EXPECT_LT(made["diagnostics"]["error"]["max"], 1e-6);
  EXPECT_GE(made["section"]["t"].size(), 4U);
  EXPECT_GE(made["events"].size(), 4U);
  Json truth = request;
  truth["scheme"] = "taylor";
  const Json known = answer(truth);
  ASSERT_EQ(known["events"].size(), made["events"].size());
  for (std::size_t i = 0; i < known["events"].size(); ++i)
    EXPECT_NEAR(made["events"][i]["t"], known["events"][i]["t"], 1e-6);
  EXPECT_NEAR(made["diagnostics"]["lyapunov"]["megno"], known["diagnostics"]["lyapunov"]["megno"], 0.02);

  // A wall that reflects the body.
  request = tide();
  request["events"] = {
      {{"name", "wall"}, {"expression", "y-0.5"}, {"direction", "up"}, {"set", {{"vy", "-vy"}}}, {"most", 6}}};
  request["scheme"]["step"] = 0.05;
  truth = request;
  truth["scheme"] = "taylor";
  made = answer(request);
  const Json acted = answer(truth);
  EXPECT_EQ(made["end"]["count"], 6);
  EXPECT_EQ(made["acts"][0]["keeps"], acted["acts"][0]["keeps"]);
  EXPECT_NEAR(made["final"]["x"], acted["final"]["x"], 1e-6);
  EXPECT_NEAR(made["final"]["t"], acted["final"]["t"], 1e-6);
}

TEST_F(KeplerSplittingHttp, IsStudiedAndVaried) {
  Json study = tide();
  study.erase("record");
  study["schemes"] = {study["scheme"], "leapfrog"};
  study["budget_seconds"] = 2;
  study.erase("scheme");
  Json made = answer(study, "/v1/work-precision");
  EXPECT_EQ(made["curves"][0]["scheme"]["id"], "kepler_splitting");
  EXPECT_EQ(made["curves"][0]["expected_order"], 4);

  Json stability = {{"problem", study["problem"]}, {"initial", study["initial"]}, {"schemes", {"kepler_splitting"}}};
  made = answer(stability, "/v1/stability");
  EXPECT_TRUE(made["limits"][0]["theory"].is_null());

  expect_bits_of_a_run(tide(), "py", {1, 1.1, 1.2});

  Json derived = tide();
  derived["sensitivities"] = {{"by", {"/problem/e"}}, {"of", "scheme"}};
  EXPECT_NE(detail_of(derived).find("there is no derivative"), std::string::npos) << detail_of(derived);
  derived["sensitivities"].erase("of");
  EXPECT_EQ(answer(derived)["sensitivities"]["of"], "motion");

  Json automatic = tide();
  automatic["scheme"] = {{"id", "auto"}, {"accuracy", 1e-6}, {"keep", {"structure"}}};
  made = answer(automatic);
  EXPECT_EQ(made["choice"]["met"], true) << made["choice"];
  EXPECT_EQ(made["scheme"]["id"], "kepler_splitting") << "of all that keep the structure";
}

// Two light bodies in a close encounter: the map that is differentiated keeps the order of the bodies at the start of
// the run, as the run does.
TEST_F(KeplerSplittingHttp, OfBodiesThatPassEachOther) {
  const auto request = [](const std::string& more, const Json& scheme) {
    Json problem = custom(R"~({"variables": ["x[3]", "y[3]"], "parameters": {"m": [1, 1e-3, 1e-3]},
                               "masses": {"x": "m", "y": "m"}})~");
    problem["potential"] = "-sum(i=1..3, j=i+1..3, m[i]*m[j]/sqrt((x[i]-x[j])^2+(y[i]-y[j])^2))" + more;
    Json all{{"problem", problem},
             {"initial", {{"x", {0, 1, -1.4}}, {"vy", {0, 1, -0.55}}}},
             {"until", 30},
             {"scheme", scheme},
             {"record", {{"every", 0}}},
             {"diagnostics", {"lyapunov"}}};
    all["scheme"]["id"] = "kepler_splitting";
    all["scheme"]["step"] = 0.05;
    return all;
  };
  for (const char* coordinates : {"jacobi", "heliocentric"}) {
    const Json made = answer(request("", {{"coordinates", coordinates}}));
    EXPECT_EQ(made["diagnostics"]["lyapunov"]["derivative"], "scheme") << coordinates;
  }
  // Jumps and kicks form one part of weak forces only where all of these act between the bodies.
  const char* further = "+0.001*x[2]^2";
  const Json refused = answer(request(further, {{"coordinates", "heliocentric"}, {"splitting", "aba_864"}}));
  EXPECT_NE(refused["stop"]["detail"].get<std::string>().find("jacobi keeps it"), std::string::npos) << refused["stop"];
  EXPECT_EQ(answer(request(further, {{"coordinates", "jacobi"}, {"splitting", "aba_864"}}))["status"], "completed");
  EXPECT_EQ(answer(request(further, {{"coordinates", "heliocentric"}}))["status"], "completed");
}

}  // namespace
}  // namespace least::server::test
