// Scenes as text for a client: their cards, runs and echoes, and what is refused where.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "tests/server/client.hpp"
#include "tests/server/faults.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

using CustomHttp = Serving;

Json run_of(int port, const std::string& body) { return Json::parse(ask(port, post("/v1/simulate", body)).body); }
Json card_of(int port, const std::string& problem) {
  return Json::parse(ask(port, post("/v1/problems", R"({"problem":)" + problem + "}")).body);
}

constexpr const char* double_well =
    R"({"id":"custom","variables":["x"],"parameters":{"alpha":0.1},"lagrangian":"vx^2/2 + x^2/2 - x^4/4 - alpha*s"})";

TEST_F(CustomHttp, ACardSaysWhatWasFound) {
  const Json card = card_of(port(), double_well);
  ASSERT_TRUE(card.contains("form")) << card;
  EXPECT_EQ(card["form"], Json::parse(R"({"kind":"contact_linear","autonomous":true,"keeps_energy":false})"));
  EXPECT_EQ(card["equations"].size(), 3U);
  EXPECT_EQ(card["equations"]["x"], "px");
  std::vector<std::string> names;
  for (const auto& variable : card["variables"]) names.push_back(variable["name"]);
  EXPECT_EQ(names, (std::vector<std::string>{"x", "px", "s"}));
  EXPECT_EQ(card["parameters"][0]["name"], "alpha");
  EXPECT_EQ(card["parameters"][0]["default"], 0.1);
  EXPECT_EQ(card["formula"].get<std::string>().rfind("<math><mi>L</mi>", 0), 0U) << card["formula"];
  const auto& schemes = card["schemes"];
  for (const char* id : {"contact_leapfrog", "contact_splitting", "contact_gauss", "taylor", "auto"})
    EXPECT_NE(std::find(schemes.begin(), schemes.end(), id), schemes.end()) << id;
  EXPECT_EQ(std::find(schemes.begin(), schemes.end(), "leapfrog"), schemes.end());
}

// Without a start the card says which values must not be 0, so that a client needs only one request to find a start.
TEST_F(CustomHttp, ACardSaysWhereAMotionCanBegin) {
  const auto start = [&](const char* potential) {
    return card_of(port(), R"~({"id":"custom","variables":["x","y"],"potential":")~" + std::string(potential) + "\"}")
        .at("start");
  };
  EXPECT_EQ(start("x^2 + y^2"), Json::object());
  EXPECT_EQ(start("-1/sqrt(x^2 + y^2)"), Json::parse(R"({"x":1})"));
  EXPECT_EQ(start("-1/x - 1/y"), Json::parse(R"({"x":1,"y":2})"));
  EXPECT_EQ(start("sqrt(-1 - x^2)"), Json());
  const std::string asked = R"~({"problem":{"id":"custom","variables":["x"],"potential":"x^2"},"initial":{"x":1}})~";
  EXPECT_FALSE(Json::parse(ask(port(), post("/v1/problems", asked)).body).contains("start"));
  EXPECT_FALSE(card_of(port(), R"("kepler")").contains("start"));
}

TEST_F(CustomHttp, FormsAreFoundNotDeclared) {
  const struct {
    const char *problem, *kind;
    bool autonomous, keeps_energy;
  } rows[] = {
      {R"~("variables":["x"],"lagrangian":"vx^2/2 - x^4")~", "separable", true, true},
      {R"~("variables":["x"],"hamiltonian":"px^2/2 + x^4")~", "separable", true, true},
      {R"~("variables":["x"],"potential":"x^4")~", "separable", true, true},
      {R"~("variables":["x"],"lagrangian":"vx^2/2 - x^4*cos(t)")~", "separable", false, false},
      {R"~("variables":["x"],"lagrangian":"(1 + x^2)*vx^2/2 - x^4")~", "metric", true, true},
      {R"~("variables":["x"],"hamiltonian":"px^2/(1 + x^2) + x^4")~", "metric", true, true},
      {R"~("variables":["x","y"],"lagrangian":"vx^2 + vx*vy + vy^2 - x^2")~", "separable", true, true},
      {R"~("variables":["x"],"lagrangian":"vx^2/2 - x^2 - 0.1*s")~", "contact_linear", true, false},
      {R"~("variables":["x"],"lagrangian":"vx^2/2 - x^2 - s*cos(t)")~", "contact_linear", false, false},
      {R"~("variables":["x"],"potential":"x^2","damping":"1/t")~", "contact_linear", false, false},
      {R"~("variables":["x"],"hamiltonian":"px^2/2 + x^2 + s^2")~", "contact_quadratic", true, false},
      {R"~("variables":["x"],"hamiltonian":"px^2/2 + x^2 + s^3")~", "hamiltonian", true, false},
      {R"~("variables":["x"],"hamiltonian":"px^2/2 + x*s")~", "hamiltonian", true, false},
      {R"~("variables":["x"],"hamiltonian":"px^4 + px^2 + x^2")~", "hamiltonian", true, true},
      {R"~("variables":["x","y"],"lagrangian":"(vx^2 + vy^2)/2 + x*vy - y*vx")~", "hamiltonian", true, true},
      {R"~("variables":["x"],"lagrangian":"(1 + x^2)*vx^2/2 - x^4 - 0.1*s")~", "hamiltonian", true, false},
      {R"~("variables":["x"],"lagrangian":"-sqrt(1 - vx^2) - x^2")~", "lagrangian", true, true},
      {R"~("variables":["x","y"],"hamiltonian":"px*py + x*y")~", "hamiltonian", true, true},
      {R"~("variables":["x","y"],"lagrangian":"vx*vy - x*y")~", "hamiltonian", true, true},
      {R"~("variables":["x"],"hamiltonian":"px*x")~", "hamiltonian", true, true},
      {R"~("variables":["x","v"],"equations":{"x":"v","v":"-x"})~", "flow", true, false},
      {R"~("variables":["x","v"],"equations":{"x":"v","v":"-x + cos(t)"})~", "flow", false, false},
  };
  for (const auto& row : rows) {
    const Json card = card_of(port(), std::string(R"({"id":"custom",)") + row.problem + "}");
    ASSERT_TRUE(card.contains("form")) << row.problem << " " << card;
    EXPECT_EQ(card["form"]["kind"], row.kind) << row.problem;
    EXPECT_EQ(card["form"]["autonomous"], row.autonomous) << row.problem;
    EXPECT_EQ(card["form"]["keeps_energy"], row.keeps_energy) << row.problem;
    EXPECT_FALSE(card["schemes"].empty()) << row.problem;
  }
}

TEST_F(CustomHttp, TheEchoIsTheSameRequest) {
  const Json first = run_of(port(), std::string(R"({"problem":)") + double_well +
                                        R"(,"initial":{"x":2,"vx":0.5},"scheme":{"id":"contact_splitting","step":0.05},
      "until":{"t":5},"record":{"every":20},"columns":["t","x","px","s","energy"],"diagnostics":["energy","decay"]})");
  ASSERT_EQ(first.value("status", ""), "completed") << first;
  EXPECT_EQ(first["initial"]["px"], 0.5);
  EXPECT_FALSE(first["initial"].contains("vx"));
  Json again;
  for (const char* key : {"problem", "initial", "scheme", "until", "record", "columns", "limits", "norm"})
    again[key] = first[key];
  again["diagnostics"] = {"energy", "decay"};
  const Json second = run_of(port(), again.dump());
  for (const char* key : {"problem", "initial", "trajectory", "final", "diagnostics"})
    EXPECT_EQ(first[key], second[key]) << key;
}

TEST_F(CustomHttp, AParameterIsOverriddenFlat) {
  const auto end = [&](const std::string& more) {
    return run_of(port(), R"({"problem":{"id":"custom","variables":["q"],"parameters":{"k":1},"potential":"k*q^2/2")" +
                              more + R"(},"initial":{"q":1},"scheme":"taylor","until":{"t":1}})")["final"]["q"]
        .get<double>();
  };
  EXPECT_NEAR(end(""), std::cos(1), 1e-12);
  EXPECT_NEAR(end(R"(,"k":4)"), std::cos(2), 1e-12);
  EXPECT_NEAR(end(R"(,"masses":{"q":"4*k"})"), std::cos(0.5), 1e-12);
}

// A relaxation oscillation for which no reference is fast enough: there is a run, which says that its error was not
// measured.
TEST_F(CustomHttp, AutoSaysWhatItCouldNotMeasure) {
  const Json chosen = run_of(port(), R"({"problem":{"id":"custom","variables":["x","v"],"parameters":{"m":1000},
      "equations":{"x":"v","v":"m*(1-x^2)*v-x"}},"initial":{"x":2,"v":0},"scheme":{"id":"auto","accuracy":1e-6},
      "until":{"t":2000},"record":{"every":0},"limits":{"seconds":0.05}})");
  ASSERT_TRUE(chosen.contains("choice")) << chosen;
  EXPECT_NE(chosen["choice"]["met"], true) << chosen["choice"];
  EXPECT_GT(chosen["final"]["t"], 0);
  bool told = false;
  for (const Json& warning : chosen["warnings"]) told = told || warning["code"] == "reference_not_finished";
  EXPECT_TRUE(told) << chosen["warnings"];
}

TEST_F(CustomHttp, EveryEndpointTakesIt) {
  const std::string well = std::string(R"("problem":)") + double_well + R"(,"initial":{"x":2},)";
  const Json chosen = run_of(port(), "{" + well + R"("scheme":{"id":"auto","accuracy":1e-6},"until":{"t":5},
      "record":{"every":0}})");
  ASSERT_EQ(chosen.value("status", ""), "completed") << chosen;
  EXPECT_TRUE(chosen["choice"]["met"]);
  EXPECT_LE(chosen["choice"]["estimated_error"], 1e-6);
  const auto at = [&](const char* path, const std::string& body) {
    return Json::parse(ask(port(), post(path, "{" + well + body + "}")).body);
  };
  const Json study = at("/v1/work-precision", R"("until":{"t":5},"schemes":["contact_leapfrog","taylor"],
      "budget_seconds":2)");
  ASSERT_TRUE(study.contains("curves")) << study;
  EXPECT_EQ(study["curves"].size(), 2U);
  const Json limits = at("/v1/stability", R"("schemes":["contact_leapfrog"],"budget_seconds":2)");
  ASSERT_TRUE(limits.contains("limits")) << limits;
  EXPECT_GT(limits["limits"][0]["step"], 0.1);
  const Json members = at("/v1/ensemble", R"("scheme":{"id":"contact_leapfrog","step":0.05},"until":{"t":100},
      "columns":["x","px"],"keep":["final"],"members":{"vary":{"/initial/x":{"grid":[-2,2,9]}}})");
  ASSERT_EQ(members.value("completed", 0), 9) << members;
  int rests = 0;
  for (const auto& x : members["final"]["x"]) rests += std::abs(std::abs(x.get<double>()) - 1) < 0.05;
  EXPECT_EQ(rests, 8) << "all but the one on the hill between the wells: " << members["final"];
}

TEST_F(CustomHttp, MomentaAreWhatTheTextSays) {
  const Json answer = run_of(port(), R"~({"problem":{"id":"custom","variables":["x","y"],
      "potential":"-1/sqrt(x^2 + y^2)","invariants":{"L":"x*py - y*px"}},"initial":{"x":1,"py":0.8},
      "scheme":"leapfrog","until":{"t":10},"record":{"every":0},"columns":["L"],
      "diagnostics":["momenta","structure","error"]})~");
  ASSERT_EQ(answer.value("status", ""), "completed") << answer;
  EXPECT_EQ(answer["diagnostics"]["momenta"].size(), 1U);
  EXPECT_EQ(answer["diagnostics"]["momenta"]["L"]["initial"], 0.8);
  EXPECT_LT(answer["diagnostics"]["momenta"]["L"]["max_abs_error"], 1e-14);
  EXPECT_LT(answer["diagnostics"]["structure"]["max_defect"], 1e-12);
  EXPECT_LT(answer["diagnostics"]["error"]["max"], 1e-2);
}

TEST_F(CustomHttp, ARegularStartIsAskedFor) {
  const auto polar = [&](const std::string& initial) {
    return ask(port(), post("/v1/simulate", R"~({"problem":{"id":"custom","variables":["r","phi"],
      "lagrangian":"(vr^2 + r^2*vphi^2)/2 + 1/r"},"initial":)~" +
                                                initial + R"(,"scheme":"runge_kutta_4",
      "until":{"t":1}})"));
  };
  const Json fault = only_fault(polar(R"({"r":0,"phi":0})"));
  EXPECT_EQ(fault["pointer"], "/problem/lagrangian");
  EXPECT_TRUE(says(fault, "not regular at the start")) << fault;
  const Json run = Json::parse(polar(R"({"r":1,"vphi":1})").body);
  ASSERT_EQ(run.value("status", ""), "completed") << run;
  EXPECT_NEAR(run["final"]["r"], 1, 1e-9);
  EXPECT_NEAR(run["final"]["phi"], 1, 1e-9);
  EXPECT_EQ(only_fault(polar(R"({"r":1,"vphi":1,"pphi":0})"))["pointer"], "/initial/vphi");
}

// A motion through the pole of a sphere starts beside the pole, and the answer says so.
TEST_F(CustomHttp, AStartAtAHarmlessPoleIsTaken) {
  const std::string scene = R"~({"problem":{"id":"custom","variables":["theta","phi"],
      "lagrangian":"(vtheta^2 + sin(theta)^2*vphi^2)/2 + cos(theta)"},"initial":{"theta":0,"vtheta":1})~";
  const Json run = Json::parse(
      ask(port(), post("/v1/simulate", scene + R"~(,"scheme":"taylor","until":{"t":5},"record":{"samples":2}})~"))
          .body);
  ASSERT_EQ(run.value("status", ""), "completed") << run;
  EXPECT_EQ(run["initial"]["theta"], 1e-12);
  EXPECT_NEAR(run["final"]["theta"], -1.04577846614, 1e-9) << "a plane pendulum's";
  EXPECT_EQ(ask(port(), post("/v1/problems", scene + "}")).status, 200);
}

// A card without a start does not check one; a card with a start checks it as a run does.
TEST_F(CustomHttp, ACardWithAStartRefusesItAsARunDoes) {
  const struct {
    const char *problem, *initial, *pointer, *says;
  } rows[] = {
      {R"~("variables":["x"],"potential":"sqrt(x - 1)")~", R"({"x":0})", "/problem/potential", "x = 0"},
      {R"~("variables":["x"],"potential":"sqrt(x - 1)")~", R"({"x":1})", "/problem/potential", "derivative"},
      {R"~("variables":["x","y"],"hamiltonian":"(px^2 + py^2)/2 - 1/sqrt(x^2 + y^2)")~", R"({"px":1})",
       "/problem/hamiltonian", "not finite at the start"},
      {R"~("variables":["x"],"hamiltonian":"px^4 + log(x)")~", R"({"px":1})", "/problem/hamiltonian", "not finite"},
      {R"~("variables":["x"],"lagrangian":"vx^2/2 + vx^4 - 1/x")~", R"({"vx":1})", "/problem/lagrangian", "not finite"},
      {R"~("variables":["x"],"potential":"x^2","damping":"1/t")~", R"({"x":1})", "/problem/damping", "t = 0"},
      {R"~("variables":["x","v"],"equations":{"x":"v","v":"-1/x"})~", R"({"v":1})", "/problem/equations/v",
       "not finite"},
      {R"~("variables":["r","phi"],"hamiltonian":"(pr^2 + pphi^2/r^2)/2")~", R"({"phi":1,"pphi":1})",
       "/problem/hamiltonian", "not regular at the start"},
      {R"~("variables":["r","phi"],"hamiltonian":"(pr^2 + pphi^2/r^2)/2")~", R"({"phi":1,"pphi":1})",
       "/problem/hamiltonian", "at r = 0.001, it is regular"},
      {R"~("variables":["x","v"],"equations":{"x":"v","v":"-2*v/t - x"})~", R"({"x":1})", "/problem/equations/v",
       "at t = 0.001, it is regular: start there, with the first terms of the series"},
      {R"~("variables":["x"],"lagrangian":"(x - 1)*vx^2/2")~", R"({"x":0.5})", "/problem/lagrangian",
       "mass that is not positive at the start"},
      {R"~("variables":["x","y"],"hamiltonian":"(px^2 - y*py^2)/2 - x")~", R"({"y":1})", "/problem/hamiltonian",
       "mass that is not positive at the start"},
  };
  for (const auto& row : rows) {
    const std::string scene = std::string(R"({"problem":{"id":"custom",)") + row.problem + "}";
    const std::string start = std::string(R"(,"initial":)") + row.initial;
    const Json card = only_fault(ask(port(), post("/v1/problems", scene + start + "}")));
    EXPECT_EQ(card["pointer"], row.pointer) << row.problem;
    EXPECT_TRUE(says(card, row.says)) << card;
    const Json run = only_fault(ask(port(), post("/v1/simulate", scene + start + R"(,"scheme":"runge_kutta_4"})")));
    EXPECT_EQ(run, card) << row.problem;
    EXPECT_EQ(ask(port(), post("/v1/problems", scene + "}")).status, 200) << row.problem << ", without a start";
  }
  const auto good = ask(port(), post("/v1/problems", R"~({"problem":{"id":"custom","variables":["x"],
      "potential":"sqrt(x - 1)"},"initial":{"x":2,"t":1}})~"));
  EXPECT_EQ(good.status, 200) << good.body;
  // An indefinite kinetic energy is no fault for a form that does not need a positive definite one.
  EXPECT_EQ(ask(port(), post("/v1/problems", R"~({"problem":{"id":"custom","variables":["x","y"],
      "lagrangian":"(vx^2 - vy^2)/2 + x*vy - x^2"},"initial":{"x":1}})~"))
                .status,
            200);
  // Where an ensemble varies the start, the request's own start is not that of any member.
  const Json members = Json::parse(ask(port(), post("/v1/ensemble", R"~({"problem":{"id":"custom","variables":["x"],
      "potential":"-log(x)"},"scheme":"leapfrog","until":{"t":0.1},"members":{"vary":{"/initial/x":{"values":[1,2]}}}})~"))
                                       .body);
  EXPECT_EQ(members.value("completed", 0), 2) << members;
}

// Equations have accelerations where the inverse of the metric is short.
TEST_F(CustomHttp, EquationsAreSolvedForAccelerations) {
  const Json one = card_of(port(), R"~({"id":"custom","variables":["x"],"lagrangian":"(1 + x^2)*vx^2/2 - x^4"})~");
  EXPECT_EQ(one["equations"]["x"], "vx");
  EXPECT_EQ(one["equations"].size(), 2U);
  EXPECT_FALSE(one.contains("equations_note"));
  const Json polar = card_of(port(), R"~({"id":"custom","variables":["r","phi"],
      "lagrangian":"(vr^2 + r^2*vphi^2)/2 + 1/r"})~");
  EXPECT_EQ(polar["equations"]["phi"], "vphi");
  // Sent back as a scene these equations have the same motion.
  const auto end = [&](const std::string& problem, const char* initial) {
    return run_of(port(), R"({"problem":)" + problem + R"(,"initial":)" + initial +
                              R"(,"scheme":"taylor","until":{"t":2},"record":{"every":0}})")["final"];
  };
  const auto flow_of = [](const Json& card) {
    Json names = Json::array();
    for (const auto& [name, rate] : card["equations"].items()) names.push_back(name);
    return Json{{"id", "custom"}, {"variables", names}, {"parameters", {{"k", 2}}}, {"equations", card["equations"]}}
        .dump();
  };
  const std::string coupled = R"~({"id":"custom","variables":["x","y"],"parameters":{"k":2},
      "lagrangian":"(1 + x^2*y^2)*vx^2/2 + sin(x)*y*vx*vy + (k + cos(x*y))*vy^2/2 - k*x^2/2 - y^2/2"})~";
  const char* start = R"({"x":1,"y":0.5,"vx":0.3,"vy":-0.4})";
  const Json typed = end(coupled, start), rates = card_of(port(), coupled);
  const Json again = end(flow_of(rates), start);
  ASSERT_TRUE(typed.contains("x") && again.contains("x")) << rates["equations"];
  for (const char* name : {"x", "y"}) EXPECT_NEAR(typed[name], again[name].get<double>(), 1e-10) << name;
  const Json polar_again = end(flow_of(polar), R"({"r":1,"vr":0.2,"vphi":0.9})"),
             polar_typed = end(R"~({"id":"custom","variables":["r","phi"],
      "lagrangian":"(vr^2 + r^2*vphi^2)/2 + 1/r"})~",
                               R"({"r":1,"vr":0.2,"vphi":0.9})");
  for (const char* name : {"r", "phi"}) EXPECT_NEAR(polar_typed[name], polar_again[name].get<double>(), 1e-10) << name;
  // Else the equations have momenta and their rates, and say so.
  const Json three = card_of(port(), R"~({"id":"custom","variables":["x","y","z"],
      "lagrangian":"(1 + x^2)*vx^2/2 + vy^2/2 + vz^2/2 + vx*vz/9"})~");
  EXPECT_TRUE(three["equations"].contains("dpx/dt"));
  EXPECT_NE(three.value("equations_note", "").find("accelerations"), std::string::npos) << three;
}

// Where H does not depend on s there is no s in schemes, errors and columns, whatever is added to H.
TEST_F(CustomHttp, AnActionThatIsNotReadIsNotThere) {
  const auto run = [&](const std::string& more) {
    return run_of(port(), R"~({"problem":{"id":"custom","variables":["x"],"hamiltonian":"(px + 0.1*x^2)^2/2 + x^2/2)~" +
                              more +
                              R"~("},"initial":{"x":1},"scheme":{"id":"runge_kutta_4","step":0.3},"until":{"t":30},
        "record":{"every":0},"diagnostics":["error","structure"]})~");
  };
  const Json plain = run(""), lifted = run(" + 1000");
  ASSERT_EQ(plain.value("status", ""), "completed") << plain;
  EXPECT_FALSE(plain["final"].contains("s"));
  EXPECT_EQ(plain["final"], lifted["final"]);
  EXPECT_EQ(plain["diagnostics"]["error"], lifted["diagnostics"]["error"]);
  EXPECT_GT(plain["diagnostics"]["error"]["final"], 1e-4);
  const Json solved = run_of(port(), R"~({"problem":{"id":"custom","variables":["x"],
      "hamiltonian":"(px + 0.1*x)^2/2 + 1e6*x"},"scheme":{"id":"contact_gauss","step":0.1},"until":{"t":1},
      "record":{"every":0},"diagnostics":["structure"]})~");
  ASSERT_EQ(solved.value("status", ""), "completed") << solved;
  EXPECT_EQ(solved["diagnostics"]["structure"]["kind"], "symplectic");
  EXPECT_LT(solved["diagnostics"]["structure"]["max_defect"], 1e-12);
}

TEST_F(CustomHttp, AMemberWithoutAMassDoesNotCount) {
  const Json answer = Json::parse(ask(port(), post("/v1/ensemble", R"({"problem":{"id":"custom","variables":["x"],
      "parameters":{"m":1},"potential":"x^2/2","masses":{"x":"m"}},"initial":{"x":1},"scheme":"leapfrog",
      "until":{"t":1},"members":{"vary":{"/problem/m":{"values":[-1,0,1,2]}}}})"))
                                      .body);
  EXPECT_EQ(answer.value("completed", 0), 2) << answer;
  EXPECT_EQ(answer["stopped"]["singular"], 2) << answer;
}

// The service is not given a formula for v from p = v/√(1 − v²): it solves for the velocity.
TEST_F(CustomHttp, ALagrangianThatIsNotQuadraticIsIterated) {
  const std::string l = R"~({"problem":{"id":"custom","variables":["q"],"lagrangian":"-sqrt(1 - v^2) - q^2/2"})~",
                    h = R"~({"problem":{"id":"custom","variables":["q"],"hamiltonian":"sqrt(1 + p^2) + q^2/2"})~";
  const std::string more = R"(,"initial":{"q":2,"p":0.5},"scheme":"contact_gauss","until":{"t":5},
      "record":{"every":0},"diagnostics":["energy","structure","error"]})";
  const Json a = run_of(port(), l + more), b = run_of(port(), h + more);
  ASSERT_EQ(a.value("status", ""), "completed") << a;
  ASSERT_EQ(b.value("status", ""), "completed") << b;
  EXPECT_NEAR(a["final"]["q"].get<double>(), b["final"]["q"].get<double>(), 1e-11);
  EXPECT_NEAR(a["final"]["p"].get<double>(), b["final"]["p"].get<double>(), 1e-11);
  EXPECT_LT(a["diagnostics"]["structure"]["max_defect"], 1e-10);
  EXPECT_LT(a["diagnostics"]["error"]["max"], 1e-4);
}

// Each scene as text that the page offers runs without changes.
TEST_F(CustomHttp, TheTextsOfThePageRun) {
  const Json scenes = Json::parse(std::ifstream(LEAST_SOURCE_DIR "/web/scenes.json"));
  ASSERT_GE(scenes.size(), 8U);
  for (const Json& scene : scenes) {
    Json request;
    for (const char* key : {"problem", "initial", "scheme", "until"}) request[key] = scene.at(key);
    request["record"] = {{"every", 0}};
    request["diagnostics"] = {"momenta"};
    const Json answer = run_of(port(), request.dump());
    ASSERT_EQ(answer.value("status", ""), "completed") << scene["name"] << " " << answer;
    for (const auto& [name, kept] : answer["diagnostics"]["momenta"].items())
      EXPECT_LT(kept["max_abs_error"], 1e-4) << scene["name"] << " " << name;
    EXPECT_FALSE(scene.at("reference").get<std::string>().empty());
  }
}

}  // namespace
}  // namespace least::server::test
