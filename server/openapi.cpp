#include "server/openapi.hpp"

#include <algorithm>
#include <cmath>

#include "core/catalogue/catalogue.hpp"
#include "core/ensemble/members.hpp"
#include "server/decode/json_parse.hpp"
#include "server/encode/run_answer.hpp"
#include "server/shared/operations.hpp"

namespace least::server {
namespace {

Json reference(const std::string& name) { return {{"$ref", "#/components/schemas/" + name}}; }

Json object_of(Json properties, Json required = Json::array()) {
  Json schema{{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
  if (!required.empty()) schema["required"] = std::move(required);
  return schema;
}
Json list_of(Json items) { return {{"type", "array"}, {"items", std::move(items)}}; }

void add_range(Json& schema, const Range& range) {
  if (std::isfinite(range.low)) schema[range.low_open ? "exclusiveMinimum" : "minimum"] = range.low;
  if (std::isfinite(range.high)) schema[range.high_open ? "exclusiveMaximum" : "maximum"] = range.high;
}
Json number_in(const Range& range) {
  Json schema{{"type", "number"}};
  add_range(schema, range);
  return schema;
}
Json count_in(std::int64_t low, std::int64_t high) {
  return {{"type", "integer"}, {"minimum", low}, {"maximum", high}};
}

// What may stand for a value, and beside it what it means.
Json described(Json schema, const std::string& doc, const std::string& unit) {
  if (!doc.empty()) schema["description"] = doc;
  if (!unit.empty()) schema["x-unit"] = unit;
  return schema;
}

Json either(Json a, Json b) { return {{"anyOf", Json::array({std::move(a), std::move(b)})}}; }

Json values_of(const ParameterCard& card) {
  switch (card.kind) {
    case Kind::number:
      return number_in(card.range);
    case Kind::integer: {
      Json schema{{"type", "integer"}};
      add_range(schema, card.range);
      return schema;
    }
    case Kind::choice: {
      Json names{{"type", "string"}, {"enum", card.choices}};
      if (!card.weights) return names;
      Json own = object_of({{"weights", list_of({{"type", "number"}})}, {"order", {{"type", "integer"}}}}, {"weights"});
      return either(std::move(names), std::move(own));
    }
    case Kind::flag:
      return {{"type", "boolean"}};
  }
  return {};
}

Json parameter(const ParameterCard& card) {
  Json schema = values_of(card);
  if (card.nullable) {
    schema = either(std::move(schema), card.word.empty() ? Json{{"type", "null"}} : Json{{"const", card.word}});
  }
  schema = described(std::move(schema), card.doc, card.unit);
  std::string value;
  JsonWriter json(value);
  write_parameter(json, card, card.value);
  schema["default"] = Json::parse(value);
  // The problem of a request may suggest another one.
  if (!card.suggested.empty()) schema["x-suggested"] = card.suggested;
  return schema;
}

template <class Card>
Json entry(const Card& card) {
  Json properties{{"id", {{"const", card.id}}}};
  if (!card.presets.empty()) {
    Json names = Json::array();
    for (const auto& preset : card.presets) names.push_back(preset.name);
    properties["preset"] = {{"type", "string"}, {"enum", names}, {"description", "fills in a named set of values"}};
  }
  for (const ParameterCard& one : card.parameters) properties[one.name] = parameter(one);
  Json schema = object_of(std::move(properties), {"id"});
  schema["title"] = card.title;
  schema["description"] = card.summary;
  return schema;
}

Json start_of(const ProblemCard& card) {
  Json properties{{"t", described({{"type", "number"}, {"default", 0}}, "the start time", "time")}};
  for (const VariableCard& variable : card.variables) {
    Json schema = number_in(variable.range);
    if (std::isnan(variable.value)) schema["type"] = {"number", "null"};  // null: from the others
    schema = described(std::move(schema), variable.doc, variable.unit);
    if (std::isfinite(variable.value)) schema["default"] = variable.value;
    properties[variable.name] = std::move(schema);
  }
  return object_of(std::move(properties));
}

// A bare id or one of the entries.
Json choice_of(const Json& ids, const std::string& prefix) {
  Json all = Json::array({Json{{"type", "string"}, {"enum", ids}}});
  for (const Json& id : ids) all.push_back(reference(prefix + id.get<std::string>()));
  return {{"anyOf", std::move(all)}};
}

// Every name that some problem knows.
template <class Names>
Json names_of_all(const Cards& cards, Names ProblemCard::*names) {
  Json all = Json::array();
  for (const auto& problem : cards.problems) {
    for (const auto& card : problem->card().*names) {
      if (std::find(all.begin(), all.end(), card.name) == all.end()) all.push_back(card.name);
    }
  }
  return {{"type", "array"}, {"items", {{"type", "string"}, {"enum", all}}}, {"uniqueItems", true}};
}

Json fault_schemas() {
  const Json text{{"type", "string"}}, count{{"type", "integer"}};
  Json fault = object_of({{"pointer", described(text, "JSON pointer to the place", "")},
                          {"detail", described(text, "what is wrong", "")},
                          {"value", described(Json::object(), "what stands there", "")},
                          {"allowed", described(text, "what may stand there", "")}},
                         {"pointer", "detail"});
  Json document = object_of({{"type", text},
                             {"title", text},
                             {"status", count},
                             {"detail", text},
                             {"errors", list_of(reference("Fault"))},
                             {"request_id", text}},
                            {"type", "title", "status", "request_id"});
  return {{"Fault", std::move(fault)}, {"ProblemDocument", std::move(document)}};
}

Json answer_schema() {
  const Json object{{"type", "object"}}, list{{"type", "array"}};
  Json schema{{"type", "object"}};
  schema["properties"] = {
      {"version", {{"type", "string"}}},
      {"status", {{"enum", {"completed", "stopped"}}}},
      {"stop", described(object, "why it ended before its end: reason, detail, t, step, singular_at", "")},
      {"trajectory", described(object, "columns by name, each a list with a value per sample", "")},
      {"final", described(object, "t and the variables at the end", "")},
      {"diagnostics", object},
      {"cost", object},
      {"events", list},
      {"warnings", list_of({{"type", "object"}, {"required", {"code", "detail"}}})}};
  schema["required"] = {"version", "status",     "problem",     "initial", "scheme", "until",  "record",
                        "columns", "trajectory", "diagnostics", "final",   "cost",   "events", "warnings"};
  return schema;
}

Json ensemble_schema(const Cards& cards, Json properties) {
  constexpr std::int64_t most = std::int64_t{1} << 53;
  const Json number{{"type", "number"}};
  const auto numbers = [&](std::size_t count) {
    Json list = list_of(number);
    list["minItems"] = count;
    list["maxItems"] = count;
    return list;
  };
  Json ways = Json::array();
  for (const std::string_view spread : spread_names) {
    const std::string name(spread);
    const Json shape = name == "values" ? list_of(number) : numbers(name == "grid" ? 3 : 2);
    ways.push_back(object_of({{name, shape}}, {name}));
  }
  const Json vary{{"type", "object"}, {"additionalProperties", {{"oneOf", ways}}}};
  const Json histogram = object_of({{"range", numbers(2)}, {"bins", count_in(1, 100'000)}}, {"range", "bins"});
  const Json directions{{"type", "string"}, {"enum", {"up", "down", "both"}}};
  properties.update(
      {{"scheme", reference("Scheme")},
       {"limits", reference("Limits")},
       {"columns", names_of_all(cards, &ProblemCard::columns)},
       {"members", object_of({{"count", count_in(1, most)},
                              {"seed", count_in(0, most)},
                              {"vary", described(vary, "by JSON pointer, as /initial/q or /problem/mu", "")}})},
       {"range", described(list_of(count_in(0, most)), "of members: from, to", "")},
       {"section",
        {{"oneOf",
          {object_of({{"period", number}, {"phase", number}}, {"period"}),
           object_of({{"expression", {{"type", "string"}}}, {"direction", directions}}, {"expression"})}}}},
       {"keep", list_of({{"type", "string"}, {"enum", {"statistics", "final", "section"}}})},
       {"histograms", {{"type", "object"}, {"additionalProperties", histogram}}}});
  return object_of(std::move(properties), {"problem", "scheme", "members"});
}

Json request_schemas(const Cards& cards, const Caps& caps) {
  constexpr std::int64_t most = std::int64_t{1} << 53;
  const Json number{{"type", "number"}};
  Json starts = Json::array();
  for (const auto& problem : cards.problems) starts.push_back(reference("Initial." + problem->card().id));
  const Json common{
      {"problem", reference("Problem")},
      {"initial", described({{"anyOf", starts}}, "the problem's own variables; others keep their default", "")},
      {"until", reference("Until")}};
  const Json norm{{"type", "string"}, {"enum", norm_names}, {"default", norm_names[0]}};
  const Json schemes = either({{"const", "all"}}, [] {
    Json list = list_of(reference("Scheme"));
    list["minItems"] = 1;
    list["maxItems"] = 100;
    return list;
  }());
  const Json budget = described(number_in({0, caps.seconds, true}), "for all of it", "s");
  Json simulate = common;
  simulate.update({{"scheme", reference("Scheme")},
                   {"record", reference("Record")},
                   {"columns", names_of_all(cards, &ProblemCard::columns)},
                   {"diagnostics", names_of_all(cards, &ProblemCard::diagnostics)},
                   {"limits", reference("Limits")},
                   {"norm", norm}});
  Json precision = common;
  precision.update({{"schemes", schemes},
                    {"error", {{"type", "string"}, {"enum", {"final", "max"}}, {"default", "final"}}},
                    {"norm", norm},
                    {"budget_seconds", budget}});
  Json stability = common;
  stability.erase("until");
  stability.update({{"schemes", schemes}, {"budget_seconds", budget}});
  return {
      {"Until",
       {{"oneOf",
         {object_of({{"t", described(number, "absolute, after the start", "time")}}, {"t"}),
          object_of({{"steps", count_in(1, most)}}, {"steps"})}}}},
      {"Record",
       {{"oneOf",
         {object_of({{"every", described(count_in(0, most), "each so many steps; 0: no trajectory", "")}}, {"every"}),
          object_of({{"samples", described(count_in(2, caps.samples), "uniform, both ends", "")}}, {"samples"}),
          object_of({{"times", list_of(number)}}, {"times"}),
          object_of({{"curve",
                      described(count_in(2, caps.samples), "both ends, at equal arc in the space of the columns", "")}},
                    {"curve"})}}}},
      {"Limits", object_of({{"seconds", number_in({0, caps.seconds, true})},
                            {"steps", count_in(1, caps.steps)},
                            {"samples", described(count_in(2, caps.samples), "numbers kept: rows × columns", "")}})},
      {"SimulateRequest", object_of(std::move(simulate), {"problem", "scheme"})},
      {"WorkPrecisionRequest", object_of(std::move(precision), {"problem", "schemes"})},
      {"StabilityRequest", object_of(std::move(stability), {"problem", "schemes"})},
      {"EnsembleRequest", ensemble_schema(cards, common)}};
}

Json schemas(const Cards& cards, const Caps& caps) {
  Json all = request_schemas(cards, caps);
  Json problems = Json::array(), scheme_ids = Json::array();
  for (const auto& problem : cards.problems) {
    const ProblemCard& card = problem->card();
    problems.push_back(card.id);
    all["Problem." + card.id] = entry(card);
    all["Initial." + card.id] = start_of(card);
  }
  for (const SchemeCard& card : cards.schemes) {
    scheme_ids.push_back(card.id);
    all["Scheme." + card.id] = entry(card);
  }
  Json automatic = entry(auto_card());
  automatic["properties"]["keep"] = {{"type", "array"},
                                     {"items", {{"type", "string"}, {"enum", keep_names}}},
                                     {"description", "what the scheme must keep"},
                                     {"default", Json::array()}};
  scheme_ids.push_back(auto_card().id);
  all["Scheme." + auto_card().id] = std::move(automatic);
  all["Problem"] = choice_of(problems, "Problem.");
  all["Scheme"] = choice_of(scheme_ids, "Scheme.");
  all["SimulateAnswer"] = answer_schema();
  all.update(fault_schemas());
  return all;
}

// ── endpoints

// Requests of one endpoint by name.
Json examples_of(std::string_view path, const Cards& cards) {
  Json all = Json::object();
  const auto add = [&](const std::string& name, Json value) { all[name] = {{"value", std::move(value)}}; };
  if (cards.problems.empty()) return all;
  const ProblemCard& first = cards.problems.front()->card();
  const auto scheme = [&](const ProblemCard& card) { return cards.schemes[card.schemes.front()].id; };
  if (path == "/v1/simulate") {
    for (const auto& problem : cards.problems) {
      const ProblemCard& card = problem->card();
      add(card.id, {{"problem", card.id}, {"scheme", scheme(card)}, {"record", {{"samples", 5}}}});
    }
    add("auto",
        {{"problem", first.id}, {"scheme", {{"id", auto_card().id}, {"accuracy", 1e-3}}}, {"record", {{"every", 0}}}});
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

Json refusal(const char* why) {
  return {{"description", why},
          {"content", {{"application/problem+json", {{"schema", reference("ProblemDocument")}}}}}};
}

Json computed(std::string_view path, const Cards& cards) {
  const bool simulates = path == "/v1/simulate";
  const std::string request = simulates                      ? "SimulateRequest"
                              : path == "/v1/ensemble"       ? "EnsembleRequest"
                              : path == "/v1/work-precision" ? "WorkPrecisionRequest"
                                                             : "StabilityRequest";
  const Json answer = simulates ? reference("SimulateAnswer") : Json{{"type", "object"}};
  Json content{{"application/json", {{"schema", answer}}}};
  if (simulates) {
    for (const Form& form : forms()) {
      if (form.type != "application/json") content[std::string(form.type)] = Json::object();
    }
  }
  if (path != "/v1/stability") content["application/x-ndjson"] = Json::object();
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
