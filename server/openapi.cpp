#include "server/openapi.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iterator>

#include "core/catalogue/catalogue.hpp"
#include "server/encode/run_answer.hpp"
#include "server/http/connection.hpp"
#include "server/http/workers.hpp"
#include "server/openapi_periodic.hpp"
#include "server/openapi_schemas.hpp"
#include "server/shared/operations.hpp"

namespace least::server {
namespace {

// examples_of returns the example requests of one endpoint by name.
Json examples_of(std::string_view path, const Cards& cards) {
  Json all = Json::object();
  const auto add = [&](const std::string& name, Json value) { all[name] = {{"value", std::move(value)}}; };
  if (cards.problems.empty()) return all;
  const auto simple = std::ranges::find_if(cards.problems, [](const auto& one) { return one->text() == nullptr; });
  const ProblemCard& first = (simple == cards.problems.end() ? cards.problems.front() : *simple)->card();
  const auto scheme = [&](const ProblemCard& card) { return cards.schemes[card.schemes.front()].id; };
  const Json well{{"id", "custom"},
                  {"variables", {"x"}},
                  {"parameters", {{"alpha", 0.1}}},
                  {"lagrangian", "vx^2/2 + x^2/2 - x^4/4 - alpha*s"}};
  if (path == "/v1/simulate") {
    for (const auto& problem : cards.problems) {
      const ProblemCard& card = problem->card();
      add(card.id, {{"problem", card.id}, {"scheme", scheme(card)}, {"record", {{"samples", 5}}}});
    }
    const std::string variable = first.variables.front().name;
    const Json square{{"name", "square"}, {"expression", variable + "^2"}};
    const Json zero{{"name", "zero"}, {"expression", variable}, {"direction", "up"}};
    add("expressions", {{"problem", first.id},
                        {"scheme", scheme(first)},
                        {"record", {{"samples", 5}}},
                        {"columns", Json::array({"t", square})},
                        {"events", Json::array({zero})}});
    add("auto",
        {{"problem", first.id}, {"scheme", {{"id", auto_card().id}, {"accuracy", 1e-3}}}, {"record", {{"every", 0}}}});
    add("custom", {{"problem", well},
                   {"initial", {{"x", 2}}},
                   {"scheme", "contact_leapfrog"},
                   {"record", {{"samples", 5}}},
                   {"columns", {"t", "x", "energy"}}});
  } else if (path == "/v1/problems") {
    add("custom", {{"problem", well}});
  } else if (path == "/v1/ensemble") {
    const std::string start = "/initial/" + first.variables.front().name;
    add(first.id, {{"problem", first.id},
                   {"scheme", scheme(first)},
                   {"until", {{"steps", 10}}},
                   {"members", {{"vary", {{start, {{"values", {0.4, 0.5, 0.6}}}}}}}}});
  } else if (path == "/v1/periodic") {
    const Json pendulum{{"id", "custom"}, {"variables", {"a"}}, {"lagrangian", "va^2/2 + cos(a)"}};
    add("family", {{"problem", pendulum},
                   {"initial", {{"a", 0.5}}},
                   {"period", 6.4},
                   {"fixed", {"pa"}},
                   {"family", {{"by", "/initial/a"}, {"to", 0.6}, {"count", 5}}}});
  } else if (path == "/v1/work-precision" || path == "/v1/stability") {
    add(first.id, {{"problem", first.id}, {"schemes", Json::array({scheme(first)})}, {"budget_seconds", 1}});
  }
  return all;
}

}  // namespace

Json example_of(std::string_view path, const Cards& cards) {
  const Json all = examples_of(path, cards);
  return all.empty() ? Json() : all.front()["value"];
}

namespace {

// By tells which operations have a status besides 200: all, those that compute, those with a text that is made once,
// those with one of several texts.
enum class By { all, computed, text, entry };

struct FurtherStatus {
  const char* status;
  By by;
  const char* why;
};
constexpr FurtherStatus further[] = {
    {"304", By::text, "what If-None-Match names is what there is"},
    {"400", By::all, "no JSON, or no well-formed request"},
    {"403", By::all, "a Host or an Origin that is not allowed"},
    {"404", By::entry, "no such id"},
    {"406", By::computed, "no such form"},
    {"406", By::text, "no such form"},
    {"408", By::all, "the rest of the request did not come in time"},
    {"411", By::computed, "neither a length nor chunks"},
    {"413", By::all, "too large"},
    {"414", By::all, "the target is too long"},
    {"415", By::all, "a Content-Encoding that is not taken"},
    {"416", By::text, "a Range that begins beyond the end"},
    {"417", By::all, "something other than 100-continue is expected"},
    {"422", By::computed, "every fault of the request, each with its place and what is allowed"},
    {"431", By::all, "the head is too large"},
    {"500", By::all, "a fault of the service"},
    {"501", By::all, "a Transfer-Encoding that is not understood"},
    {"503", By::all, "busy, out of memory, or about to end; where there is Retry-After, it says when to ask again"},
    {"505", By::all, "a version of HTTP that is not spoken"}};

Json refusals() {
  Json all = Json::object();
  for (const auto& [status, by, why] : further) {
    all[status] = {{"description", why}};
    if (by == By::text && status == std::string_view("304")) continue;
    all[status]["content"]["application/problem+json"]["schema"] = reference("ProblemDocument");
  }
  return all;
}

Json responses(const Operation& operation, Json answer) {
  constexpr std::string_view probes[] = {"/healthz", "/readyz", "/metrics"};
  const bool computes = operation.method == "POST";
  const bool text = !computes && std::find(std::begin(probes), std::end(probes), operation.path) == std::end(probes);
  const bool entry = operation.path.find("{id}") != operation.path.npos;
  Json all{{"200", std::move(answer)}};
  for (const auto& [status, by, why] : further) {
    if (by == By::all || (by == By::computed && computes) || (by == By::text && text) || (by == By::entry && entry)) {
      all[status] = {{"$ref", std::string("#/components/responses/") + status}};
    }
  }
  return all;
}

// rule_for_readers returns the text about clients that read slower than lines are computed.
std::string rule_for_readers() {
  const ConnectionBounds bounds;
  const auto seconds = [](std::chrono::milliseconds time) { return std::chrono::duration<double>(time).count(); };
  return fmt::format(
      "Lines of application/x-ndjson leave as they are computed. While their client is behind, the computation "
      "holds no place: others have it, and it goes on when there is room again, within its limits.seconds. A "
      "client that takes nothing for {:g} s, or for longer than {:g} s less than {:g} bytes a second, is let go. "
      "Where {} computations wait for their clients, a further one that would ends with what it has: stopped, "
      "reason cancelled.",
      seconds(bounds.stall), seconds(bounds.drip), bounds.rate, Workers::most_aside);
}

Json computed(const Operation& operation, const Cards& cards) {
  const std::string_view path = operation.path;
  const bool simulates = path == "/v1/simulate";
  const std::string request = simulates                      ? "SimulateRequest"
                              : path == "/v1/ensemble"       ? "EnsembleRequest"
                              : path == "/v1/work-precision" ? "WorkPrecisionRequest"
                              : path == "/v1/problems"       ? "DescribeRequest"
                              : path == "/v1/periodic"       ? "PeriodicRequest"
                                                             : "StabilityRequest";
  const Json answer = simulates                ? reference("SimulateAnswer")
                      : path == "/v1/periodic" ? reference("PeriodicAnswer")
                                               : Json{{"type", "object"}};
  Json content{{"application/json", {{"schema", answer}}}};
  if (simulates) {
    for (const Form& form : forms()) {
      if (form.type != "application/json") content[std::string(form.type)] = Json::object();
    }
  }
  if (path == "/v1/ensemble") content["application/cbor"] = Json::object();
  std::string description = "computed, also where a run stopped before its end";
  if (path != "/v1/stability" && path != "/v1/problems") {
    content["application/x-ndjson"] = Json::object();
    description += ". " + rule_for_readers();
  }
  return {
      {"requestBody",
       {{"required", true},
        {"content", {{"application/json", {{"schema", reference(request)}, {"examples", examples_of(path, cards)}}}}}}},
      {"responses", responses(operation, {{"description", description}, {"content", std::move(content)}})}};
}

Json told(const Operation& operation, const Cards& cards) {
  const bool metrics = operation.path == "/metrics";
  Json type =
      metrics ? Json{{"text/plain", Json::object()}} : Json{{"application/json", {{"schema", {{"type", "object"}}}}}};
  Json out{{"responses", responses(operation, {{"description", operation.title}, {"content", std::move(type)}})}};
  if (operation.path.find("{id}") == operation.path.npos) return out;
  Json ids = Json::array();
  if (operation.path.find("/problems/") != operation.path.npos) {
    for (const auto& problem : cards.problems) ids.push_back(problem->card().id);
  } else {
    for (const SchemeCard& card : cards.schemes) ids.push_back(card.id);
    ids.push_back(auto_card().id);
  }
  out["parameters"] = Json::array(
      {Json{{"name", "id"}, {"in", "path"}, {"required", true}, {"schema", {{"type", "string"}, {"enum", ids}}}}});
  return out;
}

// operation_id returns a name such as `post_v1_work_precision`.
std::string operation_id(const Operation& operation) {
  std::string id = std::string(operation.method) + std::string(operation.path);
  for (char& c : id) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    c = !letter ? '_' : c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return id;
}

}  // namespace

std::string write_openapi(const Cards& cards, const Caps& caps) {
  Json document{{"openapi", "3.1.0"},
                {"info",
                 {{"title", "leastaction"},
                  {"version", version},
                  {"description", "Structure-preserving integration of mechanical systems."},
                  {"license", {{"name", "MIT"}, {"identifier", "MIT"}}}}},
                {"paths", Json::object()},
                {"components", {{"schemas", schemas(cards, caps)}, {"responses", refusals()}}}};
  document["components"]["schemas"].update(periodic_schemas());
  for (const Operation& operation : operations()) {
    const bool posts = operation.method == "POST";
    Json one{{"operationId", operation_id(operation)}, {"summary", operation.title}};
    one.update(posts ? computed(operation, cards) : told(operation, cards));
    document["paths"][std::string(operation.path)][posts ? "post" : "get"] = std::move(one);
  }
  return document.dump() + '\n';
}

}  // namespace least::server
