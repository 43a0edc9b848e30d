// The built binary: commands, exit codes, signals.
#include "tests/server/process.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <thread>

#include "least_version.hpp"
#include "server/decode/json_parse.hpp"
#include "tests/server/client.hpp"

namespace least::server::test {
namespace {

using namespace std::chrono_literals;

const std::string endless_run = R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":10000000000},
    "record":{"every":0},"limits":{"steps":10000000000,"seconds":60}})";
const std::string kepler_run = R"({"problem":"kepler","scheme":"leapfrog","until":{"t":1}})";

TEST(Command, RunAnswersAsHttpWould) {
  Process run({"run", "-"}, kepler_run);
  const Json json = Json::parse(run.output());
  EXPECT_EQ(json["status"], "completed");
  EXPECT_EQ(run.errors(), "");
  EXPECT_EQ(run.wait(), 0);

  const std::string file = testing::TempDir() + "least_request.json";
  std::ofstream(file) << kepler_run;
  Process from_file({"run", file});
  Json again = Json::parse(from_file.output()), first = json;
  again.erase("cost");
  first.erase("cost");
  EXPECT_EQ(again.dump(), first.dump());
  EXPECT_EQ(from_file.wait(), 0);
  std::filesystem::remove(file);
}

TEST(Command, RunSaysWhatIsWrong) {
  Process faulty({"run", "-"}, R"({"problem":"kepler"})");
  EXPECT_EQ(Json::parse(faulty.output())["status"], 422);
  EXPECT_EQ(faulty.wait(), 2);
  Process broken({"run", "-"}, "{");
  EXPECT_EQ(Json::parse(broken.output())["status"], 400);
  EXPECT_EQ(broken.wait(), 2);
  Process nothing({"run", "/nonexistent/request.json"});
  const Json document = Json::parse(nothing.output());
  EXPECT_EQ(document["status"], 400);
  EXPECT_NE(document["detail"].get<std::string>().find("/nonexistent/request.json"), std::string::npos);
  EXPECT_EQ(nothing.wait(), 2);
  Process folder({"run", "/"});
  EXPECT_EQ(Json::parse(folder.output())["status"], 400);
  EXPECT_EQ(folder.wait(), 2);
}

TEST(Command, CatalogueVersionAndHelp) {
  Process catalogue({"catalogue"});
  const Json cards = Json::parse(catalogue.output());
  EXPECT_FALSE(cards["schemes"].empty());
  EXPECT_EQ(catalogue.wait(), 0);
  for (const Json& problem : cards["problems"]) {
    if (problem["id"] != "kepler") continue;
    std::vector<std::string> invariants;
    for (const Json& invariant : problem["invariants"]) invariants.push_back(invariant["name"]);
    EXPECT_EQ(invariants,
              (std::vector<std::string>{"energy", "angular_momentum", "laplace_runge_lenz_x", "laplace_runge_lenz_y"}));
  }
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"--version"},
                                                    {"serve", "--version"},
                                                    {"run", "--version"},
                                                    {"catalogue", "--version"}}) {
    Process version(arguments);
    EXPECT_EQ(version.output(), "leastaction " + std::string(least::version) + "\n");
    EXPECT_EQ(version.wait(), 0);
  }
  Process help({"serve", "--help"});
  EXPECT_NE(help.output().find("LEASTACTION_PORT"), std::string::npos);
  EXPECT_EQ(help.wait(), 0);
  const auto mistaken = [](const std::vector<std::string>& arguments,
                           const std::vector<std::string>& environment = {}) {
    Process mistake(arguments, "", environment);
    const std::string errors = mistake.errors();
    EXPECT_EQ(mistake.output(), "");
    EXPECT_EQ(mistake.wait(), 1);
    return errors.substr(0, errors.find('\n'));
  };
  EXPECT_EQ(mistaken({"serve", "--prot", "1"}), "leastaction: no `--prot`; did you mean `--port`?");
  EXPECT_EQ(mistaken({"serv"}), "leastaction: no `serv`; did you mean `serve`?");
  EXPECT_EQ(mistaken({"bogus"}), "leastaction: no `bogus`; there are serve, run, ensemble, merge, catalogue, health");
  EXPECT_NE(mistaken({}).find("subcommand"), std::string::npos);
  EXPECT_EQ(mistaken({"serve"}, {"LEASTACTION_PORT=abc"}).find("leastaction: LEASTACTION_PORT: "), 0u);
  EXPECT_EQ(mistaken({"serve", "--port=abc"}, {"LEASTACTION_PORT=1"}).find("leastaction: --port: "), 0u);
}

TEST(Command, OptionsComeFromTheEnvironment) {
  Process serve({"serve"}, "", {"LEASTACTION_PORT=0"});
  EXPECT_GT(port_in(serve.line()), 0);
  serve.signal(SIGTERM);
  EXPECT_EQ(serve.wait(), 0);
  Process run({"run", "-"}, R"({"problem":"kepler","scheme":"leapfrog","limits":{"seconds":2}})",
              {"LEASTACTION_MAX_SECONDS=1"});
  EXPECT_EQ(Json::parse(run.output())["errors"][0]["allowed"], "(0, 1]");
  EXPECT_EQ(run.wait(), 2);
}

TEST(Command, ServeSaysWhereAndLogsEachRequest) {
  Process serve({"serve", "--port", "0"});
  const std::string line = serve.line();
  EXPECT_EQ(line.find("listening on http://127.0.0.1:"), 0u) << line;
  EXPECT_EQ(ask(port_in(line), get("/")).status, 200);
  const Reply reply = ask(port_in(line), post("/v1/simulate", kepler_run));
  EXPECT_EQ(reply.status, 200);
  serve.signal(SIGINT);
  EXPECT_EQ(serve.output(), "");
  const std::string log = serve.errors();
  EXPECT_NE(log.find("id=" + reply.fields.at("x-request-id") + " method=POST route=/v1/simulate status=200 ms="),
            std::string::npos)
      << log;
  EXPECT_EQ(serve.wait(), 0);
}

TEST(Command, APortInUseIsAnError) {
  Process first({"serve", "--port", "0"});
  const std::string line = first.line();
  Process second({"serve", "--port", std::to_string(port_in(line))});
  EXPECT_EQ(second.output(), "");
  EXPECT_NE(second.errors().find("Address already in use"), std::string::npos);
  EXPECT_EQ(second.wait(), 1);
  first.signal(SIGTERM);
  EXPECT_EQ(first.wait(), 0);
  Process third({"serve", "--port", std::to_string(port_in(line))});  // free again at once
  EXPECT_EQ(third.line(), line);
}

TEST(Command, TerminationAnswersWhatWasAccepted) {
  Process serve({"serve", "--port", "0", "--grace", "0.3"});
  const int port = port_in(serve.line());
  Client running(port);
  running.send(post("/v1/simulate", endless_run));
  std::this_thread::sleep_for(300ms);
  serve.signal(SIGTERM);
  const auto reply = running.receive();
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 200);
  EXPECT_EQ(Json::parse(reply->body)["stop"]["reason"], "cancelled");
  EXPECT_EQ(serve.wait(), 0);
}

TEST(Command, RunReadsNoMoreThanItMay) {
  Process endless({"run", "/dev/zero"});
  EXPECT_EQ(Json::parse(endless.output())["status"], 413);
  EXPECT_EQ(endless.wait(), 2);
  Process large({"run", "-", "--max-body", "20"}, kepler_run);
  const Json document = Json::parse(large.output());
  EXPECT_EQ(document["status"], 413);
  EXPECT_NE(document["detail"].get<std::string>().find("20 bytes"), std::string::npos);
  EXPECT_EQ(large.wait(), 2);
  Process just({"run", "-", "--max-body", std::to_string(kepler_run.size())}, kepler_run);
  EXPECT_EQ(Json::parse(just.output())["status"], "completed");
  EXPECT_EQ(just.wait(), 0);
}

TEST(Command, RunReadsAPipeWithAName) {
  const std::string name = testing::TempDir() + "least_request.fifo";
  for (int k = 0; k < 5; ++k) {
    std::filesystem::remove(name);
    ASSERT_EQ(::mkfifo(name.c_str(), 0600), 0);
    Process run({"run", name});
    std::ofstream(name) << kepler_run;
    EXPECT_EQ(Json::parse(run.output())["status"], "completed");
    EXPECT_EQ(run.wait(), 0);
  }
  std::filesystem::remove(name);
}

// An answer that is written while it is computed is whole here, too.
TEST(Command, RunPrintsLargeAnswers) {
  Process run({"run", "-"}, R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":50000},"record":{"every":1}})");
  const Json answer = Json::parse(run.output());
  EXPECT_EQ(answer["trajectory"]["x"].size(), 50'001u);
  EXPECT_EQ(run.wait(), 0);
}

TEST(Command, HealthAsksTheService) {
  Process serve({"serve", "--port", "0"});
  const std::string port = std::to_string(port_in(serve.line()));
  Process good({"health", "--port", port}), by_name({"health"}, "", {"LEASTACTION_PORT=" + port});
  EXPECT_EQ(good.wait(), 0);
  EXPECT_EQ(by_name.wait(), 0);
  serve.signal(SIGTERM);
  EXPECT_EQ(serve.wait(), 0);
  Process bad({"health", "--port", port});
  EXPECT_NE(bad.errors().find(port), std::string::npos);
  EXPECT_EQ(bad.wait(), 1);
}

TEST(Command, NumbersThatAreNoneAreRefused) {
  for (const char* option : {"--grace", "--max-seconds"}) {
    for (const char* value : {"nan", "inf", "-nan"}) {
      Process serve({"serve", "--port", "0", option, value});
      EXPECT_NE(serve.errors().find(option), std::string::npos) << value;
      EXPECT_EQ(serve.wait(), 1) << option << value;
    }
  }
}

// The log of a service may remain unread: the service goes on, and ends properly.
TEST(Command, ALogThatNobodyReadsHoldsNothingUp) {
  Process serve({"serve", "--port", "0"});
  const int port = port_in(serve.line());
  Client client(port);
  constexpr int requests = 3000;  // a pipe takes 64 KiB: some 500 lines
  for (int i = 0; i < requests; ++i) {
    ASSERT_TRUE(client.send(get("/nowhere")));
    ASSERT_EQ(client.receive().value_or(Reply{}).status, 404) << i;
  }
  const auto from = std::chrono::steady_clock::now();
  serve.signal(SIGTERM);
  EXPECT_EQ(serve.wait(), 0);
  EXPECT_LT(std::chrono::steady_clock::now() - from, 5s);
}

TEST(Command, AStreamThatIsClosedIsNoClients) {
  for (const int closed : {0, 2}) {
    Process serve({"serve", "--port", "0"}, "", {}, closed);
    const int port = port_in(serve.line());
    Client client(port);
    for (int i = 0; i < 3; ++i) {
      client.send(get("/healthz"));
      EXPECT_EQ(client.receive().value_or(Reply{}).body, "{\"status\":\"ok\"}\n") << closed;
    }
    serve.signal(SIGTERM);
    EXPECT_TRUE(client.ended()) << "nothing but answers comes to a client";
    EXPECT_EQ(serve.wait(), 0);
  }
}

TEST(Command, TheLogSaysWhatHappened) {
  for (const char* format : {"text", "json"}) {
    Process serve({"serve", "--port", "0", "--log-format", format});
    const int port = port_in(serve.line());
    ask(port, post("/v1/simulate", kepler_run));
    ask(port, post("/v1/simulate", R"({"problem":"keplr","scheme":"leapfrog"})"));
    Client(port).send("GET / HTTP/1.1\r\nHo");
    std::string log = serve.errors_until("aborted");
    serve.signal(SIGTERM);
    log += serve.errors();
    EXPECT_EQ(serve.wait(), 0);
    if (std::string_view(format) == "text") {
      for (const char* part :
           {" info start url=http://127.0.0.1:", "run=completed problem=kepler scheme=leapfrog steps=", " seconds=",
            "reason=\"/problem unknown problem; did you mean", " info aborted client=127.0.0.1",
            " info ending why=signal"}) {
        EXPECT_NE(log.find(part), std::string::npos) << part << "\n" << log;
      }
      continue;
    }
    std::istringstream lines(log);
    std::vector<std::string> events;
    for (std::string line; std::getline(lines, line);) {
      const Json entry = Json::parse(line);
      events.push_back(entry.at("event"));
      EXPECT_FALSE(entry.at("time").get<std::string>().empty());
      EXPECT_EQ(entry.at("level"), "info");
      if (entry.contains("scheme")) {
        EXPECT_EQ(entry.at("status"), 200);
        EXPECT_EQ(entry.at("problem"), "kepler");
        EXPECT_GT(entry.at("steps"), 0);
      }
    }
    EXPECT_EQ(events, (std::vector<std::string>{"start", "request", "request", "aborted", "ending"}));
  }
}

// A client with half a request delays the end by no more than a second or so.
TEST(Command, HalfOpenClientsDoNotCostTheGrace) {
  Process serve({"serve", "--port", "0", "--grace", "10"});
  const int port = port_in(serve.line());
  Client half(port), body(port);
  half.send("GET / HTTP/1.1\r\nHo");
  body.send("POST /v1/simulate HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9\r\n\r\n{");
  std::this_thread::sleep_for(300ms);
  const auto from = std::chrono::steady_clock::now();
  serve.signal(SIGTERM);
  EXPECT_EQ(serve.wait(), 0);
  EXPECT_LT(std::chrono::steady_clock::now() - from, 5s);
}

// The number does not depend on the clients and what they do.
TEST(Command, TheNumberOfThreadsIsThatOfTheCoresAndFour) {
  for (const unsigned places : {0u, 3u}) {
    Process serve({"serve", "--port", "0", "--threads", std::to_string(places)});
    const int port = port_in(serve.line());
    const auto threads = [&] {
      std::ifstream status("/proc/" + std::to_string(serve.id()) + "/status");
      for (std::string word; status >> word;) {
        if (word != "Threads:") continue;
        unsigned n = 0;
        status >> n;
        return n;
      }
      return 0u;
    };
    const unsigned most = (places > 0 ? places : std::thread::hardware_concurrency()) + 4;
    EXPECT_GE(threads(), most - 3);
    std::vector<Client> clients;
    for (int i = 0; i < 300; ++i) {
      const bool computes = i % 3 == 0;
      clients.emplace_back(port).send(computes ? post("/v1/simulate", endless_run) : get("/healthz"));
      if (!computes) {
        EXPECT_EQ(clients.back().receive().value_or(Reply{}).status, 200) << i;
      }
    }
    EXPECT_LE(threads(), most);
  }
}

// Where descriptors run out idle connections make room; where none is idle, new ones wait, and are served later.
TEST(Command, SurvivesWithoutFreeDescriptors) {
  const rlimit few{24, 24};
  Process serve({"serve", "--port", "0"}, "", {}, -1, &few);
  const int port = port_in(serve.line());
  std::vector<Client> idle;
  for (int i = 0; i < 60; ++i) {
    idle.emplace_back(port).send(get("/healthz"));
    ASSERT_EQ(idle.back().receive().value_or(Reply{}).status, 200) << i;
  }
  std::vector<Client> half;
  for (int i = 0; i < 30; ++i) half.emplace_back(port).send("GET / HTTP/1.1\r\nHo");
  Client late(port);
  late.send(get("/healthz"));
  EXPECT_EQ(late.receive().value_or(Reply{}).status, 200);
  EXPECT_FALSE(half.front().receive()) << "the oldest went without an answer, before its time was over";
  EXPECT_NE(serve.errors_until("descriptors").find("allowed=24 needed=8224"), std::string::npos);
  serve.signal(SIGTERM);
  EXPECT_EQ(serve.wait(), 0);
}

// A shell gives few descriptors, and allows more.
TEST(Command, TakesTheDescriptorsThatItsConnectionsNeed) {
  const rlimit few{24, 4096};
  Process serve({"serve", "--port", "0", "--connections", "200"}, "", {}, -1, &few);
  const int port = port_in(serve.line());
  std::vector<Client> clients;
  for (int round = 0; round < 2; ++round) {
    for (std::size_t i = 0; i < 200; ++i) {
      if (round == 0) clients.emplace_back(port);
      clients[i].send(get("/healthz"));
      ASSERT_EQ(clients[i].receive().value_or(Reply{}).status, 200) << i;
    }
  }
  serve.signal(SIGTERM);
  EXPECT_EQ(serve.errors().find("descriptors"), std::string::npos);
  EXPECT_EQ(serve.wait(), 0);
}

// The logged time is no longer than the client saw, and a client that leaves after its answer aborted nothing.
TEST(Command, TheLogSaysWhenAnAnswerWasThere) {
  Process serve({"serve", "--port", "0"});
  const int port = port_in(serve.line());
  std::map<std::string, double> seen;  // in milliseconds, by what the request is called
  for (const std::string& request : {get("/healthz"), post("/v1/simulate", kepler_run), get("/nowhere")}) {
    for (int i = 0; i < 5; ++i) {
      Client client(port);
      const auto from = std::chrono::steady_clock::now();
      client.send(request);
      const auto reply = client.receive();
      ASSERT_TRUE(reply);
      seen[reply->fields.at("x-request-id")] =
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - from).count();
      if (i % 2) client.reset();
      std::this_thread::sleep_for(10ms);
    }
  }
  serve.signal(SIGTERM);
  const std::string log = serve.errors();
  EXPECT_EQ(serve.wait(), 0);
  EXPECT_EQ(log.find("aborted"), std::string::npos) << log;
  for (const auto& [id, ms] : seen) {
    const auto at = log.find(" ms=", log.find("id=" + id + " "));
    ASSERT_NE(at, std::string::npos) << log;
    EXPECT_LE(std::stod(log.substr(at + 4)), ms) << id;
  }
}

}  // namespace
}  // namespace least::server::test
