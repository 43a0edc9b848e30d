#include "server/shared/http_status.hpp"

#include <algorithm>
#include <iterator>

namespace least::server {
namespace {

struct Type {
  int status;
  std::string_view phrase, error;
};

constexpr Type kinds[] = {{100, "Continue", ""},
                          {200, "OK", ""},
                          {204, "No Content", ""},
                          {304, "Not Modified", ""},
                          {400, "Bad Request", "malformed-request"},
                          {403, "Forbidden", "forbidden"},
                          {404, "Not Found", "not-found"},
                          {405, "Method Not Allowed", "method-not-allowed"},
                          {406, "Not Acceptable", "not-acceptable"},
                          {408, "Request Timeout", "request-timeout"},
                          {411, "Length Required", "length-required"},
                          {413, "Content Too Large", "content-too-large"},
                          {414, "URI Too Long", "uri-too-long"},
                          {415, "Unsupported Media Type", "unsupported-encoding"},
                          {416, "Range Not Satisfiable", "range-not-satisfiable"},
                          {417, "Expectation Failed", "expectation-failed"},
                          {422, "Unprocessable Content", "invalid-request"},
                          {431, "Request Header Fields Too Large", "header-too-large"},
                          {500, "Internal Server Error", "internal-error"},
                          {501, "Not Implemented", "not-implemented"},
                          {503, "Service Unavailable", "busy"},
                          {505, "HTTP Version Not Supported", "version-not-supported"}};

const Type& kind(int status) {
  static constexpr Type unknown{0, "Error", "error"};
  const auto it = std::find_if(std::begin(kinds), std::end(kinds), [=](const Type& k) { return k.status == status; });
  return it == std::end(kinds) ? unknown : *it;
}

}  // namespace

std::string_view phrase(int status) { return kind(status).phrase; }
std::string_view error_name(int status) { return kind(status).error; }

}  // namespace least::server
