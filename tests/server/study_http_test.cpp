// The studies over real sockets: chunks, clients that go away, deadlines, the end of the service.
#include <gtest/gtest.h>

#include <chrono>
#include <set>
#include <thread>

#include "server/decode/json_parse.hpp"
#include "server/study.hpp"
#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"
#include "tests/support/runs.hpp"

namespace least::server::test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using StudyHttp = Serving;

constexpr std::string_view lines = "Accept: application/x-ndjson\r\n";
constexpr std::string_view small =
    R"({"problem":"harmonic_oscillator","until":{"t":5},
        "schemes":["runge_kutta_4",{"id":"leapfrog","composition":"kahan_li_8"}]})";
constexpr std::string_view simple = R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":10}})";

// long_study() requests more than can be measured in the time.
std::string long_study(std::string_view fields, double seconds) {
  return post("/v1/work-precision",
              R"({"problem":"kepler","until":{"t":4000},"schemes":"all","error":"max","budget_seconds":)" +
                  std::to_string(seconds) + "}",
              fields);
}

std::vector<Json> read_lines(const Reply& reply) {
  std::vector<Json> all;
  for (const std::string& chunk : reply.chunks) all.push_back(Json::parse(chunk));
  return all;
}

// repeatable() returns a point without what depends on the machine.
Json repeatable(Json point) {
  point.erase("seconds");
  return point;
}

TEST_F(StudyHttp, TheLinesAreTheWholeAnswerPieceByPiece) {
  Client client(port());
  client.send(post("/v1/work-precision", small, lines) + get("/healthz"));
  const auto reply = client.receive();
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 200);
  EXPECT_EQ(reply->fields.at("content-type"), "application/x-ndjson");
  EXPECT_EQ(reply->fields.count("content-length"), 0u);
  EXPECT_EQ(client.receive().value_or(Reply{}).status, 200) << "the connection goes on";
  for (const std::string& chunk : reply->chunks) {
    EXPECT_EQ(chunk.find('\n'), chunk.size() - 1) << "a chunk is a line";
  }
  auto streamed = read_lines(*reply);
  ASSERT_GT(streamed.size(), 10u);
  Json whole = Json::parse(ask(port(), post("/v1/work-precision", small)).body);
  for (const auto& [key, value] : whole.items()) {
    if (key == "curves" || key == "pareto") continue;
    const bool ahead = streamed.front().contains(key);
    EXPECT_EQ((ahead ? streamed.front() : streamed.back()).at(key), value) << key;
  }
  EXPECT_EQ(whole["status"], "completed");
  for (const Json& line : streamed)
    EXPECT_EQ(line.at("kind"), &line == &streamed.front() ? "head" : &line == &streamed.back() ? "end" : "point");
  EXPECT_EQ(streamed.front().at("schemes")[1].at("composition"), "kahan_li_8");
  std::vector<Json> points(2);
  for (std::size_t i = 1; i + 1 < streamed.size(); ++i) {
    const Json& line = streamed[i];
    EXPECT_EQ(line.at("scheme"), streamed.front()["schemes"][line.at("curve").get<std::size_t>()]);
    points.at(line.at("curve").get<std::size_t>()).push_back(repeatable(line.at("point")));
  }
  ASSERT_EQ(whole["curves"].size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const Json& curve = whole["curves"][i];
    Json expected = Json::array();
    for (const Json& point : curve.at("points")) expected.push_back(repeatable(point));
    EXPECT_EQ(points[i], expected);
    for (const char* key : {"scheme", "setting", "observed_order", "expected_order"}) {
      EXPECT_EQ(streamed.back()["curves"][i].at(key), curve.at(key));
    }
    EXPECT_FALSE(streamed.back()["curves"][i].contains("points"));
  }
}

TEST_F(StudyHttp, PointsOfTheFrontAreRunsThatCanBeMade) {
  const std::string request =
      R"({"problem":"kepler","until":{"t":8},"schemes":["jacobi_maupertuis",{"id":"time_transformed","kappa":"energy"}]})";
  const Json whole = Json::parse(ask(port(), post("/v1/work-precision", request)).body);
  std::set<std::string> settings;
  for (const Json& best : whole.at("pareto")) {
    Json run{{"problem", whole["problem"]}, {"initial", whole["initial"]}, {"until", whole["until"]}};
    run["scheme"] = best.at("scheme");
    run["diagnostics"] = Json::array();
    const Json outcome = Json::parse(ask(port(), post("/v1/simulate", run.dump())).body);
    EXPECT_EQ(outcome.at("cost").at("force_evaluations"), best.at("force_evaluations")) << best;
    settings.insert(whole["curves"][best.at("curve").get<std::size_t>()].at("setting"));
  }
  EXPECT_TRUE(settings.contains("theta"));
}

// With damping, too, adaptive steps are measured; they have no longest stable step.
TEST_F(StudyHttp, StepsThatFollowADampedMotion) {
  runs::problem_called("damped_kepler");
  const std::string asked =
      R"({"problem":"damped_kepler","until":{"t":7},"schemes":[{"id":"time_transformed","composition":"kahan_li_6"}])";
  const Json study = Json::parse(ask(port(), post("/v1/work-precision", asked + "}")).body);
  const Json& curve = study.at("curves").at(0);
  EXPECT_EQ(curve.at("setting"), "sigma");
  EXPECT_NEAR(curve.at("observed_order").get<double>(), 6, 0.3) << curve;
  for (const Json& point : curve.at("points")) EXPECT_EQ(point.at("step"), nullptr);
  EXPECT_LT(study.at("pareto").back().at("error").get<double>(), 1e-9);
  const Json longest =
      Json::parse(
          ask(port(), post("/v1/stability", R"({"problem":"damped_kepler","schemes":["time_transformed"]})")).body)
          .at("limits")
          .at(0);
  for (const char* key : {"step", "failure", "theory"}) EXPECT_EQ(longest.at(key), nullptr) << key;
  EXPECT_EQ(longest.at("why"), "it chooses its steps in time itself");
}

TEST_F(StudyHttp, ClientsOfTheFirstVersionReadUntilTheEnd) {
  Client client(port());
  client.send("POST /v1/work-precision HTTP/1.0\r\nConnection: keep-alive\r\n" + std::string(lines) +
              "Content-Length: " + std::to_string(small.size()) + "\r\n\r\n" + std::string(small));
  std::string text;
  while (const auto more = client.some()) text += *more;
  EXPECT_EQ(text.find("Transfer-Encoding"), std::string::npos);
  EXPECT_NE(text.find("Connection: close"), std::string::npos);
  const auto last = text.rfind('\n', text.size() - 2);
  EXPECT_EQ(Json::parse(text.substr(last)).at("status"), "completed");
}

TEST_F(StudyHttp, TakesPostsOnly) {
  for (const char* path : {"/v1/work-precision", "/v1/stability"}) {
    Client client(port());
    client.send("HEAD " + std::string(path) + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
    const auto head = client.receive(true);
    EXPECT_EQ(head->status, 405);
    EXPECT_EQ(head->fields.at("allow"), "POST, OPTIONS");
    EXPECT_EQ(ask(port(), "OPTIONS " + std::string(path) + " HTTP/1.1\r\nHost: localhost\r\n\r\n").status, 204);
  }
}

TEST_F(StudyHttp, FindsTheLongestStableStep) {
  const Reply reply = ask(port(), post("/v1/stability", R"({"problem":"harmonic_oscillator","schemes":["leapfrog"]})"));
  ASSERT_EQ(reply.status, 200);
  const Json json = Json::parse(reply.body);
  ASSERT_EQ(json.at("limits").size(), 1u);
  EXPECT_NEAR(json["limits"][0].at("step").get<double>(), 2, 0.02);
  EXPECT_EQ(json["limits"][0].at("failure"), "energy_growth");
  EXPECT_EQ(json.at("status"), "completed");
}

// The alternatives are searched after the choice, and one of them may cost less.
TEST_F(StudyHttp, AutoTakesTheCheapestThatItTells) {
  const std::string request = R"({"problem":{"id":"custom","variables":["q1","q2"],
    "hamiltonian":"(p1^2+p2^2)/2*(1+q1^2*q2^2/3)+p1^4/10+q1^2/2+q2^2+0.2*q1*p2"},
    "initial":{"q1":0.7,"p1":0.5,"q2":0.2},"until":3,"record":{"every":0},"scheme":{"id":"auto","accuracy":1e-3}})";
  const Json made = Json::parse(ask(port(), post("/v1/simulate", request)).body);
  ASSERT_FALSE(made["choice"]["alternatives"].empty());
  for (const Json& other : made["choice"]["alternatives"])
    EXPECT_GE(other["force_evaluations"], made["cost"]["force_evaluations"]) << made["choice"];
}

// The step follows θ, and points say so.
TEST_F(StudyHttp, PointsSayTheStepThatGoesAlong) {
  const std::string request = R"({"problem":"kepler","until":{"t":20},"budget_seconds":10,
    "schemes":[{"id":"jacobi_maupertuis","step":0.02,"theta":0.01},"time_transformed"]})";
  const Json made = Json::parse(ask(port(), post("/v1/work-precision", request)).body);
  ASSERT_EQ(made["curves"][0]["setting"], "theta");
  ASSERT_FALSE(made["curves"][0]["points"].empty());
  for (const Json& point : made["curves"][0]["points"])
    EXPECT_NEAR(point["step"].get<double>() / point["value"].get<double>(), 2, 1e-12) << point;
  for (const Json& point : made["curves"][1]["points"]) EXPECT_TRUE(point["step"].is_null()) << point;
}

TEST_F(StudyHttp, AutoRunsWhatItChose) {
  const std::string request =
      R"({"problem":"van_der_pol","scheme":{"id":"auto","accuracy":1e-4},"until":{"t":5},
          "norm":"relative","diagnostics":["error"]})";
  Json json = Json::parse(ask(port(), post("/v1/simulate", request)).body);
  ASSERT_TRUE(json.contains("choice")) << json;
  EXPECT_EQ(json["status"], "completed");
  EXPECT_FALSE(json["choice"].at("reason").get<std::string>().empty());
  EXPECT_FALSE(json["choice"].at("alternatives").empty());
  const auto without_cost = [&] {
    Json answer = Json::parse(ask(port(), post("/v1/simulate", request)).body);
    answer.erase("cost");
    return answer.dump();
  };
  EXPECT_EQ(without_cost(), without_cost()) << "measured seconds stand in cost alone";
  const auto estimated = json["choice"].at("estimated_error").get<double>();
  EXPECT_LE(estimated, 3e-4);
  EXPECT_NEAR(json["diagnostics"]["error"]["max"].get<double>() / estimated, 1, 0.5) << "it is the run that was judged";
  Json again{{"problem", json["problem"]}, {"scheme", json.at("scheme")}, {"until", json["until"]}};
  again["record"] = json["record"];
  const Json run = Json::parse(ask(port(), post("/v1/simulate", again.dump())).body);
  EXPECT_EQ(run.at("final"), json.at("final")) << "the echo is the request for the run that was chosen";
  EXPECT_FALSE(run.contains("choice"));
  const Reply hasty = ask(port(), post("/v1/simulate", R"({"problem":"kepler","scheme":{"id":"auto","accuracy":1e-4},
                                                          "limits":{"seconds":1e-9}})"));
  ASSERT_EQ(hasty.status, 200) << "where nothing could be measured, a run comes back all the same";
  const Json choice = Json::parse(hasty.body).at("choice");
  EXPECT_TRUE(choice.at("met").is_null()) << choice;
  EXPECT_FALSE(choice.at("reason").get<std::string>().empty());
}

TEST(Study, AClientThatTakesNoMoreEndsIt) {
  Admission admission(1, 0);
  const std::atomic<bool> cancelled{false};
  MemoryBudget memory(1 << 20);
  const Context context{catalogue_cards(), {}, admission, cancelled, memory};
  const std::string body = R"({"problem":"kepler","until":{"t":400},"schemes":"all","budget_seconds":30})";
  const Answer answer = answer_now(measure_work_precision, context, {body, "application/x-ndjson", "id"});
  ASSERT_EQ(answer.status, 200);
  EXPECT_FALSE(admission.enter("").has_value()) << "it holds the place from the first line on";
  int written = 0;
  const auto from = Clock::now();
  const auto end = answer.stream([&](std::string_view) { return ++written < 4; });
  EXPECT_EQ(written, 4);
  EXPECT_NE(end.value_or("").find("\"reason\":\"cancelled\""), std::string::npos) << end.value_or("");
  EXPECT_LT(Clock::now() - from, 25s) << "what it was given is not used up";
  EXPECT_TRUE(admission.enter("").has_value());
}

using StudyLoad = OnePlace;

TEST_F(StudyLoad, TheBudgetHolds) {
  start();
  const auto from = Clock::now();
  for (const std::string_view fields : {lines, std::string_view()}) {
    const Reply reply = ask(service->port(), long_study(fields, 0.4));
    ASSERT_EQ(reply.status, 200);
    const Json last = fields.empty() ? Json::parse(reply.body) : read_lines(reply).back();
    EXPECT_TRUE(!last.at("left_out").empty() || last.at("status") == "stopped") << last;
  }
  EXPECT_LT(Clock::now() - from, 30s);
  EXPECT_TRUE(is_free_soon());
}

TEST_F(StudyLoad, TheEndOfTheServiceIsToldInTheLastLine) {
  settings.grace = 0.2;
  start();
  Client client(service->port());
  client.send(long_study(lines, 30));
  std::this_thread::sleep_for(400ms);
  const auto from = Clock::now();
  service->stop();
  EXPECT_LT(Clock::now() - from, 20s);
  const auto reply = client.receive();
  ASSERT_TRUE(reply) << "the last chunk comes";
  const Json last = read_lines(*reply).back();
  EXPECT_EQ(last.at("status"), "stopped");
  EXPECT_EQ(last.at("stop").at("reason"), "cancelled");
  EXPECT_TRUE(client.ended());
}

// For so many bodies there is no reference: this is not the effect of a time limit, and both studies say so.
TEST_F(StudyHttp, WithoutAReferenceThatCanBeMadeNothingStopped) {
  Json request = Json::parse(R"~({"problem":{"id":"custom","variables":["x[n]","y[n]"],"parameters":{"n":100},
      "potential":"-sum(i=1..n,j=i+1..n,1/sqrt((x[i]-x[j])^2+(y[i]-y[j])^2))"},"until":0.002})~");
  for (int i = 0; i < 100; ++i) {
    request["initial"]["x"].push_back(i % 10);
    request["initial"]["y"].push_back(i / 10);
  }
  Json run = request;
  request["schemes"] = {"leapfrog"};
  const Reply reply = ask(port(), post("/v1/work-precision", request.dump()));
  ASSERT_EQ(reply.status, 200) << reply.body;
  const Json study = Json::parse(reply.body);
  EXPECT_EQ(study["status"], "completed");
  EXPECT_FALSE(study.contains("stop"));
  EXPECT_NE(study["left_out"].dump().find("more operations than a reference"), std::string::npos) << study["left_out"];
  run["scheme"] = {{"id", "leapfrog"}, {"step", 0.001}};
  run["diagnostics"] = {"error"};
  const Json made = Json::parse(ask(port(), post("/v1/simulate", run.dump())).body);
  EXPECT_EQ(made["diagnostics"]["error"]["reference"], "none");
}

// explicit_euler is exact at every step for a free motion, and grows at every step for an oscillation.
TEST_F(StudyHttp, AFreeMotionIsStableAtEveryStep) {
  Json request = Json::parse(R"~({"problem":{"id":"custom","variables":["x"],"potential":"0*x"},"initial":{"vx":1},
      "schemes":["explicit_euler"]})~");
  const auto limit = [&] { return Json::parse(ask(port(), post("/v1/stability", request.dump())).body); };
  const Json free = limit();
  EXPECT_EQ(free.dump().find("energy_growth"), std::string::npos) << free;
  request["problem"]["potential"] = "x^2/2";
  EXPECT_NE(limit().dump().find("energy_growth"), std::string::npos);
  request["initial"]["vx"] = 0;  // at rest
  EXPECT_EQ(limit().dump().find("energy_growth"), std::string::npos);
}

// A long chaotic motion, whose true solution takes more than the time allowed.
TEST_F(StudyHttp, WithoutAReferenceItStopped) {
  runs::problem_called("thermostat");
  const Reply reply = ask(port(), post("/v1/work-precision", R"({"problem":"thermostat","until":{"t":3000},
    "schemes":["runge_kutta_4"],"budget_seconds":0.05})"));
  ASSERT_EQ(reply.status, 200) << reply.body;
  const Json study = Json::parse(reply.body);
  EXPECT_EQ(study["status"], "stopped");
  EXPECT_EQ(study["stop"]["reason"], "deadline");
  EXPECT_TRUE(study["curves"][0]["points"].empty());
}

}  // namespace
}  // namespace least::server::test
