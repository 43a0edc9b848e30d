// From bytes to requests: however the bytes are cut on their way, the requests are the same.
#include "server/http/request_reader.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <limits>
#include <string>
#include <vector>

namespace least::server {
namespace {

// read_in() reads bytes that arrive in pieces of `piece` bytes and returns a line for each request.
std::vector<std::string> read_in(std::string_view bytes, std::size_t piece) {
  const RequestBounds bounds{{200, 100, 5}, 50};
  RequestReader reader(bounds);
  std::vector<std::string> seen;
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    reader.buffer() += bytes.substr(at, piece);
    for (;;) {
      Received received = reader.read();
      if (std::holds_alternative<std::monostate>(received)) break;
      if (const auto* const refused = std::get_if<Refused>(&received)) {
        seen.push_back(std::to_string(refused->refusal.status));
        return seen;
      }
      const auto& message = std::get<Message>(received);
      seen.push_back(message.head.method + ' ' + message.head.path + ' ' + message.body);
    }
  }
  constexpr const char* states[] = {"nothing", "head", "body"};
  seen.emplace_back(states[static_cast<int>(reader.awaits())]);
  return seen;
}

TEST(RequestReader, DoesNotCareWhereBytesAreCut) {
  const std::string host = "Host: x\r\n", chunked = "Transfer-Encoding: chunked\r\n";
  const struct {
    std::string bytes;
    std::vector<std::string> expected;
  } rows[] = {
      {"GET /a HTTP/1.1\r\n" + host + "\r\n", {"GET /a ", "nothing"}},
      {"\r\n\r\nGET /a HTTP/1.1\r\n" + host + "\r\n\r\nGET /b HTTP/1.1\r\n" + host, {"GET /a ", "head"}},
      {"POST /a HTTP/1.1\r\n" + host + "Content-Length: 3\r\n\r\nabcGET /b HTTP/1.1\r\n" + host + "\r\nG",
       {"POST /a abc", "GET /b ", "head"}},
      {"POST /a HTTP/1.1\r\n" + host + "Content-Length: 3\r\n\r\nab", {"body"}},
      {"POST /a HTTP/1.1\r\n" + host + chunked + "\r\n2;x=y\r\nab\r\n003\r\n\r\ne\r\n0\r\nA: b\r\n\r\nX",
       {"POST /a ab\r\ne", "head"}},
      {"POST /a HTTP/1.1\r\n" + host + chunked + "\r\n2\r\nab\r\n0\r\nA: b\r\n", {"body"}},
      {"POST /a HTTP/1.1\r\n" + host + chunked + "\r\n2\r\nabc\r\n", {"400"}},
      {"POST /a HTTP/1.1\r\n" + host + chunked + "\r\n33\r\n", {"413"}},
      {"POST /a HTTP/1.1\r\n" + host + chunked + "\r\n0\r\n" + std::string(300, 'a'), {"400"}},
      {"POST /a HTTP/1.1\r\n" + host + "Content-Length: 51\r\n\r\n", {"413"}},
      // A bare line feed ends a line for some readers: they would take the rest for another request.
      {"POST /a HTTP/1.1\r\n" + host + chunked + "\r\n0\r\n\n\r\nGET /b HTTP/1.1\r\n" + host + "\r\n", {"400"}},
      {"POST /a HTTP/1.1\r\n" + host + chunked + "\r\n2 junk\r\nab\r\n0\r\n\r\n", {"400"}},
      {"POST /a HTTP/1.1\r\n" + host + chunked + "\r\n2 \t;x\r\nab\r\n0\r\n\r\n", {"POST /a ab", "nothing"}},
      {"\r\n", {"nothing"}},
      {"\r\n\r\n", {"head"}},
      {"GET /" + std::string(300, 'a'), {"431"}},
      {"GET /a HTTP/1.1\r\nHost: x\n\r\n", {"400"}},
  };
  for (const auto& row : rows) {
    for (std::size_t piece = 1; piece <= row.bytes.size(); ++piece) {
      EXPECT_EQ(read_in(row.bytes, piece), row.expected) << piece << ' ' << row.bytes;
    }
  }
}

// Chunks of one byte cost the same each, however many of them arrive at once: the time, that of this thread, is
// proportional to the bytes. It was proportional to their square when the buffer was moved after each chunk.
TEST(RequestReader, TakesManySmallChunksInTheTimeOfTheirBytes) {
  constexpr std::size_t count = 1 << 16;
  std::string chunks;
  for (std::size_t i = 0; i < count; ++i) chunks += "1\r\nx\r\n";
  const auto seconds_for = [&](std::size_t piece) {
    double least = std::numeric_limits<double>::infinity();
    for (int attempt = 0; attempt < 3; ++attempt) {
      const RequestBounds bounds;
      RequestReader reader(bounds);
      reader.buffer() += "POST / HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n";
      reader.read();
      const auto now = [] {
        timespec time{};
        ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
        return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
      };
      const double from = now();
      for (std::size_t at = 0; at < chunks.size(); at += piece) {
        reader.buffer() += chunks.substr(at, piece);
        reader.read();
      }
      least = std::min(least, now() - from);
      reader.buffer() += "0\r\n\r\n";
      const Received received = reader.read();
      EXPECT_TRUE(std::holds_alternative<Message>(received));
      EXPECT_EQ(std::get<Message>(received).body, std::string(count, 'x'));
    }
    return least;
  };
  const double together = seconds_for(chunks.size()), apart = seconds_for(64);
  EXPECT_LT(together, 5 * apart);
}

TEST(RequestReader, BlankLinesHaveABound) {
  const RequestBounds bounds{{200, 100, 5}, 50};
  RequestReader reader(bounds);
  std::size_t sent = 0;
  for (; sent < 300; sent += 20) {
    reader.buffer() += std::string("\r\n\r\n\r\n\r\n\r\n\r\n\r\n\r\n\r\n\r\n");
    if (std::holds_alternative<Refused>(reader.read())) break;
  }
  EXPECT_EQ(sent, 200U) << "and no request came of them";
}

TEST(RequestReader, AsksOnceForABodyThatIsAwaited) {
  const RequestBounds bounds;
  RequestReader reader(bounds);
  reader.buffer() += "POST / HTTP/1.1\r\nHost: x\r\nExpect: 100-continue\r\nContent-Length: 2\r\n\r\n";
  reader.read();
  EXPECT_TRUE(reader.asks_to_continue());
  EXPECT_FALSE(reader.asks_to_continue());
  EXPECT_EQ(reader.too_late().refusal.status, 408);
  reader.buffer() += "{}POST / HTTP/1.1\r\nHost: x\r\nExpect: 100-continue\r\nContent-Length: 2\r\n\r\n{";
  EXPECT_TRUE(std::holds_alternative<Message>(reader.read()));
  reader.read();
  EXPECT_FALSE(reader.asks_to_continue()) << "it did not wait";
}

}  // namespace
}  // namespace least::server
