// Turns received bytes into whole requests, without knowledge of sockets. Everything a client can stretch is limited.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "server/http/request_head.hpp"
#include "server/shared/memory_budget.hpp"

namespace least::server {

/// Limits in bytes.
struct RequestBounds {
  HeadBounds head;
  std::size_t body = 1 << 20;
};

/// Message is a whole request.
struct Message {
  RequestHead head;
  std::string body;
  bool keep_alive = true;
  bool for_metrics = false;  ///< received at the port for metrics
  Held held{};               ///< charged to the memory for requests
};

/// Refused is a refusal with what is known of the request.
struct Refused {
  Refusal refusal;
  std::string method;
};

/// Received is a request or a refusal; monostate: more bytes are needed.
using Received = std::variant<std::monostate, Message, Refused>;

/// full_memory returns the message for requests when memory is full, of one request alone or of all clients.
std::string full_memory(const MemoryBudget& memory);
/// beyond_memory returns the message for a request that needs more than all memory.
std::string beyond_memory(const MemoryBudget& memory);

/// RequestReader parses the stream of one connection.
class RequestReader {
 public:
  /// Bytes that are accepted in any case, and kept by an idle connection, so that health can be asked for when memory
  /// is full.
  static constexpr std::size_t small = 4096;

  /// The bytes are charged to `memory`, if given. Both must outlive the reader.
  explicit RequestReader(const RequestBounds& bounds, MemoryBudget* memory = nullptr)
      : bounds_(bounds), memory_(memory), held_(memory) {}

  /// buffer() is where received bytes are to be appended.
  std::string& buffer() { return buffer_; }

  /// read() returns the next request if it is complete. After a refusal nothing is kept: the rest of the stream cannot
  /// be parsed.
  Received read();

  /// awaits() tells what has to arrive next: a request, the rest of a head, or the rest of a body.
  enum class Awaits { request, head, body };
  Awaits awaits() const;

  /// asks_to_continue() tells, once, that the client waits for 100 Continue.
  bool asks_to_continue();

  /// too_late() returns the refusal of a request whose rest does not arrive in time.
  Refused too_late() const;

 private:
  enum class Part { head, body, trailer, whole };

  Received next();
  std::optional<Refused> read_head();
  std::optional<Refusal> read_body();
  std::optional<Refusal> read_chunked();
  // `at` is the number of bytes of the buffer that have been parsed, here and below.
  std::optional<Refusal> read_chunks(std::size_t& at);
  std::optional<Refusal> read_trailer(std::size_t& at);
  // Returns a line without its CRLF, which stays valid while the buffer is not changed; nothing while it is incomplete,
  // or if it is too long.
  std::optional<std::string_view> read_line(std::size_t& at, std::size_t longest) const;

  const RequestBounds& bounds_;
  MemoryBudget* const memory_;
  Held held_;           // of the buffer and the message
  std::string buffer_;  // received but not yet parsed; a client may send requests ahead
  Part part_ = Part::head;
  std::size_t looked_ = 0;            // bytes of the head that were searched for its end
  std::size_t blank_ = 0;             // bytes of blank lines before it
  Message message_;                   // valid once its head is read
  Framing framing_;                   // of it
  std::optional<std::size_t> chunk_;  // bytes of the current chunk that are missing, once its size is known
  std::size_t trailer_ = 0;           // bytes of the trailer so far
  bool asks_ = false;
};

}  // namespace least::server
