// Places that an ensemble takes besides its own: all that are free, until another request needs them.
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "server/http/admission.hpp"
#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

using namespace std::chrono_literals;

std::vector<Admission::Pass> all_besides(Admission& admission, const std::string& client) {
  std::vector<Admission::Pass> passes;
  while (auto more = admission.enter_besides(client)) passes.push_back(std::move(*more));
  return passes;
}

TEST(Places, BesidesAreAllForOneAndHalfAmongSeveral) {
  Admission admission(5, 10);
  EXPECT_FALSE(admission.enter_besides("a")) << "it has no place of its own";
  const auto a = admission.enter("a");
  ASSERT_TRUE(a);
  auto besides = all_besides(admission, "a");
  EXPECT_EQ(besides.size(), 4u);
  EXPECT_FALSE(admission.gives_way("a"));

  std::optional<Admission::Pass> b;
  admission.wait(std::make_shared<Account>("b"), 10s, {}, [&](std::optional<Admission::Pass> pass) {
    if (pass) b.emplace(std::move(*pass));
  });
  EXPECT_TRUE(admission.gives_way("a")) << "somebody waits";
  besides.pop_back();
  ASSERT_TRUE(b) << "its turn has come";
  EXPECT_TRUE(admission.gives_way("a")) << "four of five are more than its share";
  besides.clear();
  EXPECT_FALSE(admission.gives_way("a"));
  besides = all_besides(admission, "a");
  EXPECT_EQ(besides.size(), 2u) << "three of five with its own";
  EXPECT_EQ(all_besides(admission, "b").size(), 1u) << "what is left";
  b.reset();
  EXPECT_EQ(all_besides(admission, "a").size(), 2u);
}

/// A request is not refused for the time that others took until now where it needs one of these places, which is soon
/// free.
TEST(Places, BesidesAreAsGoodAsFreeForOthers) {
  Admission admission(2, 0);
  {
    const auto slow = admission.enter("a");
    std::this_thread::sleep_for(50ms);
  }
  const auto a = admission.enter("a");
  auto besides = all_besides(admission, "a");
  ASSERT_EQ(besides.size(), 1u);
  EXPECT_FALSE(admission.load().full);
  std::optional<Admission::Pass> b;
  bool refused = false;
  admission.wait(std::make_shared<Account>("b"), 1ms, {}, [&](std::optional<Admission::Pass> pass) {
    refused = !pass;
    if (pass) b.emplace(std::move(*pass));
  });
  EXPECT_FALSE(refused);
  EXPECT_TRUE(admission.gives_way("a"));
  besides.clear();
  EXPECT_TRUE(b);
}

void await_computing(int port, unsigned wanted) {
  unsigned found = ~0U;
  for (const auto from = std::chrono::steady_clock::now();
       found != wanted && std::chrono::steady_clock::now() - from < 10s; std::this_thread::sleep_for(5ms)) {
    const std::string text = ask(port, get("/metrics")).body;
    found = static_cast<unsigned>(std::stoul(text.substr(text.find("\nleastaction_running ") + 21)));
  }
  EXPECT_EQ(found, wanted);
}

TEST(Places, AnEnsembleComputesOnAllCoresAndMakesRoomForOthers) {
  Settings settings = quiet_settings();
  settings.threads = 3;
  Service service(settings, page_assets);
  ASSERT_FALSE(service.start());
  const auto ensemble = [&](const std::string& accept) {
    Client client(service.port());
    client.send(post("/v1/ensemble", R"({"problem":"harmonic_oscillator","scheme":"leapfrog","until":{"steps":100000},
      "limits":{"seconds":30},"members":{"count":50000000,"seed":1,"vary":{"/initial/q":{"uniform":[0,1]}}}})",
                     "Accept: " + accept + "\r\n"));
    await_computing(service.port(), 3);
    // The ensemble has all places until its next look: a request waits, and is let in.
    for (int i = 0; i < 3; ++i) {
      const auto request = post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":10}})");
      EXPECT_EQ(ask(service.port(), request).status, 200);
    }
    await_computing(service.port(), 3);
  };
  ensemble("application/json");
  await_computing(service.port(), 0);
  ensemble("application/x-ndjson");  // nobody reads a line of it
  await_computing(service.port(), 0);
}

}  // namespace
}  // namespace least::server::test
