// What the service says to one request, before it is put on a wire (HTTP) or a terminal (`run`).
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace least::server {

/// Takes the next piece of a body; false: the client takes no more.
using Write = std::function<bool(std::string_view)>;

struct Answer {
  int status = 200;
  std::string type;  ///< media type of the body
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers;  ///< further header fields
  /// Stands in place of `body` where that is computed while it is sent. False: its end is missing.
  std::function<bool(const Write&)> stream = nullptr;
};

}  // namespace least::server
