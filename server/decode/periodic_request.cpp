#include "server/decode/periodic_request.hpp"

#include <algorithm>

#include "server/decode/plan_reader.hpp"
#include "server/decode/scene_files.hpp"
#include "server/decode/scene_reader.hpp"
#include "server/decode/sensitivities_reader.hpp"

namespace least::server {
namespace {

using periodic::FamilyAsked;
using periodic::Question;

constexpr std::string_view shape_of_family =
    "{\"by\": \"/problem/mu\", \"/initial/x\", \"period\" or \"energy\", \"to\": 0.3, \"count\": 50}";

// Way is what a family may vary, as a request names it, with the range of its values.
struct Way {
  std::string name;
  FamilyAsked::By by;
  std::size_t index = 0;
  Range range = anywhere;
};

std::vector<Way> ways_of(const ProblemCard& card) {
  std::vector<Way> all{{"period", FamilyAsked::By::period, 0, positive}, {"energy", FamilyAsked::By::energy}};
  all.reserve(2 + card.variables.size() + card.parameters.size());
  for (std::size_t i = 0; i < card.variables.size(); ++i)
    if (!card.variables[i].hidden)
      all.push_back({"/initial/" + card.variables[i].name, FamilyAsked::By::start, i, card.variables[i].range});
  for (std::size_t i = 0; i < card.parameters.size(); ++i)
    if (card.parameters[i].kind == Kind::number)
      all.push_back({"/problem/" + card.parameters[i].name, FamilyAsked::By::parameter, i, card.parameters[i].range});
  return all;
}

// refuse_velocity notes the velocity of a scene as text, which a start may name, where only variables of the card are
// known: orbits are followed in momenta. `before` stands in front of the name.
bool refuse_velocity(const Json& word, const FieldPath& path, const std::string& before, const Scene& scene) {
  const text::TextScene* const text = scene.mechanics->text();
  if (!text || !text->takes_velocities() || !word.is_string()) return false;
  for (const std::string& variable : text->definition.variables) {
    if (word != before + text::velocity_name(variable)) continue;
    const std::string momentum = before + text::momentum_name(variable);
    path.fault("is a velocity: a start may give it, but closed orbits are followed in momenta", word, momentum);
    return true;
  }
  return false;
}

void read_family(const Json& root, const FieldPath& top, const ProblemCard& card, Question& question) {
  const Json* json = find(root, "family");
  const FieldPath path = top.at("family");
  if (json == nullptr || !read_object(*json, path, {"by", "to", "count"}, "family")) return;
  FamilyAsked& asked = question.family.emplace();
  const std::vector<Way> ways = ways_of(card);
  Names names;
  names.reserve(ways.size());
  for (const Way& way : ways) names.push_back(way.name);
  const Json *by = find(*json, "by"), *to = find(*json, "to");
  std::optional<std::size_t> way;
  if (by == nullptr) {
    path.at("by").lacks("is required", std::string(shape_of_family));
  } else {
    const Json pointer = by->is_string() ? Json(pointer_in_one_way(by->get<std::string>())) : *by;
    if (!refuse_velocity(pointer, path.at("by"), "/initial/", *question.scene))
      way = read_name(pointer, path.at("by"), names, "way of a family");
  }
  if (way) {
    asked.by = ways[*way].by;
    asked.index = ways[*way].index;
    asked.name = ways[*way].name;
  }
  if (to == nullptr) {
    path.at("to").lacks("is required", std::string(shape_of_family));
  } else {
    asked.to = read_number(*to, path.at("to"), way ? ways[*way].range : anywhere).value_or(0);
  }
  if (const Json* count = find(*json, "count"))
    asked.count = static_cast<int>(read_integer(*count, path.at("count"), 2, periodic::most_members).value_or(2));
}

void read_manifolds(const Json& root, const FieldPath& top, Question& question) {
  const Json* json = find(root, "manifolds");
  const FieldPath path = top.at("manifolds");
  if (json == nullptr || !read_object(*json, path, {"count", "until"}, "manifolds")) return;
  periodic::ManifoldsAsked& asked = question.manifolds.emplace();
  asked.until = question.period;
  if (const Json* count = find(*json, "count"))
    asked.count = static_cast<int>(read_integer(*count, path.at("count"), 1, periodic::most_of_a_manifold).value_or(1));
  if (const Json* until = find(*json, "until"))
    asked.until = read_number(*until, path.at("until"), positive).value_or(asked.until);
}

// Reads the only scheme, taylor, whose tolerance is that of the orbit; by default as small as doubles allow.
void read_scheme(const Json& root, const FieldPath& top, const Cards& cards, const PresetCard* preset,
                 Question& question) {
  constexpr double close = 1e-15;
  const SchemeCard& card = *std::ranges::find(cards.schemes, "taylor", &SchemeCard::id);
  const Json* json = find(root, "scheme");
  const Json taylor = card.id;
  const FieldPath path = top.at("scheme");
  if (json != nullptr && !read_entry(json, path, "scheme of closed orbits", {card.id}).index) return;
  question.settings = read_settings(json ? *json : taylor, path, card, question.scene.get(), preset);
  const bool said = json != nullptr && find(*json, "tolerance") != nullptr;
  if (!said) question.settings[*card.find("tolerance")] = close;
}

}  // namespace

Result<Question, Faults> decode_periodic(ParsedJson body, const Cards& cards, const Caps& caps) {
  Faults faults = std::move(body.faults);
  const Json& root = body.tree;
  const FieldPath top{"", &faults};
  if (root.is_null() && !faults.empty()) return faults;
  const Names keys{"problem", "initial", "period", "fixed", "symmetric", "scheme", "family", "manifolds", "limits"};
  if (!read_object(root, top, keys, "the request")) return faults;
  Question question;
  read_limits(root, top, caps, question.limits);
  const Json* period = find(root, "period");
  if (period == nullptr) {
    top.at("period").lacks("is required: about the time after which the orbit closes", interval(positive));
  } else {
    question.period = read_number(*period, top.at("period"), positive).value_or(0);
  }
  if (const Json* symmetric = find(root, "symmetric")) {
    if (!symmetric->is_boolean()) top.at("symmetric").fault("must be true or false", *symmetric, "true, false");
    question.symmetric = symmetric->is_boolean() && symmetric->get<bool>();
  }
  read_manifolds(root, top, question);
  const auto problem = read_problem(root, top, cards);
  if (!problem) return faults;
  const auto scene = std::make_shared<Scene>();
  scene->mechanics = problem;
  const PresetCard* preset = read_scene(root, top, *scene);
  check_start(root, top, *scene);
  refuse_own_events(*problem, top.at("problem"));
  question.scene = scene;
  const ProblemCard& card = scene->card();
  if (const Json* fixed = find(root, "fixed")) {
    Names names;
    std::vector<std::size_t> places;
    names.reserve(card.variables.size());
    places.reserve(card.variables.size());
    for (std::size_t i = 0; i < card.variables.size(); ++i) {
      if (card.variables[i].hidden) continue;
      names.push_back(card.variables[i].name);
      places.push_back(i);
    }
    bool in_velocities = false;
    for (std::size_t i = 0; fixed->is_array() && i < fixed->size(); ++i)
      in_velocities = refuse_velocity((*fixed)[i], top.at("fixed").at(i), "", *scene) || in_velocities;
    if (!in_velocities)
      for (const std::size_t which : read_names(*fixed, top.at("fixed"), names, "variable"))
        question.fixed.push_back(places[which]);
  }
  read_family(root, top, card, question);
  read_scheme(root, top, cards, preset, question);
  if (!faults.empty()) return faults;
  if (const auto wrong = objection(question)) {
    const Json::json_pointer place(wrong->pointer);
    FieldPath{wrong->pointer, &faults}.fault(wrong->detail, root.contains(place) ? root.at(place) : Json(),
                                             wrong->allowed);
    return faults;
  }
  return question;
}

}  // namespace least::server
