// The answer of the service to one request, before it is sent over HTTP or written to a terminal (`run`).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace least::server {

/// Write receives the next piece of a body; false: the client takes no more.
using Write = std::function<bool(std::string_view)>;

/// Note is what the log says of an answer besides the common fields.
struct Note {
  std::string_view name;
  std::variant<std::string, double, std::int64_t> value;
};

/// Answer is a status with a body: a text, a stream or pieces.
struct Answer {
  int status = 200;
  std::string type;  ///< media type of the body
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers;  ///< further header fields
  /// Used instead of `body` if that is computed while it is sent: it writes all but the end, waiting for the client to
  /// take it, and returns the end, for which it does not wait, so that the place to compute can be given back. Nothing:
  /// the end is missing.
  std::function<std::optional<std::string>(const Write&)> stream = nullptr;
  /// How each piece of a stream begins, and its end; may be empty.
  std::string_view begins{};
  /// Used instead of `body` if that only has to be written, as there is room: appends the next piece. False: it was the
  /// last.
  std::function<bool(std::string&)> pieces = nullptr;
  /// Shared with the stream, which may add notes at its end.
  std::shared_ptr<std::vector<Note>> notes = nullptr;

  void note(std::string_view name, std::variant<std::string, double, std::int64_t> value) {
    if (!notes) {
      notes = std::make_shared<std::vector<Note>>();
      notes->reserve(5);  // enough for a run
    }
    notes->push_back({name, std::move(value)});
  }
};

}  // namespace least::server
