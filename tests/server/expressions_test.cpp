// Columns and events that are expressions, over HTTP: their values, in every form of an answer, and refusals.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <numbers>
#include <set>
#include <sstream>

#include "server/decode/simulate_request.hpp"
#include "tests/server/cards.hpp"
#include "tests/server/client.hpp"
#include "tests/server/faults.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

class Expressions : public Serving {
 protected:
  static Reply send(const Json& request, std::string_view fields = "", const char* path = "/v1/simulate") {
    return ask(port(), post(path, request.dump(), fields));
  }
  static Json run(const Json& request) {
    const Reply reply = send(request);
    if (reply.status != 200) throw std::runtime_error(request.dump() + reply.body);
    return Json::parse(reply.body);
  }
};

Json own(const char* name, const char* expression) { return {{"name", name}, {"expression", expression}}; }
Json with_own(Json request, const Json& columns, const Json& events = Json::array()) {
  request["columns"] = columns;
  if (!events.empty()) request["events"] = events;
  return request;
}
/// ellipse_of() requests a Kepler orbit of eccentricity .6 and period 2π from the perihelion.
Json ellipse_of(const Json& scheme) {
  return {{"problem", "kepler"},
          {"scheme", scheme},
          {"initial", {{"x", 0.4}, {"y", 0}, {"px", 0}, {"py", 2}}},
          {"until", {{"t", 20}}},
          {"record", {{"samples", 41}}},
          {"diagnostics", Json::array({"energy"})}};
}

TEST_F(Expressions, AreColumnsToTheBit) {
  const Json columns = Json::array({"x", own("r", "sqrt(x^2+y^2)"), "t", "y", own("scaled", "mu*x-y/2+t"), "energy",
                                    own("E", "energy"), "px", "py", own("H", "(px^2+py^2)/2-mu/sqrt(x*x+y*y)")});
  for (const char* scheme : {"leapfrog", "taylor", "time_transformed"}) {
    Json request = with_own(ellipse_of(scheme), columns);
    request["problem"] = {{"id", "kepler"}, {"mu", 1.25}};
    const Json answer = run(request);
    EXPECT_EQ(answer["columns"], columns) << "the echo";
    const Json& all = answer["trajectory"];
    ASSERT_EQ(all["r"].size(), 41U);
    for (std::size_t i = 0; i < all["r"].size(); ++i) {
      const double x = all["x"][i], y = all["y"][i], t = all["t"][i];
      EXPECT_EQ(all["r"][i], std::sqrt(x * x + y * y)) << scheme << " " << i;
      EXPECT_EQ(all["scaled"][i], 1.25 * x - y * 0.5 + t) << scheme << " " << i;
      EXPECT_EQ(all["E"][i], all["energy"][i]) << scheme << " " << i;
      EXPECT_NEAR(all["H"][i], all["energy"][i], 1e-14) << scheme << " " << i;
    }
    Json plain = request;
    plain["columns"] = Json::array({"x", "t", "y"});
    const Json alone = run(plain);
    for (const char* name : {"x", "t", "y"}) EXPECT_EQ(alone["trajectory"][name], all[name]) << scheme;
    EXPECT_EQ(alone["final"], answer["final"]) << scheme;
  }
}

// Sums, products and conditions on their indices may be used with the names of any scene.
TEST_F(Expressions, MayBeSums) {
  for (const char* problem : {R"("kepler")", R"({"id":"custom","variables":["x","y"],"potential":"x^2+y^2"})"}) {
    Json request{{"problem", Json::parse(problem)},
                 {"initial", {{"x", 0.5}, {"y", 2}}},
                 {"scheme", "leapfrog"},
                 {"until", 1},
                 {"record", {{"samples", 2}}}};
    request["columns"] = Json::array({"x", "y", own("sum", "sum(i=1..3, if(i == 2, y, i*x))")});
    const Json made = run(request);
    for (std::size_t i = 0; i < 2; ++i) {
      const double x = made["trajectory"]["x"][i], y = made["trajectory"]["y"][i];
      EXPECT_NEAR(made["trajectory"]["sum"][i], 4 * x + y, 1e-14);
    }
  }
}

TEST_F(Expressions, AreNullWhereTheyHaveNoValue) {
  const Json answer =
      run(with_own(ellipse_of("leapfrog"), Json::array({own("deep", "log(x)"), "x", own("pole", "1/y")})));
  EXPECT_EQ(answer["status"], "completed");
  const Json &deep = answer["trajectory"]["deep"], &x = answer["trajectory"]["x"];
  std::size_t nulls = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_EQ(deep[i].is_null(), x[i].get<double>() < 0) << i;
    nulls += deep[i].is_null();
  }
  EXPECT_GT(nulls, 10U);
  EXPECT_LT(nulls, x.size());
  EXPECT_TRUE(answer["trajectory"]["pole"][0].is_null()) << "infinite at the start";
  EXPECT_TRUE(answer["trajectory"]["pole"][1].is_number());
}

TEST_F(Expressions, StandInEveryForm) {
  Json request = with_own(ellipse_of("leapfrog"), Json::array({"t", own("r", "sqrt(x^2+y^2)"), own("deep", "log(x)")}),
                          Json::array({own("apsis", "x*px+y*py")}));
  for (const Json& record :
       {Json{{"every", 50}}, Json{{"samples", 31}}, Json{{"curve", 31}}, Json{{"times", {1, 2}}}}) {
    request["record"] = record;
    const Json json = run(request);
    const Json& all = json["trajectory"];
    ASSERT_EQ(json["events"].size(), 6U) << "three turns and a bit, from the perihelion";
    // lines
    std::istringstream lines(send(request, "Accept: application/x-ndjson\r\n").body);
    Json joined{{"t", Json::array()}, {"r", Json::array()}, {"deep", Json::array()}}, head, end;
    for (std::string text; std::getline(lines, text);) {
      const Json line = Json::parse(text);
      if (line["kind"] == "head") head = line;
      if (line["kind"] == "end") end = line;
      if (line["kind"] == "samples")
        for (auto& [name, values] : joined.items())
          for (const Json& value : line["trajectory"][name]) values.push_back(value);
    }
    EXPECT_EQ(joined, all) << record;
    EXPECT_EQ(head["columns"], request["columns"]);
    EXPECT_EQ(head["events"][0]["expression"], "x*px+y*py");
    EXPECT_EQ(end["events"], json["events"]);
    // values with commas
    const Reply csv = send(request, "Accept: text/csv\r\n");
    std::istringstream rows(csv.body);
    std::string row;
    std::getline(rows, row);
    EXPECT_EQ(row, "t,r,deep");
    for (std::size_t i = 0; i < all["t"].size(); ++i) {
      std::getline(rows, row);
      const std::string deep = all["deep"][i].is_null() ? "" : all["deep"][i].dump();
      EXPECT_EQ(row, all["t"][i].dump() + "," + all["r"][i].dump() + "," + deep) << record;
    }
    EXPECT_EQ(Json::parse(csv.fields.at("leastaction-request"))["events"], json["events_asked"]);
    // binary
    const Json binary = Json::from_cbor(send(request, "Accept: application/cbor\r\n").body, true, true,
                                        Json::cbor_tag_handler_t::store);
    EXPECT_EQ(binary["columns"], request["columns"]);
    for (const char* name : {"r", "deep"}) {
      const auto& bytes = binary["trajectory"][name].get_binary();
      ASSERT_EQ(bytes.size(), 8 * all[name].size()) << record;
      for (std::size_t i = 0; i < all[name].size(); ++i) {
        double value = 0;
        std::memcpy(&value, bytes.data() + 8 * i, 8);
        EXPECT_EQ(std::isnan(value), all[name][i].is_null());
        EXPECT_TRUE(std::isnan(value) || all[name][i] == value);
      }
    }
  }
}

TEST_F(Expressions, AreEventsThatEndARun) {
  const Json events =
      Json::array({own("apsis", "x*px+y*py"),
                   {{"name", "down"}, {"expression", "y"}, {"direction", "down"}},
                   {{"name", "over"}, {"expression", "x*px+y*py"}, {"direction", "up"}, {"stop", true}}});
  for (const char* scheme : {"leapfrog", "taylor", "dormand_prince_5"}) {
    Json request = ellipse_of(scheme);
    request["events"] = events;
    const Json answer = run(request);
    EXPECT_EQ(answer["status"], "completed");
    EXPECT_EQ(answer["end"], (Json{{"event", "over"}}));
    ASSERT_EQ(answer["events"].size(), 4U) << answer["events"];
    const std::vector<std::string> names{"apsis", "down", "apsis", "over"};
    std::multiset<std::string> got;
    for (const Json& event : answer["events"]) {
      EXPECT_EQ(event["kind"], "event");
      got.insert(event["name"]);
    }
    EXPECT_EQ(got, std::multiset<std::string>(names.begin(), names.end()));
    const Json& last = answer["events"].back();
    EXPECT_EQ(last["name"], "over");
    EXPECT_EQ(answer["final"]["t"], last["t"]);
    EXPECT_NEAR(last["t"].get<double>(), 2 * std::numbers::pi, scheme == std::string("taylor") ? 1e-11 : 0.1);
    for (const char* name : {"x", "y", "px", "py"}) EXPECT_EQ(answer["final"][name], last["state"][name]);
    // The request that the answer contains gives the same run.
    Json again;
    for (const char* key : {"problem", "initial", "scheme", "until", "record", "columns", "limits", "norm"})
      again[key] = answer.at(key);
    again["events"] = answer.at("events_asked");
    again["diagnostics"] = request["diagnostics"];
    const Json second = run(again);
    for (const char* key : {"end", "events", "final", "trajectory", "events_asked", "diagnostics"})
      EXPECT_EQ(second[key], answer[key]) << key;
  }
  const Json without = run(ellipse_of("leapfrog"));
  EXPECT_FALSE(without.contains("end"));
  EXPECT_FALSE(without.contains("events_asked"));
}

TEST_F(Expressions, AreServedByAutoToo) {
  Json request =
      with_own(ellipse_of({{"id", "auto"}, {"accuracy", 1e-6}}), Json::array({"t", own("r", "sqrt(x^2+y^2)")}),
               Json::array({own("apsis", "x*px+y*py"), own("late", "t-15")}));
  request["events"][1]["stop"] = true;
  const Json answer = run(request);
  EXPECT_EQ(answer["end"]["event"], "late");
  EXPECT_EQ(answer["events"].size(), 5U) << answer["events"];
  EXPECT_NEAR(answer["events"][1]["t"].get<double>(), 2 * std::numbers::pi, 1e-5);
  EXPECT_NEAR(answer["trajectory"]["r"][0].get<double>(), 0.4, 1e-15);
  EXPECT_TRUE(answer.contains("choice"));
}

// An expression with s or the energy makes a run carry it; the states do not change.
TEST_F(Expressions, MakeARunCarryWhatTheyRead) {
  const Json plain{{"problem", "damped_oscillator"}, {"scheme", "contact_leapfrog"}, {"record", {{"samples", 5}}}};
  const Json lean = run(plain), action = run(with_own(plain, Json::array({"t", "q", own("twice", "2*s")}))),
             energy = run(with_own(plain, Json::array({"t", own("E", "energy"), own("rate", "damping")}))),
             columns = run(with_own(plain, Json::array({"s", "energy"})));
  EXPECT_FALSE(lean["final"].contains("s"));
  EXPECT_TRUE(action["final"].contains("s"));
  EXPECT_FALSE(energy["final"].contains("s"));
  EXPECT_EQ(action["final"]["q"], lean["final"]["q"]);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(action["trajectory"]["twice"][i].get<double>(), 2 * columns["trajectory"]["s"][i].get<double>());
    EXPECT_EQ(energy["trajectory"]["E"][i], columns["trajectory"]["energy"][i]);
    EXPECT_EQ(energy["trajectory"]["rate"][i], energy["problem"]["damping"]);
  }
}

TEST_F(Expressions, AreRefusedWithThePlace) {
  struct Case {
    const char* member;
    Json value;
    const char *pointer, *detail;
    int position = -1;
  };
  const Case table[] = {
      {"columns", Json::array({"t", "x", own("r", "sqrt(x^2+z^2)")}), "/columns/2/expression", "unknown name z", 9},
      {"columns", Json::array({own("r", "2*enrgy")}), "/columns/0/expression", "did you mean \"energy\"", 2},
      {"columns", Json::array({own("r", "s")}), "/columns/0/expression", "unknown name s", 0},
      {"columns", Json::array({own("r", "2x")}), "/columns/0/expression", "a product needs its sign", 1},
      {"columns", Json::array({own("r", "x+µ")}), "/columns/0/expression", "no ASCII", 2},
      {"columns", Json::array({own("r", "")}), "/columns/0/expression", "is empty", 0},
      {"columns", Json::array({own("r", "x+1/0")}), "/columns/0/expression", "no finite number", 3},
      {"columns", Json::array({own("x", "y")}), "/columns/0/name", "column of the scene"},
      {"columns", Json::array({own("energy", "y")}), "/columns/0/name", "column of the scene"},
      {"columns", Json::array({own("r", "y"), own("r", "x")}), "/columns/1/name", "stands twice"},
      {"columns", Json::array({own("1r", "y")}), "/columns/0/name", "is no name"},
      {"columns", Json::array({own("r-x", "y")}), "/columns/0/name", "is no name"},
      {"columns", Json::array({own("abcdefghijklmnopqrstuvwxyzabcdefg", "y")}), "/columns/0/name", "is no name"},
      {"columns", Json::array({Json{{"name", "r"}}}), "/columns/0/expression", "is required"},
      {"columns", Json::array({Json{{"expression", "x"}}}), "/columns/0/name", "is required"},
      {"columns", Json::array({Json{{"name", "r"}, {"expression", 1}}}), "/columns/0/expression", "must be a string"},
      {"columns", Json::array({Json{{"name", "r"}, {"expression", "x"}, {"unit", "m"}}}), "/columns/0/unit",
       "unknown key"},
      {"columns", Json::array({1}), "/columns/0", "must be a string"},
      {"columns", Json::array({"t", "t"}), "/columns/1", "stands twice"},
      {"columns", Json::object(), "/columns", "must be a list"},
      {"events", Json::object(), "/events", "must be a list"},
      {"events", Json::array({"x"}), "/events/0", "must be an object"},
      {"events", Json::array({own("e", "x*")}), "/events/0/expression", "is due", 2},
      {"events", Json::array({own("e", "x"), own("e", "y")}), "/events/1/name", "stands twice"},
      {"events", Json::array({Json{{"name", "e"}, {"expression", "x"}, {"direction", "left"}}}), "/events/0/direction",
       "unknown direction"},
      {"events", Json::array({Json{{"name", "e"}, {"expression", "x"}, {"stop", 1}}}), "/events/0/stop",
       "true or false"},
      {"events", Json(17, own("e", "x")), "/events", "17 events"},
  };
  for (const auto& [member, value, pointer, detail, position] : table) {
    Json request = ellipse_of("leapfrog");
    request[member] = value;
    const auto fault = only_fault(send(request));
    EXPECT_EQ(fault["pointer"], pointer) << value;
    EXPECT_TRUE(says(fault, detail)) << value << fault;
    EXPECT_EQ(fault.value("position", -1), position) << value << fault;
  }
  Json request = ellipse_of("leapfrog");
  request["columns"] = Json::array({own("r", "z"), own("q", "x+"), "nonsense"});
  EXPECT_EQ(Json::parse(send(request).body)["errors"].size(), 3U) << "all at once";
  request["columns"] = Json::array({own("r", "x*z")});
  EXPECT_EQ(only_fault(send(request))["allowed"], "x, y, px, py, t, energy, mu, pi");
}

// The time is that beyond parsing the JSON.
TEST_F(Expressions, ThatAreHugeAreRefusedAtOnce) {
  using Clock = std::chrono::steady_clock;
#if defined(__SANITIZE_ADDRESS__)
  constexpr double at_once = 0.2;
#else
  constexpr double at_once = 0.02;
#endif
  for (const std::string& text : {std::string(1'000'000, '('), std::string(10'000'000, 'x'), std::string(5'000, '(')}) {
    const Json request{
        {"problem", "swing"}, {"scheme", "leapfrog"}, {"columns", Json::array({own("r", text.c_str())})}};
    auto parsed = parse_json(request.dump());
    ASSERT_TRUE(parsed);
    double least = 1;
    for (int attempt = 0; attempt < 3; ++attempt) {
      ParsedJson copy{parsed->tree, {}};
      const auto from = Clock::now();
      const auto decoded = decode(std::move(copy), cards(), Caps{});
      least = std::min(least, std::chrono::duration<double>(Clock::now() - from).count());
      ASSERT_FALSE(decoded);
      EXPECT_EQ(decoded.error().list().front().pointer, "/columns/0/expression");
    }
    EXPECT_LT(least, at_once) << text.size();
  }
}

TEST_F(Expressions, AreRefusedByNameWhereTheyAreNotServed) {
  const Json column = own("r", "x^2"), event = own("e", "x");
  Json study{{"problem", "kepler"}, {"schemes", {"leapfrog"}}, {"budget_seconds", 1}};
  for (const char* path : {"/v1/work-precision", "/v1/stability"})
    for (const char* member : {"columns", "events"}) {
      Json request = study;
      request[member] = Json::array({own("r", "x")});
      EXPECT_EQ(only_fault(send(request, "", path))["pointer"], "/" + std::string(member)) << path;
    }
  Json many{{"problem", "kepler"},
            {"scheme", "leapfrog"},
            {"until", {{"steps", 10}}},
            {"members", {{"vary", {{"/initial/x", {{"values", {0.4, 0.5}}}}}}}}};
  many["columns"] = Json::array({"x", column});
  many["histograms"] = {{"x", {{"range", {0, 1}}, {"bins", 3}}}};
  EXPECT_EQ(send(many, "", "/v1/ensemble").status, 200);
  many["events"] = Json::array({event});
  EXPECT_EQ(only_fault(send(many, "", "/v1/ensemble"))["pointer"], "/events");
}

}  // namespace
}  // namespace least::server::test
