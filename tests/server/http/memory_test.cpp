// The memory of what waits: texts that nobody reads, and requests whose turn has not come.
#include <gtest/gtest.h>

#include <string>
#include <thread>

#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"

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
  Service service(narrow_settings(), page_assets);
  ASSERT_FALSE(service.start());
  const auto run = [](std::size_t spaces) {
    return post("/v1/simulate", std::string(spaces, ' ') +
                                    R"({"problem":"kepler","scheme":"leapfrog","record":{"every":0},
      "until":{"steps":10000000000},"limits":{"steps":10000000000,"seconds":20}})");
  };
  constexpr std::size_t large = 800'000;
  Client computing(service.port()), waiting(service.port());
  computing.send(run(0));
  while (ask(service.port(), get("/metrics")).body.find("\nleastaction_running 1") == std::string::npos) {
  }
  waiting.send(run(large));
  EXPECT_TRUE(holds_within_time(service.port(), 5 * large, 6 * large)) << "with what is made of it";
  const Reply refused = ask(service.port(), run(large / 4));
  EXPECT_EQ(refused.status, 503);
  EXPECT_NE(refused.body.find("--max-memory"), std::string::npos) << refused.body;
  waiting.hang_up();
  computing.hang_up();
  EXPECT_TRUE(holds_within_time(service.port(), 0, 0));
}

}  // namespace
}  // namespace least::server::test
