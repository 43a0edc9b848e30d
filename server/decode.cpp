#include "server/decode.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/decode_plan.hpp"
#include "server/encode_parts.hpp"
#include "server/reader.hpp"

namespace least::server {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

template <class Card>
Names names_of(std::span<const Card> cards) {
  Names names;
  for (const auto& card : cards) names.push_back(card.id);
  return names;
}

template <class Items>
Names keys_of(const Items& items, std::initializer_list<std::string_view> more) {
  Names names(more);
  for (const auto& item : items) names.push_back(item.name);
  return names;
}

std::optional<double> named(const std::vector<NamedValue>& values, std::string_view name) {
  for (const auto& [key, value] : values) {
    if (key == name) return value;
  }
  return std::nullopt;
}

// `"kepler"` or `{"id": "kepler", …}`: what it names, and where the name stands.
struct Chosen {
  std::optional<std::size_t> index;
  Place place;
};

Chosen choose(const Json& root, const Place& top, std::string_view key, const Names& ids) {
  const Place place = top.at(key);
  const Json* json = find(root, key);
  if (json == nullptr) {
    place.lacks("is required", listed(ids));
    return {std::nullopt, place};
  }
  if (json->is_string()) return {read_name(*json, place, ids, key), place};
  if (!json->is_object()) {
    place.fault("must be an id or an object with an id", *json, listed(ids));
    return {std::nullopt, place};
  }
  const Json* id = find(*json, "id");
  if (id == nullptr) {
    place.at("id").lacks("is required", listed(ids));
    return {std::nullopt, place.at("id")};
  }
  return {read_name(*id, place.at("id"), ids, key), place.at("id")};
}

// Flat parameters beside an id; `values` comes with the defaults.
void read_parameters(const Json& object, const Place& place, const std::vector<ParameterCard>& cards,
                     std::vector<double>& values) {
  for (std::size_t i = 0; i < cards.size(); ++i) {
    const Json* json = find(object, cards[i].name);
    if (json == nullptr) continue;
    if (const auto value = read_parameter(*json, place.at(cards[i].name), cards[i])) values[i] = *value;
  }
}

// The preset of a problem's or a scheme's card that the request names.
template <class Card>
auto read_preset(const Json& object, const Place& place, const Card& card) -> decltype(card.presets.data()) {
  const Json* json = find(object, "preset");
  if (json == nullptr) return nullptr;
  if (card.presets.empty()) {
    place.at("preset").fault(fmt::format("{} has no presets", card.id), *json);
    return nullptr;
  }
  const auto index = read_name(*json, place.at("preset"), keys_of(card.presets, {}), "preset");
  return index ? &card.presets[*index] : nullptr;
}

// The problem's parameters and the start: card, then preset, then what the request says. The preset, if there is one.
const PresetCard* read_scene(const Json& root, const Place& top, const ProblemCard& card, Request& request) {
  for (const auto& parameter : card.parameters) request.parameters.push_back(parameter.value);
  for (const auto& variable : card.variables) request.initial.push_back(variable.value);

  const Place place = top.at("problem");
  const PresetCard* preset = nullptr;
  if (const Json* json = find(root, "problem"); json->is_object()) {
    read_object(*json, place, keys_of(card.parameters, {"id", "preset"}), card.id);
    if ((preset = read_preset(*json, place, card)) != nullptr) {
      for (std::size_t i = 0; i < card.parameters.size(); ++i) {
        request.parameters[i] = named(preset->parameters, card.parameters[i].name).value_or(request.parameters[i]);
      }
      for (std::size_t i = 0; i < card.variables.size(); ++i) {
        request.initial[i] = named(preset->initial, card.variables[i].name).value_or(request.initial[i]);
      }
      request.start = named(preset->initial, "t").value_or(request.start);
    }
    read_parameters(*json, place, card.parameters, request.parameters);
  }

  const Json* initial = find(root, "initial");
  const Place start = top.at("initial");
  const Names names = keys_of(card.variables, {"t"});
  if (initial == nullptr || !read_object(*initial, start, names, fmt::format("the start of {}", card.id)))
    return preset;
  bool given = false;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Json* json = find(*initial, names[i]);
    const bool follows = i > 0 && std::isnan(card.variables[i - 1].value);  // null: from the others
    if (json == nullptr || (follows && json->is_null())) continue;
    const auto value = read_number(*json, start.at(names[i]), {-infinity, infinity, true, true});
    if (value) (i == 0 ? request.start : request.initial[i - 1]) = *value;
    given = given || i > 0;
  }
  if (!given && card.regular_start != nullptr) {
    if (auto state = card.regular_start(request.parameters, request.start)) request.initial = std::move(*state);
  }
  return preset;
}

// What a list of suggestions says; NaN says nothing.
std::optional<double> suggestion(const std::vector<NamedValue>& suggested, std::string_view name) {
  const auto value = named(suggested, name);
  return value && std::isnan(*value) ? std::nullopt : value;
}

// The scheme's parameters: card, then what the problem suggests, then preset, then what the request says.
void read_scheme(const Json& root, const Place& top, const SchemeCard& card, const ProblemCard* problem,
                 const PresetCard* scene, Request& request) {
  for (const auto& parameter : card.parameters) {
    std::optional<double> value;
    if (scene != nullptr) value = suggestion(scene->suggested, parameter.suggested);
    if (problem != nullptr && !value) value = suggestion(problem->suggested, parameter.suggested);
    request.settings.push_back(value.value_or(parameter.value));
  }
  const Json* json = find(root, "scheme");
  if (!json->is_object()) return;
  const Place place = top.at("scheme");
  read_object(*json, place, keys_of(card.parameters, {"id", "preset"}), card.id);
  if (const SchemePresetCard* preset = read_preset(*json, place, card)) {
    for (std::size_t i = 0; i < card.parameters.size(); ++i) {
      request.settings[i] = named(preset->settings, card.parameters[i].name).value_or(request.settings[i]);
    }
  }
  read_parameters(*json, place, card.parameters, request.settings);
}

void check_pair(const Cards& cards, const ProblemCard& problem, std::size_t scheme, const Place& place) {
  if (std::find(problem.schemes.begin(), problem.schemes.end(), scheme) != problem.schemes.end()) return;
  const SchemeCard& card = cards.schemes[scheme];
  Names fitting;
  for (const auto index : problem.schemes) fitting.push_back(cards.schemes[index].id);
  place.fault(fmt::format("{} cannot run {}: it needs {}, and {} offers {}", card.id, problem.id, card.needs,
                          problem.id, problem.offers),
              Json(card.id), listed(fitting));
}

// Settings that were read without a fault, for a pair that fits, and do not go together.
void check_settings(const SchemeCard& card, const ProblemCard& problem, const std::vector<double>& settings,
                    const Place& place) {
  if (card.conflicts == nullptr || place.faults->within(place.pointer)) return;
  for (auto& conflict : card.conflicts(settings, problem)) {
    std::string value;
    JsonWriter json(value);
    for (std::size_t i = 0; i < settings.size(); ++i) {
      if (card.parameters[i].name == conflict.parameter) write_parameter(json, card.parameters[i], settings[i]);
    }
    place.faults->add({place.at(conflict.parameter).pointer, std::move(conflict.detail), std::move(value),
                       std::move(conflict.allowed)});
  }
}

}  // namespace

std::optional<std::size_t> fixed_step(const SchemeCard& scheme) {
  if (scheme.own_clock) return std::nullopt;
  for (std::size_t i = 0; i < scheme.parameters.size(); ++i) {
    if (scheme.parameters[i].name == "step") return i;
  }
  return std::nullopt;
}

Result<Request, Faults> decode(ParsedJson body, const Cards& cards, const Caps& caps) {
  Faults faults = std::move(body.faults);
  const Json& root = body.tree;
  const Place top{"", &faults};
  Request request;

  if (root.is_null() && !faults.empty()) return faults;  // a bound was broken: there is nothing to read
  const Names keys{"problem", "initial", "scheme", "until", "record", "columns", "diagnostics", "limits"};
  if (!read_object(root, top, keys, "the request")) return faults;

  const Chosen problem = choose(root, top, "problem", names_of(cards.problems));
  const Chosen scheme = choose(root, top, "scheme", names_of(cards.schemes));
  const ProblemCard* problem_card = problem.index ? &cards.problems[*problem.index] : nullptr;
  const SchemeCard* scheme_card = scheme.index ? &cards.schemes[*scheme.index] : nullptr;
  const PresetCard* preset = problem_card ? read_scene(root, top, *problem_card, request) : nullptr;
  if (scheme_card) read_scheme(root, top, *scheme_card, problem_card, preset, request);
  if (problem_card && scheme_card) {
    check_pair(cards, *problem_card, *scheme.index, scheme.place);
    check_settings(*scheme_card, *problem_card, request.settings, top.at("scheme"));
  }
  double span = problem_card ? problem_card->span : 0;
  if (preset != nullptr && preset->span > 0) span = preset->span;
  read_plan(root, top, problem_card, scheme_card, span, caps, request);

  if (!faults.empty()) return faults;
  request.problem = *problem.index;
  request.scheme = *scheme.index;
  return request;
}

}  // namespace least::server
