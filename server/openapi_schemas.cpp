#include "server/openapi_schemas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>

#include "core/ensemble/members.hpp"
#include "core/text/expansion.hpp"
#include "core/text/sized_scene.hpp"
#include "core/text/start_velocities.hpp"
#include "core/text/velocities.hpp"
#include "core/text/written_out.hpp"
#include "server/decode/custom_reader.hpp"
#include "server/openapi_cards.hpp"
#include "server/openapi_parts.hpp"
#include "server/openapi_sensitivities.hpp"

namespace least::server {
namespace {

// choice_of allows a bare id or one of the entries.
Json choice_of(const Json& ids, const std::string& prefix) {
  Json all = Json::array({Json{{"type", "string"}, {"enum", ids}}});
  for (const Json& id : ids) all.push_back(reference(prefix + id.get<std::string>()));
  return {{"anyOf", std::move(all)}};
}

// names_of_all returns every name that some problem has.
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

// An expression under a name of the request's own.
Json own_properties() {
  const Json text{{"type", "string"}};
  return {{"name", described(text, "a letter, then letters, digits, _; at most 32", "")},
          {"expression", described(text,
                                   "of the variables, t, the parameters, energy, pi, + - * / ^ ( ), sin cos tan asin "
                                   "acos atan sinh cosh tanh exp log sqrt abs",
                                   "")}};
}
Json columns_of_a_text() {
  return either(described({{"type", "string"}}, "t, a variable, energy, …", ""),
                object_of(own_properties(), {"name", "expression"}));
}
Json columns_of_a_run(const Cards& cards) {
  Json columns = names_of_all(cards, &ProblemCard::columns);
  columns["minItems"] = 1;
  Json& names = columns["items"]["enum"];
  std::set<std::string> lists;
  for (const Json& name : names)
    if (const auto element = text::element_of(name.get_ref<const std::string&>())) lists.emplace(element->first);
  for (const std::string& list : lists) names.push_back(list + "[*]");
  columns["items"] = either(columns["items"], object_of(own_properties(), {"name", "expression"}));
  return columns;
}
Json events_asked() {
  Json properties = own_properties();
  properties["direction"] = {{"type", "string"}, {"enum", event_directions}, {"default", event_directions.back()}};
  properties["stop"] = described({{"type", "boolean"}, {"default", false}}, "ends the run there", "");
  properties["set"] = described(
      {{"type", "object"}, {"additionalProperties", {{"type", {"number", "string"}}}}},
      "what variables become there: all formulas are read before any is written, and the run begins anew", "");
  properties["most"] = described(count_in(1, greatest_count), "after so many acts the run ends", "");
  Json events = list_of(object_of(std::move(properties), {"name", "expression"}));
  events["maxItems"] = most_events;
  return described(std::move(events),
                   "zeros of expressions along the run, at which their sign changes, however many within a step: one "
                   "that an expression touches and turns back from, as x^2 does, is none; where they turn faster than "
                   "closer looks can follow, the answer warns: events_unresolved. Of those that vanish in the instant "
                   "in which one acts each acts on what the one before has left",
                   "");
}

Json section_asked() {
  const Json number = quantity();
  const Json directions{{"type", "string"}, {"enum", event_directions}, {"default", event_directions.back()}};
  return {{"oneOf",
           {described(object_of({{"period", number}, {"phase", number}}, {"period"}),
                      "at the times phase + k · period after the start", ""),
            described(object_of({{"expression", {{"type", "string"}}}, {"direction", directions}}, {"expression"}),
                      "where the expression vanishes; the direction is along the run", "")}}};
}

Json fault_schemas() {
  const Json text{{"type", "string"}}, count{{"type", "integer"}};
  Json fault = object_of({{"pointer", described(text, "JSON pointer to the place", "")},
                          {"detail", described(text, "what is wrong", "")},
                          {"value", described(Json::object(), "what stands there", "")},
                          {"allowed", described(text, "what may stand there", "")},
                          {"position", described(count, "of what is wrong within a text: the character, from 0", "")}},
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
      {"section",
       described(object,
                 "what was asked for, and of each point its crossing, from 0, t and the columns; where limits.samples "
                 "has no room for all, the first: section_truncated",
                 "")},
      {"final", described(object, "t and the variables at the end", "")},
      {"diagnostics",
       described(
           object,
           "by name, what was asked for: of lyapunov exponent, megno, verdict (in words, what the two of them "
           "mean), derivative (of the scheme or of the motion) and, where both numbers are null, the reason; of "
           "energy beside forces their work, ∫F·q̇ dt, which errors and drift do not count; the drift weighs by time. "
           "Errors of momenta, and of an energy that the motion keeps, are the largest at the ends of steps; that "
           "of error, and what the motion changes of the energy where steps set their own length, is looked for "
           "within steps, too",
           "")},
      {"cost", object},
      {"choice",
       described(
           object,
           "of scheme auto: reason, met (null where it cannot be told), estimated_error (null where errors at the end "
           "mean nothing, as in long chaos, or could not be measured), alternatives; where seconds were wished for, "
           "these have theirs, which differ from one answer to the same request to the next. Where an event acts runs "
           "are "
           "looked at up to there, and the answer warns: judged_before_acts",
           "")},
      {"events", described(list, "what was found along the run: t, kind, and what goes with it", "")},
      {"events_asked", described(list, "the member events of the request", "")},
      {"acts",
       described(list, "of events that set variables: name, count, what they keep (symplectic, contact, none), defect",
                 "")},
      {"end", described(object, "the event that ended the run, and how often it acted", "")},
      {"sensitivities", sensitivities_found()},
      {"warnings", list_of({{"type", "object"}, {"required", {"code", "detail"}}})}};
  schema["required"] = {"version", "status",     "problem",     "initial", "scheme", "until",  "record",
                        "columns", "trajectory", "diagnostics", "final",   "cost",   "events", "warnings"};
  return schema;
}

Json ensemble_schema(const Cards& cards, Json properties) {
  constexpr std::int64_t most = std::int64_t{1} << 53;
  const Json number = quantity();
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
  properties.update(
      {{"scheme", reference("Scheme.stated")},
       {"limits", reference("Limits")},
       {"columns", columns_of_a_run(cards)},
       {"members", object_of({{"count", count_in(1, most)},
                              {"seed", count_in(0, most)},
                              {"vary", described(vary, "by JSON pointer, as /initial/q or /problem/mu", "")},
                              {"holds",
                               {{"enum", text::held_names},
                                {"description",
                                 "what members have in common of their starts where momenta depend on what varies; by "
                                 "default what the start says"}}}})},
       {"range", described(list_of(count_in(0, most)), "of members: from, to", "")},
       {"section", section_asked()},
       {"record", described(reference("Record"), "of trajectories, where they are kept; no curve", "")},
       {"keep", list_of({{"type", "string"}, {"enum", {"statistics", "final", "section", "trajectories"}}})},
       {"histograms", {{"type", "object"}, {"additionalProperties", histogram}}}});
  return object_of(std::move(properties), {"problem", "scheme", "members"});
}

Json request_schemas(const Cards& cards, const Caps& caps) {
  constexpr std::int64_t most = std::int64_t{1} << 53;
  Json times = list_of(quantity());
  times["minItems"] = 1;
  Json starts = Json::array();
  for (const auto& problem : cards.problems) starts.push_back(reference("Initial." + problem->card().id));
  starts.push_back(reference("Initial.custom"));
  const Json common{
      {"problem", reference("Problem")},
      {"initial", described({{"anyOf", starts}}, "the problem's own variables; others keep their default", "")},
      {"until", reference("Until")}};
  const Json norm = described({{"type", "string"}, {"enum", norm_names}, {"default", norm_names[0]}},
                              "what errors are divided by: absolute, max(1, the largest component of the true state); "
                              "relative, each component by its own largest size along the true motion, those of one "
                              "kind (x, y, z; x1, x2; x[1]) by the largest of theirs",
                              "");
  Json some = list_of(reference("Scheme.stated"));
  some["minItems"] = 1;
  some["maxItems"] = 100;
  const Json schemes = either({{"const", "all"}}, some);
  const Json budget = described(number_in({0, caps.seconds, true}), "for all of it", "s");
  Json simulate = common;
  simulate.update({{"scheme", reference("Scheme")},
                   {"record", reference("Record")},
                   {"columns", columns_of_a_run(cards)},
                   {"section", section_asked()},
                   {"events", events_asked()},
                   {"diagnostics", names_of_all(cards, &ProblemCard::diagnostics)},
                   {"limits", reference("Limits")},
                   {"norm", norm},
                   {"sensitivities", sensitivities_asked()}});
  // The columns of catalogue problems are known; those of a scene given as text depend on it.
  const auto run_of = [&](const char* problem) {
    Json properties = simulate;
    properties["problem"] = reference(problem);
    if (problem == std::string_view("Problem.custom")) properties["columns"]["items"] = columns_of_a_text();
    return object_of(std::move(properties), {"problem", "scheme"});
  };
  Json precision = common;
  precision.update({{"schemes", schemes},
                    {"error", {{"type", "string"}, {"enum", {"final", "max"}}, {"default", "final"}}},
                    {"norm", norm},
                    {"budget_seconds", budget}});
  Json described_scene = common;  // the start is optional, and checked where it is given
  described_scene.erase("until");
  Json stability = described_scene;
  stability.update({{"schemes", schemes}, {"budget_seconds", budget}});
  return {
      {"Until",
       {{"oneOf",
         {described(quantity(), "the same as t", "time"),
          object_of({{"t", described(quantity(), "absolute; before the start a run goes backward", "time")}}, {"t"}),
          object_of({{"steps", count_in(1, most)}}, {"steps"})}}}},
      {"Record",
       {{"oneOf",
         {object_of({{"every", described(count_in(0, most), "each so many steps; 0: no trajectory", "")}}, {"every"}),
          object_of({{"samples", described(count_in(2, caps.samples), "uniform, both ends", "")}}, {"samples"}),
          object_of({{"times", described(times, "each after the one before it, within the run", "")}}, {"times"}),
          object_of(
              {{"curve", described(count_in(2, caps.samples),
                                   "both ends, at equal arc in the space of the columns other than t: distances of "
                                   "neighbours differ by a tenth at most",
                                   "")}},
              {"curve"})}}}},
      {"Limits", object_of({{"seconds", number_in({0, caps.seconds, true})},
                            {"steps", count_in(1, caps.steps)},
                            {"samples", described(count_in(2, caps.samples), "numbers kept: rows × columns", "")}})},
      {"SimulateRequest", either(run_of("Problem.catalogue"), run_of("Problem.custom"))},
      {"WorkPrecisionRequest", object_of(std::move(precision), {"problem", "schemes"})},
      {"DescribeRequest", object_of(std::move(described_scene), {"problem"})},
      {"StabilityRequest", object_of(std::move(stability), {"problem", "schemes"})},
      {"EnsembleRequest", ensemble_schema(cards, common)}};
}

}  // namespace

Json reference(const std::string& name) { return {{"$ref", "#/components/schemas/" + name}}; }

// A scene given as text; parameters may be overridden beside the id.
Json typed_problem() {
  const Json text{{"type", "string"}}, number{{"type", "number"}}, formula = either(text, number);
  const auto by_name = [](Json value) { return Json{{"type", "object"}, {"additionalProperties", std::move(value)}}; };
  Json place = list_of(formula);
  place["minItems"] = 2;
  place["maxItems"] = 3;
  const Json link = either({{"type", "integer"}, {"minimum", 0}}, {{"const", "pivot"}});
  const Json body =
      object_of({{"at", described(place, "its place: columns or expressions", "")},
                 {"linked", described(list_of(link), "by rods: other bodies by number, or the pivot", "")},
                 {"kind", {{"type", "string"}, {"enum", text::Pictures::kinds}, {"default", "bob"}}}},
                {"at"});
  Json names = list_of(text);
  names["minItems"] = 1;
  names["maxItems"] = text::most_variables;
  Json schema = object_of(
      {{"id", {{"const", custom_id}}},
       {"title", text},
       {"variables", described(names, "coordinates, or what equations are of; `x[5]` declares x[1] … x[5]", "")},
       {"parameters", described(by_name(either(quantity(), list_of(quantity()))), "with their values", "")},
       {"definitions",
        described(by_name(formula), "`r` or `d(i,j)`: what later texts may use, and columns and events", "")},
       {"lagrangian", described(text, "L(q, v, t, s)", "")},
       {"hamiltonian", described(text, "H(q, p, t, s)", "")},
       {"potential", described(text, "V(q, t)", "")},
       {"masses", described(by_name(formula), "of a potential's coordinates; 1 otherwise", "")},
       {"damping", described(formula, "α(t) of a term α s beside a potential", "")},
       {"action_curvature", described(formula, "γ of a term γs²/2 − R beside a potential", "")},
       {"offset", described(formula, "R", "")},
       {"equations", described(by_name(formula), "the rate of every variable", "")},
       {"invariants", described(by_name(text), "what the motion keeps, reported by `momenta`", "")},
       {"forces",
        described(by_name(formula), "generalised, on coordinates; of q, t and velocities, or momenta beside H", "")},
       {"dissipation", described(formula, "Rayleigh's D(q, v, t): adds the forces −∂D/∂v", "")},
       {"note", described(text, "what is to be said of the scene", "")},
       {"views", described(list_of(place), "pictures: columns or expressions drawn together, with equal axes", "")},
       {"bodies", described(list_of(body), "what moves, in one picture", "")}},
      {"id", "variables"});
  schema["additionalProperties"] = either(quantity(), list_of(quantity()));
  schema["oneOf"] = Json::array();
  for (const char* kind : {"lagrangian", "hamiltonian", "potential", "equations"})
    schema["oneOf"].push_back({{"required", Json::array({kind})}});
  schema["title"] = "A scene as text";
  schema["description"] = fmt::format(
      "Texts are made of numbers, pi, t, names, + - * / ^ (or **), functions ({}; of many of a kind sum prod mod) and "
      "conditions in if(a < b and not c >= d, …, …). A name is a letter, then letters, digits, _: at most {} before "
      "an index. At most {} coordinates, of which a Lagrangian couples the velocities of {} where it is not quadratic "
      "in "
      "them, {} variables of equations; {} characters as typed, {} operations, {} in the terms of long sums, {} with "
      "all others written out, {} so in columns or in events, {} in the equations of motion. Numbers of `initial`, "
      "`until`, "
      "parameters and settings may be texts "
      "of constants, as \"2*pi/3\".",
      fmt::join(text::function_names(), " "), text::longest_name, text::most_coordinates,
      text::Velocities::most_coupled, text::most_variables, text::most_characters, text::most_operations,
      text::most_kept, text::most_summed, text::most_operations_beside, text::SizedScene::most_equations);
  return schema;
}

Json schemas(const Cards& cards, const Caps& caps) {
  Json all = request_schemas(cards, caps);
  Json problems = Json::array(), scheme_ids = Json::array();
  for (const auto& problem : cards.problems) {
    const ProblemCard& card = problem->card();
    problems.push_back(card.id);
    all["Problem." + card.id] = entry_of(card);
    all["Initial." + card.id] = start_of(*problem);
  }
  for (const SchemeCard& card : cards.schemes) {
    scheme_ids.push_back(card.id);
    all["Scheme." + card.id] = entry_of(card);
  }
  Json automatic = entry_of(auto_card());
  automatic["properties"]["keep"] = {{"type", "array"},
                                     {"items", {{"type", "string"}, {"enum", keep_names}}},
                                     {"description", "what the scheme must keep"},
                                     {"default", Json::array()}};
  all["Scheme.stated"] = choice_of(scheme_ids, "Scheme.");
  scheme_ids.push_back(auto_card().id);
  all["Scheme." + auto_card().id] = std::move(automatic);
  all["Problem.catalogue"] = choice_of(problems, "Problem.");
  all["Problem"] = either(reference("Problem.catalogue"), reference("Problem.custom"));
  all["Problem.custom"] = typed_problem();
  all["Initial.custom"] = {{"type", "object"}, {"additionalProperties", either(quantity(), list_of(quantity()))}};
  all["Scheme"] = choice_of(scheme_ids, "Scheme.");
  all["SimulateAnswer"] = answer_schema();
  all.update(fault_schemas());
  return all;
}

}  // namespace least::server
