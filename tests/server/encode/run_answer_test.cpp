#include "server/encode/run_answer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "least_version.hpp"
#include "server/decode/simulate_request.hpp"
#include "tests/server/cards.hpp"

namespace least::server {
namespace {

// A run as the core would leave it, of the scheme with its own clock: every kind of parameter and of report.
struct Example {
  Request request;
  Solution outcome;
  Samples samples;
  const ProblemCard& problem = test::cards().problems.data()[0]->card();
  const SchemeCard& scheme = test::cards().schemes.data()[2];

  Example() {
    auto parsed = parse_json(R"({"problem":{"id":"swing","level":7},"initial":{"t":-0.0,"q":1e-9},
      "scheme":{"id":"own_clock","critical":null,"keep":false,"stages":null,"kappa":"energy"},"record":{"times":[0,2.5]},"columns":["t","energy"]})");
    request = decode(std::move(*parsed), test::cards(), {})->run;
    const double values[] = {0, 1.5, 2.5, std::nan("")};
    samples.append(values);
    outcome.t = 20;
    outcome.final = {0.25, std::numeric_limits<double>::infinity()};
    outcome.diagnostics = {{"energy", std::vector<Report>{{"initial", 1.0}, {"kind", std::string("a\"b")}}},
                           {"zeros", std::vector<double>{1, 2.5}},
                           {"poles", std::vector<Report>{{"", 1.0}, {"", true}}},
                           {"none", std::monostate{}}};
    using Event = std::vector<Report>;
    outcome.events = {{"", Event{{"t", 1.0},
                                 {"kind", std::string("switch")},
                                 {"from", std::string("hamilton")},
                                 {"to", std::string("jacobi_maupertuis")},
                                 {"parameter", std::string("q")}}},
                      {"", Event{{"t", 1.5}, {"kind", std::string("parameter")}, {"parameter", std::monostate{}}}}};
    outcome.warnings = {{"damping_sign", "θ < 0\r\nX-Evil: 1"}};
    outcome.cost = {4, 8, 2, 1e-6};
  }
  FinishedRun run() const { return {request, problem, scheme, outcome, samples}; }
};

TEST(EncodeJson, WritesTheResponseOfTheContract) {
  const Example example;
  const Answer answer = encode_json(example.run());
  EXPECT_EQ(answer.type, "application/json");
  EXPECT_EQ(
      answer.body,
      R"({"version":")" + std::string(version) +
          R"(","status":"completed","problem":{"id":"swing","mass":1,"level":7},)"
          R"("initial":{"t":-0.0,"q":1e-09,"p":0},"scheme":{"id":"own_clock","keep":false,"critical":null,"stages":null,"kappa":"energy","step":0.1},)"
          R"("until":{"t":20},"record":{"times":[0,2.5]},"columns":["t","energy"],)"
          R"("limits":{"seconds":10,"steps":100000000,"samples":1000000},"norm":"absolute",)"
          R"("trajectory":{"t":[0,2.5],"energy":[1.5,null]},"final":{"t":20,"q":0.25,"p":null},)"
          R"("diagnostics":{"energy":{"initial":1,"kind":"a\"b"},"zeros":[1,2.5],"poles":[1,true],"none":null},)"
          R"("cost":{"steps":4,"force_evaluations":8,"iterations":2,"seconds":1e-06,"nanoseconds_per_step":250},)"
          R"("events":[{"t":1,"kind":"switch","from":"hamilton","to":"jacobi_maupertuis","parameter":"q"},)"
          R"({"t":1.5,"kind":"parameter","parameter":null}],)"
          R"("warnings":[{"code":"damping_sign","detail":"θ < 0\u000d\u000aX-Evil: 1"}]})"
          "\n");
}

TEST(EncodeJson, TheEchoIsACompleteRequest) {
  Example example;
  const Json first = Json::parse(encode_json(example.run()).body);
  Json request;
  for (const char* key : {"problem", "initial", "scheme", "until", "record", "columns", "limits", "norm"}) {
    request[key] = first.at(key);
  }
  const auto again = decode({request, {}}, test::cards(), {});
  ASSERT_TRUE(again);
  EXPECT_EQ(std::signbit(again->run.scene->start), true);
  EXPECT_EQ(
      Json::parse(encode_json({again->run, example.problem, example.scheme, example.outcome, example.samples}).body),
      first);
}

TEST(EncodeJson, SaysHowASchemeWasChosen) {
  const Example example;
  const Advice advice{
      SchemeConfig{0, {0.5, 1}}, "the \"cheapest\"", 1e-7, true, {{{1, {0.25}}, 500, std::nan(""), 1e-3}}};
  const AdviceWithCards chosen{advice, test::cards().schemes};
  least::server::FinishedRun run = example.run();
  EXPECT_FALSE(Json::parse(encode_json(run).body).contains("choice"));
  run.choice = &chosen;
  const Json choice = Json::parse(encode_json(run).body)["choice"];
  EXPECT_EQ(choice.dump(), R"({"reason":"the \"cheapest\"","met":true,"estimated_error":1e-07,"alternatives":[)"
                           R"({"scheme":{"id":"runge_kutta_4","step":0.25},"force_evaluations":500,)"
                           R"("estimated_error":null,"seconds":0.001}]})");
  bool told = false;
  for (const auto& [name, value] : encode_csv(run).headers) {
    told = told || (name == "Leastaction-Choice" && Json::parse(value) == choice);
  }
  EXPECT_TRUE(told);
}

// Columns of codes beside a column of numbers: mode (two words), parameter (the variables q and p).
Example coded() {
  Example example;
  example.request.columns = {0, 4, 5};
  const double nan = std::nan("");
  example.samples.values = {0, 0, -1, 1, 1, 1, 2, 1, 0, 3, nan, nan, 4, 2, std::numeric_limits<double>::infinity()};
  return example;
}

TEST(EncodeJson, ColumnsOfCodesAreWords) {
  const Json trajectory = Json::parse(encode_json(coded().run()).body)["trajectory"];
  EXPECT_EQ(trajectory["t"].dump(), "[0,1,2,3,4]");
  EXPECT_EQ(trajectory["mode"].dump(), R"(["hamilton","jacobi_maupertuis","jacobi_maupertuis",null,null])");
  EXPECT_EQ(trajectory["parameter"].dump(), R"([null,"p","q",null,null])");
  Example none = coded();
  none.samples.values.clear();
  EXPECT_EQ(Json::parse(encode_json(none.run()).body)["trajectory"].dump(), R"({"t":[],"mode":[],"parameter":[]})");
}

TEST(EncodeCsv, ColumnsOfCodesAreWords) {
  EXPECT_EQ(encode_csv(coded().run()).body,
            "t,mode,parameter\n0,hamilton,\n1,jacobi_maupertuis,p\n2,jacobi_maupertuis,q\n3,,\n4,,\n");
}

TEST(EncodeJson, SaysWhyARunStopped) {
  Example example;
  example.outcome.stop = {ReturnCode::singular, "r = 0", 1.25, 125, 1.26};
  Json json = Json::parse(encode_json(example.run()).body);
  EXPECT_EQ(json["status"], "stopped");
  EXPECT_EQ(json["stop"].dump(), R"({"reason":"singular","detail":"r = 0","t":1.25,"step":125,"singular_at":1.26})");
  example.outcome.stop.singular_at.reset();
  example.outcome.cost.steps = 0;
  json = Json::parse(encode_json(example.run()).body);
  EXPECT_TRUE(json["stop"]["singular_at"].is_null());
  EXPECT_EQ(json["cost"]["nanoseconds_per_step"], 0);
}

TEST(EncodeCsv, WritesColumnsAndBoundedFields) {
  Example example;
  example.outcome.diagnostics.push_back({"zeros", std::vector<double>(10'000, 1.5)});
  const Answer answer = encode_csv(example.run());
  EXPECT_EQ(answer.body, "t,energy\n0,1.5\n2.5,\n");
  for (const auto& [name, value] : answer.headers) {
    EXPECT_LE(value.size(), 4096u) << name;
    for (const char c : value) EXPECT_TRUE(c >= 0x20 && c < 0x7F) << name;
    if (name == "Leastaction-Diagnostics") {
      EXPECT_EQ(value, R"({"omitted":true})");
    }
    if (name == "Leastaction-Request") {  // the echo of the JSON form
      const Json whole = Json::parse(encode_json(example.run()).body), request = Json::parse(value);
      for (const auto& [key, echoed] : request.items()) EXPECT_EQ(echoed, whole.at(key)) << key;
      EXPECT_TRUE(request.contains("limits"));
    }
    if (name == "Leastaction-Final") {
      EXPECT_EQ(value, R"({"t":20,"q":0.25,"p":null})");
    }
    if (name == "Leastaction-Warnings") {
      EXPECT_EQ(Json::parse(value)[0]["detail"], "θ < 0\r\nX-Evil: 1");
    }
  }
}

}  // namespace
}  // namespace least::server
