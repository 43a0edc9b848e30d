#include "server/openapi_periodic.hpp"

#include "core/periodic/closed_orbit.hpp"
#include "server/openapi_parts.hpp"
#include "server/openapi_schemas.hpp"

namespace least::server {
namespace {

const Json a_number{{"type", "number"}}, a_text{{"type", "string"}}, a_count{{"type", "integer"}},
    a_flag{{"type", "boolean"}}, an_object{{"type", "object"}};

Json maybe(const char* type) { return {{"type", {type, "null"}}}; }

Json asked() {
  const Json ways = described(a_text, "/problem/mu or /initial/x, or period, or energy", "");
  const Json family =
      object_of({{"by", ways}, {"to", quantity()}, {"count", count_in(2, periodic::most_members)}}, {"by", "to"});
  const Json manifolds = object_of(
      {{"count", described(count_in(1, periodic::most_of_a_manifold), "places along the orbit; two sides of each", "")},
       {"until", described(quantity(), "how long their trajectories are; by default a period", "time")}});
  return object_of(
      {{"problem", reference("Problem")},
       {"initial", described(an_object, "the guess", "")},
       {"period",
        described(quantity(), "about; of a driven scene that of the drive, or a multiple, which stays", "time")},
       {"fixed", described(list_of(a_text), "variables that keep the value of the guess", "")},
       {"symmetric",
        described(a_flag,
                  "half an orbit between two crossings at right angles: the variables that are 0 in the guess and "
                  "change their sign where time is reversed are 0 again after half the period",
                  "")},
       {"scheme", described(reference("Scheme.taylor"), "its tolerance; taylor alone", "")},
       {"family", described(family, "a curve of closed orbits along which a number moves", "")},
       {"manifolds", described(manifolds, "trajectories that leave the orbit, or come to it", "")},
       {"limits", reference("Limits")}},
      {"problem", "period"});
}

Json multipliers() {
  Json kinds = periodic::multiplier_kinds;
  kinds.push_back(nullptr);
  return list_of(object_of({{"re", a_number},
                            {"im", a_number},
                            {"modulus", a_number},
                            {"kind", described({{"enum", std::move(kinds)}},
                                               "null: so small that rounding of the others hides what it is", "")}}));
}

Json answered() {
  Json names = Json::array({nullptr});
  for (const auto& name : periodic::bifurcation_names)
    if (!name.empty()) names.push_back(name);
  const Json member{{"type", "object"},
                    {"properties",
                     {{"value", a_number},
                      {"initial", an_object},
                      {"period", a_number},
                      {"period_slope", described(maybe("number"), "dT/dvalue along the family", "")},
                      {"energy", described(maybe("number"), "null where it is not conserved", "")},
                      {"closure", a_number},
                      {"multipliers", multipliers()},
                      {"stable", maybe("boolean")},
                      {"bifurcation", {{"enum", names}}}}}};
  const Json properties{
      {"version", a_text},
      {"status", {{"enum", {"closed", "not_closed"}}}},
      {"reason", described(a_text, "why it is not closed", "")},
      {"stop", described(an_object, "the limit that ended the search: reason", "")},
      {"initial", described(an_object, "a start on the orbit, or on the nearest to one", "")},
      {"guess", described(an_object, "initial and period as they were asked for", "")},
      {"period", a_number},
      {"closure", described(maybe("number"), "how far it does not close, as a part of its extent", "")},
      {"segments", described(a_count, "between nodes of multiple shooting", "")},
      {"iterations", a_count},
      {"invariant",
       described(an_object, "energy, null where it is not conserved, and what a scene as text declares", "")},
      {"rows", described(list_of(a_text), "the variables that rows and columns of the monodromy are of", "")},
      {"monodromy", list_of(list_of(maybe("number")))},
      {"multipliers", described(multipliers(), "of contact scenes those of (q, p); first the trivial ones", "")},
      {"trivial", described(a_count, "unit multipliers that are explained, and left out of stable", "")},
      {"trivial_by", described(an_object, "time, invariants, symmetries: how many are explained by each", "")},
      {"stable", described(maybe("boolean"), "null: the multipliers do not tell", "")},
      {"pair_product", described(maybe("number"), "of two multipliers: 1, of contact scenes e^{−∫∂H/∂s dt}", "")},
      {"pairing_defect", described(maybe("number"), "the largest departure from it, as a part of it", "")},
      {"family", list_of(member)},
      {"family_end", described(a_text, "why the family ends; empty: it has come to `to`", "")},
      {"manifolds",
       described(an_object, "unstable and stable, each with multiplier and trajectories: side, t, variables", "")},
      {"cost", an_object}};
  return {{"type", "object"},
          {"properties", properties},
          {"required", {"version", "status", "problem", "initial", "period", "closure", "iterations", "multipliers"}}};
}

}  // namespace

Json periodic_schemas() { return {{"PeriodicRequest", asked()}, {"PeriodicAnswer", answered()}}; }

}  // namespace least::server
