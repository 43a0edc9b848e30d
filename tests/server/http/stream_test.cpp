// Answers that are computed or written while they are sent, to clients of every speed; and what ends their computation.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "server/encode/problem_document.hpp"
#include "server/http/cancellation.hpp"
#include "server/http/http_server.hpp"
#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"

namespace least::server {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using test::Client;

constexpr int tight_buffer = 16 * 1024;  // bytes that the system holds between the two ends

// A server whose only endpoint gives the answer of the test.
class Stream : public testing::Test {
 protected:
  HttpSettings settings = test::quiet_settings();
  std::unique_ptr<HttpServer> server;

  void serve(std::function<Answer(const HttpRequest&)> answer) {
    server = std::make_unique<HttpServer>(settings, static_cast<ErrorAnswer>(problem_document));
    server->router().add_computed("/", [answer](const HttpRequest& request) -> Prepared {
      return Job([=](Admission::Pass) { return answer(request); });
    });
    const auto error = server->start();
    ASSERT_FALSE(error) << *error;
  }
  // serve_stream() serves a stream that adds nothing at its end.
  void serve_stream(const std::function<bool(const Write&)>& pieces) {
    serve([pieces](const HttpRequest&) {
      Answer answer{200, "text/plain", {}, {}};
      answer.stream = [pieces](const Write& write) { return pieces(write) ? std::optional("") : std::nullopt; };
      return answer;
    });
  }
  // body() returns all bytes that a client with these fields receives, without the head.
  std::string body(std::string_view version = "1.1", std::string_view fields = "Connection: close\r\n",
                   bool half_closed = false) const {
    Client client(server->port());
    client.send("POST / HTTP/" + std::string(version) + "\r\nHost: localhost\r\nContent-Length: 0\r\n" +
                std::string(fields) + "\r\n");
    if (half_closed) client.end_sending();
    std::string text;
    while (const auto some = client.some()) text += *some;
    const auto end = text.find("\r\n\r\n");
    return end == std::string::npos ? text : text.substr(end + 4);
  }
  Client asking(char minor = '1', int buffer = 0) const {
    Client client(server->port(), nullptr, buffer);
    std::string request = test::post("/", "");
    request[request.find("HTTP/1.") + 7] = minor;
    client.send(request);
    return client;
  }
};

TEST_F(Stream, PiecesAreChunks) {
  serve_stream([](const Write& write) { return write("first\n") && write("") && write(std::string(26, 'x')); });
  EXPECT_EQ(body(), "6\r\nfirst\n\r\n1a\r\n" + std::string(26, 'x') + "\r\n0\r\n\r\n");
  EXPECT_EQ(body("1.0"), "first\n" + std::string(26, 'x')) << "bare in the first version";
}

TEST_F(Stream, OneThatBreaksOffHasNoEnd) {
  for (const bool throws : {false, true}) {
    serve_stream([=](const Write& write) {
      write("a");
      if (throws) throw std::runtime_error("broken");
      return false;
    });
    EXPECT_EQ(body(), "1\r\na\r\n");
    EXPECT_EQ(body("1.1", ""), "1\r\na\r\n") << "nor has its connection a next one";
    EXPECT_TRUE(asking('0').ends_by_reset()) << "the end of the connection would be the end of the body";
  }
  serve_stream([](const Write& write) { return write("a"); });
  EXPECT_FALSE(asking('0').ends_by_reset());
}

// A stream whose client was let go has no end either.
TEST_F(Stream, OneThatIsCutOffHasNoEnd) {
  settings.bounds.stall = 200ms;
  const auto ended = std::make_shared<std::atomic<bool>>(false);
  serve_stream([ended](const Write& write) {
    while (write(std::string(10'000, 'x'))) {
    }
    return !(*ended = true);
  });
  Client deaf = asking('0');
  for (const auto from = Clock::now(); !*ended && Clock::now() - from < 40s;) std::this_thread::sleep_for(10ms);
  EXPECT_TRUE(*ended);
  EXPECT_TRUE(deaf.ends_by_reset());
}

// A stream waits for a client that reads nothing only as long as it is not at its end.
TEST_F(Stream, TheEndIsNotWaitedFor) {
  settings.bounds.stall = settings.bounds.drip = 60s;
  const auto ended = std::make_shared<std::atomic<int>>(0);
  serve([ended](const HttpRequest&) {
    Answer answer{200, "text/plain", {}, {}};
    answer.stream = [ended, guard = std::shared_ptr<void>(nullptr, [ended](void*) { ++*ended; })](const Write& write) {
      write(std::string(20'000'000, 'x')) && write(std::string(1'000'000, 'x'));  // more than is held for a client
      return std::optional(std::string(1000, 'y'));
    };
    return answer;
  });
  Client deaf = asking();
  for (const auto from = Clock::now(); *ended == 0 && Clock::now() - from < 30s;) std::this_thread::sleep_for(5ms);
  EXPECT_EQ(*ended, 1) << "its worker went on to other things";
  EXPECT_TRUE(deaf.receive().value_or(test::Reply{}).body.ends_with("xy" + std::string(999, 'y')));
}

TEST_F(Stream, WhatIsWrittenInPiecesIsWhole) {
  std::string expected;
  for (int i = 0; i < 300; ++i) expected += std::string(10'000, static_cast<char>('a' + i % 26));
  serve([](const HttpRequest&) {
    Answer answer{200, "text/plain", {}, {}};
    answer.pieces = [i = 0](std::string& out) mutable {
      out += std::string(10'000, static_cast<char>('a' + i % 26));
      return ++i < 300;
    };
    return answer;
  });
  EXPECT_TRUE(body("1.0") == expected);
  Client client = asking();
  for (int k = 0; k < 3; ++k) {
    const auto reply = client.receive();
    ASSERT_TRUE(reply);
    EXPECT_TRUE(reply->body == expected);
    client.send(test::post("/", ""));
  }
}

// A client that does not read holds the bytes on their way, and no thread.
TEST_F(Stream, WhatNobodyReadsIsNotWritten) {
  settings.threads = 1;
  const auto written = std::make_shared<std::atomic<std::size_t>>(0);
  serve([written](const HttpRequest&) {
    Answer answer{200, "text/plain", {}, {}};
    answer.pieces = [written, bytes = std::size_t{0}](std::string& out) mutable {
      out += std::string(100'000, 'x');
      *written += 100'000;
      return (bytes += 100'000) < 60'000'000;
    };
    return answer;
  });
  std::vector<Client> deaf;
  for (int i = 0; i < 4; ++i) deaf.push_back(asking());
  std::this_thread::sleep_for(500ms);
  EXPECT_LT(*written, 4 * 15'000'000u) << "what the system takes, and less than a megabyte more";
  Client reader = asking();
  EXPECT_EQ(reader.receive().value_or(test::Reply{}).body.size(), 60'000'000u);
}

TEST_F(Stream, AClientThatTakesNothingIsLetGo) {
  settings.bounds.stall = 200ms;
  const auto ended = std::make_shared<std::atomic<bool>>(false);
  serve_stream([ended](const Write& write) {
    const std::string piece(10'000, 'x');
    const auto from = Clock::now();
    while (Clock::now() - from < 50s && write(piece)) {
    }
    *ended = true;
    return false;
  });
  const Client deaf = asking();
  const auto from = Clock::now();
  while (!*ended && Clock::now() - from < 40s) std::this_thread::sleep_for(10ms);
  EXPECT_TRUE(*ended);
}

// A byte now and then is not enough, whether the answer is in memory, written in pieces or computed.
TEST_F(Stream, AClientThatDripsIsLetGo) {
  settings.bounds.drip = 300ms;
  settings.bounds.rate = 1e12;  // more than anybody takes
  settings.bounds.send_buffer = tight_buffer;
  constexpr std::size_t most = 2'000'000;  // of forty
  for (const int kind : {0, 1, 2}) {
    serve([kind](const HttpRequest&) {
      Answer answer{200, "text/plain", kind == 0 ? std::string(40'000'000, 'x') : "", {}};
      if (kind == 1) {
        answer.pieces = [n = 0](std::string& out) mutable {
          out += std::string(100'000, 'x');
          return ++n < 400;
        };
      }
      if (kind == 2) {
        answer.stream = [](const Write& write) -> std::optional<std::string> {
          for (int n = 0; n < 400; ++n)
            if (!write(std::string(100'000, 'x'))) return std::nullopt;
          return "";
        };
      }
      return answer;
    });
    Client dripping = asking('1', tight_buffer);
    std::size_t bytes = 0;  // until it is let go: no clock of this test has a part in it
    while (const auto some = dripping.some(256)) {
      if ((bytes += some->size()) > most) break;
      std::this_thread::sleep_for(1ms);
    }
    EXPECT_LT(bytes, most) << kind;
  }
}

// A slow computation is not the client's fault.
TEST_F(Stream, AStreamMayTakeItsTime) {
  settings.bounds.drip = 50ms;
  settings.bounds.stall = 50ms;
  serve_stream([](const Write& write) {
    for (int k = 0; k < 4; ++k) {
      std::this_thread::sleep_for(100ms);
      if (!write("x")) return false;
    }
    return true;
  });
  EXPECT_TRUE(body().ends_with("0\r\n\r\n"));
}

// A computation learns that its client hung up, before its answer and within it, while it has nothing to send. A client
// that only ended its sending has not hung up.
TEST_F(Stream, SeesThatTheClientWentAway) {
  constexpr auto longest = 2s;
  const auto seconds = std::make_shared<std::atomic<double>>(-1);
  for (const bool within : {false, true}) {
    const auto wait = [=](const std::function<bool()>& gone) {
      const auto from = Clock::now();
      while (!gone() && Clock::now() - from < longest) std::this_thread::sleep_for(1ms);
      *seconds = std::chrono::duration<double>(Clock::now() - from).count();
    };
    serve([=](const HttpRequest& request) {
      Answer answer{200, "text/plain", "text", {}};
      if (!within) wait(request.gone);
      if (within) {
        answer.stream = [wait, gone = request.gone](const Write& write) -> std::optional<std::string> {
          if (!write("line 1\n")) return std::nullopt;
          wait(gone);
          return "line 2\n";
        };
        answer.begins = "line";
      }
      return answer;
    });
    for (const auto leave : {&Client::hang_up, &Client::reset, &Client::end_sending}) {
      for (const char minor : {'1', '0'}) {
        *seconds = -1;
        Client client = asking(minor);
        client.send("x");  // what it sent ahead hides nothing
        std::this_thread::sleep_for(100ms);
        (client.*leave)();
        for (const auto from = Clock::now(); *seconds < 0 && Clock::now() - from < 10s;)
          std::this_thread::sleep_for(1ms);
        if (leave != &Client::end_sending) {
          EXPECT_LT(*seconds, longest.count()) << within << minor;
          continue;
        }
        EXPECT_GE(*seconds, longest.count()) << within << minor;
        const std::string body = within ? "line 1\nline 2\n" : "text";
        if (minor == '1') {
          EXPECT_EQ(client.receive().value_or(test::Reply{}).body, body);
          continue;
        }
        std::string text;
        while (const auto some = client.some()) text += *some;
        EXPECT_TRUE(text.starts_with("HTTP/1.1 200 OK\r\n") && text.ends_with("\r\n\r\n" + body)) << text;
      }
    }
  }
}

// The check for the client sends nothing that is not part of the answer, also where the answer is compressed or has
// begun.
TEST_F(Stream, LooksForTheClientWithWhatIsSentAnyway) {
  serve([](const HttpRequest&) {
    Answer answer{200, "text/plain", {}, {}};
    answer.begins = "line";
    answer.stream = [](const Write& write) -> std::optional<std::string> {
      for (int k = 0; k < 3; ++k) {
        if (!write("line " + std::string(2000, 'x') + "\n")) return std::nullopt;
        std::this_thread::sleep_for(400ms);
      }
      return "line\n";
    };
    return answer;
  });
  for (const char* fields : {"Accept-Encoding: gzip\r\n", ""}) {
    EXPECT_TRUE(body("1.0", fields, true) == body("1.0", fields)) << fields;
  }
}

// A client that first ended its sending and hung up later is noticed, too.
TEST_F(Stream, SeesThatTheClientWentAwayInTheEnd) {
  const auto left = std::make_shared<std::atomic<bool>>(false);
  serve([left](const HttpRequest& request) {
    for (const auto from = Clock::now(); !request.gone() && Clock::now() - from < 20s;)
      std::this_thread::sleep_for(1ms);
    *left = request.gone();
    return Answer{200, "text/plain", "text", {}};
  });
  {
    Client client = asking();
    client.end_sending();
    EXPECT_EQ(client.some(1), "H");
    std::this_thread::sleep_for(200ms);
    (void)client.some();  // unread bytes would cause a reset
    EXPECT_FALSE(*left);
  }
  for (const auto from = Clock::now(); !*left && Clock::now() - from < 10s;) std::this_thread::sleep_for(1ms);
  EXPECT_TRUE(*left);
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
