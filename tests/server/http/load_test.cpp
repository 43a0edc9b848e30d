// Many clients, slow clients, long runs, and the end of the service.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
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

// Computes until it is ended.
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
};

TEST_F(Load, SlowClientsDoNotStarveOthers) {
  start();
  std::list<Client> slow;
  for (int i = 0; i < 200; ++i) {
    slow.emplace_back(service->port()).send("POST /v1/simulate HTTP/1.1\r\nHost: local");
  }
  const auto from = Clock::now();
  EXPECT_EQ(ask(service->port(), short_run()).status, 200);
  EXPECT_LT(Clock::now() - from, 5s);  // half of what a slow head is given
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
  // A byte now and then does not set the clock back.
  Client drip(service->port());
  const auto from = Clock::now();
  while (drip.send("x") && Clock::now() - from < 5s) std::this_thread::sleep_for(20ms);
  EXPECT_LT(Clock::now() - from, 5s);
}

TEST_F(Load, IdleConnectionsMakeRoom) {
  settings.connections = 2;
  start();
  std::list<Client> idle;
  const auto from = Clock::now();
  for (int i = 0; i < 6; ++i) {
    idle.emplace_back(service->port()).send(get("/healthz"));
    EXPECT_EQ(idle.back().receive().value_or(Reply{}).status, 200) << i;
  }
  EXPECT_LT(Clock::now() - from, 10s);  // an idle connection is kept for 15 s when nobody waits
}

// Clients who never idle for long do not keep the threads for themselves.
TEST_F(Load, BusyConnectionsMakeRoom) {
  settings.connections = 2;
  start();
  std::atomic<bool> end{false};
  std::vector<std::jthread> pollers;
  for (int i = 0; i < 2; ++i) {
    pollers.emplace_back([&] {
      while (!end) {
        Client client(service->port());
        while (!end && client.send(get("/healthz")) && client.receive()) std::this_thread::sleep_for(5ms);
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
  // However late the other thread gets to it: the end has begun once nobody is let in any more.
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
