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
  std::chrono::milliseconds idle{60'000};  ///< between requests
  std::chrono::milliseconds head_time{5'000}, body_time{10'000};
  std::chrono::milliseconds stall{5'000};  ///< without one byte taken by the client while answering
  /// An answer waits for its client no longer than this, and no longer than bytes leave at `rate` in a second.
  std::chrono::milliseconds drip{5'000};
  double rate = 64 * 1024;
};

/// A whole request.
struct Message {
  RequestHead head;
  std::string body;
  bool keep_alive = true;
};

/// The client is gone, was idle for too long, or the service ends.
struct Gone {
  bool begun = false;  ///< a request had begun
};

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

  /// Whether a request that the client sent ahead has come.
  bool has_more() const { return !buffer_.empty(); }

  /// Whether the client went away, as far as it can be told. Who only ended its sending is still there: it is sent an
  /// interim answer, and seen at the next call not to be there where that was refused. To be called by one thread at a
  /// time, and while an answer is computed or sent.
  bool gone();

  /// Ends sending and lets the client finish talking for a moment: closing at once would take the answer back from a
  /// client that is still sending.
  void linger();

 private:
  using Clock = std::chrono::steady_clock;

  void begin_answer(bool interim);
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
  std::size_t sent_ = 0, taken_ = 0;                         // of the last answer: bytes of its body, and all that left
  Clock::time_point last_write_ = Clock::time_point::max();  // set once, when the service ends: so long may all be sent
  Clock::duration blocked_{0};                               // that its client let it wait
  // Of the request that is answered now; looked at by another thread while it is.
  std::atomic<bool> interim_{false};    // its client understands interim answers
  std::atomic<bool> answering_{false};  // its answer has begun
  std::atomic<bool> probed_{false};     // an interim answer was sent
};

}  // namespace least::server
