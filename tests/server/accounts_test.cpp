// The order of turns among clients of one address, refusals at once where a turn cannot come, and the time to ask
// again.
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/decode/json_parse.hpp"
#include "server/http/admission.hpp"
#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

using namespace std::chrono_literals;
using MaybePass = std::optional<Admission::Pass>;

AccountPtr account(const std::string& address = "a") { return std::make_shared<Account>(address); }

// Waiting tells what became of a request that waits.
struct Waiting {
  bool refused = false;
  std::shared_ptr<MaybePass> pass = std::make_shared<MaybePass>();
};

// Time is a clock that advances when the test says so.
class Time {
 public:
  std::function<Admission::Clock::time_point()> clock() {
    return [this] { return now_; };
  }
  void pass(std::chrono::milliseconds time) { now_ += time; }

 private:
  Admission::Clock::time_point now_{1h};
};

// ask_for_turn() puts a request into the queue; `name` is appended to `order` when its turn has come.
std::shared_ptr<Waiting> ask_for_turn(Admission& admission, const AccountPtr& who, std::chrono::milliseconds patience,
                                      std::string* order = nullptr, char name = ' ') {
  auto waiting = std::make_shared<Waiting>();
  admission.wait(who, patience, {}, [=](MaybePass pass) {
    waiting->refused = !pass;
    if (pass && order) *order += name;
    if (pass) waiting->pass->emplace(std::move(*pass));
  });
  return waiting;
}

// after() returns an account that has just computed for so long; no run came of it, so that nobody expects others to
// take as long.
AccountPtr after(Admission& admission, Time& time, std::chrono::seconds computed) {
  auto who = account();
  auto pass = admission.enter(who);
  EXPECT_TRUE(pass);
  pass->excuse();
  time.pass(computed);
  return who;
}

// serve_all() gives places back until nobody holds one.
void serve_all(std::vector<std::shared_ptr<Waiting>>& all) {
  for (bool found = true; found;) {
    found = false;
    for (auto& waiting : all) {
      if (!*waiting->pass) continue;
      waiting->pass->reset();
      found = true;
    }
  }
}

TEST(Accounts, WhoComputedLeastGoesFirstAndEveryOtherTurnIsForWhoWaitedLongest) {
  Time time;
  Admission admission(1, 100, nullptr, time.clock());
  const auto little = after(admission, time, 1s), some = after(admission, time, 5s), much = after(admission, time, 20s);
  std::string order;
  auto held = admission.enter("b");
  std::vector<std::shared_ptr<Waiting>> all;
  const auto next = [&](const AccountPtr& who, char name) {
    all.push_back(ask_for_turn(admission, who, 20s, &order, name));
    time.pass(1ms);
  };
  next(much, 'm');
  next(some, 's');
  next(little, 'l');
  next(account(), 'n');  // nobody knows it: the mean of these, some 8 s
  held.reset();
  serve_all(all);
  EXPECT_EQ(order, "lmsn") << "the one that computed most came first and does not wait for all others";
}

TEST(Accounts, OfEqualsTheFirstGoesFirst) {
  Admission admission(1, 100);
  std::string order;
  auto held = admission.enter("b");
  std::vector<std::shared_ptr<Waiting>> all;
  for (const char name : {'1', '2', '3', '4'}) all.push_back(ask_for_turn(admission, account(), 20s, &order, name));
  held.reset();
  serve_all(all);
  EXPECT_EQ(order, "1234");
}

TEST(Accounts, AFullQueueMakesRoomForWhoComputedLess) {
  Time time;
  Admission admission(1, 2, nullptr, time.clock());
  const auto little = after(admission, time, 1s), much = after(admission, time, 5s), more = after(admission, time, 20s);
  const auto held = admission.enter("b");
  const auto first = ask_for_turn(admission, more, 20s), second = ask_for_turn(admission, much, 20s);
  const auto third = ask_for_turn(admission, little, 20s);
  EXPECT_TRUE(first->refused);
  EXPECT_FALSE(second->refused || third->refused);
  EXPECT_TRUE(ask_for_turn(admission, more, 20s)->refused) << "it computed most";
}

// Seventeen clients that ask without a pause, and one with the same address that asks now and then, for much shorter
// runs.
TEST(Accounts, ManyConnectionsDoNotShutOutOneOfTheirAddress) {
  struct Asking {
    std::chrono::milliseconds takes;
    AccountPtr who = account();
    std::shared_ptr<Waiting> waiting{};
    int asked = 0, served = 0;
  };
  Time time;
  Admission admission(1, 8, nullptr, time.clock());
  std::vector<Asking> all(17, Asking{30ms});
  for (Asking& one : all) one.who = account();
  all.push_back({1ms});
  Asking& now_and_then = all.back();
  int served = 0;
  const auto ask = [&](Asking& one) {
    if (one.waiting) return;
    one.waiting = ask_for_turn(admission, one.who, 10s);
    ++one.asked;
  };
  for (int round = 0; round < 5000 && (now_and_then.asked < 15 || now_and_then.waiting); ++round) {
    for (Asking& one : all)
      if (&one != &now_and_then || (served > 40 && one.asked < 15 && round % 3 == 0)) ask(one);
    for (Asking& one : all) {
      if (!one.waiting || !*one.waiting->pass) continue;
      time.pass(one.takes);
      one.waiting->pass->reset();
      one.waiting.reset();
      ++one.served, ++served;
    }
    for (Asking& one : all)
      if (one.waiting && one.waiting->refused) one.waiting.reset();
    time.pass(1ms);
    admission.look();
  }
  EXPECT_EQ(now_and_then.served, 15);
  EXPECT_EQ(now_and_then.asked, 15);
  admission.close();
}

TEST(Accounts, WhoseTurnCannotComeIsToldAtOnceAndWhen) {
  Time time;
  Admission admission(2, 100, nullptr, time.clock());
  auto a = admission.enter("a"), b = admission.enter("b");
  a->may_take(60);
  b->may_take(30);
  time.pass(150ms);  // both compute
  const auto who = account("c");
  EXPECT_TRUE(ask_for_turn(admission, who, 10s)->refused);
  EXPECT_GT(admission.retry_after(who), 25);
  EXPECT_LE(admission.retry_after(who), 30);
  EXPECT_FALSE(ask_for_turn(admission, who, 40s)->refused) << "it has the patience";
  admission.close();
}

// Limits of seconds are not taken for durations where runs end long before them.
TEST(Accounts, LimitsThatNobodyUsesTurnNobodyAway) {
  Time time;
  Admission admission(1, 100, nullptr, time.clock());
  for (int i = 0; i < 60; ++i) admission.enter("a")->may_take(60);
  auto held = admission.enter("a");
  held->may_take(60);
  time.pass(150ms);
  const auto waiting = ask_for_turn(admission, account("b"), 10s);
  EXPECT_FALSE(waiting->refused);
  held.reset();
  EXPECT_TRUE(*waiting->pass);
}

TEST(Accounts, AServiceSaysAtOnceWhenItHasRoomAgain) {
  Settings settings = quiet_settings();
  settings.threads = 1;
  settings.grace = 0;
  settings.caps.seconds = 100;
  Service service(settings, page_assets);
  ASSERT_FALSE(service.start());
  Client busy(service.port());
  busy.send(post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":10000000000},
    "record":{"every":0},"limits":{"steps":10000000000,"seconds":100}})"));
  while (ask(service.port(), get("/metrics")).body.find("\nleastaction_running 1\n") == std::string::npos)
    std::this_thread::sleep_for(5ms);
  const auto from = std::chrono::steady_clock::now();
  const Reply reply = ask(service.port(), post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog"})"));
  EXPECT_EQ(reply.status, 503);
  EXPECT_LT(std::chrono::steady_clock::now() - from, 5s) << "its patience is ten";
  ASSERT_TRUE(reply.fields.contains("retry-after"));
  EXPECT_GT(std::stoi(reply.fields.at("retry-after")), 50);
  EXPECT_LE(std::stoi(reply.fields.at("retry-after")), 100);
}

}  // namespace
}  // namespace least::server::test
