// Ensembles over HTTP: faults by name, and lines that add up to the answer.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>

#include "core/catalogue/catalogue.hpp"
#include "server/decode/ensemble_request.hpp"
#include "tests/server/client.hpp"
#include "tests/server/ensembles.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

using EnsembleHttp = Serving;

// faults_of() returns pointers and details of the faults of a request that differs from a good one in one member.
std::string faults_of(const std::string& member, const Json& value) {
  Json request = Json::parse(
      R"({"problem":"kepler","scheme":"leapfrog","members":{"count":10,"vary":{"/initial/x":{"uniform":[0,1]}}}})");
  request[member] = value;
  const auto plan = decode_ensemble(std::move(*parse_json(request.dump())), catalogue_cards(), {});
  std::string all;
  if (plan) return all;
  for (const Fault& fault : plan.error().list())
    all += fault.pointer + ": " + fault.detail + "; " + fault.allowed + "\n";
  return all;
}
void expect_fault(const std::string& member, const std::string& value, std::string_view pointer,
                  std::string_view words) {
  const std::string faults = faults_of(member, Json::parse(value));
  EXPECT_NE(faults.find(std::string(pointer) + ": "), std::string::npos) << value << "\n" << faults;
  EXPECT_NE(faults.find(words), std::string::npos) << value << "\n" << faults;
}

TEST(EnsembleRequest, AllowsWhatMembersCanHave) {
  for (const char* const unknown : {R"("contact_leap")", R"({"id":"taylorr"})", "7"}) {
    const std::string faults = faults_of("scheme", Json::parse(unknown));
    EXPECT_NE(faults.find("leapfrog"), std::string::npos) << faults;
    for (const char* const refused : {"taylor\"", "taylor,", "variational_midpoint", "fehlberg_78", "auto"})
      EXPECT_EQ(faults.find(refused), std::string::npos) << faults;
  }
  expect_fault("scheme", R"({"id":"auto","accuracy":1e-6})", "/scheme", "one scheme in common");
  for (const char* const unknown : {R"(["xx"])", R"([])", R"("energy")"}) {
    const std::string faults = faults_of("columns", Json::parse(unknown));
    EXPECT_NE(faults.find("energy"), std::string::npos) << faults;
    EXPECT_EQ(faults.find("step_size"), std::string::npos) << faults;
  }
}

TEST(EnsembleRequest, NamesEveryFault) {
  EXPECT_EQ(faults_of("keep", Json::array({"statistics", "final"})), "");
  const auto vary = [](const std::string& what) { return R"({"count":10,"vary":{)" + what + "}}"; };
  const std::string of_x = "/members/vary/~1initial~1x";
  expect_fault("members", "7", "/members", "must be an object");
  expect_fault("members", R"({"count":0})", "/members/count", "at least 1");
  expect_fault("members", R"({})", "/members/count", "is required where no grid");
  expect_fault("members", R"({"count":-2,"vary":{"/initial/xx":{"uniform":[0,1]}}})", "/members/count", "at least 1");
  expect_fault("members", vary(R"("/initial/xx":{"uniform":[0,1]})"), of_x + "x", "did you mean \"/initial/x\"");
  expect_fault("members", vary(R"("/initial/t":{"uniform":[0,1]})"), "/members/vary/~1initial~1t", "the same time");
  expect_fault("members", vary(R"("/scheme/step":{"uniform":[0,1]})"), "/members/vary/~1scheme~1step", "the scheme");
  expect_fault("members", vary(R"("/initial/x":{"uniform":[1,0]})"), of_x + "/uniform", "goes the wrong way");
  expect_fault("members", vary(R"("/initial/x":{"grid":[1,0,10]})"), of_x + "/grid", "goes the wrong way");
  expect_fault("members", vary(R"("/initial/x":{"grid":[0,1,2.5]})"), of_x + "/grid/2", "whole number");
  expect_fault("members", vary(R"("/initial/x":{"grid":[0,1,11]})"), "/members/count", "make 11 members");
  const std::string drawn_too = R"("/initial/y":{"uniform":[-4,-3]},"/initial/x":{"grid":[0,1,11]})";
  expect_fault("members", vary(drawn_too), "/members/count", "11 or more");
  expect_fault("members", vary(R"("/initial/x":{"uniform":[1]})"), of_x + "/uniform", "list of numbers");
  expect_fault("members", vary(R"("/initial/x":{"gauss":[1]})"), of_x + "/gauss", "unknown variation");
  expect_fault("members", vary(R"("/initial/x":{"normal":[0,-1]})"), of_x + "/normal/1", "greater than 0");
  expect_fault("members", vary(R"("/problem/mu":{"normal":[1,0.1]})"), "/members/vary/~1problem~1mu/normal", "reaches");
  expect_fault("members", vary(R"("/problem/mu":{"values":[1,1e299]})"), "/members/vary/~1problem~1mu/values/1",
               "at most");
  expect_fault("members", R"({"vary":{"/initial/x":{"grid":[0,1,1e9]},"/initial/y":{"grid":[0,1,1e9]}}})",
               "/members/vary", "more than can be counted");
  expect_fault("scheme", R"("variational_midpoint")", "/scheme", "solves equations");
  expect_fault("scheme", R"("time_transformed")", "/scheme", "own clock");
  expect_fault("scheme", R"("contact_leapfrog")", "/scheme", "cannot run kepler");
  expect_fault("range", "[5,5]", "/range", "none of members");
  expect_fault("range", "[0,11]", "/range", "none of members");
  expect_fault("keep", R"(["section"])", "/section", "is required");
  expect_fault("keep", R"(["finals"])", "/keep/0", "did you mean \"final\"");
  expect_fault("section", R"({"period":-1})", "/section/period", "greater than 0");
  expect_fault("section", R"({"period":1,"phase":1e17})", "/section/phase", "too many periods");
  expect_fault("section", R"({"period":1e-20})", "/section/period", "more than 1e9 times");
  expect_fault("section", R"({"expression":"r"})", "/section/expression", "unknown name r");
  expect_fault("section", R"({"expression":"x*"})", "/section/expression", "ends");
  expect_fault("section", R"({"expression":7})", "/section/expression", "must be a string");
  expect_fault("section", R"({"expression":"x","direction":"left"})", "/section/direction", "unknown direction");
  expect_fault("section", R"({"phase":1})", "/section", "either period or expression");
  expect_fault("columns", R"(["x","step_size"])", "/columns/1", "does not follow from a final state");
  const auto own = [](const std::string& name, const std::string& text) {
    return R"(["x",{"name":")" + name + R"(","expression":")" + text + R"("}])";
  };
  expect_fault("columns", own("r", "sqrt(x^2+"), "/columns/1/expression", "ends");
  expect_fault("columns", own("r", "xx"), "/columns/1/expression", "unknown name xx");
  expect_fault("columns", own("index", "x"), "/columns/1/name", "something else");
  expect_fault("columns", own("x", "x"), "/columns/1/name", "name of a column");
  expect_fault("histograms", R"({"x":{"range":[1,0],"bins":3}})", "/histograms/x/range", "lower first");
  expect_fault("histograms", R"({"energy":{"range":[0,1],"bins":3}})", "/histograms/energy", "unknown key");
  expect_fault("record", R"({"every":-1})", "/record/every", "must be");
  expect_fault("histograms", R"({"x":{"range":[-1.7e308,1.7e308],"bins":3}})", "/histograms/x/range", "wider");
  Json large = Json::parse(R"({"problem":"kepler","scheme":"leapfrog","keep":["final"]})");
  large["members"] = {{"count", 1000000000000}};
  const auto plan = decode_ensemble(std::move(*parse_json(large.dump())), catalogue_cards(), {});
  ASSERT_FALSE(plan);
  EXPECT_EQ(plan.error().list().at(0).pointer, "/keep");
}

// A refused column has no card: other members that name it are not examined, and the request is refused without a
// crash.
TEST_F(EnsembleHttp, RefusedColumnsAreNamedWhateverElseIsAsked) {
  Json request = Json::parse(orbits);
  request["columns"].push_back({{"name", "mean"}, {"expression", "1/0"}});
  request["histograms"]["mean"] = {{"range", {0, 1}}, {"bins", 2}};
  const auto reply = ask(port(), post("/v1/ensemble", request.dump()));
  EXPECT_EQ(reply.status, 422) << reply.body;
  EXPECT_NE(reply.body.find("/columns/4/expression"), std::string::npos) << reply.body;
  EXPECT_EQ(reply.body.find("/histograms"), std::string::npos) << reply.body;
  request["histograms"]["x"]["range"] = {1, 0};  // further faults are named, too
  const auto both = ask(port(), post("/v1/ensemble", request.dump()));
  EXPECT_NE(both.body.find("/columns/4/expression"), std::string::npos) << both.body;
  EXPECT_NE(both.body.find("/histograms/x/range"), std::string::npos) << both.body;
  const auto run = ask(port(), post("/v1/simulate", R"({"problem":{"id":"kepler","mu":0.2},"scheme":"leapfrog",
      "columns":[{"name":"a","expression":"sqrt(mu-1/3)+0*x"},"error"],"record":{"curve":20}})"));
  EXPECT_EQ(run.status, 422) << run.body;
}
// Where a parameter varies its common value is not used.
TEST_F(EnsembleHttp, AnExpressionIsThatOfEachMember) {
  Json request = Json::parse(R"({"problem":{"id":"kepler","mu":0.2},"scheme":"leapfrog","until":{"t":1},
      "members":{"vary":{"/problem/mu":{"values":[0.5,0.2,2]}}},"keep":["final"],
      "columns":[{"name":"a","expression":"sqrt(mu-1/3)+0*x"},{"name":"b","expression":"mu"}]})");
  const auto reply = ask(port(), post("/v1/ensemble", request.dump()));
  ASSERT_EQ(reply.status, 200) << reply.body;
  const Json final = Json::parse(reply.body)["final"];
  EXPECT_EQ(final["b"], Json::array({0.5, 0.2, 2.0}));
  EXPECT_TRUE(final["a"][1].is_null());
  EXPECT_NEAR(final["a"][2].get<double>(), std::sqrt(5 / 3.0), 1e-15);
}

TEST_F(EnsembleHttp, TheAnswerIsARequestThatGivesIt) {
  const auto reply = ask(port(), post("/v1/ensemble", orbits));
  ASSERT_EQ(reply.status, 200) << reply.body;
  const Json answer = Json::parse(reply.body);
  EXPECT_EQ(answer["status"], "completed");
  EXPECT_EQ(answer["completed"], 9000);
  EXPECT_EQ(answer["final"]["index"].size(), 9000u);
  EXPECT_EQ(answer["section"]["member"].size(), 18000u);
  for (const char* column : {"x", "y", "energy", "r"}) {
    double sum = 0;
    for (const auto& x : answer["final"][column]) sum += x.get<double>();
    EXPECT_NEAR(answer["statistics"][column]["mean"].get<double>(), sum / 9000, 1e-12) << column;
  }
  std::int64_t counted =
      answer["histograms"]["x"]["below"].get<std::int64_t>() + answer["histograms"]["x"]["above"].get<std::int64_t>();
  for (const auto& n : answer["histograms"]["x"]["counts"]) counted += n.get<std::int64_t>();
  EXPECT_EQ(counted, 9000);
  Json again;
  for (const char* key : {"problem", "initial", "scheme", "until", "limits", "members", "range", "columns", "keep",
                          "section", "histograms"})
    again[key] = answer[key];
  for (const char* key : {"member", "crossing", "t", "x", "y", "energy"}) again["section"].erase(key);  // `r` may stay
  EXPECT_EQ(without_cost(ask(port(), post("/v1/ensemble", again.dump())).body), without_cost(reply.body));
}

// numbers_in() returns a column of a CBOR answer: a typed array of binary64, little endian.
std::vector<double> numbers_in(const Json& column) {
  const auto& bytes = column.get_binary();
  EXPECT_EQ(bytes.subtype(), 86u);
  std::vector<double> numbers(bytes.size() / sizeof(double));
  std::memcpy(numbers.data(), bytes.data(), bytes.size());
  return numbers;
}
TEST_F(EnsembleHttp, BinaryHoldsTheSameNumbers) {
  const Json whole = without_cost(ask(port(), post("/v1/ensemble", orbits)).body);
  const auto reply = ask(port(), post("/v1/ensemble", orbits, "Accept: application/cbor\r\n"));
  ASSERT_EQ(reply.status, 200);
  EXPECT_EQ(reply.fields.at("content-type"), "application/cbor");
  Json binary = Json::from_cbor(reply.body, true, true, Json::cbor_tag_handler_t::store);
  binary.erase("cost");
  for (const auto& [part, columns] :
       {std::pair<const char*, std::vector<const char*>>{"final", {"x", "y", "energy", "r"}},
        {"section", {"t", "x", "y", "energy", "r"}}}) {
    for (const char* column : columns) binary[part][column] = numbers_in(binary[part][column]);
  }
  EXPECT_EQ(binary, whole);
}

// The points of a section are the events of the runs of its members, whether these move in lanes or not. Each request
// has one variation, by `values`.
TEST_F(EnsembleHttp, SectionsAreTheEventsOfTheirMembers) {
  const std::string well = R"({"id":"custom","variables":["x"],"parameters":{"alpha":0.1},)"
                           R"("lagrangian":"vx^2/2 + x^2/2 - x^4/4 - alpha*s"})";
  struct Case {
    std::string problem, scheme, vary, expression, direction;
    double end;
  };
  const std::vector<Case> cases{
      {R"("kepler")", R"({"id":"leapfrog","step":0.02})", R"({"/initial/x":[0.5,0.7,0.9]})", "x - 0.1", "up", 30},
      {R"("kepler")", R"({"id":"leapfrog","step":0.02})", R"({"/initial/x":[0.5,0.7,0.9]})", "x*px + y*py", "both", 30},
      {R"("kepler")", R"({"id":"ruth_3","step":0.02})", R"({"/initial/x":[0.5,0.7]})", "sin(3*t) - y/mu", "down", 20},
      {R"("kepler")", R"({"id":"leapfrog","step":0.02})", R"({"/problem/mu":[0.8,1.1]})", "mu*x - y/3", "up", 30},
      {R"("damped_oscillator")", R"({"id":"contact_splitting","step":0.1})", R"({"/initial/q":[1,2]})", "energy - 0.4",
       "down", 20},
      {R"("damped_oscillator")", R"({"id":"contact_splitting","step":0.1})", R"({"/initial/q":[1,2]})", "s - 0.01*q",
       "both", 20},
      {R"("spin_orbit")", R"({"id":"contact_splitting","step":0.1})", R"({"/initial/q":[0,2]})", "sin(q - t)", "up",
       60},
      {R"({"id":"lane_emden","n":1})", R"({"id":"contact_splitting","step":0.01})", R"({"/problem/n":[1,2]})",
       "q - 0.5", "down", 3},
      {R"("van_der_pol")", R"({"id":"contact_splitting","step":0.05})", R"({"/problem/epsilon":[1,2]})", "x", "up", 40},
      {well, R"({"id":"contact_splitting","step":0.05})", R"({"/initial/x":[2,1.5]})", "x - 0.9", "both", 40},
      {well, R"({"id":"contact_splitting","step":0.05})", R"({"/problem/alpha":[0.05,0.2]})", "px - alpha*x", "down",
       40},
  };
  for (const auto& [problem, scheme, vary, expression, direction, end] : cases) {
    const Json varied = Json::parse(vary), scene = Json::parse(problem);
    const std::string& pointer = varied.begin().key();
    const std::string id = (scene.is_object() ? scene["id"] : scene).get<std::string>(), name = id + ": " + expression;
    if (id != "custom" && !find_problem(id)) continue;  // left out of this build
    const Json initial = Json::parse(name.starts_with("kepler")   ? R"({"x":0.6,"y":0,"px":0,"py":1.2})"
                                     : name.starts_with("custom") ? R"({"x":2})"
                                                                  : "{}");
    Json request{{"problem", scene},
                 {"initial", initial},
                 {"scheme", Json::parse(scheme)},
                 {"until", {{"t", end}}},
                 {"members", {{"vary", {{pointer, {{"values", varied.begin().value()}}}}}}},
                 {"keep", {"section"}},
                 {"section", {{"expression", expression}, {"direction", direction}}}};
    const Json section = Json::parse(ask(port(), post("/v1/ensemble", request.dump())).body)["section"];
    ASSERT_TRUE(section.contains("t")) << name;
    std::size_t at = 0;
    for (std::size_t member = 0; member < varied.begin().value().size(); ++member) {
      Json alone{{"problem", scene.is_object() ? scene : Json{{"id", scene}}},
                 {"initial", initial},
                 {"scheme", request["scheme"]},
                 {"until", request["until"]},
                 {"record", {{"every", 0}}},
                 {"events", {{{"name", "cut"}, {"expression", expression}, {"direction", direction}}}}};
      alone[Json::json_pointer(pointer)] = varied.begin().value()[member];
      const Json events = Json::parse(ask(port(), post("/v1/simulate", alone.dump())).body)["events"];
      EXPECT_GT(events.size(), 0u) << name;
      std::size_t crossing = 0;
      for (const Json& event : events) {
        ASSERT_LT(at, section["t"].size()) << name;
        EXPECT_EQ(section["member"][at], member) << name;
        EXPECT_EQ(section["crossing"][at], crossing++) << name;
        EXPECT_NEAR(section["t"][at].get<double>(), event["t"].get<double>(), 1e-10) << name;
        for (const auto& [variable, value] : event["state"].items()) {
          if (!section.contains(variable)) continue;
          EXPECT_NEAR(section[variable][at].get<double>(), value.get<double>(), 1e-10) << name << ", " << variable;
        }
        ++at;
      }
    }
    EXPECT_EQ(at, section["t"].size()) << name;
  }
}

TEST_F(EnsembleHttp, LinesAddUpToTheAnswer) {
  const Json whole = without_cost(ask(port(), post("/v1/ensemble", orbits)).body);
  const auto reply = ask(port(), post("/v1/ensemble", orbits, "Accept: application/x-ndjson\r\n"));
  ASSERT_EQ(reply.status, 200);
  EXPECT_GT(reply.chunks.size(), 2 + 3U) << "a line of many numbers is never in memory as a whole";
  std::vector<Json> lines;
  std::istringstream text(reply.body);
  for (std::string line; std::getline(text, line);) lines.push_back(Json::parse(line));
  ASSERT_EQ(lines.size(), 2 + 3u) << "a block has 4,096 members";
  EXPECT_EQ(lines.front()["members"], whole["members"]);
  for (const char* key : {"statistics", "histograms", "completed", "status", "warnings"})
    EXPECT_EQ(lines.back()[key], whole[key]) << key;
  for (const char* part : {"final", "section"}) {
    for (const auto& [key, value] : whole[part].items()) {
      if (!value.is_array()) continue;
      Json joined = Json::array();
      for (std::size_t i = 1; i + 1 < lines.size(); ++i)
        for (const auto& x : lines[i][part][key]) joined.push_back(x);
      EXPECT_EQ(joined, value) << part << " " << key;
    }
  }
}

TEST_F(EnsembleHttp, WarnsInEveryForm) {
  Json request = Json::parse(orbits);
  request["scheme"]["step"] = 0.9;
  request["until"]["t"] = 60;
  request["keep"] = {"statistics"};
  request.erase("section");
  const auto codes = [](const Json& answer) {
    std::vector<std::string> all;
    for (const Json& warning : answer["warnings"]) all.push_back(warning["code"]);
    return all;
  };
  const auto whole = codes(Json::parse(ask(port(), post("/v1/ensemble", request.dump())).body));
  EXPECT_NE(std::ranges::find(whole, "large_error"), whole.end());
  const std::string lines = ask(port(), post("/v1/ensemble", request.dump(), "Accept: application/x-ndjson\r\n")).body;
  EXPECT_EQ(codes(Json::parse(lines.substr(lines.rfind("\n{") + 1))), whole);
}

// The same as for single runs, in every form; the first member is so near the origin that the expression changes
// slowly.
TEST_F(EnsembleHttp, SaysOfWhichMembersEventsAreUnresolved) {
  const std::string request =
      R"({"problem": "harmonic_oscillator", "scheme": "leapfrog", "until": {"t": 3}, "columns": ["q"],
          "section": {"expression": "sin(1e9*q) - 0.5", "direction": "both"}, "keep": ["section"], "limits": {"samples": 100},
          "members": {"count": 3, "seed": 1, "vary": {"/initial/q": {"values": [1e-9, 1, 2]}}}})";
  const auto told = [](const Json& answer) {
    for (const Json& warning : answer["warnings"])
      if (warning["code"] == "events_unresolved") return warning["detail"].get<std::string>();
    return std::string();
  };
  const std::string whole = told(Json::parse(ask(port(), post("/v1/ensemble", request)).body));
  EXPECT_NE(whole.find("2 members"), std::string::npos) << whole;
  EXPECT_NE(whole.find("the first is member 1"), std::string::npos) << whole;
  const std::string lines = ask(port(), post("/v1/ensemble", request, "Accept: application/x-ndjson\r\n")).body;
  EXPECT_EQ(told(Json::parse(lines.substr(lines.rfind("\n{") + 1))), whole);
}

// Members for which a column is not finite are left out of its statistics, and the answer tells their number.
TEST_F(EnsembleHttp, SaysForHowManyMembersAColumnIsNotFinite) {
  Json counted = Json::parse(R"~({"problem": "harmonic_oscillator", "scheme": "leapfrog", "until": 1,
      "columns": ["q", {"name": "l", "expression": "log(q)"}], "histograms": {"l": {"range": [-5, 5], "bins": 1}},
      "keep": ["final"], "members": {"vary": {"/initial/q": {"values": [-3, -2, -1, 1]}}}})~");
  Json with_statistics = counted, without = counted;
  with_statistics["keep"] = {"statistics", "final"};
  without.erase("histograms");
  const auto told = [&](const Json& asked) {
    std::vector<std::string> all;
    const Json answer = Json::parse(ask(port(), post("/v1/ensemble", asked.dump())).body);
    EXPECT_EQ(answer["completed"], 4);
    for (const Json& warning : answer["warnings"])
      if (warning["code"] == "values_not_finite") all.push_back(warning["detail"]);
    return all;
  };
  for (const Json& asked : {with_statistics, counted}) {
    const auto all = told(asked);
    ASSERT_EQ(all.size(), 1U);
    EXPECT_EQ(all[0].find("l is not a finite number for 3 of the 4 members"), 0U) << all[0];
  }
  EXPECT_TRUE(told(without).empty()) << "final states have their nulls";
}

// The limit counts numbers: the time of a point and its other columns, as the sections of single runs do.
TEST_F(EnsembleHttp, SectionsHaveRoomForAsManyNumbersAsTheLimitSays) {
  Json request = Json::parse(
      R"({"problem": "harmonic_oscillator", "scheme": "leapfrog", "until": 100, "keep": ["section"], "section": {"period": 0.1},
          "columns": [], "limits": {"samples": 1000}})");
  for (int k = 0; k < 9; ++k)
    request["columns"].push_back({{"name", "c" + std::to_string(k)}, {"expression", "q+" + std::to_string(k)}});
  Json alone = request;
  alone.erase("keep");
  request["members"] = {{"count", 2}, {"vary", Json::object()}};
  const Json many = Json::parse(ask(port(), post("/v1/ensemble", request.dump())).body);
  EXPECT_EQ(many["section"]["t"].size(), 100U) << many.dump().substr(0, 300);
  EXPECT_NE(many["warnings"].dump().find("section_truncated"), std::string::npos);
  EXPECT_EQ(Json::parse(ask(port(), post("/v1/simulate", alone.dump())).body)["section"]["t"].size(), 100U);
}

// The example of the contract: members beyond the product of grids and values go through it again, with their own
// draws.
TEST_F(EnsembleHttp, GridsAreGoneThroughAgainWhereSomethingIsDrawn) {
  const std::string request =
      R"({"problem": {"id": "custom", "variables": ["q"], "parameters": {"k": 1, "alpha": 0}, "potential": "k*q^2/2",
                      "damping": "alpha"},
          "scheme": "contact_leapfrog", "until": {"t": 0.01}, "columns": ["q", "p"], "keep": ["final"],
          "members": {"count": 20, "seed": 7, "vary": {"/initial/q": {"uniform": [-1, 1]},
            "/problem/alpha": {"grid": [0, 1, 3]}, "/problem/k": {"values": [1, 2]}}}})";
  const Json answer = Json::parse(ask(port(), post("/v1/ensemble", request)).body);
  ASSERT_EQ(answer["completed"], 20) << answer;
  // The motion is linear: from rest p/q shows which parameters a member has, and q which start.
  const std::vector<double> q = answer["final"]["q"], p = answer["final"]["p"];
  for (std::size_t i = 0; i + 6 < q.size(); ++i) {
    EXPECT_NEAR(p[i + 6] / q[i + 6], p[i] / q[i], 1e-15) << i;
    EXPECT_GT(std::abs(p[i + 1] / q[i + 1] - p[i] / q[i]), 1e-3) << i;
    EXPECT_GT(std::abs(q[i + 6] - q[i]), 1e-6) << i;
  }
}

TEST_F(EnsembleHttp, ALimitOfTimeIsNamed) {
  Json request = Json::parse(orbits);
  request["until"]["t"] = 1e5;
  request["limits"] = {{"seconds", 0.1}};
  const Json answer = Json::parse(ask(port(), post("/v1/ensemble", request.dump())).body);
  EXPECT_EQ(answer["status"], "stopped");
  EXPECT_EQ(answer["stop"]["reason"], "deadline");
}

}  // namespace
}  // namespace least::server::test
