// Answers that are computed while they are sent, on a bare pair of sockets; and what ends their computation.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <thread>

#include "server/http/cancellation.hpp"
#include "server/http/connection.hpp"

namespace least::server {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

class Stream : public testing::Test {
 protected:
  ~Stream() override {
    hang_up();
    ::close(ends[0]);
  }
  void hang_up() {
    if (ends[1] >= 0) ::close(ends[1]);
    ends[1] = -1;
  }
  void ask(std::string_view version) {
    const std::string request = "GET / HTTP/" + std::string(version) + "\r\nHost: x\r\n\r\n";
    EXPECT_GT(::send(ends[1], request.data(), request.size(), 0), 0);
    EXPECT_TRUE(std::holds_alternative<Message>(connection.receive()));
  }
  // All that came, without the head.
  std::string body() {
    ::shutdown(ends[0], SHUT_WR);
    std::string text;
    char bytes[4096];
    for (ssize_t n; (n = ::recv(ends[1], bytes, sizeof bytes, 0)) > 0;) text.append(bytes, static_cast<std::size_t>(n));
    return text.substr(text.find("\r\n\r\n") + 4);
  }
  static Answer streaming(std::function<bool(const Write&)> stream) {
    return {200, "text/plain", {}, {}, std::move(stream)};
  }

  std::array<int, 2> ends = [] {
    std::array<int, 2> pair{-1, -1};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, pair.data()), 0);
    return pair;
  }();
  ConnectionBounds bounds;
  Lifecycle lifecycle;
  Connection connection{ends[0], bounds, lifecycle};
};

TEST_F(Stream, PiecesAreChunks) {
  ask("1.1");
  const bool sent = connection.send(
      streaming([](const Write& write) { return write("first\n") && write("") && write(std::string(26, 'x')); }), true,
      true);
  EXPECT_TRUE(sent);
  EXPECT_EQ(connection.sent(), 32u);
  EXPECT_EQ(body(), "6\r\nfirst\n\r\n1a\r\n" + std::string(26, 'x') + "\r\n0\r\n\r\n");
}

TEST_F(Stream, PiecesAreBareInTheFirstVersion) {
  ask("1.0");
  EXPECT_TRUE(connection.send(streaming([](const Write& write) { return write("a") && write("b"); }), false, true));
  EXPECT_EQ(body(), "ab");
}

TEST_F(Stream, OneThatBreaksOffHasNoEnd) {
  ask("1.1");
  EXPECT_FALSE(connection.send(streaming([](const Write& write) {
                                 write("a");
                                 return false;
                               }),
                               true, true));
  EXPECT_EQ(body(), "1\r\na\r\n");
}

TEST_F(Stream, AClientThatTakesNothingIsLetGo) {
  ask("1.1");
  bounds.stall = 200ms;
  const std::string piece(10'000, 'x');
  const auto from = Clock::now();
  EXPECT_FALSE(connection.send(streaming([&](const Write& write) {
                                 while (Clock::now() - from < 50s) {
                                   if (!write(piece)) return false;
                                 }
                                 return true;
                               }),
                               true, true));
  EXPECT_LT(Clock::now() - from, 40s);
  EXPECT_LT(connection.sent(), 10'000'000u);
}

// A byte now and then is not enough.
TEST_F(Stream, AClientThatDripsIsLetGo) {
  ask("1.1");
  bounds.drip = 300ms;
  std::atomic<bool> end{false};
  std::jthread reader([&] {
    char bytes[256];
    while (!end && ::recv(ends[1], bytes, sizeof bytes, 0) > 0) std::this_thread::sleep_for(20ms);
  });
  Answer answer{200, "text/plain", std::string(20'000'000, 'x'), {}};
  const auto from = Clock::now();
  EXPECT_FALSE(connection.send(answer, true, true));
  EXPECT_LT(Clock::now() - from, 10s);
  end = true;
  ::shutdown(ends[0], SHUT_RDWR);
}

// A slow computation is not the client's fault.
TEST_F(Stream, AStreamMayTakeItsTime) {
  ask("1.1");
  bounds.drip = 50ms;
  EXPECT_TRUE(connection.send(streaming([](const Write& write) {
                                for (int k = 0; k < 4; ++k) {
                                  std::this_thread::sleep_for(100ms);
                                  if (!write("x")) return false;
                                }
                                return true;
                              }),
                              true, true));
}

TEST_F(Stream, SeesThatTheClientWentAway) {
  EXPECT_FALSE(connection.gone());
  EXPECT_EQ(::send(ends[1], "x", 1, 0), 1);  // what it sent ahead hides nothing
  EXPECT_FALSE(connection.gone());
  hang_up();
  EXPECT_TRUE(connection.gone());
}

TEST(CancellationWatch, SaysWhyItEndedAComputation) {
  enum class End { none, late, gone };
  const auto end = [](const std::atomic<bool>& ended, const std::function<bool()>& gone, double seconds,
                      std::chrono::milliseconds patience = 20s) {
    const CancellationWatch watch(ended, gone, seconds);
    for (const auto from = Clock::now(); !watch.cancelled() && Clock::now() - from < patience;) {
      std::this_thread::sleep_for(5ms);
    }
    return !watch.cancelled() ? End::none : watch.timed_out() ? End::late : End::gone;
  };
  const std::atomic<bool> no{false}, yes{true};
  const auto always = [] { return true; };
  const auto never = [] { return false; };
  EXPECT_EQ(end(no, {}, 100, 300ms), End::none);
  EXPECT_EQ(end(no, never, 100, 300ms), End::none);
  EXPECT_EQ(end(no, {}, 0.05), End::late);
  EXPECT_EQ(end(no, always, 100), End::gone);
  EXPECT_EQ(end(yes, {}, 100), End::gone);
  const auto from = Clock::now();
  for (int k = 0; k < 100; ++k) const CancellationWatch watch(no, {}, 100);
  EXPECT_LT(Clock::now() - from, 5s) << "its end waits for nothing";
}

}  // namespace
}  // namespace least::server
