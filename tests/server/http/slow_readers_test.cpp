// Streams with slow readers: their runs lend their places to others, and go on when there is room.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <list>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "server/decode/json_parse.hpp"
#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr int tight_buffer = 16 * 1024;  // bytes that the system holds between the two ends

class SlowReaders : public testing::Test {
 protected:
  Settings settings = quiet_settings();
  std::unique_ptr<Service> service;
  std::list<Client> slow;

  void start(unsigned threads) {
    settings.threads = threads;
    settings.bounds.send_buffer = tight_buffer;
    settings.bounds.stall = settings.bounds.drip = 60s;
    service = std::make_unique<Service>(settings, page_assets);
    ASSERT_FALSE(service->start());
  }
  // read_slowly() requests megabytes, of which nothing is read but what the system buffers.
  Client& read_slowly(const std::string& path, const std::string& body) {
    slow.emplace_back(service->port(), nullptr, tight_buffer)
        .send(post(path, body, "Accept: application/x-ndjson\r\n"));
    return slow.back();
  }
  Client& simulate_slowly(int steps = 40'000) {
    return read_slowly("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","record":{"every":1},
      "columns":["t","x"],"limits":{"seconds":60},"until":{"steps":)" +
                                           std::to_string(steps) + "}}");
  }
  double metric(const std::string& name) const {
    const std::string text = ask(service->port(), get("/metrics")).body;
    return std::stod(text.substr(text.find("\nleastaction_" + name + " ") + name.size() + 14));
  }
  void await(const std::string& name, double value) const {
    double now = metric(name);
    for (const auto from = Clock::now(); now != value && Clock::now() - from < 30s; now = metric(name))
      std::this_thread::sleep_for(5ms);
    EXPECT_EQ(now, value) << name;
  }
  void others_are_served() const {
    for (int i = 0; i < 3; ++i) {
      await("running", 0);  // the run before gives its place back a little after its answer
      const auto request = post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":10}})");
      EXPECT_EQ(ask(service->port(), request).status, 200) << i;
    }
  }
};

Json last_line(const std::string& lines) {
  const auto end = lines.find_last_not_of('\n');
  const auto begin = lines.rfind('\n', end);
  return Json::parse(lines.substr(begin + 1, end - begin));
}

TEST_F(SlowReaders, HoldNoPlace) {
  settings.queue = 0;
  start(1);
  for (int i = 0; i < 4; ++i) {
    simulate_slowly();
    await("parked", i + 1);
  }
  await("running", 0);
  others_are_served();
  for (Client& client : slow) {
    const Reply reply = client.receive().value_or(Reply{});
    EXPECT_EQ(last_line(reply.body)["status"], "completed");
    EXPECT_EQ(last_line(reply.body)["cost"]["steps"], 40'000);
  }
  await("parked", 0);
  await("running", 0);
}

// A parked run goes on beside others that ask all the time.
TEST_F(SlowReaders, ComeToTheirEndBesideABusyCrowd) {
  start(1);
  Client& client = simulate_slowly();
  await("parked", 1);
  std::atomic<bool> end{false};
  std::atomic<int> refused{0};
  std::vector<std::jthread> crowd;
  for (int i = 0; i < 3; ++i) {
    crowd.emplace_back([&] {
      Client busy(service->port());
      while (!end) {
        busy.send(post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":100000},
          "record":{"every":0},"diagnostics":[]})"));
        refused += busy.receive().value_or(Reply{}).status == 200 ? 0 : 1;
      }
    });
  }
  const Reply reply = client.receive().value_or(Reply{});
  end = true;
  crowd.clear();
  EXPECT_EQ(refused, 0);
  ASSERT_EQ(reply.status, 200);
  EXPECT_EQ(last_line(reply.body)["status"], "completed");
}

TEST_F(SlowReaders, OfStudiesAndEnsemblesHoldNoPlaceEither) {
  start(2);
  read_slowly("/v1/ensemble", R"({"problem":"harmonic_oscillator","scheme":"leapfrog","until":{"steps":10},
    "keep":["final"],"limits":{"seconds":60},"members":{"count":400000,"seed":1,"vary":{"/initial/q":{"uniform":[0,1]}}}})");
  await("parked", 1);
  await("running", 0);
  others_are_served();
}

// There are threads for a limited number of waiting runs. A further one ends, and says so.
TEST_F(SlowReaders, BeyondABoundEnd) {
  start(1);
  constexpr int most = 32;
  for (int i = 0; i < most; ++i) {
    simulate_slowly();
    await("parked", i + 1);
  }
  Client& last = simulate_slowly();
  await("run_seconds_count", 1);  // before anything was read
  const Reply reply = last.receive().value_or(Reply{});
  ASSERT_EQ(reply.status, 200);
  EXPECT_EQ(last_line(reply.body)["status"], "stopped");
  EXPECT_EQ(last_line(reply.body)["stop"]["reason"], "cancelled");
  await("parked", most);  // one of them may have sent what its client took meanwhile
  others_are_served();
}

TEST_F(SlowReaders, ThatHangUpAreForgotten) {
  start(1);
  simulate_slowly();
  await("parked", 1);
  slow.front().hang_up();
  await("parked", 0);
  others_are_served();
  await("cancelled_total", 1);
}

// Runs that wait for their clients do not delay the end of the service much beyond its grace.
TEST_F(SlowReaders, DoNotHoldUpTheEnd) {
  settings.grace = 0.3;
  start(1);
  simulate_slowly();
  await("parked", 1);
  const auto from = Clock::now();
  service->stop();
  EXPECT_LT(Clock::now() - from, 3s) << "and not as long as a client may read nothing, a minute";
}

}  // namespace
}  // namespace least::server::test
