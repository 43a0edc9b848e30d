// One client connection: whole requests come off it, whole answers go onto it. Everything a client can stretch has a
// bound here: sizes, counts, times.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "server/http/request_head.hpp"
#include "server/shared/answer.hpp"

namespace least::server {

/// What all connections look at.
struct Lifecycle {
  std::atomic<bool> draining{false};   ///< no new requests; those that came are answered
  std::atomic<bool> cancelled{false};  ///< runs end now
  std::atomic<int> waiting{0};         ///< connections accepted that no thread has taken up yet
};

/// Bounds of one connection. A client that is slower than this is let go, so that a slow one costs a thread for
/// seconds.
struct ConnectionBounds {
  HeadBounds head;
  std::size_t body = 1 << 20;
  std::chrono::milliseconds idle{15'000};  ///< between requests
  std::chrono::milliseconds head_time{10'000}, body_time{10'000};
  std::chrono::milliseconds stall{5'000};  ///< without one byte taken by the client while answering
};

/// A whole request.
struct Message {
  RequestHead head;
  std::string body;
  bool keep_alive = true;
};

/// The client is gone, was idle for too long, or the service ends.
struct Gone {};

/// A refusal beside what is known of the request.
struct Refused {
  Refusal refusal;
  std::string method;
};

using Received = std::variant<Message, Refused, Gone>;

class Connection {
 public:
  /// Borrows the socket.
  Connection(int socket, const ConnectionBounds& bounds, const Lifecycle& lifecycle)
      : socket_(socket), bounds_(bounds), lifecycle_(lifecycle) {}

  /// The next request. After a refusal the rest of the stream cannot be read: answer, then `linger`.
  Received receive();

  /// Sends an answer; `body` false for HEAD. False when the client did not take it, or a stream broke off: what came of
  /// it then ends with the connection and without the mark of its end. Throws what a stream throws.
  bool send(const Answer& answer, bool keep_alive, bool body);

  /// Bytes of the last answer's body that were sent, or tried to.
  std::size_t sent() const { return sent_; }

  /// Whether the client has ended its side of the connection. Safe from any thread.
  bool gone() const;

  /// Ends sending and lets the client finish talking for a moment: closing at once would take the answer back from a
  /// client that is still sending.
  void linger();

 private:
  using Clock = std::chrono::steady_clock;

  bool await_request();
  bool fill(Clock::time_point deadline);
  bool write(std::string_view bytes);
  bool write_stream(const Answer& answer);
  std::optional<Refusal> read_body(const Framing& framing, std::string& body);
  std::optional<Refusal> read_chunks(std::string& body, Clock::time_point deadline);
  std::optional<std::string> read_line(std::size_t longest, Clock::time_point deadline);

  int socket_;
  const ConnectionBounds& bounds_;
  const Lifecycle& lifecycle_;
  std::string buffer_;  // received, not yet read: a client may send requests ahead
  bool fresh_ = true;   // no request came yet
  bool chunks_ = true;  // the client of the last request understands chunked coding: it is not of HTTP/1.0
  std::size_t sent_ = 0;
};

}  // namespace least::server
