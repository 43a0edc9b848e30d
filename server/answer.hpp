// What the service says to one request, before it is put on a wire (HTTP) or a terminal (`run`).
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace least::server {

struct Answer {
  int status = 200;
  std::string type;  ///< media type of the body
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers;  ///< further header fields
};

}  // namespace least::server
