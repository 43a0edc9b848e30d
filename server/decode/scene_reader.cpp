#include "server/decode/scene_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/catalogue/backward.hpp"
#include "core/catalogue/found_schemes.hpp"
#include "core/catalogue/start_beside.hpp"
#include "core/run/suggestions.hpp"
#include "core/text/scene.hpp"
#include "core/text/start_velocities.hpp"
#include "core/text/written_out.hpp"
#include "server/decode/custom_reader.hpp"
#include "server/decode/objection_place.hpp"
#include "server/decode/pictures_reader.hpp"
#include "server/decode/scene_files.hpp"

namespace least::server {
namespace {

template <class Items>
Names keys_of(const Items& items, std::initializer_list<std::string_view> more) {
  Names names;
  names.reserve(more.size() + items.size());
  names.insert(names.end(), more.begin(), more.end());
  for (const auto& item : items) names.push_back(item.name);
  return names;
}

std::optional<double> named(const std::vector<NamedValue>& values, std::string_view name) {
  for (const auto& [key, value] : values) {
    if (key == name) return value;
  }
  return std::nullopt;
}

// Reads parameters that are given flat beside an id. `values` are the defaults on entry, and end with the weights of a
// composition, if any.
void read_parameters(const Json& object, const FieldPath& path, const std::vector<ParameterCard>& cards,
                     std::vector<double>& values) {
  std::vector<double> weights;
  for (std::size_t i = 0; i < cards.size(); ++i) {
    const Json* json = find(object, cards[i].name);
    if (json == nullptr) continue;
    if (const auto value = read_parameter(*json, path.at(cards[i].name), cards[i], weights)) values[i] = *value;
  }
  values.insert(values.end(), weights.begin(), weights.end());
}

// read_preset returns the preset of the card that the request names.
template <class Card>
auto read_preset(const Json& object, const FieldPath& path, const Card& card) -> decltype(card.presets.data()) {
  const Json* json = find(object, "preset");
  if (json == nullptr) return nullptr;
  if (card.presets.empty()) {
    path.at("preset").fault(fmt::format("{} has no presets", card.id), *json);
    return nullptr;
  }
  const auto index = read_name(*json, path.at("preset"), keys_of(card.presets, {}), "preset");
  return index ? &card.presets[*index] : nullptr;
}

// An answer reports the order of a composition's weights: a request may omit it but not contradict it.
void check_order(const Json& scheme, const FieldPath& path, const SchemeCard& card, const std::vector<double>& settings,
                 std::size_t i) {
  if (!has_weights(card.parameters[i], settings[i])) return;
  const Json& composition = scheme[std::string(card.parameters[i].name)];
  const Json* said = find(composition, "order");
  const int order = order_with_weights(card, settings);
  if (said == nullptr || *said == order) return;
  path.at(card.parameters[i].name).at("order").fault("is not the order of these weights", *said, std::to_string(order));
}

}  // namespace

NamedEntry read_entry(const Json* json, const FieldPath& path, std::string_view what, const Names& ids) {
  if (json == nullptr) {
    path.lacks("is required", listed(ids));
    return {std::nullopt, path};
  }
  if (json->is_string()) return {read_name(*json, path, ids, what), path};
  if (!json->is_object()) {
    path.fault("must be an id or an object with an id", *json, listed(ids));
    return {std::nullopt, path};
  }
  const Json* id = find(*json, "id");
  if (id == nullptr) {
    path.at("id").lacks("is required", listed(ids));
    return {std::nullopt, path.at("id")};
  }
  return {read_name(*id, path.at("id"), ids, what), path.at("id")};
}

std::shared_ptr<const Mechanics> read_problem(const Json& root, const FieldPath& top, const Cards& cards) {
  Names ids = names_of(cards.problems);
  ids.push_back(custom_id);
  const Json* json = find(root, "problem");
  const NamedEntry entry = read_entry(json, top.at("problem"), "problem", ids);
  if (!entry.index) return nullptr;
  if (*entry.index < cards.problems.size()) return cards.problems[*entry.index];
  return read_custom(*json, top.at("problem"));
}

namespace {

// velocity_names returns the names that a start may use instead of momenta; empty where neither a Lagrangian nor a
// potential is given.
std::vector<std::string> velocity_names(const text::TextScene& scene) {
  std::vector<std::string> names;
  if (!scene.takes_velocities()) return names;
  for (const auto& name : scene.definition.variables) names.push_back(text::velocity_name(name));
  return names;
}

// read_velocities reads a start with velocities, or with momenta of some coordinates and velocities of the others;
// momenta that are not given follow from velocities. Missing velocities are 0; in the catalogue those of the default
// start, which are `known` if it says them, whatever parameters and coordinates the request gives.
void read_velocities(const Json& initial, const FieldPath& start, const text::TextScene& text,
                     const std::vector<std::string>& names, const std::vector<double>& known, Scene& scene,
                     std::vector<double>* velocities) {
  if (names.empty()) return;
  const bool by_default = !text.known || !known.empty();
  if (!by_default && std::ranges::none_of(names, [&](const auto& name) { return find(initial, name) != nullptr; }))
    return;
  std::vector<double> state = scene.initial;
  const auto moving = state.begin() + text.capacity;
  const std::vector<double> said(moving,
                                 // The momenta, where they are given
                                 moving + static_cast<std::ptrdiff_t>(names.size()));
  if (by_default) {
    std::fill(moving, moving + text.capacity, 0.0);
    std::ranges::copy(known, moving);
  } else {
    std::ranges::copy(text::velocities_of(text, scene.parameters, scene.start, state), moving);
  }
  std::vector<std::size_t> in_momenta;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string momentum = text::momentum_name(text.definition.variables[i]);
    if (find(initial, momentum) != nullptr) in_momenta.push_back(i);
    const Json* json = find(initial, names[i]);
    if (json == nullptr) continue;
    if (!in_momenta.empty() && in_momenta.back() == i && !start.faults->within(start.at(names[i]).pointer))
      start.at(names[i]).fault("and " + momentum + " exclude each other", *json, "one of them");
    if (const auto value = read_number(*json, start.at(names[i]), anywhere))
      moving[static_cast<std::ptrdiff_t>(i)] = *value;
  }
  if (in_momenta.size() == names.size() || start.faults->within(start.pointer) || start.faults->within("/problem"))
    return;
  if (velocities && in_momenta.empty()) velocities->assign(moving, moving + static_cast<std::ptrdiff_t>(names.size()));
  std::vector<double> momenta(in_momenta.size());
  std::ranges::transform(in_momenta, momenta.begin(), [&](std::size_t i) { return said[i]; });
  if (!text::make_momenta_of_start(text, scene.parameters, scene.start, in_momenta, momenta, state))
    return start.lacks("no velocities were found that these momenta have beside the other velocities",
                       "velocities, or momenta, of all coordinates");
  scene.initial = std::move(state);
}

// is_in_velocities tells whether a start is given by velocities, which then stay fixed: it has no momenta; or, for a
// problem of the catalogue whose default start is in momenta, it has a velocity.
bool is_in_velocities(const Json& root, const text::TextScene* text) {
  if (!text || !text->takes_velocities()) return false;
  const bool by_default = !text->known || !default_velocities(*text).empty();
  const Json* initial = find(root, "initial");
  if (initial == nullptr) return by_default;
  const auto kind = [](const std::string& name) { return name.substr(0, name.find('[')); };
  const bool says_other = std::ranges::any_of(text->definition.variables, [&](const std::string& variable) {
    const std::string other = kind(by_default ? text::momentum_name(variable) : text::velocity_name(variable));
    for (const auto& [name, value] : initial->items())
      if (kind(name) == other) return true;
    return false;
  });
  return by_default != says_other;
}

// without_lists returns a start, or parameters, with lists replaced by their elements: {"x": [1, 2]} becomes {"x[1]":
// 1, "x[2]": 2}. Where something else stands for a list it is left out.
Json without_lists(const Json& initial, const FieldPath& start, const text::TextScene& text) {
  Json elements = Json::object();
  for (const auto& [name, entry] : initial.items()) {
    const std::int64_t count = text::length_of_list(text.definition, name);
    if (count == 0) {
      elements[name] = entry;
    } else if (!entry.is_array()) {
      start.at(name).fault("is a list and takes as many numbers as it has elements", entry,
                           fmt::format("{} numbers, or one of {} to {}", count, text::element_name(name, 1),
                                       text::element_name(name, count)));
    } else if (entry.size() != static_cast<std::size_t>(count)) {
      start.at(name).lacks("is a list of " + std::to_string(entry.size()) + " numbers",
                           std::to_string(count) + " numbers");
    } else {
      for (std::size_t i = 0; i < entry.size(); ++i) {
        const std::string element = text::element_name(name, static_cast<std::int64_t>(i) + 1);
        const FieldPath place = start.at(name).at(i);
        if (initial.contains(element))
          place.fault(fmt::format("is given twice: {} stands beside the list", element), entry[i], "one of them");
        else if (const auto value = read_number(entry[i], place, anywhere))
          elements[element] = *value;
      }
    }
  }
  return elements;
}

// has_list_of tells whether a list of parameters is given beside the id, or something that stands for one.
bool has_list_of(const Json& problem, const std::vector<ParameterCard>& parameters, const Names& keys) {
  for (const auto& [name, entry] : problem.items()) {
    if (std::ranges::find(keys, name) != keys.end()) continue;
    const std::string first = text::element_name(name, 1);
    if (std::ranges::find(parameters, first, &ParameterCard::name) != parameters.end()) return true;
  }
  return false;
}

}  // namespace

const PresetCard* read_scene(const Json& root, const FieldPath& top, Scene& scene, std::vector<double>* velocities) {
  const ProblemCard& card = scene.card();
  const text::TextScene* const text = scene.mechanics->text();
  for (const auto& parameter : card.parameters) scene.parameters.push_back(parameter.value);
  for (const auto& variable : card.variables) scene.initial.push_back(variable.value);

  const FieldPath path = top.at("problem");
  const PresetCard* preset = nullptr;
  if (const Json* json = find(root, "problem"); json->is_object()) {
    const bool typed = text && !text->known;
    Names keys = typed ? keys_of(card.parameters, {}) : keys_of(card.parameters, {"id", "preset"});
    if (typed) keys.insert(keys.end(), text::reserved_keys().begin(), text::reserved_keys().end());
    if (typed && text->definition.vocabulary)  // sizes belong to the scene that was made
      keys.insert(keys.end(), text->definition.vocabulary->fixed.begin(), text->definition.vocabulary->fixed.end());
    Json elements;
    if (text && has_list_of(*json, card.parameters, keys)) json = &(elements = without_lists(*json, path, *text));
    read_object(*json, path, keys, card.id);
    if ((preset = read_preset(*json, path, card)) != nullptr) {
      for (std::size_t i = 0; i < card.parameters.size(); ++i) {
        scene.parameters[i] = named(preset->parameters, card.parameters[i].name).value_or(scene.parameters[i]);
      }
      for (std::size_t i = 0; i < card.variables.size(); ++i) {
        scene.initial[i] = named(preset->initial, card.variables[i].name).value_or(scene.initial[i]);
      }
      scene.start = named(preset->initial, "t").value_or(scene.start);
    }
    read_parameters(*json, path, card.parameters, scene.parameters);
    if (text && text->definition.typed) check_pictures(text->definition.typed->pictures, path, scene);
  }

  if (text && !top.faults->within(path.pointer))
    if (const auto objection = text->objection(scene.parameters))
      add_objection(root, top, scene, *objection,
                    [&](const Scene& other) { return !text->objection(other.parameters); });
  static const Json nothing = Json::object();
  const Json* initial = find(root, "initial");
  if (initial == nullptr && text == nullptr) return preset;
  const FieldPath start = top.at("initial");
  Json elements;
  if (text && initial && initial->is_object()) initial = &(elements = without_lists(*initial, start, *text));
  if (initial == nullptr) initial = &nothing;
  const Names names = keys_of(card.variables, {"t"});
  const std::vector<std::string> names_of_velocities = text ? velocity_names(*text) : std::vector<std::string>();
  Names known{"t"};
  for (const auto& variable : card.variables)
    if (!variable.hidden) known.push_back(variable.name);
  known.insert(known.end(), names_of_velocities.begin(), names_of_velocities.end());
  if (!read_object(*initial, start, known, fmt::format("the start of {}", card.id))) return preset;
  bool given = false;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0 && card.variables[i - 1].hidden) continue;
    const Json* json = find(*initial, names[i]);
    const bool follows = i > 0 && std::isnan(card.variables[i - 1].value);  // null: the value follows from the others
    if (json == nullptr || (follows && json->is_null())) continue;
    const auto value = read_number(*json, start.at(names[i]), i == 0 ? anywhere : card.variables[i - 1].range);
    if (value) (i == 0 ? scene.start : scene.initial[i - 1]) = *value;
    given = given || i > 0;
  }
  if (text) {
    const std::vector<double>& by_default = default_velocities(*text, preset ? preset->name : std::string_view());
    read_velocities(*initial, start, *text, names_of_velocities, by_default, scene, velocities);
  }
  if (given) return preset;
  if (auto regular = scene.mechanics->regular_start(scene.parameters, scene.start)) {
    if (regular->objection.empty()) {
      scene.initial = std::move(regular->state);
    } else {
      start.at("t").fault(regular->objection, Json(scene.start), listed(keys_of(card.variables, {})));
    }
  }
  return preset;
}

bool holds_velocities(const Json& root, const Json& asked, const FieldPath& path, const text::TextScene* text,
                      bool both) {
  const Json* holds = find(asked, "holds");
  if (holds == nullptr) return is_in_velocities(root, text);
  Names names(text::held_names.begin(), text::held_names.end());
  if (!both || !text || !text->takes_velocities()) names.pop_back();
  return read_name(*holds, path.at("holds"), names, "part of a start").value_or(0) == 1;
}

namespace {

// keeps_velocities tells whether a start has the velocities that the request says, if it says any. Where a mass
// vanishes, momenta do not know them.
bool keeps_velocities(const Json& root, const Scene& scene, const std::vector<double>& start) {
  constexpr double close = 1e-6;
  const text::TextScene& text = *scene.mechanics->text();
  if (!text.takes_velocities()) return true;
  Faults faults;
  Scene asked{scene.mechanics, {}, {}, 0};
  std::vector<double> said;
  read_scene(root, {"", &faults}, asked, &said);
  const std::vector<double> has = text::velocities_of(text, scene.parameters, scene.start, start);
  for (std::size_t i = 0; i < said.size(); ++i)
    if (said[i] != 0 && !(std::abs(has[i] - said[i]) <= close * std::abs(said[i]))) return false;
  return true;
}

}  // namespace

void check_start(const Json& root, const FieldPath& top, Scene& scene) {
  const text::TextScene* const text = scene.mechanics->text();
  if (text == nullptr || top.faults->within("/problem") || top.faults->within("/initial")) return;
  auto objection = text->objection_to_start(scene.parameters, scene.start, scene.initial);
  if (!objection) return;
  if (auto other = start_beside(scene); other && keeps_velocities(root, scene, *other)) {
    scene.initial = *std::move(other);
    return;
  }
  if (const std::string advice = advice_on_start(scene); !advice.empty()) objection->detail += "; " + advice;
  add_objection(root, top, scene, *objection, [&](const Scene& other) {
    return !text->objection(other.parameters) &&
           !text->objection_to_start(other.parameters, other.start, other.initial);
  });
}

std::vector<double> read_settings(const Json& json, const FieldPath& path, const SchemeCard& card, const Scene* scene,
                                  const PresetCard* preset) {
  const bool known = scene != nullptr && scene->mechanics != nullptr;
  std::vector<double> settings = plain_settings(known ? &scene->card() : nullptr, card, preset);
  std::vector<bool> given(settings.size(), false);
  if (json.is_object()) {
    read_object(json, path, keys_of(card.parameters, {"id", "preset"}), card.id);
    const SchemePresetCard* own = read_preset(json, path, card);
    for (std::size_t i = 0; i < card.parameters.size(); ++i) {
      const auto value = own ? named(own->settings, card.parameters[i].name) : std::nullopt;
      settings[i] = value.value_or(settings[i]);
      given[i] = value || find(json, card.parameters[i].name) != nullptr;
    }
    read_parameters(json, path, card.parameters, settings);
  }
  if (known && path.faults->empty()) adapt_to_units(*scene, card, preset, given, settings);
  for (std::size_t i = 0; i < card.parameters.size(); ++i) check_order(json, path, card, settings, i);
  return settings;
}

void check_pair(const Cards& cards, const Scene& scene, std::size_t scheme, const FieldPath& path) {
  const text::TextScene* const text = scene.mechanics->text();
  if (text && !text->known && path.faults->within("/problem")) return;  // something else may stand in for it
  const ProblemCard& problem = scene.card();
  const SchemeCard& card = cards.schemes[scheme];
  std::string why = objection_to_scheme(scene, card.id);  // the reason may depend on the parameters
  if (why.empty() && std::find(problem.schemes.begin(), problem.schemes.end(), scheme) != problem.schemes.end()) return;
  if (!why.empty()) why.insert(0, ": ");
  Names fitting;
  fitting.reserve(problem.schemes.size());
  for (const auto index : problem.schemes)
    if (index != scheme) fitting.push_back(cards.schemes[index].id);
  if (why.empty() && goes_backward(scene) &&
      std::ranges::find(forward_of(scene).card().schemes, scheme) != forward_of(scene).card().schemes.end())
    return path.fault(fmt::format("{} runs {} forward in time alone", card.id, problem.id), Json(card.id),
                      listed(fitting));
  path.fault(fmt::format("{} cannot run {}: it needs {}, and {} offers {}{}", card.id, problem.id, card.needs,
                         problem.id, problem.offers, why),
             Json(card.id), listed(fitting));
}

void check_settings(const SchemeCard& card, const ProblemCard& problem, const std::vector<double>& settings,
                    const FieldPath& path) {
  if (card.conflicts == nullptr || path.faults->within(path.pointer)) return;
  for (auto& conflict : card.conflicts(settings, problem)) {
    std::string value;
    JsonWriter json(value);
    for (std::size_t i = 0; i < card.parameters.size(); ++i) {
      if (card.parameters[i].name == conflict.parameter) write_setting(json, card, settings, i);
    }
    path.faults->add({path.at(conflict.parameter).pointer, std::move(conflict.detail), std::move(value),
                      std::move(conflict.allowed)});
  }
}

}  // namespace least::server
