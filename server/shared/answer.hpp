// What the service says to one request, before it is put on a wire (HTTP) or a terminal (`run`).
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

/// Takes the next piece of a body; false: the client takes no more.
using Write = std::function<bool(std::string_view)>;

/// What the log says of an answer beside what is said of all.
struct Note {
  std::string_view name;
  std::variant<std::string, double, std::int64_t> value;
};

struct Answer {
  int status = 200;
  std::string type;  ///< media type of the body
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers;  ///< further header fields
  /// Stands in place of `body` where that is computed while it is sent: whoever computes waits for the client to take
  /// it, but not for its end to be taken, which is what is returned: a place to compute may be given back before.
  /// Nothing: its end is missing.
  std::function<std::optional<std::string>(const Write&)> stream = nullptr;
  /// How each piece of a stream begins, and its end; may be empty.
  std::string_view begins{};
  /// Stands in place of `body` where that is only to be written, whenever there is room: appends the next piece. False:
  /// it was the last.
  std::function<bool(std::string&)> pieces = nullptr;
  /// Shared with a stream, which knows more at its end.
  std::shared_ptr<std::vector<Note>> notes = nullptr;

  void note(std::string_view name, std::variant<std::string, double, std::int64_t> value) {
    if (!notes) {
      notes = std::make_shared<std::vector<Note>>();
      notes->reserve(5);  // of a run
    }
    notes->push_back({name, std::move(value)});
  }
};

}  // namespace least::server
