// Events that act, over HTTP: bounces, kicks, switches and billiards with known motions.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "tests/server/balls.hpp"
#include "tests/server/client.hpp"
#include "tests/server/faults.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

using std::numbers::pi;

class EventsThatAct : public Asking {};

// No ball falls through the floor, whatever part of its speed is kept, however long the run, and wherever the floor is.
TEST_F(EventsThatAct, NoBallFallsThroughTheFloor) {
  for (const double until : {20.0, 40.0, 100.0})
    for (const double floor : {0.0, 1.0, -300.0})
      for (int percent = 30; percent <= 86; percent += 4) {
        const double r = percent / 100.0, limit = std::sqrt(2.0) * (1 + r) / (1 - r);
        Json request = ball(r);
        request["until"] = until;
        request["initial"]["x"] = floor + 1;
        request["problem"]["parameters"]["f"] = floor;
        request["events"][0]["expression"] = "x - f";
        const Json made = answer(request);
        ASSERT_EQ(made["status"], "stopped") << request << made["final"];
        EXPECT_EQ(made["stop"]["reason"], "accumulating_events") << request;
        EXPECT_NEAR(made["stop"]["singular_at"], limit, floor == 0 ? 1e-9 : 1e-5) << request;
        EXPECT_NEAR(made["final"]["x"], floor, 1e-9) << request;
      }
}

// A member that is not a list is refused in the same way as without an event that acts.
TEST_F(EventsThatAct, StandBesideListsAlone) {
  for (const char* key : {"columns", "diagnostics"})
    for (const Json& wrong : {Json("error"), Json("x"), Json(1), Json{{"x", "error"}}}) {
      Json request = ball(0.5);
      request[key] = wrong;
      const Json fault = fault_of(request);
      EXPECT_EQ(fault["pointer"], std::string("/") + key) << wrong;
      EXPECT_TRUE(says(fault, "must be a list")) << fault;
    }
}

// A ball that keeps nothing of its speed stays on the floor: the first bounce is the last, and the run ends there. With
// symplectic_euler the ball arrives without speed once a bounce fits into a step.
TEST_F(EventsThatAct, ABallAtRestOnTheFloorEndsTheRun) {
  for (const char* scheme : {"taylor", "leapfrog", "runge_kutta_4", "dormand_prince_5", "galerkin_4"}) {
    Json request = ball(0);
    request["scheme"] = scheme;
    const Json made = answer(request);
    ASSERT_EQ(made["status"], "stopped") << scheme << made["final"];
    EXPECT_EQ(made["stop"]["reason"], "accumulating_events") << scheme;
    EXPECT_NEAR(made["stop"]["singular_at"], std::sqrt(2.0), 1e-6) << scheme;
    EXPECT_NEAR(made["final"]["x"], 0, 1e-9) << scheme;
    EXPECT_EQ(made["events"].size(), 1U) << scheme;
  }
  for (const double step : {0.01, 0.03, 0.05, 0.11})
    for (const double kept : {0.0, 0.5, 0.8}) {
      Json request = ball(kept);
      request["scheme"] = {{"id", "symplectic_euler"}, {"step", step}};
      const Json made = answer(request);
      ASSERT_EQ(made["status"], "stopped") << request << made["final"];
      EXPECT_EQ(made["stop"]["reason"], "accumulating_events") << request;
      EXPECT_NEAR(made["final"]["x"], 0, 1e-9) << request;
    }
}

// A ball stopped at a ceiling falls down again, and one that is slowed down on its way goes on.
TEST_F(EventsThatAct, WhatIsStoppedWhereItIsDrawnAwayGoesOn) {
  Json thrown = ball(0);
  thrown["until"] = 2;
  thrown["initial"] = {{"x", 0}, {"vx", 1}};
  thrown["events"][0]["expression"] = "x - 0.3";
  thrown["events"][0]["direction"] = "up";
  for (const char* direction : {"up", "both"}) {
    thrown["events"][0]["direction"] = direction;
    const Json made = answer(thrown);
    EXPECT_EQ(made["status"], "completed") << made["stop"];
    EXPECT_EQ(made["acts"][0]["count"], 1);
    const double after = 2 - (1 - std::sqrt(0.4));  // at rest there after 1 − √(1 − 2·.3)
    EXPECT_NEAR(made["final"]["x"], 0.3 - after * after / 2, 1e-9);
  }
  Json slowed = ball(0);
  slowed["until"] = 2;
  slowed["events"][0]["set"] = {{"vx", "0.01*vx"}};
  const Json made = answer(slowed);
  EXPECT_EQ(made["status"], "completed") << made["stop"];
  EXPECT_LT(made["final"]["x"], 0);
}

// A ball that an act puts back to its start, at rest, falls again, as often as time permits.
TEST_F(EventsThatAct, WhatIsTakenElsewhereAtRestGoesOn) {
  for (const char* height : {"1", "10", "0.0001"}) {
    Json request = ball(0);
    request["scheme"] = {{"id", "dormand_prince_5"}, {"tolerance", 1e-11}};
    request["until"] = 60;
    request["events"][0]["set"] = {{"x", height}, {"vx", "0"}};
    const Json made = answer(request);
    EXPECT_EQ(made["status"], "completed") << height << made["stop"];
    EXPECT_GE(made["final"]["x"], 0) << height;
  }
  for (const char* scheme : {"taylor", "leapfrog", "runge_kutta_4", "dormand_prince_5"}) {
    Json request = ball(0);
    request["scheme"] = scheme;
    request["until"] = 10;
    request["events"][0]["set"] = {{"x", "1"}, {"vx", "0"}};
    const Json made = answer(request);
    ASSERT_EQ(made["status"], "completed") << scheme << made["stop"];
    ASSERT_EQ(made["events"].size(), 7U) << scheme;
    const double left = 10 - 7 * std::sqrt(2.0);
    EXPECT_NEAR(made["final"]["x"], 1 - left * left / 2, 1e-6) << scheme;
  }
}

// The n-th bounce is at sqrt(2) (1 + 2 Σ rᵏ), and infinitely many come before sqrt(2) (1 + r)/(1 − r).
TEST_F(EventsThatAct, ABallBouncesAsItIsKnownTo) {
  const double r = 0.8, fall = std::sqrt(2.0), limit = fall * (1 + r) / (1 - r);
  for (const char* scheme :
       {"taylor", "leapfrog", "dormand_prince_5", "runge_kutta_4", "bulirsch_stoer", "galerkin_4"}) {
    Json request = ball(r);
    request["scheme"] = scheme;
    const Json made = answer(request);
    EXPECT_EQ(made["status"], "stopped") << scheme;
    EXPECT_EQ(made["stop"]["reason"], "accumulating_events") << scheme << made["stop"];
    EXPECT_NEAR(made["stop"]["singular_at"], limit, 1e-6) << scheme;
    ASSERT_GT(made["events"].size(), 50U) << scheme;
    double t = fall;
    for (int n = 0; n < 20; ++n) {
      const Json& event = made["events"][std::size_t(n)];
      EXPECT_NEAR(event["t"], t, 1e-7) << scheme << " bounce " << n;
      EXPECT_NEAR(event["after"]["px"].get<double>(), -r * event["state"]["px"].get<double>(), 1e-15) << scheme;
      t += 2 * fall * std::pow(r, n + 1);
    }
    EXPECT_EQ(made["acts"][0]["name"], "floor");
    EXPECT_EQ(made["acts"][0]["keeps"], "none");
    EXPECT_NEAR(made["acts"][0]["defect"], 1 - r * r, 1e-9) << "areas shrink by the square";
    EXPECT_TRUE(made["warnings"].empty()) << made["warnings"];
  }
}

TEST_F(EventsThatAct, ElasticBouncesKeepTheForm) {
  Json request = ball(1);
  request["problem"]["potential"] = "x^2/2";  // half an oscillator
  request["scheme"] = {{"id", "leapfrog"}, {"step", 0.05}};
  request["until"] = "1000*pi";
  request["events"][0]["most"] = 999;
  const Json made = answer(request);
  EXPECT_EQ(made["status"], "completed");
  EXPECT_EQ(made["end"], Json::parse(R"({"event":"floor","count":999})"));
  EXPECT_EQ(made["events"].size(), 999U);
  EXPECT_GT(made["final"]["px"], 0.9) << "after the act";
  EXPECT_NEAR(made["final"]["t"], 998.5 * pi, 1e-3 * 998 * pi);
  EXPECT_LT(made["diagnostics"]["energy"]["max_rel_error"], 2e-3) << "bounded";
  EXPECT_EQ(made["acts"][0]["count"], 999);
  EXPECT_EQ(made["acts"][0]["keeps"], "symplectic");
  EXPECT_LT(made["acts"][0]["defect"], 1e-12);
}

TEST_F(EventsThatAct, WithAnActionTheyKeepTheContactForm) {
  Json request = ball(1);
  request["problem"]["damping"] = 0.1;
  request["scheme"] = {{"id", "contact_leapfrog"}, {"step", 0.01}};
  request["until"] = 10;
  Json made = answer(request);
  EXPECT_EQ(made["status"], "completed");
  EXPECT_GE(made["events"].size(), 3U);
  EXPECT_EQ(made["acts"][0]["keeps"], "contact") << made["acts"];
  request["events"][0]["set"] = {{"vx", "-vx"}, {"s", "s + 1"}};
  request["columns"] = {"t", "s"};
  made = answer(request);
  EXPECT_NEAR(made["events"][0]["after"]["s"].get<double>(), made["events"][0]["state"]["s"].get<double>() + 1, 1e-14);
}

// In a circular billiard every chord is as long as the first; angular momentum and speed are kept.
TEST_F(EventsThatAct, BilliardsReflect) {
  const Json request = Json::parse(R"~({"problem":{"id":"custom","variables":["x","y"],"potential":"0"},
    "initial":{"x":0.5,"y":0,"vx":0.3,"vy":1},"scheme":{"id":"leapfrog","step":0.1},"until":50,
    "record":{"every":0},"diagnostics":["energy"],
    "events":[{"name":"wall","expression":"x^2+y^2-1","direction":"up",
               "set":{"vx":"vx-2*(x*vx+y*vy)*x","vy":"vy-2*(x*vx+y*vy)*y"}}]})~");
  const Json made = answer(request);
  EXPECT_EQ(made["status"], "completed");
  const double speed = std::hypot(0.3, 1.0), momentum = 0.5 * 1, distance = momentum / speed;
  const double chord = 2 * std::sqrt(1 - distance * distance) / speed;
  const Json& hits = made["events"];
  ASSERT_GT(hits.size(), 20U);
  for (std::size_t i = 1; i < hits.size(); ++i)
    EXPECT_NEAR(hits[i]["t"].get<double>() - hits[i - 1]["t"].get<double>(), chord, 1e-12) << i;
  EXPECT_LT(made["diagnostics"]["energy"]["max_abs_error"], 1e-13);
  EXPECT_EQ(made["acts"][0]["keeps"], "symplectic");
  const Json& last = made["final"];
  EXPECT_NEAR(last["x"].get<double>() * last["py"].get<double>() - last["y"].get<double>() * last["px"].get<double>(),
              momentum, 1e-13);
}

TEST_F(EventsThatAct, KicksAndSwitches) {
  // A free rotor that is kicked whenever a clock strikes: p = 1, 3, 5 …
  Json request = Json::parse(R"~({"problem":{"id":"custom","variables":["x"],"potential":"0"},
    "initial":{"vx":1},"scheme":"leapfrog","until":5,"record":{"times":[0.5,1.5,2.5,3.5,4.5]},"columns":["t","x","px"],
    "events":[{"name":"strike","expression":"sin(pi*t)","direction":"both","set":{"vx":"vx+2"}}]})~");
  Json made = answer(request);
  EXPECT_EQ(made["trajectory"]["px"], Json::parse("[1,3,5,7,9]"));
  EXPECT_NEAR(made["trajectory"]["x"][4], 1 + 3 + 5 + 7 + 9 * 0.5, 1e-12);
  // A thermostat switches at 19 and 21: the heating is a variable without a rate.
  request = Json::parse(R"~({"problem":{"id":"custom","variables":["T","on"],
      "equations":{"T":"on*3-(T-15)/4","on":"0"}},
    "initial":{"T":20,"on":1},"scheme":"taylor","until":30,"record":{"every":0},
    "events":[{"name":"warm","expression":"T-21","direction":"up","set":{"on":0}},
              {"name":"cold","expression":"T-19","direction":"down","set":{"on":1}}]})~");
  made = answer(request);
  ASSERT_GT(made["events"].size(), 10U);
  const double up = 4 * std::log((27.0 - 19) / (27 - 21)), down = 4 * std::log((21.0 - 15) / (19 - 15));
  for (std::size_t i = 2; i + 1 < made["events"].size(); ++i) {
    const double wait = made["events"][i]["t"].get<double>() - made["events"][i - 1]["t"].get<double>();
    EXPECT_NEAR(wait, made["events"][i]["name"] == "warm" ? up : down, 1e-10) << i;
  }
  EXPECT_EQ(made["acts"][0]["keeps"], "none");
}

// Into the corner of a box: both walls are met at the same time, and both act, whatever the scheme and their order; an
// event that does not act is reported, too.
TEST_F(EventsThatAct, InOneInstantAllOfThemAct) {
  const auto wall = [](const std::string& x) {
    return Json{{"name", "wall_" + x}, {"expression", x}, {"direction", "down"}, {"set", {{"v" + x, "-v" + x}}}};
  };
  const Json looks_on{{"name", "corner"}, {"expression", "x+y"}, {"direction", "down"}};
  Json request = Json::parse(R"({"problem":{"id":"custom","variables":["x","y"],"potential":"0"},
    "initial":{"x":1,"y":1,"vx":-1,"vy":-1},"until":3,"record":{"every":0}})");
  for (const char* scheme : {"taylor", "leapfrog", "runge_kutta_4", "dormand_prince_5"})
    for (const Json& events : {Json{wall("x"), wall("y"), looks_on}, Json{looks_on, wall("y"), wall("x")}}) {
      request["scheme"] = scheme;
      request["events"] = events;
      const Json made = answer(request);
      EXPECT_EQ(made["status"], "completed") << scheme;
      ASSERT_EQ(made["events"].size(), 3U) << scheme << made["events"];
      for (const Json& event : made["events"]) EXPECT_NEAR(event["t"], 1, 1e-14) << scheme;
      EXPECT_EQ(made["acts"].size(), 2U) << scheme << made["acts"];
      for (const char* name : {"x", "y"}) EXPECT_NEAR(made["final"][name], 2, 1e-12) << scheme;
      for (const char* name : {"px", "py"}) EXPECT_NEAR(made["final"][name], 1, 1e-14) << scheme;
    }
  // Each event acts on the state that the one before has left; one that ends the run does so after those that have
  // acted.
  request["events"] = {wall("x"), wall("y"), {{"name", "over"}, {"expression", "t-1"}, {"stop", true}}};
  request["events"][1]["set"] = {{"vy", "-vy+vx"}};
  const Json made = answer(request);
  EXPECT_EQ(made["end"]["event"], "over") << made["events"];
  EXPECT_NEAR(made["final"]["px"], 1, 1e-14);
  EXPECT_NEAR(made["final"]["py"], 2, 1e-14);
}

// The step in which an event acts is cut short, also in a run that counts its steps: samples reach to the new end.
// Events act in the order of the request, so that one that stops the run keeps those after it from acting.
TEST_F(EventsThatAct, DoNotHappenAfterAnEventThatStopsTheRunThere) {
  for (const char* scheme : {"taylor", "leapfrog", "dormand_prince_5"}) {
    Json request = ball(0.5);
    request["scheme"] = scheme;
    const Json act = request["events"][0], stop{{"name", "there"}, {"expression", "x"}, {"stop", true}};
    request["events"] = {stop, act};
    const Json first = answer(request);
    EXPECT_EQ(first["end"]["event"], "there") << scheme;
    EXPECT_NEAR(first["final"]["t"], std::sqrt(2.0), 1e-9) << scheme;
    EXPECT_NEAR(first["final"]["px"], -std::sqrt(2.0), 1e-9) << scheme;
    request["events"] = {act, stop};
    const Json last = answer(request);
    EXPECT_EQ(last["end"]["event"], "there") << scheme;
    EXPECT_NEAR(last["final"]["px"], std::sqrt(0.5), 1e-9) << scheme;
  }
}

// An echo without events, sent back, gives a run without events, also where the scene has events of its own.
TEST_F(EventsThatAct, ThatAreNotWantedStayAway) {
  Json request{{"problem", "bouncing_ball"}, {"scheme", "leapfrog"}, {"until", 3}, {"events", Json::array()}};
  const Json made = answer(request);
  ASSERT_TRUE(made.contains("events_asked"));
  request["events"] = made["events_asked"];
  EXPECT_EQ(answer(request)["final"], made["final"]);
  EXPECT_LT(made["final"]["x"], -1);
}

TEST_F(EventsThatAct, SamplesOfARunByStepsAreAsManyAsWereAskedFor) {
  Json request = ball(1);
  request["scheme"] = {{"id", "leapfrog"}, {"step", 0.07}};
  request["until"] = {{"steps", 100}};
  request["record"] = {{"samples", 21}};
  const Json made = answer(request);
  ASSERT_GE(made["events"].size(), 2U);
  const Json& t = made["trajectory"]["t"];
  ASSERT_EQ(t.size(), 21U) << t;
  EXPECT_EQ(t[0], 0);
  EXPECT_EQ(t[20], made["final"]["t"]);
  EXPECT_LT(made["final"]["t"], 100 * 0.07 - 1e-3);
  for (std::size_t k = 1; k < t.size(); ++k) {
    EXPECT_LT(t[k - 1], t[k]) << t;
    EXPECT_NEAR(t[k].get<double>() - t[k - 1].get<double>(), 0.35, 0.02) << "nearly evenly";
  }
}

// A scene that an event sets back to 0 has moved.
TEST_F(EventsThatAct, BringBackToZeroWhatDoesNotRest) {
  const Json request = Json::parse(R"~({"problem":{"id":"custom","variables":["x"],"equations":{"x":"1"}},
      "scheme":"taylor","until":2,"record":{"samples":5},
      "events":[{"name":"r","expression":"x-1","set":{"x":"0"}}]})~");
  const Json made = answer(request);
  EXPECT_EQ(made["final"]["x"], 0);
  for (const Json& warning : made["warnings"]) EXPECT_NE(warning["code"], "starts_at_rest_in_equilibrium");
  // Nor is a scene at rest that comes back to 0 by itself.
  Json there_and_back = request;
  there_and_back["problem"]["equations"]["x"] = "if(t<1,1,-1)";
  there_and_back.erase("events");
  there_and_back["scheme"] = {{"id", "explicit_euler"}, {"step", 0.5}};
  const Json back = answer(there_and_back);
  EXPECT_EQ(back["final"]["x"], 0);
  for (const Json& warning : back["warnings"]) EXPECT_NE(warning["code"], "starts_at_rest_in_equilibrium");
}

TEST_F(EventsThatAct, AreEchoedAndChosenFor) {
  Json request = ball(0.5);
  request["until"] = 3;
  request["record"] = {{"samples", 31}};
  const Json made = answer(request);
  EXPECT_EQ(made["trajectory"]["x"].size(), 31U);
  EXPECT_EQ(made["events_asked"][0]["set"], Json::parse(R"({"vx":"-r*vx"})"));
  Json echoed;
  for (const char* key : {"problem", "initial", "scheme", "until", "record", "columns", "limits", "norm"})
    echoed[key] = made[key];
  echoed["events"] = made["events_asked"];
  EXPECT_EQ(answer(echoed)["trajectory"], made["trajectory"]);
  request["scheme"] = {{"id", "auto"}, {"accuracy", 1e-6}};
  const Json chosen = answer(request);
  EXPECT_EQ(chosen["status"], "completed");
  EXPECT_NEAR(chosen["final"]["x"], made["final"]["x"], 1e-5);
  EXPECT_EQ(chosen["events"].size(), made["events"].size());
  // Errors are measured up to the first bounce, and the run says so; a run that ends before it does not.
  const auto says = [](const Json& run) {
    std::string said;
    for (const Json& warning : run["warnings"])
      if (warning["code"] == "judged_before_acts") said = warning["detail"];
    return said;
  };
  EXPECT_NE(says(chosen).find("t = 1.41421, where floor acts"), std::string::npos) << chosen["warnings"];
  EXPECT_EQ(says(made), "");
  request["until"] = 1;
  EXPECT_EQ(says(answer(request)), "");
}

TEST_F(EventsThatAct, SayWhatIsWrong) {
  const auto fault = [](const Json& set, const Json& more = Json::object()) {
    Json request = ball(1);
    request["events"][0]["set"] = set;
    request["events"][0].update(more);
    return answer(request, "/v1/simulate", 422)["errors"][0];
  };
  EXPECT_EQ(fault({{"vy", "1"}})["pointer"], "/events/0/set/vy");
  EXPECT_EQ(fault({{"vx", "-vy"}})["position"], 1);
  EXPECT_EQ(fault({{"vx", "1"}, {"px", "1"}})["pointer"], "/events/0/set");
  EXPECT_EQ(fault(Json::array())["pointer"], "/events/0/set");
  EXPECT_EQ(fault({{"vx", true}})["pointer"], "/events/0/set/vx");
  EXPECT_EQ(fault({{"vx", "-vx"}}, {{"most", 0}})["pointer"], "/events/0/most");
  Json request = ball(1);
  request["events"][0].erase("set");
  request["events"][0]["most"] = 3;
  EXPECT_EQ(answer(request, "/v1/simulate", 422)["errors"][0]["pointer"], "/events/0/most");
  request = ball(1);
  request["diagnostics"] = {"energy", "error"};
  EXPECT_EQ(answer(request, "/v1/simulate", 422)["errors"][0]["pointer"], "/diagnostics/1");
  request.erase("diagnostics");
  request["columns"] = {"t", "x", "error"};
  EXPECT_EQ(answer(request, "/v1/simulate", 422)["errors"][0]["pointer"], "/columns/2");
  request = ball(1);
  request["events"][0]["set"] = {{"vx", "1/x"}};
  const Json made = answer(request);
  EXPECT_TRUE(made["status"] == "completed" || made["stop"]["reason"] == "not_finite") << made["stop"];
}

}  // namespace
}  // namespace least::server::test
