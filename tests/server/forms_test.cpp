// The forms of an answer over real sockets: lines that come during a run, binary columns, large answers.
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <set>
#include <sstream>
#include <thread>

#include "server/decode/json_parse.hpp"
#include "tests/server/client.hpp"
#include "tests/server/faults.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

using namespace std::chrono_literals;

class Forms : public Serving {};

constexpr const char* accept_lines = "Accept: application/x-ndjson\r\n";
constexpr const char* accept_cbor = "Accept: application/cbor\r\n";

std::vector<Json> lines_of(const std::string& body) {
  std::vector<Json> lines;
  std::istringstream text(body);
  for (std::string line; std::getline(text, line);) lines.push_back(Json::parse(line));
  return lines;
}

// joined() assembles the JSON answer from the lines of a run.
Json joined(const std::vector<Json>& lines) {
  Json answer = lines.front();
  answer["trajectory"] = Json::object();
  for (const Json& column : answer["columns"]) answer["trajectory"][column.get<std::string>()] = Json::array();
  for (const Json& line : lines) {
    if (line["kind"] == "samples") {
      for (const auto& [name, values] : line["trajectory"].items()) {
        for (const Json& value : values) answer["trajectory"][name].push_back(value);
      }
    }
  }
  for (const auto& [key, value] : lines.back().items()) answer[key] = value;
  answer.erase("kind");
  return answer;
}

// expect_same() compares both as sorted trees, without their costs.
void expect_same(const Json& a, const Json& b, std::string_view what) {
  auto left = nlohmann::json::parse(a.dump()), right = nlohmann::json::parse(b.dump());
  left.erase("cost");
  right.erase("cost");
  EXPECT_EQ(left, right) << what;
}

const std::vector<std::string>& requests_of_all_kinds() {
  static const std::vector<std::string> all{
      R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":5000},"record":{"every":1}})",
      R"({"problem":"kepler","scheme":"leapfrog","record":{"every":0}})",
      R"({"problem":"kepler","scheme":{"id":"jacobi_maupertuis","step":0.05},"until":{"t":9.5},"record":{"every":3},
          "columns":["t","x","mode","parameter"],"diagnostics":["energy","orbit"]})",
      R"({"problem":"kepler","scheme":{"id":"dormand_prince_5"},"until":{"t":20},"columns":["t","x","error"]})",
      R"({"problem":"kepler","scheme":{"id":"leapfrog","step":0.01},"initial":{"x":0,"y":0},"until":{"t":1}})",
      R"({"problem":"kepler","scheme":{"id":"leapfrog","step":100},"until":{"t":500}})"};
  return all;
}

TEST_F(Forms, LinesAmountToTheJsonAnswer) {
  for (const std::string& request : requests_of_all_kinds()) {
    const Json whole = Json::parse(ask(port(), post("/v1/simulate", request)).body);
    const Reply reply = ask(port(), post("/v1/simulate", request, accept_lines));
    ASSERT_EQ(reply.status, 200) << reply.body;
    EXPECT_EQ(reply.fields.at("content-type"), "application/x-ndjson");
    const auto lines = lines_of(reply.body);
    EXPECT_EQ(lines.front()["kind"], "head");
    EXPECT_EQ(lines.back()["kind"], "end");
    for (std::size_t i = 1; i + 1 < lines.size(); ++i) {
      EXPECT_TRUE(lines[i]["kind"] == "samples" || lines[i]["kind"] == "progress") << lines[i];
    }
    expect_same(joined(lines), whole, request);
  }
}

TEST_F(Forms, BinaryHoldsTheSameNumbers) {
  for (const std::string& request : requests_of_all_kinds()) {
    const Json whole = Json::parse(ask(port(), post("/v1/simulate", request)).body);
    const Reply reply = ask(port(), post("/v1/simulate", request, accept_cbor));
    ASSERT_EQ(reply.status, 200);
    EXPECT_EQ(reply.fields.at("content-type"), "application/cbor");
    Json binary = Json::from_cbor(reply.body, true, true, Json::cbor_tag_handler_t::store);
    for (auto& [name, column] : binary["trajectory"].items()) {
      if (!column.is_binary()) continue;
      std::vector<double> numbers(column.get_binary().size() / sizeof(double));
      if (!numbers.empty()) std::memcpy(numbers.data(), column.get_binary().data(), column.get_binary().size());
      column = numbers;
    }
    expect_same(binary, whole, request);
  }
}

// Lines come during the run; progress comes at most every 200 ms, with the rows so far.
TEST_F(Forms, LinesComeWhileTheRunGoesOn) {
  Client client(port());
  client.send(post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":10000000000},
    "record":{"every":1000000},"limits":{"steps":10000000000,"seconds":2.5}})",
                   accept_lines));
  const auto from = std::chrono::steady_clock::now();
  ASSERT_EQ(client.interim(), 200);
  std::vector<Json> lines;
  std::vector<double> when;
  for (;;) {
    const auto line = client.chunk();
    ASSERT_TRUE(line);
    if (line->empty()) break;
    lines.push_back(Json::parse(*line));
    when.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count());
  }
  double last = -1, steps = 0;
  std::size_t told = 0, samples = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i]["kind"] == "samples") samples += when[i] < 2 ? 1 : 0;
    if (lines[i]["kind"] != "progress") continue;
    ++told;
    EXPECT_GT(lines[i]["steps"].get<double>(), steps);
    EXPECT_GT(lines[i]["t"].get<double>(), last);
    steps = lines[i]["steps"];
    last = lines[i]["t"];
  }
  EXPECT_LT(when.front(), 1);
  EXPECT_GE(told, 4u);
  EXPECT_LE(told, 14u);
  EXPECT_GE(samples, 2u) << "rows do not wait for their block to be full";
  EXPECT_EQ(lines.back()["stop"]["reason"], "deadline");
}

TEST_F(Forms, AFaultIsNoStream) {
  for (const char* accept : {accept_lines, accept_cbor}) {
    const Reply reply = ask(port(), post("/v1/simulate", R"({"problem":"kepler"})", accept));
    EXPECT_EQ(reply.status, 422);
    EXPECT_EQ(reply.fields.at("content-type"), "application/problem+json");
  }
}

TEST_F(Forms, LinesSayWhatWasChosen) {
  const std::string request =
      R"({"problem":"kepler","scheme":{"id":"auto","accuracy":1e-6},"until":{"t":20},"record":{"samples":20}})";
  const auto lines = lines_of(ask(port(), post("/v1/simulate", request, accept_lines)).body);
  ASSERT_GE(lines.size(), 3u);
  EXPECT_TRUE(lines[0]["choice"]["met"].get<bool>());
  EXPECT_NE(lines[0]["scheme"]["id"], "auto");
}

// A large answer is sent in pieces, and is the same.
TEST_F(Forms, LargeAnswersAreWhole) {
  const std::string request =
      R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":60000},"record":{"every":1}})";
  const Reply json = ask(port(), post("/v1/simulate", request));
  EXPECT_EQ(json.fields.at("transfer-encoding"), "chunked");
  EXPECT_GT(json.chunks.size(), 20u);
  const Json answer = Json::parse(json.body);
  for (const char* column : {"t", "x", "y", "px", "py"}) EXPECT_EQ(answer["trajectory"][column].size(), 60'001u);
  const Reply csv = ask(port(), post("/v1/simulate", request, "Accept: text/csv\r\n"));
  EXPECT_EQ(std::count(csv.body.begin(), csv.body.end(), '\n'), 60'002);
  EXPECT_EQ(Json::parse(csv.fields.at("leastaction-final")), answer["final"]);
}

// A table has rows only: what does not fit into a header field is left out.
TEST_F(Forms, ATableHasRowsAlone) {
  const std::string request = R"({"problem":"kepler","scheme":{"id":"jacobi_maupertuis","step":0.01},
    "until":{"t":400},"record":{"every":0}})";
  const Json json = Json::parse(ask(port(), post("/v1/simulate", request)).body);
  ASSERT_GT(json["events"].dump().size(), 4096u) << "a request with many events is needed here";
  const Reply csv = ask(port(), post("/v1/simulate", request, "Accept: text/csv\r\n"));
  EXPECT_EQ(csv.fields.at("leastaction-events"), R"({"omitted":true})");
  EXPECT_EQ(csv.body, "t,x,y,px,py\n");
}

TEST_F(Forms, SamplesAreCountedInNumbers) {
  const auto status = [](const std::string& plan) {
    return ask(port(),
               post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":99},)" + plan + "}"))
        .status;
  };
  EXPECT_EQ(status(R"("record":{"every":1},"columns":["t","x"],"limits":{"samples":200})"), 200);
  EXPECT_EQ(status(R"("record":{"every":1},"columns":["t","x"],"limits":{"samples":199})"), 422);
  EXPECT_EQ(status(R"("record":{"every":1},"columns":["t"],"limits":{"samples":199})"), 200);
  EXPECT_EQ(status(R"("record":{"samples":40},"columns":["t","x"],"limits":{"samples":79})"), 422);
  EXPECT_EQ(status(R"("record":{"samples":40},"columns":["t","x"],"limits":{"samples":80})"), 200);
}

// The limit of samples holds for every scheme, also for one chosen by `auto`, and for one whose steps are not known
// beforehand.
TEST_F(Forms, NoSchemeKeepsMoreSamplesThanItMay) {
  const Reply chosen = ask(port(), post("/v1/simulate", R"({"problem":"kepler","scheme":{"id":"auto","accuracy":1e-6},
    "until":{"t":200},"record":{"every":1},"limits":{"samples":500}})"));
  if (chosen.status == 200) {  // a scheme that sets its own clock
    EXPECT_LE(Json::parse(chosen.body)["trajectory"]["t"].size(), 100u);
  } else {
    EXPECT_EQ(chosen.status, 422);
    EXPECT_NE(chosen.body.find("limits.samples"), std::string::npos) << chosen.body;
  }
  const Json clock = Json::parse(ask(port(), post("/v1/simulate", R"({"problem":"kepler","scheme":"time_transformed",
    "until":{"t":200},"record":{"every":1},"limits":{"samples":500}})"))
                                     .body);
  EXPECT_EQ(clock["trajectory"]["t"].size(), 100u);
  EXPECT_EQ(clock["warnings"][0]["code"], "samples_truncated");
}

TEST_F(Forms, AutoClaimsNothingThatNoRequestCouldAskFor) {
  for (const char* end : {"1e16", "9.5e15", "1e300"}) {
    const Reply reply = ask(port(), post("/v1/simulate", std::string(R"({"problem":"harmonic_oscillator","scheme":
      {"id":"auto","accuracy":1e-6},"record":{"every":0},"limits":{"seconds":1},"until":{"t":)") +
                                                             end + "}}"));
    ASSERT_EQ(reply.status, 200) << end << reply.body;
    const Json run = Json::parse(reply.body);
    EXPECT_NE(run["choice"]["met"], true) << end << reply.body;
    EXPECT_NE(run["status"], "completed") << end << reply.body;
  }
  const Json answer = Json::parse(ask(port(), post("/v1/simulate", R"({"problem":"kepler","scheme":
      {"id":"auto","accuracy":1e-6},"until":{"t":50},"record":{"samples":5}})"))
                                      .body);
  Json echo;
  for (const char* key : {"problem", "initial", "scheme", "until", "record", "columns", "limits", "norm"}) {
    echo[key] = answer.at(key);
  }
  EXPECT_EQ(Json::parse(ask(port(), post("/v1/simulate", echo.dump())).body)["final"], answer["final"]);
}

TEST_F(Forms, CountsBeyondTheExactOnesAreRefused) {
  const auto status = [](const std::string& steps) {
    return ask(port(), post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":)" + steps +
                                                R"(},"record":{"every":0},"limits":{"steps":10}})"))
        .status;
  };
  EXPECT_EQ(status("9007199254740992"), 200);
  EXPECT_EQ(status("9007199254740993"), 422);
  EXPECT_EQ(status("18446744073709551615"), 422);
}

// What has no room although no other request holds any is a fault of the request: to ask again would not help.
TEST(Memory, ThatNobodyElseHoldsIsAFaultOfTheRequest) {
  Settings settings = quiet_settings();
  settings.max_memory = 1 << 20;  // one largest answer fits in any case
  const auto expect_fault = [](int port, const char* path, const std::string& body, std::set<std::string> places) {
    const Reply reply = ask(port, post(path, body));
    ASSERT_EQ(reply.status, 422) << reply.body.substr(0, 500);
    const Json fault = only_fault(reply);
    EXPECT_TRUE(places.contains(fault["pointer"])) << fault;
    EXPECT_NE(fault["detail"].get<std::string>().find(" bytes of memory"), std::string::npos) << fault;
    EXPECT_NE(fault["allowed"].get<std::string>().find("--max-memory"), std::string::npos) << fault;
  };
  const std::string ensemble = R"({"problem":"kepler","scheme":{"id":"leapfrog","step":0.01},"until":{"t":100},
      "section":{"period":0.01,"phase":0},"columns":["t","x","y"],"keep":["section"],
      "members":{"count":4096,"vary":{"/initial/x":{"uniform":[0,0.1]}}},"limits":{"samples":10000000}})";
  {
    Service service(settings, page_assets);
    ASSERT_FALSE(service.start());
    expect_fault(service.port(), "/v1/ensemble", ensemble, {"/section"});
    const Reply lines = ask(service.port(), post("/v1/ensemble", ensemble, "Accept: application/x-ndjson\r\n"));
    EXPECT_EQ(lines.status, 422) << lines.body.substr(0, 500);
  }
  settings.caps.samples = 1'000'000;
  Service service(settings, page_assets);
  ASSERT_FALSE(service.start());
  expect_fault(service.port(), "/v1/simulate",
               R"({"problem":"kepler","scheme":{"id":"leapfrog","step":0.01},"until":{"steps":180000},
                   "record":{"every":1},"section":{"period":0.01,"phase":0}})",
               {"/section", "/record"});
}

// Likewise what is derived from a scene, which has no place of its own in the request.
TEST(Memory, ThatNobodyElseHoldsIsAFaultOfTheScene) {
  Settings settings = quiet_settings();
  settings.caps.samples = 1000;
  settings.max_memory = 30 << 20;
  Service service(settings, page_assets);
  ASSERT_FALSE(service.start());
  const std::string scene = post("/v1/simulate", R"~({"problem":{"id":"custom","variables":["q[100]"],
      "hamiltonian":"sum(i=1..100,p[i]^2/2)+sum(i=1..100,j=1..100,sin(q[i]*q[j]))"},"scheme":"taylor","until":1})~");
  const Reply refused = ask(service.port(), scene);
  ASSERT_EQ(refused.status, 422) << refused.body.substr(0, 500);
  const Json fault = only_fault(refused);
  EXPECT_EQ(fault["pointer"], "");
  EXPECT_NE(fault["detail"].get<std::string>().find("31457280 bytes"), std::string::npos) << fault;
  EXPECT_FALSE(refused.fields.contains("retry-after"));
}

// All answers together hold no more memory than the limit; a client that reads makes room for others.
TEST(Memory, IsBoundedAcrossAnswers) {
  Settings settings = quiet_settings();
  settings.caps.samples = 1'000'000;
  settings.max_memory = 1 << 20;  // one largest answer fits in any case
  settings.bounds.stall = 60s;
  Service service(settings, page_assets);
  ASSERT_FALSE(service.start());
  const std::string large =
      post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":180000},"record":{"every":1}})");
  EXPECT_EQ(ask(service.port(), large).status, 200);
  Client reader(service.port());
  reader.send(large);
  ASSERT_EQ(reader.interim(), 200);  // and reads no further
  const Reply refused = ask(service.port(), large);
  EXPECT_EQ(refused.status, 503);
  EXPECT_NE(refused.body.find("memory"), std::string::npos);
  EXPECT_TRUE(refused.fields.contains("retry-after"));
  const std::string metrics = ask(service.port(), get("/metrics")).body;
  EXPECT_NE(metrics.find("leastaction_held_bytes 8"), std::string::npos) << "900,000 numbers and what is on its way";
  while (const auto piece = reader.chunk()) {
    if (piece->empty()) break;
  }
  EXPECT_EQ(ask(service.port(), large).status, 200);
  EXPECT_NE(ask(service.port(), get("/metrics")).body.find("leastaction_held_bytes 0\n"), std::string::npos);
}

// Bodies of requests count as well, as they arrive; small ones are always taken.
TEST(Memory, IsBoundedAcrossRequests) {
  Settings settings = quiet_settings();
  settings.caps.samples = 1000;
  settings.max_memory = 4'400'000;  // room for a body and for the text of an answer, but not for a second body
  settings.bounds.body = 1 << 21;
  Service service(settings, page_assets);
  ASSERT_FALSE(service.start());
  const auto held = [&] {
    const std::string text = ask(service.port(), get("/metrics")).body;
    return std::stoul(text.substr(text.find("\nleastaction_held_bytes ") + 23));
  };
  const std::string large = post("/v1/simulate", std::string(2'000'000, ' '));
  const std::string computing =
      post("/v1/simulate", std::string(1'900'000, ' ') +
                               R"({"problem":"kepler","scheme":"leapfrog","record":{"every":0},
      "until":{"steps":10000000000},"limits":{"steps":10000000000,"seconds":20}})");
  const std::string in_chunks = large.substr(0, large.find("Content-Length")) +
                                "Transfer-Encoding: chunked\r\n\r\n1e8480\r\n" + std::string(1'900'000, ' ');
  const auto all_is_given_back = [&] {
    for (int i = 0; i < 2000 && held() > 0; ++i) std::this_thread::sleep_for(5ms);
    return held() == 0;
  };
  Client kept(service.port());
  kept.send(large);
  EXPECT_EQ(kept.receive().value_or(Reply{}).status, 400) << "no JSON";
  for (const std::string& holder : {large.substr(0, 1'900'200), in_chunks, computing}) {
    EXPECT_TRUE(all_is_given_back()) << "an open connection holds nothing";
    Client first(service.port()), second(service.port());
    first.send(holder);
    for (int i = 0; i < 2000 && held() < 1'900'000; ++i) std::this_thread::sleep_for(5ms);
    EXPECT_GE(held(), 1'900'000u);
    second.send(large);
    const auto refused = second.receive();
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->status, 503);
    EXPECT_NE(refused->body.find("--max-memory"), std::string::npos) << refused->body;
    EXPECT_TRUE(refused->fields.contains("retry-after"));
    EXPECT_EQ(ask(service.port(), post("/v1/simulate", "{}")).status, 422) << "what is small";
    first.hang_up();
    EXPECT_TRUE(all_is_given_back());
    EXPECT_EQ(ask(service.port(), large).status, 400) << "there is room again";
  }
}

}  // namespace
}  // namespace least::server::test
