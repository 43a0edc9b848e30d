// Trajectories of the members of an ensemble: they equal single runs, in every form, within the limits.
#include <gtest/gtest.h>

#include <cstring>
#include <sstream>

#include "server/decode/json_parse.hpp"
#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

class Trajectories : public Asking {
 protected:
  static Reply reply(const Json& request, const std::string& accept = {}) {
    return Asking::reply(request, "/v1/ensemble", accept);
  }
  static Json answer(const Json& request, const char* path = "/v1/ensemble") { return Asking::answer(request, path); }
  static Json fault(const Json& request) {
    const Reply made = reply(request);
    EXPECT_EQ(made.status, 422) << made.body.substr(0, 300);
    return Json::parse(made.body)["errors"][0];
  }
  /// expect_runs_of_members() compares the ensemble with a run of each member, whose initial x varies.
  static void expect_runs_of_members(Json request) {
    const Json all = answer(request);
    const Json vary = request["members"]["vary"]["/initial/x"]["values"];
    ASSERT_EQ(all["trajectories"]["member"].size(), vary.size());
    for (const char* key : {"members", "keep"}) request.erase(key);
    for (std::size_t m = 0; m < vary.size(); ++m) {
      request["initial"]["x"] = vary[m];
      const Json one = answer(request, "/v1/simulate");
      EXPECT_EQ(all["trajectories"]["member"][m], m);
      for (const auto& [name, column] : one["trajectory"].items())
        EXPECT_EQ(all["trajectories"][name][m], column) << name << " of member " << m << ", " << request["record"];
    }
  }
};

Json orbits_of(const Json& record) {
  Json request = Json::parse(R"({"problem":"kepler","initial":{"y":0,"px":0,"py":1.1},
      "scheme":{"id":"leapfrog","step":0.05},"until":{"t":4.02},"columns":["t","x","py","energy"],
      "members":{"vary":{"/initial/x":{"values":[0.8,1,1.3]}}},"keep":["trajectories"]})");
  if (!record.is_null()) request["record"] = record;
  return request;
}

TEST_F(Trajectories, AreRunsByThemselves) {
  for (const char* record :
       {R"({"every":7})", R"({"every":1})", R"({"samples":10})", R"({"times":[0,0.05,1.01,4.02]})", "null"})
    expect_runs_of_members(orbits_of(Json::parse(record)));
  Json whole = orbits_of({{"every", 20}});
  whole["until"] = {{"t", 4}};  // the last step ends there
  expect_runs_of_members(whole);
  whole["until"] = {{"steps", 61}};
  expect_runs_of_members(whole);
  whole["limits"] = {{"steps", 50}};
  expect_runs_of_members(whole);
}

// Members that stop earlier have fewer rows, or none.
TEST_F(Trajectories, OfMembersThatStop) {
  Json request = {{"problem", {{"id", "custom"}, {"variables", {"x"}}, {"equations", {{"x", "x^2"}}}}},
                  {"scheme", {{"id", "explicit_euler"}, {"step", 0.01}}},
                  {"until", 3},
                  {"columns", {"t", "x"}},
                  {"record", {{"every", 30}}},
                  {"keep", {"trajectories", "final"}}};
  request["members"]["vary"]["/initial/x"]["values"] = {0.2, 1, 1e80, 0.5, -1};
  const Json all = answer(request);
  expect_runs_of_members(request);
  const auto rows = [&](std::size_t m) { return all["trajectories"]["x"][m].size(); };
  EXPECT_EQ(rows(0), 11u);
  EXPECT_LT(rows(1), 10u);
  EXPECT_GT(rows(1), 2u);
  EXPECT_LT(rows(2), 2u);
  EXPECT_EQ(rows(4), 11u);
  EXPECT_EQ(all["final"]["index"], Json({0, 4}));

  request = Json::parse(R"({"problem":{"id":"custom","variables":["x"],"parameters":{"m":1},"potential":"x^2/2",
      "masses":{"x":"m"}},"initial":{"x":1},"scheme":"leapfrog","until":1,"record":{"samples":3},
      "keep":["trajectories"],"members":{"vary":{"/problem/m":{"values":[1,0,2]}}}})");
  const Json some = answer(request)["trajectories"];
  EXPECT_EQ(some["member"], Json({0, 1, 2}));
  EXPECT_EQ(some["x"][1], Json::array()) << "a mass of 0 cannot begin";
  EXPECT_EQ(some["x"][2].size(), 3u);
}

// Trajectories beside everything else that is kept, in lanes and not; the last row is the final state.
TEST_F(Trajectories, StandBesideTheRest) {
  for (const char* problem : {R"("kepler")", R"~({"id":"custom","variables":["x"],"parameters":{"k":1},
       "potential":"k*x^2/2 + cos(x)"})~"}) {
    Json request = {{"problem", Json::parse(problem)}, {"scheme", {{"id", "leapfrog"}, {"step", 0.05}}}, {"until", 12}};
    request["initial"] = {{"x", 1}, {"px", 0.3}};
    request["members"] = Json::parse(R"({"count":70,"seed":3,"vary":{"/initial/px":{"uniform":[0.2,0.5]}}})");
    request["columns"] = {"t", "x", {{"name", "v"}, {"expression", "px^2"}}};
    for (const Json& section : {Json{{"period", 1.5}}, Json{{"expression", "x"}}}) {
      request["section"] = section;
      request["record"] = {{"samples", 5}};
      request["keep"] = {"statistics", "final", "section"};
      const Json without = answer(request);
      request["keep"].push_back("trajectories");
      const Json all = answer(request);
      for (const char* part : {"statistics", "final", "section"}) EXPECT_EQ(all[part], without[part]) << section;
      EXPECT_EQ(all["trajectories"]["member"].size(), 70u);
      for (std::size_t m = 0; m < 70; ++m) {
        EXPECT_EQ(all["trajectories"]["t"][m], Json({0, 3, 6, 9, 12}));
        for (const char* column : {"x", "v"})
          EXPECT_EQ(all["trajectories"][column][m][4], all["final"][column][m]) << column;
      }
      Json again;
      for (const char* key : {"problem", "initial", "scheme", "until", "record", "limits", "members", "range",
                              "columns", "keep", "section"})
        again[key] = all[key];
      for (const char* key : {"member", "crossing", "t", "x"}) again["section"].erase(key);
      EXPECT_EQ(answer(again)["trajectories"], all["trajectories"]);
    }
  }
}

// Many members and long trajectories: lists are cut where they are sent.
TEST_F(Trajectories, StandInEveryForm) {
  for (const std::size_t rows : {2, 30'000}) {
    Json request = orbits_of({{"samples", rows}});
    request["columns"] = {"x", "py"};
    const std::size_t members = rows > 2 ? 3 : 5000;
    request["members"] = {{"count", members}, {"vary", {{"/initial/x", {{"uniform", {0.8, 1.2}}}}}}};
    const Json whole = answer(request)["trajectories"];
    ASSERT_EQ(whole["member"].size(), members);
    ASSERT_EQ(whole["x"][members - 1].size(), rows);

    Json joined = {{"member", Json::array()}, {"x", Json::array()}, {"py", Json::array()}};
    std::istringstream stream(reply(request, "application/x-ndjson").body);
    std::size_t blocks = 0;
    for (std::string text; std::getline(stream, text);) {
      const Json line = Json::parse(text);
      if (line["kind"] != "block") continue;
      ++blocks;
      for (auto& [name, list] : joined.items())
        for (const Json& value : line["trajectories"][name]) list.push_back(value);
    }
    EXPECT_EQ(blocks, rows > 2 ? 1u : 2u);
    EXPECT_EQ(joined, whole);

    Json binary = Json::from_cbor(reply(request, "application/cbor").body, true, true,
                                  Json::cbor_tag_handler_t::store)["trajectories"];
    for (const char* column : {"x", "py"})
      for (std::size_t m = 0; m < members; ++m) {
        const auto& bytes = binary[column][m].get_binary();
        std::vector<double> numbers(bytes.size() / sizeof(double));
        std::memcpy(numbers.data(), bytes.data(), bytes.size());
        ASSERT_EQ(Json(numbers), whole[column][m]) << column << m;
      }
  }
}

// Where there is no room for the result nothing is computed.
TEST_F(Trajectories, AreRefusedByName) {
  Json large = orbits_of({{"samples", 1000}});
  large["members"] = {{"count", 1000000}, {"vary", {{"/initial/x", {{"uniform", {0.8, 1.2}}}}}}};
  const Json found = fault(large);
  EXPECT_EQ(found["pointer"], "/record");
  EXPECT_EQ(found["allowed"], "1250 members with so many rows each");
  large["range"] = {0, 1250};
  EXPECT_EQ(reply(large, "application/x-ndjson").status, 200);
  large["range"] = {0, 1251};
  EXPECT_EQ(fault(large)["pointer"], "/record");
  EXPECT_EQ(fault(orbits_of({{"curve", 50}}))["pointer"], "/record/curve");
  EXPECT_EQ(fault(orbits_of({{"every", 0}}))["pointer"], "/record");
  EXPECT_EQ(fault(orbits_of({{"every", -1}}))["pointer"], "/record/every");
  Json kept = orbits_of({{"every", 1}});
  kept["keep"] = {"trajectory"};
  EXPECT_EQ(fault(kept)["pointer"], "/keep/0");
}

}  // namespace
}  // namespace least::server::test
