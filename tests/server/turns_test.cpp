// Turns to compute: the queue, clients that leave, and clients that only end their sending.
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <ctime>
#include <functional>
#include <future>
#include <list>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "server/decode/json_parse.hpp"
#include "server/http/admission.hpp"
#include "server/http/metrics.hpp"
#include "tests/server/client.hpp"
#include "tests/server/crowd.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

using namespace std::chrono_literals;
using Ticks = std::chrono::steady_clock;

// enter() waits for a turn on this thread.
std::optional<Admission::Pass> enter(Admission& admission, const std::string& client,
                                     std::chrono::milliseconds patience, const std::function<bool()>& gone = {}) {
  std::promise<std::optional<Admission::Pass>> come;
  auto came = come.get_future();
  admission.wait(std::make_shared<Account>(client), patience, gone,
                 [&](std::optional<Admission::Pass> pass) { come.set_value(std::move(pass)); });
  while (came.wait_for(1ms) != std::future_status::ready) admission.look();
  return came.get();
}

// Asking waits for a turn on a thread of its own.
struct Asking {
  Asking(Admission& admission, const std::string& client, std::vector<std::string>& order, std::mutex& mutex)
      : thread([&admission, &order, &mutex, client] {
          const auto pass = enter(admission, client, 20s);
          const std::lock_guard lock(mutex);
          order.push_back(pass ? client : client + " refused");
        }) {}
  std::jthread thread;
};

void await_waiting(const Admission& admission, unsigned waiting) {
  for (const auto from = Ticks::now(); admission.load().waiting != waiting && Ticks::now() - from < 10s;) {
    std::this_thread::sleep_for(1ms);
  }
  EXPECT_EQ(admission.load().waiting, waiting);
}

TEST(Turns, GoRoundTheClients) {
  Admission admission(1, 100);
  auto first = enter(admission, "a", 1s);
  ASSERT_TRUE(first);
  std::vector<std::string> order;
  std::mutex mutex;
  std::list<Asking> asking;
  unsigned n = 0;
  for (const char* client : {"a", "a", "a", "b", "a", "b", "c"}) {
    asking.emplace_back(admission, client, order, mutex);
    await_waiting(admission, ++n);
  }
  first.reset();
  asking.clear();
  EXPECT_EQ(order, (std::vector<std::string>{"a", "b", "c", "a", "b", "a", "a"}));
  EXPECT_EQ(admission.load().running, 0u);
}

TEST(Turns, OneClientHasHalfOfThePlacesWhileOthersWait) {
  Admission admission(4, 100);
  std::vector<std::optional<Admission::Pass>> held;
  for (int i = 0; i < 4; ++i) held.push_back(enter(admission, "greedy", 1s));
  std::atomic<int> greedy{0}, modest{0};
  std::atomic<bool> end{false};
  std::vector<std::jthread> threads;
  const auto wait = [&](const char* client, std::atomic<int>& count) {
    threads.emplace_back([&, client] {
      const auto pass = enter(admission, client, 20s);
      ++count;
      while (!end) std::this_thread::sleep_for(1ms);
    });
  };
  for (int i = 0; i < 8; ++i) wait("greedy", greedy);
  await_waiting(admission, 8);
  for (int i = 0; i < 4; ++i) wait("modest", modest);
  await_waiting(admission, 12);
  held.clear();  // all four places: two for each
  await_waiting(admission, 8);
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(greedy, 2);
  EXPECT_EQ(modest, 2);
  end = true;
}

TEST(Turns, AFullQueueMakesRoomForWhoHasLessInIt) {
  Metrics metrics;
  Admission admission(1, 4, &metrics);
  auto first = enter(admission, "a", 1s);
  std::vector<std::string> order;
  std::mutex mutex;
  std::list<Asking> asking;
  for (unsigned i = 1; i <= 4; ++i) {
    asking.emplace_back(admission, "a", order, mutex);
    await_waiting(admission, i);
  }
  EXPECT_TRUE(admission.load().full);
  const auto from = Ticks::now();
  EXPECT_FALSE(enter(admission, "a", 20s)) << "it has the most";
  EXPECT_LT(Ticks::now() - from, 5s) << "told at once";
  asking.emplace_back(admission, "b", order, mutex);
  for (const auto since = Ticks::now(); Ticks::now() - since < 10s; std::this_thread::sleep_for(1ms)) {
    const std::lock_guard lock(mutex);
    if (!order.empty()) break;
  }
  first.reset();
  asking.clear();
  EXPECT_EQ(order, (std::vector<std::string>{"a refused", "a", "b", "a", "a"}));
  EXPECT_NE(metrics.text({}).find("leastaction_rejected_total 2\n"), std::string::npos);
}

TEST(Turns, WhoCannotBeServedInTimeIsToldAtOnce) {
  Admission admission(1, 100);
  for (int i = 0; i < 30; ++i) {
    const auto pass = enter(admission, "a", 1s);
    std::this_thread::sleep_for(10ms);
  }
  const auto held = enter(admission, "a", 1s);
  const auto from = Ticks::now();
  EXPECT_FALSE(enter(admission, "a", 1ms)) << "runs take ten milliseconds each";
  EXPECT_LT(Ticks::now() - from, 500ms);
  EXPECT_FALSE(enter(admission, "b", 300ms)) << "this one may hope, for so long";
  EXPECT_GE(Ticks::now() - from, 300ms);
}

TEST(Turns, WhoLeavesTheQueueIsForgotten) {
  Admission admission(1, 1);
  const auto held = enter(admission, "a", 1s);
  const auto from = Ticks::now();
  EXPECT_FALSE(enter(admission, "b", 20s, [] { return true; }));
  EXPECT_LT(Ticks::now() - from, 5s);
  EXPECT_EQ(admission.load().waiting, 0u);
}

class Leaving : public testing::Test {
 protected:
  Settings settings = quiet_settings();
  std::unique_ptr<Service> service;
  void SetUp() override {
    settings.threads = 1;
    settings.queue = 0;
    service = std::make_unique<Service>(settings, page_assets);
    ASSERT_FALSE(service->start());
    EXPECT_EQ(ask(service->port(), short_request()).status, 200);
  }
  static std::string short_request() {
    return post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":9}})");
  }
  static std::string long_request(const std::string& seconds, const std::string& fields = "", char minor = '1') {
    std::string request =
        post("/v1/simulate",
             R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":10000000000},"record":{"every":0},
            "limits":{"steps":10000000000,"seconds":)" +
                 seconds + "}}",
             fields);
    request[request.find("HTTP/1.") + 7] = minor;
    return request;
  }
  unsigned running() const {
    const std::string text = ask(service->port(), get("/metrics")).body;
    return static_cast<unsigned>(std::stoul(text.substr(text.find("\nleastaction_running ") + 21)));
  }
  double seconds_until_free() const {
    const auto from = Ticks::now();
    while (running() > 0 && Ticks::now() - from < 10s) std::this_thread::sleep_for(5ms);
    return std::chrono::duration<double>(Ticks::now() - from).count();
  }
};

TEST_F(Leaving, FreesTheCoreWithinAFifthOfASecond) {
  int left = 0;
  for (const char* fields : {"", "Accept: text/csv\r\n", "Accept: application/x-ndjson\r\n"}) {
    for (const char minor : {'1', '0'}) {  // many proxies speak the older version
      for (const bool reset : {false, true}) {
        // Within a stream lines may be on their way.
        const double most = *fields && std::string_view(fields).ends_with("ndjson\r\n") ? 0.6 : 0.25;
        double least = most;
        for (int attempt = 0; attempt < 3 && !(least < most); ++attempt) {  // others may be at work on the machine
          {
            Client client(service->port());
            client.send(long_request("20", fields, minor));
            std::this_thread::sleep_for(300ms);
            EXPECT_EQ(running(), 1u);
            if (reset) client.reset();
          }
          least = std::min(least, seconds_until_free());
          ++left;
        }
        EXPECT_LT(least, most) << fields << minor << reset;
      }
    }
  }
  EXPECT_NE(
      ask(service->port(), get("/metrics")).body.find("leastaction_cancelled_total " + std::to_string(left) + "\n"),
      std::string::npos);
}

// A client that has ended its sending still reads.
TEST_F(Leaving, AHalfClosedClientIsAnswered) {
  for (const auto& [fields, minor] : {std::pair("", '1'), {"", '0'}, {"Accept: application/x-ndjson\r\n", '1'}}) {
    Client client(service->port());
    client.send(long_request("0.7", fields, minor));
    client.end_sending();
    if (!*fields) {
      EXPECT_TRUE(std::string_view("HTTP/1.1").starts_with(client.peek())) << "as any answer begins: is it there?";
    }
    const auto reply = client.receive();
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->status, 200);
    EXPECT_NE(reply->body.find("\"reason\":\"deadline\""), std::string::npos) << reply->body;
  }
}

TEST_F(Leaving, AHalfClosedClientIsAdvisedAsAnyOther) {
  const std::string request = R"({"problem":"kepler","scheme":{"id":"auto","accuracy":1e-9},"until":{"t":100},
    "record":{"every":0},"diagnostics":["error"]})";
  const Json whole = Json::parse(ask(service->port(), post("/v1/simulate", request)).body);
  Client client(service->port());
  client.send(post("/v1/simulate", request));
  client.end_sending();
  const auto reply = client.receive();
  ASSERT_TRUE(reply);
  const Json half = Json::parse(reply->body);
  EXPECT_EQ(half["scheme"], whole["scheme"]);
  EXPECT_EQ(half["final"], whole["final"]);
}

// Choosing a scheme and running it keep the limit together. The time is processor time, because the service is not
// responsible for other work of the machine.
TEST_F(Leaving, AutoKeepsTheLimitOfSeconds) {
  const std::clock_t from = std::clock();
  const Reply reply = ask(service->port(), post("/v1/simulate", R"({"problem":"kepler",
    "initial":{"x":1,"y":0,"px":0,"py":1.1},"scheme":{"id":"auto","accuracy":1e-3,"keep":["structure"]},
    "until":{"t":200000},"record":{"every":0},"columns":["t","x"],"diagnostics":["structure","error","momenta"],
    "limits":{"seconds":1.5,"steps":10000000000}})"));
  EXPECT_LT(static_cast<double>(std::clock() - from) / CLOCKS_PER_SEC, 2.3) << reply.body;
}

// A megabyte of unknown names is refused before it has cost much.
TEST_F(Leaving, HopelessRequestsCostLittle) {
  std::string columns;
  for (int i = 0; columns.size() < 1'000'000; ++i) {
    columns += (i ? ",\"" : "\"") + std::string(50, static_cast<char>('a' + i % 26)) + std::to_string(i) + "\"";
  }
  const std::string request =
      post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","columns":[)" + columns + "]}");
  Reply reply;
  const auto cost = [&](const std::string& bytes) {
    double best = 1e9;
    for (int k = 0; k < 5; ++k) {
      reply = ask(service->port(), bytes);
      EXPECT_EQ(reply.status, 422);
      best = std::min(best, std::stod(reply.fields.at("server-timing").substr(12)));
    }
    return best;
  };
  // As many bytes, but only the first key is examined.
  std::string unread = request;
  unread.replace(unread.find("columns"), 7, "column_");
  const double least = cost(unread);
  EXPECT_LT(cost(request), 3 * least) << "milliseconds";
  EXPECT_EQ(Json::parse(reply.body)["errors"].size(), 100u);
  std::string wrong;
  for (int i = 0; i < 30; ++i)
    wrong += (i ? ",\"energi" : "\"energi") + std::string(static_cast<std::size_t>(i) % 2, 'e') + "\"";
  const Json few = Json::parse(ask(service->port(), post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog",
    "columns":[)" + wrong + "]}"))
                                   .body);
  std::size_t meant = 0;
  for (const Json& error : few["errors"])
    meant += error["detail"].get<std::string>().find("did you mean") != std::string::npos;
  EXPECT_EQ(meant, 10u);
  EXPECT_EQ(few["errors"].size(), 30u);
}

// Faults of a short request are reported while others compute; a long request is expensive to read, and waits for its
// turn.
TEST_F(Leaving, OnlyShortRequestsAreReadOutOfTurn) {
  Client computes(service->port());
  computes.send(long_request("20"));
  while (running() == 0) std::this_thread::sleep_for(1ms);
  const std::string wrong = R"({"problem":"no_such","scheme":"leapfrog"})";
  EXPECT_EQ(ask(service->port(), post("/v1/simulate", wrong)).status, 422);
  EXPECT_EQ(ask(service->port(), post("/v1/simulate", wrong + std::string(4096, ' '))).status, 503);
  computes.reset();
  seconds_until_free();
  EXPECT_EQ(ask(service->port(), post("/v1/simulate", wrong + std::string(4096, ' '))).status, 422);
}

// A body whose first character cannot begin JSON is refused at once, however long it is and whoever computes.
TEST_F(Leaving, WhatBeginsAsNoJsonIsRefusedAtAGlance) {
  Client computes(service->port());
  computes.send(long_request("20"));
  while (running() == 0) std::this_thread::sleep_for(1ms);
  const std::string much(100'000, ' ');
  for (const std::string body : {"<a>", "\n problem=kepler"}) {
    const Reply reply = ask(service->port(), post("/v1/simulate", body + much));
    EXPECT_EQ(reply.status, 400) << body;
    EXPECT_NE(reply.body.find("not JSON at byte"), std::string::npos) << reply.body;
  }
  // This look ahead is bounded, and skips a byte order mark.
  const std::string run = R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":9}})";
  EXPECT_EQ(ask(service->port(), post("/v1/simulate", much + "[]")).status, 503);
  EXPECT_EQ(ask(service->port(), post("/v1/simulate", "\xEF\xBB\xBF" + run + much)).status, 503);
  computes.reset();
  seconds_until_free();
  for (const std::string& body : {much + run + much, "\xEF\xBB\xBF" + run + much}) {
    EXPECT_EQ(ask(service->port(), post("/v1/simulate", body)).status, 200);
  }
  EXPECT_EQ(ask(service->port(), post("/v1/simulate", "[1,2" + much)).status, 400) << "what may be JSON is read";
  EXPECT_EQ(ask(service->port(), post("/v1/simulate", much + "[]")).status, 422);
}

// One client with many connections, and another with one: the latter is served all the same.
TEST(Fairness, ManyConnectionsDoNotShutOutOne) {
  Settings settings = quiet_settings();
  settings.threads = 1;
  settings.queue = 8;
  settings.host = "0.0.0.0";
  Service service(settings, page_assets);
  ASSERT_FALSE(service.start());
  const std::string request = post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":1000000},
    "record":{"every":0},"diagnostics":[]})");
  const Crowd crowd(service.port(), 17, request);
  std::this_thread::sleep_for(500ms);
  EXPECT_EQ(served_of(20, Client(service.port(), "127.0.0.2")), 20);
}

// A class behind one address: a connection with many requests is served as often as those with one.
TEST(Fairness, ConnectionsOfOneAddressAreServedAlike) {
  Settings settings = quiet_settings();
  settings.threads = 1;
  settings.queue = 16;
  Service service(settings, page_assets);
  ASSERT_FALSE(service.start());
#if defined(__SANITIZE_ADDRESS__)
  const std::string steps = "20000";
#else
  const std::string steps = "500000";
#endif
  const std::string request = post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":)" +
                                                       steps + R"(},"record":{"every":0},"diagnostics":[]})");
  constexpr std::size_t connections = 8;
  std::array<std::atomic<int>, connections> served{};
  std::atomic<int> failed{0}, all{0};
  {
    std::vector<std::jthread> class_;
    for (std::size_t i = 0; i < connections; ++i) {
      class_.emplace_back([&, i] {
        Client client(service.port());
        const int ahead = i == 0 ? 50 : 1;  // so many are on their way
        for (int k = 0; k < ahead; ++k) client.send(request);
        while (all < 160) {
          const auto reply = client.receive();
          ++(reply && reply->status == 200 ? served[i] : failed);
          ++all;
          client.send(request);
        }
      });
    }
  }
  EXPECT_EQ(failed, 0);
  const auto [least, most] = std::minmax_element(served.begin() + 1, served.end());
  EXPECT_GT(2 * *least, *most);
  EXPECT_LT(served[0], 2 * *least) << "who asks ahead waits like all";
}

}  // namespace
}  // namespace least::server::test
