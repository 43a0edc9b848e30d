#include "server/openapi.hpp"

#include "core/catalogue/catalogue.hpp"
#include "server/encode/run_answer.hpp"
#include "server/openapi_schemas.hpp"
#include "server/shared/operations.hpp"

namespace least::server {
namespace {

// Requests of one endpoint by name.
Json examples_of(std::string_view path, const Cards& cards) {
  Json all = Json::object();
  const auto add = [&](const std::string& name, Json value) { all[name] = {{"value", std::move(value)}}; };
  if (cards.problems.empty()) return all;
  const ProblemCard& first = cards.problems.front()->card();
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

Json refusal(const char* why) {
  return {{"description", why},
          {"content", {{"application/problem+json", {{"schema", reference("ProblemDocument")}}}}}};
}

Json computed(std::string_view path, const Cards& cards) {
  const bool simulates = path == "/v1/simulate";
  const std::string request = simulates                      ? "SimulateRequest"
                              : path == "/v1/ensemble"       ? "EnsembleRequest"
                              : path == "/v1/work-precision" ? "WorkPrecisionRequest"
                              : path == "/v1/problems"       ? "DescribeRequest"
                                                             : "StabilityRequest";
  const Json answer = simulates ? reference("SimulateAnswer") : Json{{"type", "object"}};
  Json content{{"application/json", {{"schema", answer}}}};
  if (simulates) {
    for (const Form& form : forms()) {
      if (form.type != "application/json") content[std::string(form.type)] = Json::object();
    }
  }
  if (path == "/v1/ensemble") content["application/cbor"] = Json::object();
  if (path != "/v1/stability" && path != "/v1/problems") content["application/x-ndjson"] = Json::object();
  return {
      {"requestBody",
       {{"required", true},
        {"content", {{"application/json", {{"schema", reference(request)}, {"examples", examples_of(path, cards)}}}}}}},
      {"responses",
       {{"200", {{"description", "computed, also where a run stopped before its end"}, {"content", content}}},
        {"400", refusal("no JSON, or no well-formed request")},
        {"406", refusal("no such form")},
        {"411", refusal("neither a length nor chunks")},
        {"413", refusal("too large")},
        {"415", refusal("a Content-Encoding that is not taken")},
        {"422", refusal("every fault of the request, each with its place and what is allowed")},
        {"503", refusal("busy; Retry-After says when to ask again")}}}};
}

Json told(const Operation& operation, const Cards& cards) {
  const bool metrics = operation.path == "/metrics";
  Json type =
      metrics ? Json{{"text/plain", Json::object()}} : Json{{"application/json", {{"schema", {{"type", "object"}}}}}};
  Json out{{"responses", {{"200", {{"description", operation.title}, {"content", std::move(type)}}}}}};
  if (operation.path == "/readyz") out["responses"]["503"] = refusal("not ready");
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
  out["responses"]["404"] = refusal("no such id");
  return out;
}

// `post_v1_work_precision`
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
                {"components", {{"schemas", schemas(cards, caps)}}}};
  for (const Operation& operation : operations()) {
    const bool posts = operation.method == "POST";
    Json one{{"operationId", operation_id(operation)}, {"summary", operation.title}};
    one.update(posts ? computed(operation.path, cards) : told(operation, cards));
    document["paths"][std::string(operation.path)][posts ? "post" : "get"] = std::move(one);
  }
  return document.dump() + '\n';
}

}  // namespace least::server
