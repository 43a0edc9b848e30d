// Memory: of answers that nobody reads, of requests that wait for their turn, of the whole process.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <string>
#include <thread>

#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"
#include "tests/server/process.hpp"

namespace least::server::test {
namespace {

using namespace std::chrono_literals;

std::size_t held_by(int port) {
  const std::string text = ask(port, get("/metrics")).body;
  return std::stoul(text.substr(text.find("\nleastaction_held_bytes ") + 23));
}
bool holds_within_time(int port, std::size_t least, std::size_t most) {
  for (int i = 0; i < 2000; ++i) {
    if (const auto held = held_by(port); held >= least && held <= most) return true;
    std::this_thread::sleep_for(5ms);
  }
  return false;
}

Settings narrow_settings() {
  Settings settings = quiet_settings();
  settings.caps.samples = 1000;
  settings.max_memory = 5'000'000;
  settings.bounds.stall = 60s;
  settings.threads = 1;
  return settings;
}

TEST(Memory, IsBoundedAcrossTextsThatNobodyReads) {
  const std::string body(4'000'000, 'x');
  const Asset assets[] = {{"/large.txt", "font/none", body}};
  Service service(narrow_settings(), assets);
  ASSERT_FALSE(service.start());
  Client reads(service.port());
  reads.send(get("/large.txt"));
  EXPECT_EQ(reads.receive().value_or(Reply{}).body.size(), body.size());
  EXPECT_TRUE(holds_within_time(service.port(), 0, 0)) << "a connection that has all";
  Client does_not(service.port());
  does_not.send(get("/large.txt"));
  EXPECT_TRUE(holds_within_time(service.port(), body.size(), body.size()));
  const Reply refused = ask(service.port(), get("/large.txt"));
  EXPECT_EQ(refused.status, 503);
  EXPECT_NE(refused.body.find("--max-memory"), std::string::npos) << refused.body;
  EXPECT_TRUE(refused.fields.contains("retry-after"));
  does_not.hang_up();
  EXPECT_TRUE(holds_within_time(service.port(), 0, 0));
  EXPECT_EQ(ask(service.port(), get("/large.txt")).status, 200);
}

TEST(Memory, IsBoundedAcrossRequestsThatWait) {
  Settings settings = narrow_settings();
  settings.max_memory = 4'000'000;
  Service service(settings, page_assets);
  ASSERT_FALSE(service.start());
  const auto run = [](std::size_t spaces) {
    return post("/v1/simulate", std::string(spaces, ' ') +
                                    R"({"problem":"kepler","scheme":"leapfrog","record":{"every":0},
      "until":{"steps":10000000000},"limits":{"steps":10000000000,"seconds":10}})");
  };
  constexpr std::size_t large = 800'000;
  Client computing(service.port()), waiting(service.port()), too(service.port());
  computing.send(run(0));
  EXPECT_TRUE(holds_within_time(service.port(), 1, 4 * large));
  const std::size_t alone = held_by(service.port());  // the most that an answer takes
  waiting.send(run(large));
  EXPECT_TRUE(holds_within_time(service.port(), alone + large, alone + 2 * large)) << "and nothing is made of it yet";
  too.send(run(large));
  EXPECT_TRUE(holds_within_time(service.port(), alone + 2 * large, alone + 4 * large));
  const Reply refused = ask(service.port(), run(large));
  EXPECT_EQ(refused.status, 503);
  EXPECT_NE(refused.body.find("--max-memory"), std::string::npos) << refused.body;
  waiting.hang_up();
  too.hang_up();
  computing.hang_up();
  EXPECT_TRUE(holds_within_time(service.port(), 0, 0));
}

// The parsed tree of a text may be forty times as large as the text.
TEST(Memory, IsBoundedAcrossTreesOfRequests) {
  std::string columns;
  while (columns.size() < 900'000) columns += R"({"a":1},)";
  const std::string request =
      post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","columns":[)" + columns + "1]}");
  Service narrow(narrow_settings(), page_assets), wide(quiet_settings(), page_assets);
  ASSERT_FALSE(narrow.start());
  ASSERT_FALSE(wide.start());
  EXPECT_EQ(ask(wide.port(), request).status, 422);
  const Reply refused = ask(narrow.port(), request);
  EXPECT_EQ(refused.status, 503);
  EXPECT_NE(refused.body.find("--max-memory"), std::string::npos) << refused.body;
  EXPECT_TRUE(refused.fields.contains("retry-after"));
  EXPECT_TRUE(holds_within_time(narrow.port(), 0, 0));
}

#if !defined(__SANITIZE_ADDRESS__)  // a sanitizer has needs of its own

double mebibytes(const Process& service, const std::string& name) {
  std::ifstream file("/proc/" + std::to_string(service.id()) + "/status");
  double kibibytes = 0;
  for (std::string word; file >> word;) {
    if (word == name && file >> kibibytes) break;
  }
  return kibibytes / 1024;
}

// A run of a million samples of five numbers: 40 million bytes where it is kept, next to nothing in lines.
TEST(Memory, OfTheProcessFollowsWhatIsKept) {
  Process service({"serve", "--port", "0"});
  const int port = port_in(service.line());
  const auto run = [&](const char* accept) {
    const Reply reply = ask(port, post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog",
      "until":{"steps":999999},"record":{"every":1}})",
                                       accept));
    EXPECT_GT(reply.body.size(), 40'000'000U);
  };
  const auto most = [&] { return mebibytes(service, "VmHWM:"); };
  ask(port, post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog"})"));
  const double before = most();
  run("Accept: application/x-ndjson\r\n");
  EXPECT_LT(most(), before + 4);
  run("");
  EXPECT_LT(most(), before + 45);
  EXPECT_LT(mebibytes(service, "VmRSS:"), before + 8) << "and all of it goes back";
}

TEST(Memory, WithoutItsThreadsTheServiceDoesNotBegin) {
  // A thread's stack takes 8 MiB of the 1 GiB of addresses.
  std::FILE* const service =
      ::popen("ulimit -v 1048576; exec " LEAST_BINARY " serve --port 0 --threads 4096 2>&1", "r");
  std::string said;
  for (int c; (c = std::fgetc(service)) != EOF;) said += static_cast<char>(c);
  EXPECT_EQ(WEXITSTATUS(::pclose(service)), 1);
  EXPECT_NE(said.find("cannot start the threads"), std::string::npos) << said;
  EXPECT_EQ(said.find("listening"), std::string::npos) << said;
}

#endif

}  // namespace
}  // namespace least::server::test
