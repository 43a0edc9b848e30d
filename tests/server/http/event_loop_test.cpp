// The event loop where its handlers throw: that costs the connection for which it happened, and no other.
#include "server/http/event_loop.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <thread>

#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"

namespace least::server {
namespace {

using namespace std::chrono_literals;
using test::Client;
using test::get;

// Failing answers requests without a body, and throws for the path /fails and for refusals.
class Failing final : public Handler {
 public:
  ExchangePtr begin(Message message, Peer& peer, Line line) override {
    if (message.head.path == "/fails") throw std::bad_alloc();
    auto exchange = std::make_shared<Exchange>(std::move(message), "id", peer.account, std::move(line));
    exchange->keep_alive = true;
    exchange->outbox.finish(true, "HTTP/1.1 200 OK\r\nContent-Length: 0\r\n\r\n", true);
    return exchange;
  }
  ExchangePtr refuse(Refused /*refused*/, const Peer& /*peer*/, Line /*line*/) override {
    ++refusals;
    throw std::bad_alloc();
  }
  void go_on(const ExchangePtr& /*exchange*/) override {}
  void aborted(const std::string& /*address*/) noexcept override {}
  void left(const Exchange& /*exchange*/) noexcept override {}
  bool busy() const override { return false; }

  std::atomic<int> refusals{0};
};

TEST(EventLoop, LivesWhenWhatItCallsFails) {
  test::quiet_settings();
  ConnectionBounds bounds;
  bounds.head_time = 100ms;
  Lifecycle lifecycle;
  Failing handler;
  EventLoop loop(10, bounds, lifecycle, handler);
  ASSERT_FALSE(loop.listen("127.0.0.1", 0));
  std::atomic<int> ticks{0};
  std::atomic<bool> over{false};
  std::jthread thread([&] {
    try {
      loop.run([&] {
        if (++ticks % 2) throw std::runtime_error("a tick that fails");
        throw "nothing that says why";
      });
    } catch (...) {
      ADD_FAILURE() << "an exception ended the loop";
    }
    over = true;
  });
  Client good(loop.port()), fails(loop.port()), late(loop.port());
  const auto is_served = [&] { return good.send(get("/")) && good.receive().value_or(test::Reply{}).status == 200; };
  EXPECT_TRUE(is_served());
  fails.send(get("/fails"));
  EXPECT_TRUE(fails.ended());
  late.send("GET / HTTP/1.1\r\nHo");  // to be refused by a tick
  EXPECT_TRUE(late.ended());
  EXPECT_EQ(handler.refusals, 1);
  while (ticks < 4 && !over) std::this_thread::sleep_for(5ms);
  EXPECT_TRUE(is_served());
  lifecycle.draining = true;
  loop.wake();
}

}  // namespace
}  // namespace least::server
