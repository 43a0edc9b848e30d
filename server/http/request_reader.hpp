// Bytes of a client → whole requests. Knows no socket: what came is put in, what is whole comes out, and everything a
// client can stretch has a bound.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <variant>

#include "server/http/request_head.hpp"
#include "server/shared/memory_budget.hpp"

namespace least::server {

/// In bytes.
struct RequestBounds {
  HeadBounds head;
  std::size_t body = 1 << 20;
};

/// A whole request.
struct Message {
  RequestHead head;
  std::string body;
  bool keep_alive = true;
  bool for_metrics = false;  ///< it came by the port for them
  Held held{};               ///< of the memory for requests
};

/// A refusal beside what is known of the request.
struct Refused {
  Refusal refusal;
  std::string method;
};

/// Nothing: more has to come.
using Received = std::variant<std::monostate, Message, Refused>;

/// What to say where there is no more.
std::string full_memory(const MemoryBudget& memory);

class RequestReader {
 public:
  /// Bytes taken in any case, and kept by a connection that idles: whether the service lives can be asked when memory
  /// is full.
  static constexpr std::size_t small = 4096;

  /// What is read counts in `memory`, where there is any. Both live on.
  explicit RequestReader(const RequestBounds& bounds, MemoryBudget* memory = nullptr)
      : bounds_(bounds), memory_(memory), held_(memory) {}

  /// Where bytes that came are put, at the end.
  std::string& buffer() { return buffer_; }

  /// The next request, if all of it has come. After a refusal nothing is kept: the rest of the stream cannot be read.
  Received read();

  /// What has to come next: a request, the rest of a head, or the rest of a body.
  enum class Awaits { request, head, body };
  Awaits awaits() const;

  /// Whether the client waits to be asked for the body; said once.
  bool asks_to_continue();

  /// What to say when the rest does not come in time.
  Refused too_late() const;

 private:
  enum class Part { head, body, trailer, whole };

  Received next();
  std::optional<Refused> read_head();
  std::optional<Refusal> read_body();
  std::optional<Refusal> read_chunks();
  std::optional<Refusal> read_trailer();
  std::optional<std::string> read_line(std::size_t longest);

  const RequestBounds& bounds_;
  MemoryBudget* const memory_;
  Held held_;           // for the buffer and the message
  std::string buffer_;  // received, not yet read: a client may send requests ahead
  Part part_ = Part::head;
  std::size_t looked_ = 0;            // so much of a head has no end in it
  std::size_t blank_ = 0;             // bytes of blank lines before it
  Message message_;                   // from its head on
  Framing framing_;                   // of it
  std::optional<std::size_t> chunk_;  // bytes of a chunk that are to come, where its size has
  std::size_t trailer_ = 0;           // bytes of the trailer that came
  bool asks_ = false;
};

}  // namespace least::server
