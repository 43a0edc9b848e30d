// Many clients, slow clients, long runs, and the end of the service.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <future>
#include <list>
#include <thread>
#include <vector>

#include "server/decode/json_parse.hpp"
#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

// long_run() requests a run that computes until it is ended.
std::string long_run(double seconds) {
  return post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":10000000000},
    "record":{"every":0},"limits":{"steps":10000000000,"seconds":)" +
                                  std::to_string(seconds) + "}}");
}

std::string short_run() {
  return post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":10}})");
}

class Load : public testing::Test {
 protected:
  Settings settings = quiet_settings();
  std::unique_ptr<Service> service;
  void start() {
    service = std::make_unique<Service>(settings, page_assets);
    const auto error = service->start();
    ASSERT_FALSE(error) << *error;
  }
  // slowest_but_one() returns the second longest time in seconds of small runs, each on a connection of its own,
  // because a machine may delay one by chance.
  double slowest_but_one(int runs) const {
    std::vector<double> times;
    for (int i = 0; i < runs; ++i) {
      const auto from = Clock::now();
      EXPECT_EQ(ask(service->port(), short_run()).status, 200) << i;
      times.push_back(std::chrono::duration<double>(Clock::now() - from).count());
    }
    std::sort(times.begin(), times.end());
    return times[times.size() - 2];
  }
  static unsigned threads() {
    const auto tasks = std::filesystem::directory_iterator("/proc/self/task");
    return static_cast<unsigned>(std::distance(begin(tasks), end(tasks)));
  }
};

// Clients that send half a head, half a body, or nothing at all.
TEST_F(Load, HalfOpenClientsCostOthersNothing) {
  start();
  std::list<Client> half;
  const std::string_view begun[] = {
      "POST /v1/simulate HTTP/1.1\r\nHost: local", "",
      "POST /v1/simulate HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100\r\n\r\n{\"problem\""};
  for (std::size_t i = 0; i < 256; ++i) half.emplace_back(service->port()).send(begun[i % 3]);
  EXPECT_LT(slowest_but_one(100), 0.5);
  EXPECT_LT(threads(), 40u);
}

// They are answered one after the other, each as soon as the one before.
TEST_F(Load, RequestsSentAheadAreNotKeptWaiting) {
  start();
  double best = 1e9;
  for (int attempt = 0; attempt < 3; ++attempt) {
    Client client(service->port());
    std::string ahead;
    for (int i = 0; i < 40; ++i) ahead += short_run();
    const auto from = Clock::now();
    client.send(ahead);
    for (int i = 0; i < 40; ++i) ASSERT_EQ(client.receive().value_or(Reply{}).status, 200);
    best = std::min(best, std::chrono::duration<double>(Clock::now() - from).count());
  }
  EXPECT_LT(best, 1);
}

// Eight clients that read hundreds of megabytes slowly hold no worker, and little memory beside the numbers.
TEST_F(Load, DrippingReadersHoldNoWorker) {
  settings.threads = 1;
  start();
  std::atomic<bool> end{false};
  std::vector<std::jthread> readers;
  for (int i = 0; i < 8; ++i) {
    readers.emplace_back([&, i] {
      Client client(service->port());
      client.send(post("/v1/simulate",
                       R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":100000},"record":{"every":1}})",
                       i % 2 ? "Accept: text/csv\r\n" : ""));
      while (!end && client.some(1024)) std::this_thread::sleep_for(10ms);
    });
  }
  std::this_thread::sleep_for(1s);
  EXPECT_LT(slowest_but_one(50), 1);
  end = true;
}

// No connection is closed to make room while there are descriptors.
TEST_F(Load, ConnectionsThatIdleAreKept) {
  start();
  std::list<Client> idle;
  for (int i = 0; i < 400; ++i) {
    idle.emplace_back(service->port()).send(get("/healthz"));
    EXPECT_EQ(idle.back().receive().value_or(Reply{}).status, 200) << i;
  }
  for (auto& client : idle) {
    client.send(get("/healthz"));
    EXPECT_EQ(client.receive().value_or(Reply{}).status, 200);
  }
}

TEST_F(Load, SlowClientsAreLetGo) {
  settings.bounds.head_time = settings.bounds.body_time = 200ms;
  settings.bounds.idle = 300ms;
  start();
  Client head(service->port()), body(service->port()), idle(service->port());
  head.send("GET / HTTP/1.1\r\nHo");
  body.send("POST /v1/simulate HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9\r\n\r\n{");
  EXPECT_EQ(head.receive().value_or(Reply{}).status, 408);
  EXPECT_TRUE(head.ended());
  EXPECT_EQ(body.receive().value_or(Reply{}).status, 408);
  EXPECT_TRUE(idle.ended());
  // A byte now and then does not restart the timeout.
  Client drip(service->port());
  const auto from = Clock::now();
  while (drip.send("x") && Clock::now() - from < 5s) std::this_thread::sleep_for(20ms);
  EXPECT_LT(Clock::now() - from, 5s);
}

// As many connections as the limit: nobody waits, and all stay, new ones and idle ones.
TEST_F(Load, AllPlacesAreKeptWhileNobodyWaits) {
  settings.connections = 4;
  start();
  std::list<Client> clients;
  for (int i = 0; i < 4; ++i) clients.emplace_back(service->port());
  for (int round = 0; round < 3; ++round) {
    for (auto& client : clients) {
      client.send(get("/healthz"));
      const auto reply = client.receive();
      ASSERT_TRUE(reply) << round;
      EXPECT_EQ(reply->fields.at("connection"), "keep-alive") << round;
    }
    std::this_thread::sleep_for(300ms);  // from here on they idle
  }
}

TEST_F(Load, IdleConnectionsMakeRoom) {
  settings.connections = 4;
  start();
  std::list<Client> idle;
  for (int i = 0; i < 4; ++i) {
    idle.emplace_back(service->port()).send(get("/healthz"));
    EXPECT_EQ(idle.back().receive().value_or(Reply{}).fields["connection"], "keep-alive") << i;
    std::this_thread::sleep_for(60ms);
  }
  auto best = Clock::duration::max();
  for (int i = 0; i < 3; ++i) {  // a machine may falter once, or twice
    const auto from = Clock::now();
    idle.emplace_back(service->port()).send(get("/healthz"));
    EXPECT_EQ(idle.back().receive().value_or(Reply{}).status, 200) << i;
    best = std::min(best, Clock::now() - from);
  }
  EXPECT_LT(best, 500ms);
  EXPECT_TRUE(idle.front().ended()) << "who idled for longest";
}

// Clients that never send a whole request give way to those that do, the oldest first, long before their time is over.
TEST_F(Load, RequestsThatDoNotComeMakeRoom) {
  settings.connections = 4;
  settings.bounds.head_time = settings.bounds.body_time = 60s;
  start();
  std::list<Client> half;
  for (int i = 0; i < 8; ++i) {
    half.emplace_back(service->port())
        .send(i % 2 ? "GET / HTTP/1.1\r\nHo"
                    : "POST /v1/simulate HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9\r\n\r\n{");
  }
  for (int i = 0; i < 3; ++i) EXPECT_EQ(ask(service->port(), get("/healthz")).status, 200) << i;
  EXPECT_TRUE(half.front().ended());
  EXPECT_TRUE(half.back().send("st: localhost\r\n\r\n"));
  EXPECT_EQ(half.back().receive().value_or(Reply{}).status, 200) << "the youngest has stayed";
}

// Streams that nobody reads hold only the workers of their places, however much is left when the run is over and its
// place is given back: with one of these sizes only the end is left.
TEST_F(Load, StreamsThatNobodyReadsHoldNoFurtherWorker) {
  settings.threads = 1;
  settings.bounds.stall = settings.bounds.drip = 60s;
  start();
  std::string columns = R"("t")";
  for (int i = 0; i < 20; ++i) columns += R"(,{"name":"c)" + std::to_string(i) + R"(","expression":"x / 3"})";
  for (int rows = 512; rows <= 12 * 512; rows += 256) {
    const std::string request = post("/v1/simulate",
                                     R"({"problem":"kepler","scheme":"leapfrog","record":{"every":1},"columns":[)" +
                                         columns + R"(],"until":{"steps":)" + std::to_string(rows) + "}}",
                                     "Accept: application/x-ndjson\r\n");
    Client deaf(service->port()), too(service->port());
    deaf.send(request);
    too.send(request);
    std::this_thread::sleep_for(60ms);
    ASSERT_EQ(ask(service->port(), post("/v1/simulate", "{}")).status, 422) << rows;
  }
}

// Clients that never idle for long do not keep all connections for themselves.
TEST_F(Load, BusyConnectionsMakeRoom) {
  settings.connections = 8;
  start();
  std::atomic<bool> end{false};
  std::vector<std::jthread> pollers;
  for (int i = 0; i < 8; ++i) {
    pollers.emplace_back([&] {
      while (!end) {
        Client client(service->port());
        while (!end && client.send(get("/healthz")) && client.receive()) std::this_thread::sleep_for(30ms);
      }
    });
  }
  std::this_thread::sleep_for(200ms);
  for (int i = 0; i < 5; ++i) {
    const auto from = Clock::now();
    EXPECT_EQ(ask(service->port(), short_run()).status, 200);
    EXPECT_LT(Clock::now() - from, 3s);
  }
  end = true;
}

TEST_F(Load, ManyClientsAtOnceAreAllServed) {
  start();
  std::list<Client> clients;
  for (int i = 0; i < 200; ++i) clients.emplace_back(service->port());
  for (auto& client : clients) client.send(get("/healthz", "Connection: close\r\n"));
  for (auto& client : clients) EXPECT_EQ(client.receive().value_or(Reply{}).status, 200);
}

TEST_F(Load, ABusyServiceSaysSo) {
  settings.threads = 1;
  settings.queue = 0;
  settings.grace = 0;
  start();
  EXPECT_EQ(ask(service->port(), short_run()).status, 200);  // the first of all is slow to begin under a sanitizer
  std::this_thread::sleep_for(300ms);
  Client first(service->port());
  first.send(long_run(20));
  std::this_thread::sleep_for(300ms);
  const Reply second = ask(service->port(), short_run());
  ASSERT_EQ(second.status, 503);
  EXPECT_GT(std::stoi(second.fields.at("retry-after")), 0);
  EXPECT_EQ(ask(service->port(), get("/healthz")).status, 200);
  service->stop();
  const auto reply = first.receive();
  ASSERT_TRUE(reply);
  EXPECT_EQ(Json::parse(reply->body)["stop"]["reason"], "cancelled");
}

TEST_F(Load, ARunWaitsForItsTurn) {
  settings.threads = 1;
  settings.queue = 1;
  start();
  Client first(service->port());
  first.send(long_run(0.5));
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(ask(service->port(), short_run()).status, 200);
  const auto reply = first.receive();
  ASSERT_TRUE(reply);
  EXPECT_EQ(Json::parse(reply->body)["stop"]["reason"], "deadline");
  // Places are given back: many runs one after another all find one.
  for (int i = 0; i < 20; ++i) EXPECT_EQ(ask(service->port(), short_run()).status, 200);
}

TEST_F(Load, TheEndAnswersWhatWasAccepted) {
  settings.grace = 20;
  settings.threads = 2;
  start();
  const int port = service->port();
  Client running(port), half(port), idle(port);
  idle.send(get("/healthz"));
  EXPECT_EQ(idle.receive()->status, 200);
  running.send(long_run(2.5));
  const std::string request = short_run();
  half.send(request.substr(0, 40));
  std::this_thread::sleep_for(200ms);
  auto end = std::async(std::launch::async, [&] { service->stop(); });
  // The other thread may be late: the end has begun once no connection is accepted any more.
  const auto from = Clock::now();
  while (Client(port).connected() && Clock::now() - from < 2s) std::this_thread::sleep_for(5ms);
  EXPECT_FALSE(Client(port).connected());
  half.send(request.substr(40));
  for (Client* client : {&half, &running}) {
    const auto reply = client->receive();
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->status, 200);
    EXPECT_EQ(reply->fields.at("connection"), "close");
  }
  EXPECT_TRUE(idle.ended());
  EXPECT_EQ(end.wait_for(10s), std::future_status::ready);  // well before the grace is over
  EXPECT_FALSE(service->running());
}

TEST_F(Load, TheEndIsBounded) {
  settings.grace = 0.2;
  settings.bounds.stall = 1s;
  start();
  Client half(service->port()), deaf(service->port());
  half.send("POST /v1/simulate HTTP/1.1\r\n");
  // An answer of tens of megabytes that nobody reads.
  deaf.send(post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":400000},
    "record":{"every":1}})"));
  std::this_thread::sleep_for(500ms);
  const auto from = Clock::now();
  service->stop();
  EXPECT_LT(Clock::now() - from, 15s);
}

}  // namespace
}  // namespace least::server::test
