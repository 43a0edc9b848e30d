// Runs backward in time over HTTP: `until` before the start.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "core/catalogue/catalogue.hpp"
#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"
#include "tests/support/runs.hpp"

namespace least::server::test {
namespace {

class Backward : public Asking {
 protected:
  /// return_of() requests the same scene and scheme from the end of a run to its start.
  static Json return_of(const Json& made) {
    return {{"problem", made["problem"]},
            {"scheme", made["scheme"]},
            {"initial", made["final"]},
            {"record", {{"every", 0}}},
            {"until", made["initial"]["t"]}};
  }
  static void expect_state(const Json& state, const Json& start, double within) {
    for (const auto& [name, value] : start.items()) {
      if (!state.contains(name)) continue;
      EXPECT_NEAR(state[name], value, within) << name;
    }
  }
};

/// Schemes whose step with h followed by one with −h is the identity, whatever the problem.
const std::set<std::string> retrace{"leapfrog",         "variational_midpoint",         "galerkin_4",
                                    "contact_leapfrog", "contact_variational_midpoint", "contact_splitting",
                                    "contact_gauss"};

// Every problem of the catalogue by every scheme that fits it.
TEST_F(Backward, EverySchemeReturns) {
  for (const auto& problem : problem_list()) {
    const ProblemCard& card = problem->card();
    if (card.id == "lane_emden") continue;  // from ξ > 0 it returns to where its equations are singular
    for (const std::size_t place : card.schemes) {
      const std::string& scheme = schemes()[place].id;
      // Exact flows of the parts of a vector field are known forward only.
      if (scheme == "contact_splitting" && !card.keeps_form) continue;
      const auto found = [&] { return card.id + " by " + scheme; };
      const Json there =
          answer({{"problem", card.id}, {"scheme", scheme}, {"until", {{"steps", 8}}}, {"record", {{"every", 0}}}});
      ASSERT_EQ(there["status"], "completed") << found();
      const Json back = answer(return_of(there));
      EXPECT_EQ(back["status"], "completed") << found();
      EXPECT_EQ(back["final"]["t"], there["initial"]["t"]) << found();
      if (!retrace.contains(scheme)) continue;
      SCOPED_TRACE(found());
      expect_state(back["final"], there["initial"], 1e-12);
    }
  }
}

/// Diagnostics at a problem's own sections, or averages along a motion: these exist forward only.
const std::set<std::string> known_forward_alone{"entropy", "zeros", "moments", "slope", "cycle", "poles"};

/// Columns that depend on how a state was reached.
const std::set<std::string> of_the_way{"step_size", "mode", "parameter", "discrete_energy", "error"};

// A run backward begins where a run forward ends: the columns of a state do not depend on the direction.
TEST_F(Backward, AProblemSaysTheSameOfAState) {
  for (const auto& problem : problem_list()) {
    const ProblemCard& card = problem->card();
    Json columns = Json::array(), diagnostics = Json::array();
    for (const ColumnCard& column : card.columns)
      if (!column.hidden && !known_forward_alone.contains(column.name) && !of_the_way.contains(column.name))
        columns.push_back(column.name);
    for (const DiagnosticCard& one : card.diagnostics)
      if (!known_forward_alone.contains(std::string(one.name)) && one.name != "lyapunov")
        diagnostics.push_back(one.name);
    const Json there = answer({{"problem", card.id},
                               {"scheme", schemes()[card.schemes.front()].id},
                               {"until", {{"steps", 8}}},
                               {"columns", columns},
                               {"record", {{"every", 8}}}});
    Json question = return_of(there);
    question["columns"] = columns;
    question["diagnostics"] = diagnostics;
    question["record"] = {{"every", 1}};
    const Json back = answer(question);
    EXPECT_EQ(back["diagnostics"].size(), diagnostics.size()) << card.id << back;
    for (const auto& [name, values] : there["trajectory"].items()) {
      if (values.back().is_null()) continue;
      const double before = values.back(), now = back["trajectory"][name].front();
      EXPECT_NEAR(now, before, 1e-12 * std::max(1.0, std::abs(before))) << card.id << ' ' << name;
    }
  }
}

// The star with n = 1 from a regular start: the motion ends where q vanishes, backward as forward, with every scheme.
TEST_F(Backward, TheDomainOfAMotionIsKept) {
  const ProblemCard& card = runs::problem_card("lane_emden");
  for (const std::size_t place : card.schemes) {
    const std::string& scheme = schemes()[place].id;
    const Json made = answer({{"problem", {{"id", "lane_emden"}, {"n", 1}}},
                              {"initial", {{"t", 3}, {"q", 0.5}, {"p", 1}}},
                              {"scheme", scheme},
                              {"until", 1},
                              {"record", {{"every", 0}}}});
    EXPECT_EQ(made["stop"]["reason"], "left_domain") << scheme;
    EXPECT_NEAR(made["stop"]["t"].get<double>(), 2.5951, 3e-3) << scheme;
  }
}

// The rotation of the apsis and the angular momentum have the signs of the motion forward.
TEST_F(Backward, AnOrbitHasTheSenseOfTheMotionForward) {
  runs::problem_called("perturbed_kepler");
  Json reports[2];
  for (const double end : {12.0, -12.0})
    reports[end < 0] = answer({{"problem", "perturbed_kepler"},
                               {"scheme", "taylor"},
                               {"until", end},
                               {"record", {{"every", 0}}},
                               {"diagnostics", {"orbit"}}})["diagnostics"]["orbit"];
  EXPECT_LT(reports[0]["apsidal_rotation"].get<double>(), -0.01);  // the perturbation is even in t
  for (const auto& [name, value] : reports[0].items())
    EXPECT_NEAR(reports[1][name].get<double>(), value.get<double>(), 1e-9) << name;
}

// An end before the start, and times of such a run, are not reported as faults beside another fault.
TEST_F(Backward, OnlyWhatIsWrongIsTold) {
  runs::problem_called("lorenz");
  const struct {
    const char *request, *pointer;
  } rows[] = {{R"({"problem":"kepler","initial":{"q":1},"scheme":"leapfrog","until":-1})", "/initial/q"},
              {R"({"problem":"kepler","scheme":"leapfrog","until":-1,"zz":1,"record":{"times":[0,-0.5]}})", "/zz"},
              {R"({"problem":"lorenz","scheme":"contact_splitting","until":-1})", "/scheme"}};
  for (const auto& [request, pointer] : rows) {
    const Reply reply = ask(port(), post("/v1/simulate", request));
    EXPECT_EQ(reply.status, 422) << request;
    const Json errors = Json::parse(reply.body)["errors"];
    ASSERT_EQ(errors.size(), 1U) << errors;
    EXPECT_EQ(errors[0]["pointer"], pointer);
  }
  const Reply reply = ask(port(), post("/v1/simulate", rows[2].request));
  EXPECT_NE(reply.body.find("runs lorenz forward in time alone"), std::string::npos) << reply.body;
}

// There is no factor e^{−∫α} across t = 0 where α = 2/t: no step of a contact scheme crosses it, forward or backward.
TEST_F(Backward, NoContactStepGoesOverAPoleOfTheDamping) {
  const Json typed = Json::parse(R"({"id":"custom","variables":["q"],"potential":"q^2/2","damping":"2/t"})");
  const Json star{{"id", "lane_emden"}, {"after_zero", "signed"}};  // goes on where it would end
  for (const Json& problem : {typed, star})
    for (const char* scheme :
         {"contact_splitting", "contact_leapfrog", "contact_variational_midpoint", "contact_gauss"})
      for (const double start : {1.0, 1.005, 0.006, -1.005}) {
        if (start < 0 && problem == star) continue;  // singular at once, as it says
        const Json run = answer({{"problem", problem},
                                 {"initial", {{"t", start}, {"q", 1}}},
                                 {"scheme", scheme},
                                 {"until", -start},
                                 {"record", {{"every", 0}}}});
        EXPECT_EQ(run["stop"]["reason"], "singular") << problem << scheme << start;
        EXPECT_GT(run["stop"]["t"].get<double>() * start, 0) << problem << scheme << start;
        EXPECT_LT(std::abs(run["stop"]["t"].get<double>()), 0.031) << problem << scheme << start;
      }
}

// A scene that depends on time and on s.
TEST_F(Backward, IsTheSameMotion) {
  const Json problem = Json::parse(R"({"id":"custom","variables":["x"],"parameters":{"c":0.1},
      "lagrangian":"vx^2/2 - x^2/2 + 0.3*x*cos(2*t) - c*s"})");
  Json request = {{"problem", problem},
                  {"initial", {{"x", 1}, {"vx", 0.5}}},
                  {"until", -3},
                  {"columns", {"t", "x", "px", "s", {{"name", "w"}, {"expression", "px*t - s"}}}},
                  {"record", {{"samples", 4}}},
                  {"scheme", "taylor"}};
  request["diagnostics"] = {"energy", "decay", "error"};
  const Json there = answer(request);
  EXPECT_EQ(there["trajectory"]["t"], Json({0, -1, -2, -3}));
  EXPECT_EQ(there["until"]["t"], -3);
  for (std::size_t i = 0; i < 4; ++i) {
    const Json& row = there["trajectory"];
    const double own = row["px"][i].get<double>() * row["t"][i].get<double>() - row["s"][i].get<double>();
    EXPECT_NEAR(row["w"][i], own, 1e-15);
  }
  const Json& found = there["diagnostics"];
  EXPECT_LT(found["decay"]["max_residual"], 1e-11);
  EXPECT_LT(found["error"]["max"], 1e-11);
  EXPECT_LT(found["error"]["max_at"], 0);
  const double gained = found["energy"]["final"].get<double>() - found["energy"]["initial"].get<double>();
  EXPECT_GT(gained, 0.1) << "what damping takes away forward";
  EXPECT_LT(found["energy"]["drift_per_time"].get<double>() * gained, 0) << "the time decreases";

  Json again = return_of(there);
  again["initial"]["s"] = there["trajectory"]["s"][3];
  again["columns"] = {"t", "x", "px", "s"};
  again["record"] = {{"times", {-2, -1, 0}}};
  const Json back = answer(again);
  expect_state(back["final"], there["initial"], 1e-11);
  for (const char* column : {"x", "px", "s"})
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_NEAR(back["trajectory"][column][i], there["trajectory"][column][2 - i], 1e-11) << column;
}

TEST_F(Backward, OfEveryFormAsText) {
  for (const char* scene : {R"~({"variables":["x"],"potential":"x^4/4","damping":"0.2/(1+t^2)"})~",
                            R"~({"variables":["x"],"potential":"x^2/2","action_curvature":"0.3","offset":"0.1"})~",
                            R"~({"variables":["x"],"hamiltonian":"px^2/2 + x^2/2 + 0.1*x*px + 0.2*s*x"})~",
                            R"~({"variables":["a","b"],"lagrangian":"va^2/2*(2+cos(b)) + vb^2/2 - a^2 - b^2/3"})~",
                            R"~({"variables":["a"],"lagrangian":"va^2/2 + 0.2*va*a^2*sin(t) - a^2/2 - 0.1*s*a"})~",
                            R"~({"variables":["a"],"lagrangian":"va^4/4 + va^2/2 - a^2/2"})~",
                            R"~({"variables":["x","y"],"equations":{"x":"y - 0.1*x","y":"-x + 0.2*sin(t)"}})~",
                            R"~({"variables":["q[24]"],
             "hamiltonian":"sum(i=1..24, p[i]^2/2 + q[i]^4/4) + sum(i=1..23, (q[i+1]-q[i])^2/2)"})~"}) {
    Json problem = Json::parse(scene);
    problem["id"] = "custom";
    const std::string first = problem["variables"][0], name = first == "q[24]" ? "q[1]" : first;
    const Json there = answer({{"problem", problem}, {"initial", {{name, 0.8}}}, {"until", -2}, {"scheme", "taylor"}});
    ASSERT_EQ(there["status"], "completed") << scene;
    EXPECT_GT(std::abs(there["final"][name].get<double>() - 0.8), 1e-3) << scene;
    const Json back = answer(return_of(there));
    SCOPED_TRACE(scene);
    expect_state(back["final"], there["initial"], 1e-11);
  }
}

// Answers, and the requests that they echo, are in the run's own time.
TEST_F(Backward, IsToldInEveryForm) {
  Json request = {{"problem", "kepler"}, {"scheme", "leapfrog"}, {"until", {{"t", -2}}}, {"record", {{"samples", 5}}}};
  const Json made = answer(request);
  EXPECT_EQ(made["trajectory"]["t"], Json({0, -0.5, -1, -1.5, -2}));
  EXPECT_NEAR(made["final"]["px"], -0.09637942137646088, 1e-15) << "as by a loop of steps of −h";
  Json echo;
  for (const char* key : {"problem", "initial", "scheme", "until", "record", "columns", "limits", "norm"})
    echo[key] = made[key];
  EXPECT_EQ(answer(echo)["trajectory"], made["trajectory"]);

  const std::string csv = ask(port(), post("/v1/simulate", request.dump(), "Accept: text/csv\r\n")).body;
  EXPECT_NE(csv.find("\n-2,"), std::string::npos) << csv;
  const std::string lines = ask(port(), post("/v1/simulate", request.dump(), "Accept: application/x-ndjson\r\n")).body;
  EXPECT_NE(lines.find(R"("t":[0,-0.5,-1,-1.5,-2])"), std::string::npos) << lines;
  EXPECT_NE(lines.find(R"("final":{"t":-2,)"), std::string::npos) << lines;

  request["record"] = {{"times", {-0.5, -1}}};
  EXPECT_EQ(answer(request)["record"], request["record"]);
  request["record"] = {{"times", {-1, -0.5}}};
  EXPECT_EQ(answer(request, "/v1/simulate", 422)["errors"][0]["pointer"], "/record/times/1");
  request["record"] = {{"times", {0.5}}};
  EXPECT_EQ(answer(request, "/v1/simulate", 422)["errors"][0]["allowed"], "[-2, 0]");
}

TEST_F(Backward, IsChosenAndMeasured) {
  const Json chosen = answer({{"problem", "kepler"},
                              {"scheme", {{"id", "auto"}, {"accuracy", 1e-9}}},
                              {"until", -5},
                              {"diagnostics", {"error"}}});
  EXPECT_EQ(chosen["choice"]["met"], true);
  EXPECT_LT(chosen["diagnostics"]["error"]["final"], 1e-9);
  const Json study =
      answer({{"problem", "kepler"}, {"schemes", {"leapfrog"}}, {"until", {{"t", -5}}}, {"budget_seconds", 2}},
             "/v1/work-precision");
  EXPECT_EQ(study["until"]["t"], -5);
  EXPECT_NEAR(study["curves"][0]["observed_order"], 2, 0.1);
}

// Directions of events are those along the run; what events set is in the scene's own variables.
TEST_F(Backward, HasEventsThatAct) {
  const Json problem = {{"id", "custom"}, {"variables", {"y"}}, {"potential", "y"}};
  Json request = {{"problem", problem}, {"initial", {{"y", 1}, {"vy", 0.3}}}, {"until", -3}, {"scheme", "taylor"}};
  request["events"] = {
      {{"name", "floor"}, {"expression", "y"}, {"direction", "down"}, {"set", {{"vy", "-0.5*vy + 0*t"}}}}};
  const Json made = answer(request);
  ASSERT_FALSE(made["events"].empty());
  const Json& event = made["events"][0];
  const double fall = 0.3 - std::sqrt(0.09 + 2);  // 1 + .3 t − t²/2 = 0
  EXPECT_NEAR(event["t"], fall, 1e-14);
  EXPECT_NEAR(event["state"]["py"], 0.3 - fall, 1e-14);
  EXPECT_NEAR(event["after"]["py"], -0.5 * (0.3 - fall), 1e-14);

  request["events"][0]["direction"] = "up";
  EXPECT_TRUE(answer(request)["events"].empty()) << "it falls as the run goes on";
}

// An event that acts at the end of the run acts, in either direction of time, and does not end the run.
TEST_F(Backward, HasEventsThatActAtTheEnd) {
  for (const double end : {2.0, -2.0}) {
    Json request = {{"problem", {{"id", "custom"}, {"variables", {"x"}}, {"potential", "x^2/2"}}},
                    {"initial", {{"x", 1}}},
                    {"until", end},
                    {"record", {{"samples", 5}}}};
    const std::string kick = end > 0 ? "t-2" : "t+2";
    for (const char* scheme : {"taylor", "leapfrog"}) {
      request["scheme"] = scheme;
      request["events"] = {{{"name", "k"}, {"expression", kick}, {"set", {{"vx", "vx+5"}}}}};
      const Json made = answer(request);
      EXPECT_NEAR(made["final"]["px"], -std::sin(end) + 5, 1e-4) << scheme << end;
      EXPECT_FALSE(made.contains("end")) << scheme << made["end"];
      ASSERT_EQ(made["acts"].size(), 1U) << scheme << end;
      EXPECT_EQ(made["acts"][0]["count"], 1) << scheme << end;
      EXPECT_EQ(made["events"].size(), 1U) << scheme << end;
      EXPECT_EQ(made["trajectory"]["t"].size(), 5U) << scheme << end;
      // Of two events at the same time the second acts on the state that the first has left.
      request["events"].push_back({{"name", "l"}, {"expression", "2*(" + kick + ")"}, {"set", {{"vx", "2*vx"}}}});
      const Json both = answer(request);
      EXPECT_NEAR(both["final"]["px"], 2 * (-std::sin(end) + 5), 1e-4) << scheme << end;
      // An event that stops the run comes before those after it.
      request["events"][0] = {{"name", "stop"}, {"expression", kick}, {"stop", true}};
      const Json stopped = answer(request);
      EXPECT_NEAR(stopped["final"]["px"], -std::sin(end), 1e-4) << scheme << end;
    }
  }
}

// The time where a run stops is its own time.
TEST_F(Backward, StopsAtASingularity) {
  const Json request = {{"problem", {{"id", "custom"}, {"variables", {"x"}}, {"equations", {{"x", "-x^2"}}}}},
                        {"initial", {{"x", 1}}},
                        {"until", -3},
                        {"scheme", "taylor"}};
  const Json made = answer(request);  // x = 1/(1 + t)
  EXPECT_EQ(made["status"], "stopped");
  EXPECT_NEAR(made["stop"]["t"], -1, 1e-6);
  EXPECT_NEAR(made["stop"]["singular_at"], -1, 1e-4);
}

TEST_F(Backward, WarnsInItsOwnTime) {
  runs::problem_called("lorenz");  // or it is skipped
  const Json warned =
      answer({{"problem", "lorenz"}, {"scheme", {{"id", "explicit_midpoint"}, {"step", 0.01}}}, {"until", -0.3}});
  ASSERT_FALSE(warned["warnings"].empty());
  EXPECT_NE(warned["warnings"].dump().find("t = -0."), std::string::npos) << warned["warnings"];
}

// The same holds for the times that `auto` and studies report.
TEST_F(Backward, IsLookedAtInItsOwnTime) {
  Json request = {{"problem", {{"id", "custom"}, {"variables", {"x"}}, {"equations", {{"x", "-x^2"}}}}},
                  {"initial", {{"x", 1}}},
                  {"until", -3}};
  Json chosen = request;
  chosen["scheme"] = {{"id", "auto"}, {"accuracy", 1e-6}};
  const std::string reason = answer(chosen)["choice"]["reason"];
  EXPECT_NE(reason.find("measured up to t = -0.995"), std::string::npos) << reason;
  request["schemes"] = {"runge_kutta_4"};
  const Json study = answer(request, "/v1/work-precision");
  EXPECT_NEAR(study["end"], -0.995, 1e-3);
  EXPECT_EQ(study["left_out"][0], "times after t = -0.995, where the motion nears its end");
}

TEST_F(Backward, IsRefusedByName) {
  const auto fault = [](const Json& request, const char* path = "/v1/simulate") {
    return answer(request, path, 422)["errors"][0];
  };
  EXPECT_EQ(fault({{"problem", "kepler"}, {"scheme", "leapfrog"}, {"until", 0}})["detail"],
            "must differ from the start, t = 0");
  EXPECT_EQ(fault({{"problem", "kepler"}, {"scheme", "leapfrog"}, {"until", -1}, {"columns", {"radius"}}})["pointer"],
            "/columns/0");
  EXPECT_EQ(
      fault({{"problem", "kepler"}, {"scheme", "leapfrog"}, {"until", -1}, {"members", {{"count", 2}, {"seed", 1}}}},
            "/v1/ensemble")["detail"],
      "must be greater than the start, t = 0");
}

}  // namespace
}  // namespace least::server::test
