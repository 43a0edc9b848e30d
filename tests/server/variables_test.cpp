// The built binary: options from the environment, sizes, the first line of the log, and signals.
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/decode/json_parse.hpp"
#include "tests/server/client.hpp"
#include "tests/server/process.hpp"

namespace least::server::test {
namespace {

using namespace std::chrono_literals;

// log_of() returns what a service with these arguments and variables logs until it is ended; the log says why it ended.
std::string log_of(std::vector<std::string> arguments, std::vector<std::string> environment) {
  arguments.insert(arguments.begin(), "serve");
  Process serve(std::move(arguments), "", std::move(environment));
  EXPECT_GT(port_in(serve.line()), 0);
  serve.signal(SIGTERM);
  const std::string log = serve.errors();
  EXPECT_EQ(serve.wait(), 0) << log;
  return log;
}

TEST(Variables, ThatNoOptionHasAreNamed) {
  const std::string log = log_of({"--port", "0"}, {"LEASTACTION_MAX_STEP=7", "LEASTACTION_ZZZ=1", "OTHER=1"});
  EXPECT_NE(log.find("warning environment why=\"no option has the variable LEASTACTION_MAX_STEP; did you mean "
                     "LEASTACTION_MAX_STEPS?\""),
            std::string::npos)
      << log;
  EXPECT_NE(log.find("no option has the variable LEASTACTION_ZZZ"), std::string::npos) << log;
  EXPECT_EQ(log.find("OTHER"), std::string::npos);
  Process catalogue({"catalogue"}, "", {"LEASTACTION_PORT=80"});  // of another command
  EXPECT_FALSE(catalogue.output().empty());
  EXPECT_EQ(catalogue.errors(), "");
  EXPECT_EQ(catalogue.wait(), 0);
}

TEST(Variables, GiveWayToTheCommandLineWithAWord) {
  for (const char* value : {"LEASTACTION_PORT=abc", "LEASTACTION_PORT=70000", "LEASTACTION_PORT=8080"}) {
    const std::string log = log_of({"--port", "0"}, {value});
    EXPECT_NE(log.find("\"LEASTACTION_PORT is overlooked: --port is given\""), std::string::npos) << log;
  }
  Process bad({"serve"}, "", {"LEASTACTION_PORT=abc"});
  EXPECT_EQ(bad.errors().find("leastaction: LEASTACTION_PORT: "), 0u);
  EXPECT_EQ(bad.wait(), 1);
}

TEST(Sizes, TakeUnits) {
  EXPECT_NE(log_of({"--port", "0", "--max-memory", "100M"}, {}).find(" memory=104857600 "), std::string::npos);
  EXPECT_NE(log_of({"--port", "0"}, {"LEASTACTION_MAX_MEMORY=2G"}).find(" memory=2147483648 "), std::string::npos);
  EXPECT_NE(log_of({"--port", "0", "--max-memory", "100000000"}, {}).find(" memory=100000000 "), std::string::npos);
  for (const char* wrong : {"M", "1.5G", "1MB", "-1M", "99999999999G", "1M ", "0x1M"}) {
    Process serve({"serve", "--port", "0", "--max-memory", wrong});
    EXPECT_EQ(serve.errors().find("leastaction: --max-memory: "), 0u) << wrong;
    EXPECT_EQ(serve.wait(), 1) << wrong;
  }
  Process narrow({"run", "-", "--max-body", "1K"}, std::string(1025, ' '));
  EXPECT_EQ(Json::parse(narrow.output())["status"], 413);
  EXPECT_EQ(narrow.wait(), 2);
}

TEST(Sizes, RunHoldsNoMoreMemoryThanItMay) {
  std::string numbers = "0";
  for (int i = 0; i < 200'000; ++i) numbers += ",0";
  const std::string request = R"({"problem":"kepler","scheme":"leapfrog","numbers":[)" + numbers + "]}";
  for (const char* command : {"run", "ensemble"}) {
    const std::vector<std::string> narrow{command, "-", "--max-samples", "2"};
    Process refused(narrow, request, {"LEASTACTION_MAX_MEMORY=1M"});
    const Json document = Json::parse(refused.output());
    EXPECT_EQ(document["status"], 503) << document;
    EXPECT_NE(document["detail"].get<std::string>().find("(--max-memory)"), std::string::npos) << document;
    EXPECT_EQ(refused.errors(), "");
    EXPECT_NE(refused.wait(), 0);
    Process wide(narrow, request);
    EXPECT_EQ(Json::parse(wide.output())["errors"][0]["pointer"], "/numbers") << "which is read, and has no meaning";
    EXPECT_EQ(wide.wait(), 2);
  }
  // The largest answer has room in any case.
  Process large({"run", "-", "--max-memory", "1M"},
                R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":50000},"record":{"every":1}})");
  EXPECT_EQ(Json::parse(large.output())["trajectory"]["x"].size(), 50'001U);
  EXPECT_EQ(large.wait(), 0);
}

TEST(Variables, MergeHasNoLimitsOfRequests) {
  for (const char* option : {"--max-seconds", "--max-steps", "--max-samples", "--max-body", "--max-memory"}) {
    Process merge({"merge", option, "5", "part"});
    EXPECT_NE(merge.errors().find(option), std::string::npos) << option;
    EXPECT_EQ(merge.wait(), 1) << option;
  }
}

TEST(Log, TheFirstLineSaysWhatRuns) {
  const std::string log = log_of({"--port", "0", "--threads", "3", "--queue", "5"}, {});
  const std::string first = log.substr(0, log.find('\n'));
  for (const char* part : {" info start url=http://127.0.0.1:", " version=", " threads=3 ", " memory=1073741824 ",
                           " queue=5 ", " connections=8192 ", " max_seconds=", " max_steps=", " max_samples="}) {
    EXPECT_NE(first.find(part), std::string::npos) << part << "\n" << first;
  }
  EXPECT_EQ(first.find("metrics_port"), std::string::npos);
  // Only the log says which port was picked.
  const std::string apart = log_of({"--port", "0", "--metrics-port", "0"}, {});
  constexpr std::string_view before = " metrics_port=";
  const auto place = apart.find(before);
  ASSERT_LT(place, apart.find('\n')) << apart;
  EXPECT_GT(std::stoi(apart.substr(place + before.size())), 0) << apart;
}

TEST(Log, NamesTheClientBehindAProxyAndItsRequest) {
  Process serve({"serve", "--port", "0", "--trusted-proxy", "10.0.0.1,127.0.0.1"});
  ask(port_in(serve.line()), get("/v1", "X-Forwarded-For: 1.2.3.4\r\nX-Request-Id: a=b\r\n"));
  serve.signal(SIGTERM);
  const std::string log = serve.errors();
  EXPECT_EQ(serve.wait(), 0);
  EXPECT_NE(log.find("id=\"a=b\" method=GET route=/v1 "), std::string::npos) << log;
  EXPECT_NE(log.find(" client=1.2.3.4\n"), std::string::npos) << log;
  Process wrong({"serve", "--port", "0", "--trusted-proxy", "proxy"});
  EXPECT_EQ(wrong.errors().find("leastaction: --trusted-proxy: `proxy` is no address"), 0u);
  EXPECT_EQ(wrong.wait(), 1);
}

// A closing terminal ends the service as SIGTERM does, and a run that computes is answered.
TEST(Signals, HangingUpEndsInGoodOrder) {
  Process serve({"serve", "--port", "0", "--grace", "0.3"});
  const int port = port_in(serve.line());
  Client running(port);
  running.send(post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":10000000000},
    "record":{"every":0},"limits":{"steps":10000000000,"seconds":60}})"));
  while (ask(port, get("/metrics")).body.find("\nleastaction_running 1\n") == std::string::npos)
    std::this_thread::sleep_for(5ms);
  serve.signal(SIGHUP);
  const auto reply = running.receive();
  ASSERT_TRUE(reply);
  EXPECT_EQ(Json::parse(reply->body)["stop"]["reason"], "cancelled");
  EXPECT_EQ(serve.wait(), 0);
}

// From the signal on /readyz says so, and nobody is refused until the port closes.
TEST(Signals, ARolloutIsSeenBeforeThePortCloses) {
  Process serve({"serve", "--port", "0"}, "", {"LEASTACTION_DRAIN=2"});
  const int port = port_in(serve.line());
  EXPECT_EQ(ask(port, get("/readyz")).status, 200);
  serve.signal(SIGTERM);
  int status = 200, served = 0;
  bool was_told = false;
  for (; status != 0; status = ask(port, get("/readyz")).status) {
    was_told = was_told || status == 503;
    served += was_told && status == 503 ? 1 : 0;
    std::this_thread::sleep_for(5ms);
  }
  EXPECT_TRUE(was_told);
  EXPECT_GT(served, 5) << "two seconds of them";
  EXPECT_EQ(serve.wait(), 0);
}

}  // namespace
}  // namespace least::server::test
