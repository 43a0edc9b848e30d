#include "server/encode/periodic_json.hpp"

#include <algorithm>

#include "core/catalogue/catalogue.hpp"
#include "server/encode/answer_parts.hpp"

namespace least::server {
namespace {

using periodic::Member;
using periodic::Orbit;
using periodic::Question;
using periodic::Stability;

void write_initial(JsonWriter& json, const Scene& scene) {
  const auto& variables = scene.card().variables;
  json.open('{').key("t").number(scene.start);
  for (std::size_t i = 0; i < variables.size(); ++i)
    if (!variables[i].hidden) json.key(variables[i].name).number(scene.initial[i]);
  json.close('}');
}

// Writes the question; family and manifolds are part of the results.
void write_question(JsonWriter& json, const Question& question) {
  const auto& variables = question.scene->card().variables;
  json.key("fixed").open('[');
  for (const std::size_t place : question.fixed) json.text(variables[place].name);
  json.close(']').key("symmetric").boolean(question.symmetric);
  const auto& cards = schemes();
  write_scheme(json.key("scheme"), *std::ranges::find(cards, "taylor", &SchemeCard::id), question.settings);
  json.key("limits").open('{').key("seconds").number(question.limits.seconds);
  json.key("steps").integer(question.limits.steps).key("samples").integer(question.limits.samples).close('}');
}

void write_guess(JsonWriter& json, const Question& question) {
  write_initial(json.open('{').key("initial"), *question.scene);
  json.key("period").number(question.period).close('}');
}

void write_multipliers(JsonWriter& json, const Stability& of) {
  json.key("multipliers").open('[');
  for (const auto& [value, kind, error] : of.multipliers) {
    json.open('{').key("re").number(value.real()).key("im").number(value.imag()).key("modulus");
    json.number(std::abs(value)).key("kind");
    kind ? json.text(periodic::multiplier_kinds[static_cast<std::size_t>(*kind)]) : json.null();
    json.close('}');
  }
  json.close(']').key("stable");
  of.stable ? json.boolean(*of.stable) : json.null();
}

void write_stability(JsonWriter& json, const Stability& of) {
  write_multipliers(json, of);
  json.key("trivial").integer(static_cast<std::int64_t>(of.trivial()));
  json.key("trivial_by").open('{').key("time").integer(static_cast<std::int64_t>(of.by_time));
  json.key("invariants").integer(static_cast<std::int64_t>(of.by_invariants));
  json.key("symmetries").integer(static_cast<std::int64_t>(of.by_symmetries)).close('}');
  json.key("pair_product").number(of.pair_product).key("pairing_defect").number(of.pairing_defect);
}

void write_orbit(JsonWriter& json, const Orbit& orbit) {
  json.key("period").number(orbit.period).key("closure").number(orbit.closure);
  json.key("segments").integer(static_cast<std::int64_t>(orbit.segments));
  json.key("invariant").open('{').key("energy").number(orbit.energy);
  for (const auto& [name, value] : orbit.invariants) json.key(name).number(value);
  json.close('}').key("rows");
  write_texts(json, orbit.rows);
  json.key("monodromy").open('[');
  for (std::size_t i = 0; i < orbit.monodromy.rows; ++i) {
    json.open('[');
    for (std::size_t j = 0; j < orbit.monodromy.columns; ++j) json.number(orbit.monodromy(i, j));
    json.close(']');
  }
  json.close(']');
  write_stability(json, orbit.stability);
}

void write_member(JsonWriter& json, const Member& member) {
  json.key("value").number(member.value);
  write_initial(json.key("initial"), *member.orbit.scene);
  json.key("period").number(member.orbit.period).key("period_slope").number(member.period_slope);
  json.key("energy").number(member.orbit.energy).key("closure").number(member.orbit.closure);
  write_multipliers(json, member.orbit.stability);
  json.key("bifurcation");
  const auto kind = static_cast<std::size_t>(member.bifurcation);
  kind == 0 ? json.null() : json.text(periodic::bifurcation_names[kind]);
}

// Writes all results except the members of the family and the curves of manifolds.
void write_found(JsonWriter& json, const Question& question, const periodic::Answer& found) {
  json.key("version").text(version).key("status").text(found.closed ? "closed" : "not_closed");
  if (!found.closed) json.key("reason").text(found.reason);
  if (found.end != ReturnCode::completed) json.key("stop").open('{').key("reason").text(name(found.end)).close('}');
  write_scene(json, *found.orbit.scene);
  write_guess(json.key("guess"), question);
  write_question(json, question);
  json.key("iterations").integer(found.iterations);
  write_orbit(json, found.orbit);
  json.key("cost").open('{').key("steps").integer(found.steps).key("seconds").number(found.seconds).close('}');
  if (question.family && found.closed) json.key("family_end").text(found.family_end);
}

void write_curve(JsonWriter& json, const Orbit& orbit, const periodic::Manifold::Curve& curve) {
  json.open('{').key("side").integer(curve.side).key("t").open('[');
  for (const double t : curve.t) json.number(t);
  json.close(']');
  for (std::size_t a = 0; a < orbit.rows.size(); ++a) {
    json.key(orbit.rows[a]).open('[');
    for (const auto& state : curve.states) json.number(state[a]);
    json.close(']');
  }
  json.close('}');
}

// A manifold has a piece for each curve, and one before them that opens it; the last one closes it.
std::size_t pieces_of(const periodic::Manifold& manifold) { return manifold.curves.size() + 1; }
void write_piece(const Orbit& orbit, const periodic::Manifold& manifold, std::size_t piece, bool first,
                 std::string& out) {
  JsonWriter json(out, Notation::json, piece == 0 ? first : piece == 1);
  if (piece == 0) {
    json.key(manifold.stable ? "stable" : "unstable").open('{').key("multiplier").number(manifold.multiplier);
    if (!manifold.reason.empty()) json.key("reason").text(manifold.reason);
    json.key("trajectories").open('[');
  } else {
    write_curve(json, orbit, manifold.curves[piece - 1]);
  }
  if (piece + 1 == pieces_of(manifold)) json.close(']').close('}');
}

void write_manifolds(const periodic::Answer& found, std::string& out) {
  bool first = true;
  for (const auto& manifold : found.manifolds)
    for (std::size_t piece = 0; piece < pieces_of(manifold); ++piece, first = false)
      write_piece(found.orbit, manifold, piece, first, out);
}

}  // namespace

bool encode_orbit(const Question& question, const periodic::Answer& found, std::size_t piece, std::string& out) {
  JsonWriter json(out);
  const bool curves = !found.manifolds.empty();
  if (piece == 0) {
    json.open('{');
    write_found(json, question, found);
    if (question.family && found.closed) {
      json.key("family").open('[');
      for (const Member& member : found.family) {
        json.open('{');
        write_member(json, member);
        json.close('}');
      }
      json.close(']');
    }
    if (curves) json.key("manifolds").open('{');
    if (!curves) out += "}\n";
    return curves;
  }
  std::size_t which = piece - 1, manifold = 0;
  while (which >= pieces_of(found.manifolds[manifold])) which -= pieces_of(found.manifolds[manifold++]);
  write_piece(found.orbit, found.manifolds[manifold], which, piece == 1, out);
  const bool last = manifold + 1 == found.manifolds.size() && which + 1 == pieces_of(found.manifolds[manifold]);
  if (last) out += "}}\n";
  return !last;
}

std::string orbit_head_line(const Question& question) {
  return object_line("head", [&](JsonWriter& json) {
    json.key("version").text(version);
    write_scene(json, *question.scene);
    json.key("period").number(question.period);
    write_question(json, question);
  });
}

std::string orbit_member_line(const Member& member) {
  return object_line("member", [&](JsonWriter& json) { write_member(json, member); });
}

std::string orbit_end_line(const Question& question, const periodic::Answer& found) {
  return object_line("end", [&](JsonWriter& json) {
    write_found(json, question, found);
    if (found.manifolds.empty()) return;
    json.key("manifolds").open('{');
    write_manifolds(found, json.buffer());
    json.close('}');
  });
}

}  // namespace least::server
