#include "server/encode/run_answer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

#include "least_version.hpp"
#include "server/decode/simulate_request.hpp"
#include "tests/server/cards.hpp"

namespace least::server {
namespace {

Answer encode_json(const FinishedRun& run) { return whole_answer(forms()[0], run); }
Answer encode_csv(const FinishedRun& run) { return whole_answer(csv_form, run); }

// Example is a run as the core would leave it, by the scheme with its own clock: every kind of parameter and of report.
struct Example {
  Request request;
  Solution outcome;
  std::shared_ptr<KeptRows> samples = std::make_shared<KeptRows>(2);
  const ProblemCard& problem = test::cards().problems.data()[0]->card();
  const SchemeCard& scheme = test::cards().schemes.data()[2];

  Example() {
    auto parsed = parse_json(R"({"problem":{"id":"swing","level":7},"initial":{"t":-0.0,"q":1e-9},
      "scheme":{"id":"own_clock","critical":null,"keep":false,"stages":null,"kappa":"energy"},"record":{"times":[0,2.5]},"columns":["t","energy"]})");
    request = decode(std::move(*parsed), test::cards(), {})->run;
    const double values[] = {0, 1.5, 2.5, std::nan("")};
    samples->append(values);
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
  FinishedRun run() const { return {{request, problem, scheme}, outcome, *samples}; }
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
          R"("limits":{"seconds":10,"steps":100000000,"samples":5000000},"norm":"absolute",)"
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
      Json::parse(encode_json({{again->run, example.problem, example.scheme}, example.outcome, *example.samples}).body),
      first);
}

TEST(EncodeJson, SaysHowASchemeWasChosen) {
  const Example example;
  Advice advice{SchemeConfig{0, {0.5, 1}}, "the \"cheapest\"", 1e-7, true, {{{1, {0.25}}, 500, std::nan(""), 1e-3}}};
  const AdviceWithCards chosen{advice, test::cards().schemes};
  least::server::FinishedRun run = example.run();
  EXPECT_FALSE(Json::parse(encode_json(run).body).contains("choice"));
  run.choice = &chosen;
  const Json choice = Json::parse(encode_json(run).body)["choice"];
  EXPECT_EQ(choice.dump(), R"({"reason":"the \"cheapest\"","met":true,"estimated_error":1e-07,"alternatives":[)"
                           R"({"scheme":{"id":"runge_kutta_4","step":0.25},"force_evaluations":500,)"
                           R"("estimated_error":null}]})");
  const AdviceWithCards timed{advice, test::cards().schemes, true};
  run.choice = &timed;
  EXPECT_EQ(Json::parse(encode_json(run).body)["choice"]["alternatives"][0]["seconds"], 0.001);
  run.choice = &chosen;
  advice.known = false;
  EXPECT_TRUE(Json::parse(encode_json(run).body)["choice"]["met"].is_null());
  advice.known = true;
  bool told = false;
  for (const auto& [name, value] : encode_csv(run).headers) {
    told = told || (name == "Leastaction-Choice" && Json::parse(value) == choice);
  }
  EXPECT_TRUE(told);
}

// Columns of codes beside a column of numbers: mode (two words) and parameter (the variables q and p).
Example coded() {
  Example example;
  example.request.columns = {0, 4, 5};
  const double nan = std::nan("");
  const double values[] = {0, 0, -1, 1, 1, 1, 2, 1, 0, 3, nan, nan, 4, 2, std::numeric_limits<double>::infinity()};
  example.samples = std::make_shared<KeptRows>(3);
  example.samples->append(values);
  return example;
}

TEST(EncodeJson, ColumnsOfCodesAreWords) {
  const Json trajectory = Json::parse(encode_json(coded().run()).body)["trajectory"];
  EXPECT_EQ(trajectory["t"].dump(), "[0,1,2,3,4]");
  EXPECT_EQ(trajectory["mode"].dump(), R"(["hamilton","jacobi_maupertuis","jacobi_maupertuis",null,null])");
  EXPECT_EQ(trajectory["parameter"].dump(), R"([null,"p","q",null,null])");
  Example none = coded();
  none.samples = std::make_shared<KeptRows>(3);
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
  EXPECT_EQ(answer.body, "t,energy\n0,1.5\n2.5,\n") << "what does not fit into a field is no row";
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

// from_cbor() converts a CBOR tree to one of JSON: typed arrays of binary64 become arrays of numbers, and NaN in them
// null.
Json from_cbor(const std::string& bytes) {
  Json tree = Json::from_cbor(bytes, true, true, Json::cbor_tag_handler_t::store);
  for (auto& [name, column] : tree["trajectory"].items()) {
    if (!column.is_binary()) continue;
    const auto& binary = column.get_binary();
    EXPECT_TRUE(binary.has_subtype() && binary.subtype() == 86) << name;
    std::vector<double> numbers(binary.size() / sizeof(double));
    std::memcpy(numbers.data(), binary.data(), binary.size());
    column = Json::array();
    for (const double x : numbers) column.push_back(std::isfinite(x) ? Json(x) : Json());
  }
  return tree;
}

TEST(EncodeCbor, HoldsWhatJsonHolds) {
  for (const Example& example : {Example(), coded()}) {
    const Answer answer = whole_answer(forms()[2], example.run());
    EXPECT_EQ(answer.type, "application/cbor");
    const Json json = Json::parse(encode_json(example.run()).body);
    EXPECT_EQ(from_cbor(answer.body), json);
  }
}

TEST(EncodeCbor, WritesHeadsOfEverySize) {
  for (const std::int64_t n : {0L, 23L, 24L, 255L, 256L, 65535L, 65536L, 4294967295L, 4294967296L, 1L << 53, -1L, -24L,
                               -25L, -257L, -65537L, -4294967297L}) {
    std::string bytes;
    JsonWriter(bytes, Notation::cbor).integer(n);
    EXPECT_EQ(Json::from_cbor(bytes), n);
    EXPECT_EQ(bytes.size(), Json::to_cbor(Json(n)).size()) << n;
  }
  for (const std::size_t length : {0, 23, 24, 300, 70'000}) {
    std::string bytes;
    JsonWriter(bytes, Notation::cbor).text(std::string(length, 'x'));
    EXPECT_EQ(Json::from_cbor(bytes), std::string(length, 'x'));
  }
  std::string bytes;
  JsonWriter json(bytes, Notation::cbor);
  json.open('[').number(-0.0).number(1e300).number(std::nan("")).boolean(true).boolean(false).null().close(']');
  EXPECT_EQ(Json::from_cbor(bytes).dump(), "[-0.0,1e+300,null,true,false,null]");
}

// However large an answer is, and wherever its blocks and pieces end, the pieces together are the whole.
TEST(EncodeInPieces, GivesTheBytesOfTheWhole) {
  Example example;
  std::vector<double> values(400'002);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::sqrt(static_cast<double>(i));
  values[301] = std::nan("");
  example.samples = std::make_shared<KeptRows>(2);
  for (std::size_t at = 0; at < values.size(); at += 1000) {
    example.samples->append(std::span(values).subspan(at, std::min<std::size_t>(1000, values.size() - at)));
  }
  EXPECT_EQ(example.samples->rows(), 200'001u);
  EXPECT_GT(example.samples->slices(), 20u);
  std::string table = "t,energy\n";
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) append_number(table, values[i]);
    table += i % 2 == 0 ? ',' : '\n';
  }
  EXPECT_TRUE(encode_csv(example.run()).body == table);
  for (const Form& form : forms()) {
    std::string joined, piece;
    std::size_t largest = 0;
    for (std::size_t i = 0; i < form.pieces(example.run()); ++i, joined += piece) {
      piece.clear();
      form.write(example.run(), i, piece);
      largest = std::max(largest, piece.size());
    }
    EXPECT_TRUE(joined == whole_answer(form, example.run()).body) << form.type;
    EXPECT_LT(largest, 400'000u) << form.type;
    EXPECT_GT(joined.size(), 3'000'000u);
  }
  const Json json = Json::parse(encode_json(example.run()).body);
  EXPECT_EQ(json["trajectory"]["t"].size(), 200'001u);
  EXPECT_TRUE(json["trajectory"]["energy"][150].is_null());
  const Json cbor =
      Json::from_cbor(whole_answer(forms()[2], example.run()).body, true, true, Json::cbor_tag_handler_t::ignore);
  for (std::size_t i = 0; i < 200'001; ++i) {
    ASSERT_EQ(json["trajectory"]["t"][i], values[2 * i]) << i;
    double x = 0;
    std::memcpy(&x, cbor["trajectory"]["t"].get_binary().data() + i * sizeof x, sizeof x);
    ASSERT_EQ(x, values[2 * i]) << i;
  }
}

TEST(KeptRows, KeepToTheirBudget) {
  MemoryBudget budget(1 << 20);
  const std::vector<double> rows(1000, 1.0);
  {
    KeptRows first(5, &budget), second(5, &budget);
    EXPECT_TRUE(first.append(rows));
    EXPECT_GE(budget.held(), 8000u);
    EXPECT_LE(budget.held(), 16'000u) << "short runs do not pay for long ones";
    int taken = 0;
    while (second.append(rows) && taken < 1000) ++taken;
    EXPECT_TRUE(second.overflowed());
    EXPECT_FALSE(first.overflowed());
    EXPECT_GT(taken, 30);
    EXPECT_LE(budget.held(), std::size_t{1} << 20);
  }
  EXPECT_EQ(budget.held(), 0u);
}

}  // namespace
}  // namespace least::server
