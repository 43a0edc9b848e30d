#include "server/problem_document.hpp"

#include <algorithm>
#include <iterator>

#include "server/json_writer.hpp"

namespace least::server {
namespace {

struct Type {
  int status;
  std::string_view phrase, type;
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

void head(JsonWriter& json, int status) {
  json.open('{').key("type").text("/errors/" + std::string(kind(status).type));
  json.key("title").text(kind(status).phrase).key("status").integer(status);
}

Answer finish(JsonWriter& json, int status, std::string_view request_id) {
  json.key("request_id").text(request_id).close('}');
  return {status, "application/problem+json", std::move(json.buffer()) + '\n', {}};
}

}  // namespace

std::string_view phrase(int status) { return kind(status).phrase; }

Answer problem_document(int status, std::string_view detail, std::string_view request_id) {
  std::string body;
  JsonWriter json(body);
  head(json, status);
  if (!detail.empty()) json.key("detail").text(detail);
  return finish(json, status, request_id);
}

Answer problem_document(const Faults& faults, std::string_view request_id) {
  std::string body;
  JsonWriter json(body);
  head(json, 422);
  json.key("errors").open('[');
  for (const Fault& fault : faults.list()) {
    json.open('{').key("pointer").text(fault.pointer).key("detail").text(fault.detail);
    if (!fault.value.empty()) json.key("value").raw(fault.value);
    if (!fault.allowed.empty()) json.key("allowed").text(fault.allowed);
    json.close('}');
  }
  json.close(']');
  return finish(json, 422, request_id);
}

}  // namespace least::server
