#include "server/openapi_sensitivities.hpp"

#include "core/text/start_velocities.hpp"
#include "core/variations/sensitivities.hpp"
#include "server/openapi_parts.hpp"

namespace least::server {
namespace {

Json list(Json items) { return {{"type", "array"}, {"items", std::move(items)}}; }
Json one_of(const Json& names, const char* doc) { return {{"enum", names}, {"description", doc}}; }

Json pointers() {
  Json all = list({{"type", "string"}});
  all["minItems"] = 1;
  all["maxItems"] = variations::most_quantities;
  all["description"] = "JSON pointers to numbers of initial (t too) and parameters: /initial/x, /problem/mu";
  return all;
}

}  // namespace

Json sensitivities_asked() {
  const Json properties{
      {"by", {{"anyOf", {pointers(), Json{{"const", "initial"}}}}}},
      {"order", count_in(1, 2)},
      {"of",
       one_of(variations::map_names,
              "motion: the true one from the start of the run, whichever scheme runs it; scheme: its own map, the "
              "default of schemes of equal steps wherever that has the derivatives that are asked for")},
      {"at", one_of({"final", "samples"}, "at the end alone, or at every sample, too")},
      {"holds", one_of(text::held_names,
                       "what stays where another number of the start changes; by default what the start says")}};
  return {{"type", "object"},
          {"properties", properties},
          {"required", {"by"}},
          {"additionalProperties", false},
          {"description", "derivatives of the states by numbers of the start and parameters"}};
}

Json sensitivities_found() {
  const Json slopes = list(list({{"type", {"number", "null"}}})), texts = list({{"type", "string"}});
  const Json slopes_or_none{{"anyOf", {slopes, Json{{"type", "null"}}}}};
  const Json properties{
      {"by", texts},
      {"rows", texts},
      {"order", {{"type", "integer"}}},
      {"of", {{"type", "string"}}},
      {"at", {{"type", "string"}}},
      {"holds", {{"type", "string"}}},
      {"final", slopes_or_none},
      {"second",
       {{"type", "object"},
        {"description", "of order 2: pairs of places in by, and final, of each row the second derivatives"}}},
      {"samples",
       {{"type", "array"}, {"items", slopes_or_none}, {"description", "of the first samples, as far as they go"}}},
      {"events", list({{"type", "object"}, {"required", {"name", "t"}}})},
      {"structure",
       {{"type", {"object", "null"}}, {"description", "of the whole map: kind, max_defect, factor; null without one"}}},
      {"uncertainty",
       {{"type", {"number", "null"}},
        {"description",
         "an estimate of the largest error of an entry, divided by the largest entry: first derivatives of a motion "
         "are "
         "held against a control of higher order along one random direction, second ones against a control of every "
         "pair "
         "with half the tolerance, those of a scheme against differences of runs"}}},
      {"reason", {{"type", "string"}, {"description", "why there are none, or some are missing"}}}};
  return {{"type", "object"}, {"properties", properties}};
}

}  // namespace least::server
