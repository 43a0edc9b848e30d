// Scenes as text with many variables of a kind, over HTTP: lists in requests and answers, numbers as texts, and the
// places of faults.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "tests/server/client.hpp"
#include "tests/server/faults.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

class Many : public Serving {
 protected:
  static Json run(const Json& request, const char* path = "/v1/simulate") {
    const Reply reply = ask(port(), post(path, request.dump()));
    EXPECT_EQ(reply.status, 200) << reply.body;
    return Json::parse(reply.body);
  }
  static Json faults(const Json& request) {
    const Reply reply = ask(port(), post("/v1/simulate", request.dump()));
    EXPECT_EQ(reply.status, 422) << reply.body;
    return Json::parse(reply.body).at("errors");
  }
  static Json chain() {
    return Json::parse(R"~({"problem":{"id":"custom","variables":["x[n]"],
      "parameters":{"n":4,"alpha":"1/4","m":[1,2,1,"4/2"]},
      "definitions":{"at(i)":"if(i==0,0,x[i])","stretch(i)":"if(i<n,at(i+1),0)-at(i)"},
      "potential":"sum(i=0..n, stretch(i)^2/2+alpha*stretch(i)**3/3)","masses":{"x":"m"}},
      "initial":{"x":[0.7,0,0,"pi/10"],"vx[2]":0.5},"until":{"t":"2*pi"},"scheme":"leapfrog","record":{"samples":3},
      "columns":["t","x[*]",{"name":"kinetic","expression":"sum(i=1..n, px[i]^2/(2*m[i]))"},"energy"]})~");
  }
};

TEST_F(Many, AnswerByTheNamesOfElements) {
  const Json answer = run(chain());
  EXPECT_EQ(answer["status"], "completed");
  EXPECT_EQ(answer["until"]["t"], 2 * std::numbers::pi);
  EXPECT_EQ(answer["initial"]["x[1]"], 0.7);
  EXPECT_EQ(answer["initial"]["x[4]"], std::numbers::pi / 10);
  EXPECT_EQ(answer["initial"]["px[2]"], 1) << "twice its velocity";
  EXPECT_EQ(answer["initial"]["px[1]"], 0) << "what is missing is at rest";
  const Json& columns = answer["trajectory"];
  for (const char* name : {"t", "x[1]", "x[2]", "x[3]", "x[4]", "kinetic", "energy"})
    EXPECT_EQ(columns.at(name).size(), 3U) << name;
  EXPECT_EQ(columns["kinetic"][0], 0.25);
  EXPECT_NE(answer["final"]["x[3]"], 0);
  EXPECT_LT(answer["diagnostics"]["energy"]["max_rel_error"], 1e-4);
}

// As many bodies as the expanded texts have room for: their card, and a run.
TEST_F(Many, AHundredBodiesAreAnswered) {
  Json request = Json::parse(R"~({"problem":{"id":"custom","variables":["x[n]","y[n]","z[n]"],"parameters":{"n":100},
    "potential":"-sum(i=1..n, j=i+1..n, 1/sqrt((x[i]-x[j])^2+(y[i]-y[j])^2+(z[i]-z[j])^2+0.01))"}})~");
  const Json card = run(request, "/v1/problems");
  EXPECT_EQ(card["equations"].size(), 600U);
  for (const char* axis : {"x", "y", "z"}) {
    request["initial"][axis] = Json::array();
    for (int i = 0; i < 100; ++i) request["initial"][axis].push_back(std::sin((7.3 + *axis) * i));
  }
  request.update(Json::parse(R"~({"until":0.01,"scheme":{"id":"leapfrog","step":0.001},"record":{"every":0}})~"));
  const Json answer = run(request);
  EXPECT_EQ(answer["status"], "completed");
  EXPECT_LT(answer["diagnostics"]["energy"]["max_rel_error"], 1e-6);
}

// More than can be expanded: sums stay sums, in cards, runs and their echoes; what needs every term is refused with
// that reason.
TEST_F(Many, FiveHundredBodiesAreAnswered) {
  Json request = Json::parse(R"~({"problem":{"id":"custom","variables":["x[n]","y[n]"],"parameters":{"n":500},
    "potential":"-sum(i=1..n, j=i+1..n, 1/sqrt((x[i]-x[j])^2+(y[i]-y[j])^2+0.01))/n"}})~");
  const Json card = run(request, "/v1/problems");
  EXPECT_EQ(card["equations"]["px[500]"], "…");
  EXPECT_EQ(card["equations_note"], "its sums are too long to be written out term by term");
  for (const char* axis : {"x", "y"}) {
    request["initial"][axis] = Json::array();
    for (int i = 0; i < 500; ++i) request["initial"][axis].push_back(std::sin((7.3 + *axis) * i));
  }
  request.update(Json::parse(R"~({"until":0.04,"scheme":{"id":"leapfrog","step":0.01},"record":{"every":0},
    "columns":["t","energy"]})~"));
  Json first = run(request);
  EXPECT_EQ(first["status"], "completed");
  EXPECT_LT(first["diagnostics"]["energy"]["max_rel_error"], 1e-3);
  Json again;
  for (const char* key : {"problem", "initial", "until", "scheme", "record", "columns"}) again[key] = first[key];
  EXPECT_EQ(run(again)["final"], first["final"]);
  request["scheme"] = "taylor";
  EXPECT_NE(faults(request)[0]["detail"].dump().find("sums of more terms than series are made of"), std::string::npos);
  request["scheme"] = {{"id", "leapfrog"}, {"step", 0.01}};
  request["sensitivities"] = {{"by", Json::array({"/initial/x/0"})}};
  EXPECT_NE(faults(request)[0]["detail"].dump().find("more terms than derivatives"), std::string::npos);
}

// For equations too long for quad precision the reference is a run in double precision, as `reference` says.
TEST_F(Many, ErrorsOfFiftyBodiesAreKnown) {
  Json request = Json::parse(R"~({"problem":{"id":"custom","variables":["x[n]","y[n]"],"parameters":{"n":50},
    "potential":"-sum(i=1..n, j=i+1..n, 1/sqrt((x[i]-x[j])^2+(y[i]-y[j])^2+0.01))/n"},
    "scheme":{"id":"leapfrog","step":0.01},"until":{"t":0.5},"record":{"every":0},"diagnostics":["error"]})~");
  for (const char* axis : {"x", "y"})
    for (int i = 0; i < 50; ++i) request["initial"][axis].push_back(std::sin(7.3 * (i + (*axis == 'x' ? 0 : 50))));
  const Json leap = run(request);
  const Json& error = leap["diagnostics"]["error"];
  EXPECT_EQ(error["reference"], "double precision run");
  EXPECT_LT(error["uncertainty"], 1e-12);
  EXPECT_GT(error["uncertainty"], 0x1p-52) << "of two runs whose roundings are the same";
  request["scheme"] = {{"id", "taylor"}, {"tolerance", 1e-15}};
  request["diagnostics"] = Json::array();
  const Json series = run(request);
  double apart = 0, largest = 1;
  for (const auto& [name, value] : series["final"].items()) {
    if (name == "t") continue;
    apart = std::max(apart, std::abs(value.get<double>() - leap["final"][name].get<double>()));
    largest = std::max(largest, std::abs(value.get<double>()));
  }
  EXPECT_GT(apart, 1e-6);
  EXPECT_NEAR(error["final"].get<double>(), apart / largest, 1e-11);
}

// The echo is the request as it was typed, and leads to the same bytes.
TEST_F(Many, EchoWhatWasTyped) {
  Json first = run(chain());
  EXPECT_EQ(first["problem"]["variables"], Json::parse(R"~(["x[n]"])~"));
  EXPECT_EQ(first["problem"]["parameters"]["m"], Json::parse("[1,2,1,2]"));
  EXPECT_EQ(first["problem"]["definitions"]["at(i)"], "if(i==0,0,x[i])");
  EXPECT_EQ(first["problem"]["masses"]["x"], "m");
  Json again;
  for (const char* key : {"problem", "initial", "until", "scheme", "record", "columns"}) again[key] = first[key];
  Json second = run(again);
  for (Json* answer : {&first, &second}) {
    answer->erase("cost");
    answer->erase("request_id");
  }
  EXPECT_EQ(first.dump(), second.dump());
}

TEST_F(Many, VaryInEnsemblesAndStopAtEvents) {
  Json request = chain();
  request.erase("record");
  request["columns"] = {"x[1]", "px[1]"};
  request["members"] = {
      {"count", 8}, {"vary", {{"/initial/x[2]", {{"uniform", {-1, 1}}}}, {"/problem/m[3]", {{"uniform", {1, 3}}}}}}};
  EXPECT_EQ(run(request, "/v1/ensemble")["completed"], 8);
  request = chain();
  request["events"] =
      Json::parse(R"~([{"name":"back","expression":"stretch(0)-0.1","direction":"down","stop":true}])~");
  const Json answer = run(request);
  EXPECT_EQ(answer["end"]["event"], "back") << answer.dump().substr(0, 2000);
  EXPECT_NEAR(answer["final"]["x[1]"].get<double>(), 0.1, 1e-12);
}

TEST_F(Many, FaultsPointToWhatWasTyped) {
  const auto first = [](const Json& request) { return faults(request).at(0); };
  Json request = chain();
  request["problem"]["definitions"]["stretch(i)"] = "x[i+1]-x[i]";
  EXPECT_EQ(first(request)["pointer"], "/problem/definitions/stretch(i)");
  EXPECT_NE(first(request)["detail"].get<std::string>().find("for i = 0"), std::string::npos);
  request = chain();
  request["initial"]["x"] = {1, 2};
  EXPECT_EQ(first(request)["pointer"], "/initial/x");
  request = chain();
  request["columns"] = {"y[*]"};
  EXPECT_EQ(first(request)["pointer"], "/columns/0");
  request = chain();
  request["columns"] = Json::parse(R"~([{"name":"a","expression":"1+x[n+1]"}])~");
  EXPECT_EQ(first(request)["pointer"], "/columns/0/expression");
  EXPECT_EQ(first(request)["position"], 2);
  request = chain();
  request["problem"]["n"] = 3;
  EXPECT_EQ(first(request)["pointer"], "/problem/masses/x") << "there are as many masses as there were";
  request = chain();
  request["problem"]["variables"] = {"x[1000000000]"};
  EXPECT_EQ(first(request)["pointer"], "/problem/variables/0");
  request = chain();
  request["problem"]["potential"] = "sum(i=1..1000000000, x[1])";
  EXPECT_EQ(first(request)["pointer"], "/problem/potential");
  request = chain();
  request["until"]["t"] = "2*n";
  EXPECT_EQ(first(request)["pointer"], "/until/t") << "numbers know no names";
}

// In a rotating frame the momenta of a body at rest are not zero.
TEST_F(Many, WhatIsMissingIsAtRest) {
  Json request = Json::parse(R"~({"problem":{"id":"custom","variables":["x","y"],
    "lagrangian":"((vx-y)^2+(vy+x)^2)/2"},"initial":{"x":1},"until":{"t":0.5},"scheme":"taylor"})~");
  const Json turning = run(request);
  EXPECT_EQ(turning["initial"]["py"], 1);
  EXPECT_NEAR(turning["final"]["x"].get<double>(), std::cos(0.5) + 0.5 * std::sin(0.5), 1e-10) << "straight ahead";
  request["initial"] = {{"x", 1}, {"px", 0}};
  EXPECT_EQ(run(request)["initial"]["py"], 1) << "y is at rest, whatever is said of x";
  request["initial"] = {{"x", 1}, {"px", 0}, {"py", 0}};
  EXPECT_EQ(run(request)["initial"]["py"], 0);
  request = Json::parse(R"~({"problem":{"id":"custom","variables":["x"],"potential":"0*x","masses":{"x":3}},
    "initial":{"vx":2},"until":{"t":1},"scheme":"leapfrog"})~");
  const Json free = run(request);
  EXPECT_EQ(free["initial"]["px"], 6);
  EXPECT_NEAR(free["final"]["x"].get<double>(), 2, 1e-13);
}

// Each coordinate has a velocity or a momentum. Here p = (2 va + vb cos(a−b), vb + va cos(a−b)).
TEST_F(Many, CoordinatesInVelocitiesStandBesideOthersInMomenta) {
  Json request = Json::parse(R"~({"problem":{"id":"custom","variables":["a","b"],
    "lagrangian":"va^2 + vb^2/2 + va*vb*cos(a-b) + 2*cos(a) + cos(b)"},
    "initial":{"a":1,"b":0.5,"pa":0.7,"vb":0.4},"until":{"t":0.1},"scheme":"taylor"})~");
  const double c = std::cos(0.5), va = (0.7 - 0.4 * c) / 2;
  Json start = run(request)["initial"];
  EXPECT_EQ(start["pa"], 0.7);
  EXPECT_NEAR(start["pb"].get<double>(), 0.4 + va * c, 1e-15);
  request["initial"] = {{"a", 1}, {"b", 0.5}, {"pa", 0.7}};
  EXPECT_NEAR(run(request)["initial"]["pb"].get<double>(), 0.7 / 2 * c, 1e-15) << "what is missing is at rest";
  request["initial"] = {{"a", 1}, {"vb", 0.4}, {"pb", 0.4}};
  const Json fault = faults(request).at(0);
  EXPECT_EQ(fault["pointer"], "/initial/vb");
  EXPECT_NE(fault["detail"].get<std::string>().find("pb exclude each other"), std::string::npos) << fault;
  // Momenta of a hundred coordinates, velocities of a hundred others: one does not change another's.
  request = Json::parse(R"~({"problem":{"id":"custom","variables":["x[100]","y[100]"],
    "lagrangian":"sum(i=1..100, (2*vx[i]^2 + vy[i]^2 - x[i]^2)/2)"},"until":{"t":0.1},"scheme":"taylor"})~");
  request["initial"] = {{"px", Json(std::vector<double>(100, 0.5))}, {"vy", Json(std::vector<double>(100, 3))}};
  start = run(request)["initial"];
  EXPECT_EQ(start["px[100]"], 0.5);
  EXPECT_EQ(start["py[100]"], 3);
}

TEST_F(Many, CountsAreTextsOfConstantsToo) {
  Json request = chain();
  request["until"] = {{"steps", "2*2^2"}};
  request.erase("record");
  const Json answer = run(request);
  EXPECT_EQ(answer["until"]["steps"], 8);
  EXPECT_EQ(answer["cost"]["steps"], 8);
  request["scheme"] = {{"id", "taylor"}, {"order", "4*5"}};
  request["until"] = 1;
  EXPECT_EQ(run(request)["scheme"]["order"], 20);
  for (const char* none : {"5/2", "1/0", "n", "1e300"}) {
    request["until"] = {{"steps", none}};
    EXPECT_EQ(faults(request).at(0)["pointer"], "/until/steps") << none;
  }
}

TEST_F(Many, AnIndexOfASumHasAName) {
  Json request = chain();
  for (const char* twice : {"sum(i=1..n, i=1..n, x[i])", "sum(i=1..n, x[i]*prod(i=1..2, x[i]))"}) {
    request["problem"]["potential"] = twice;
    const Json fault = faults(request).at(0);
    EXPECT_EQ(fault["pointer"], "/problem/potential") << twice;
    EXPECT_EQ(fault["detail"], "i is an index already") << twice;
  }
}

TEST_F(Many, AStartInEquilibriumIsToldWhereNothingMoves) {
  Json request = Json::parse(R"~({"problem":{"id":"custom","variables":["x"],"potential":"x^2/2"},
    "until":{"t":1},"scheme":"leapfrog"})~");
  EXPECT_EQ(run(request)["warnings"][0]["code"], "starts_at_rest_in_equilibrium");
  request["initial"] = {{"vx", 1}};
  EXPECT_EQ(run(request)["warnings"], Json::array());
  request.erase("initial");
  request["problem"]["potential"] = "x^2/2-x*sin(t)";
  EXPECT_EQ(run(request)["warnings"], Json::array()) << "a force that begins at 0 moves it";
}

// A parameter in a condition stays a parameter whatever its value, whole or not.
class Conditions : public Asking {};

TEST_F(Conditions, OnParametersAreSettledByTheirValues) {
  for (const char* bound : {"0.5", "0", "1"})
    for (const double a : {-1.0, 1.0, 1.5, 2.0}) {
      Json request = {{"problem", custom(R"({"variables":["x"],"parameters":{"a":1}})")},
                      {"initial", {{"x", 1}}},
                      {"scheme", "taylor"},
                      {"until", 1},
                      {"sensitivities", {{"by", {"/problem/a"}}}}};
      request["problem"]["potential"] = std::string("if(a > ") + bound + ", x^2/2, 2*x^2)";
      request["problem"]["a"] = a;
      const double frequency = a > std::stod(bound) ? 1 : 2;
      const Json made = answer(request);
      EXPECT_NEAR(made["final"]["x"], std::cos(frequency), 1e-12) << bound << ' ' << a;
      EXPECT_EQ(made["sensitivities"]["final"][0][0], 0) << bound << ' ' << a;
    }
}

}  // namespace
}  // namespace least::server::test
