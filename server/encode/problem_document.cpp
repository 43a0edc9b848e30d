#include "server/encode/problem_document.hpp"

#include "server/shared/http_status.hpp"
#include "server/shared/json_writer.hpp"

namespace least::server {
namespace {

void head(JsonWriter& json, int status) {
  json.open('{').key("type").text("/errors/" + std::string(error_name(status)));
  json.key("title").text(phrase(status)).key("status").integer(status);
}

Answer finish(JsonWriter& json, int status, std::string_view request_id, std::string reason) {
  json.key("request_id").text(request_id).close('}');
  Answer answer{status, "application/problem+json", std::move(json.buffer()) + '\n', {}};
  if (!reason.empty()) answer.note("reason", std::move(reason));
  return answer;
}

}  // namespace

Answer problem_document(int status, std::string_view detail, std::string_view request_id) {
  std::string body;
  JsonWriter json(body);
  head(json, status);
  if (!detail.empty()) json.key("detail").text(detail);
  return finish(json, status, request_id, std::string(detail));
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
    if (fault.position) json.key("position").integer(static_cast<std::int64_t>(*fault.position));
    json.close('}');
  }
  json.close(']');
  const auto& first = faults.list().front();
  return finish(json, 422, request_id, first.pointer + " " + first.detail);
}

}  // namespace least::server
