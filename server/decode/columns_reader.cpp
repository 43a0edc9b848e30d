#include "server/decode/columns_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>

#include "core/catalogue/backward.hpp"
#include "core/ensemble/ensemble.hpp"
#include "core/ensemble/member_columns.hpp"
#include "core/run/acts.hpp"
#include "core/run/columns.hpp"
#include "core/text/expansion.hpp"
#include "core/text/scene.hpp"
#include "server/decode/scene_files.hpp"
#include "server/decode/section_reader.hpp"
#include "server/shared/beside_acts.hpp"

namespace least::server {
namespace {

constexpr std::size_t longest_own_name = 32, most_own_columns = 100;
constexpr std::string_view event_shape =
    "{\"name\": …, \"expression\": …, \"direction\": \"up|down|both\", \"stop\": true|false, \"set\": {…}}";

template <class Cards>
Names names_in(const Cards& cards) {
  Names names;
  for (const auto& card : cards) names.push_back(card.name);
  return names;
}

const Json* member(const Json& object, const FieldPath& path, std::string_view key, std::string_view allowed) {
  const Json* json = find(object, key);
  if (json == nullptr) {
    path.at(key).lacks("is required", std::string(allowed));
  } else if (!json->is_string()) {
    path.at(key).fault("must be a string", *json, std::string(allowed));
    json = nullptr;
  }
  return json;
}

// read_own_name reads the name that a request gives to an expression.
std::optional<std::string> read_own_name(const Json& object, const FieldPath& path) {
  constexpr std::string_view allowed = "a letter, then letters, digits, _; at most 32";
  const Json* json = member(object, path, "name", allowed);
  if (json == nullptr) return std::nullopt;
  const auto& name = json->get_ref<const std::string&>();
  if (text::is_name(name) && name.size() <= longest_own_name) return name;
  path.at("name").fault("is no name", *json, std::string(allowed));
  return std::nullopt;
}

}  // namespace

template <class Reader>
void read_expression(const Json& object, const FieldPath& path, std::string name, Reader& reader) {
  const Json* json = member(object, path, "expression", "a formula: \"sqrt(x^2 + y^2)\"");
  if (json == nullptr) return;
  auto fault = reader.read(std::move(name), json->get<std::string>());
  if (!fault) return;
  const FieldPath place = path.at("expression");
  if (!fault->unknown.empty())
    fault->detail = fmt::format("unknown name {}{}", fault->unknown, place.meant(fault->unknown, reader.names()));
  place.faults->add(
      {place.pointer, std::move(fault->detail), shown(*json), std::move(fault->allowed), fault->position});
}
template void read_expression(const Json&, const FieldPath&, std::string, MeasureReader&);
template void read_expression(const Json&, const FieldPath&, std::string, MemberReader&);

namespace {

// stands_beside_columns tells whether the finals or the section of an ensemble's answer have a list of this name.
bool stands_beside_columns(std::string_view name) {
  return name == "index" || std::ranges::find(names_of_a_section, name) != std::end(names_of_a_section);
}

// all_of_a_kind returns, for `x[*]`, the columns of all elements of x.
std::vector<std::size_t> all_of_a_kind(const Json& json, const Names& known) {
  std::vector<std::size_t> all;
  constexpr std::string_view every = "[*]";
  const std::string_view name = json.is_string() ? std::string_view(json.get_ref<const std::string&>()) : "";
  if (!name.ends_with(every)) return all;
  for (std::size_t i = 0; i < known.size(); ++i)
    if (const auto element = text::element_of(known[i]); element && element->first == name.substr(0, name.size() - 3))
      all.push_back(i);
  return all;
}

template <class Reader>
void read_own_column(const Json& json, const FieldPath& path, const Names& known, Reader& reader, Names& own_names) {
  if (!read_object(json, path, {"name", "expression"}, "a column")) return;
  auto name = read_own_name(json, path);
  if (!name) return read_expression(json, path, {}, reader);  // the expression is read for its faults alone
  const std::string_view word = json["name"].get_ref<const std::string&>();
  if (std::ranges::find(known, word) != known.end())
    path.at("name").fault("is the name of a column of the scene", json["name"]);
  if (std::ranges::find(own_names, word) != own_names.end())
    path.at("name").fault("the column stands twice", json["name"]);
  if (std::is_same_v<Reader, MemberReader> && stands_beside_columns(word))
    path.at("name").fault("is what the answer calls something else", json["name"]);
  own_names.push_back(word);
  read_expression(json, path, std::move(*name), reader);
}

// columns_for returns the columns that are allowed here. For members these are functions of a final state, and the name
// that was given, which is then refused with a specific message.
template <class Reader>
Names columns_for(const Json& json, const ProblemCard& problem, Names known) {
  if (!std::is_same_v<Reader, MemberReader>) return known;
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (!is_of_state(problem.columns[i]) && json != known[i]) known[i] = {};
  }
  return known;
}

template <class Reader>
void read_list_of_columns(const Json& json, const FieldPath& path, const ProblemCard& problem, Reader& reader,
                          Request& request) {
  Names known = names_in(problem.columns);
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (problem.columns[i].hidden) known[i] = {};
  }
  if (!json.is_array()) {
    request.columns = read_names(json, path, columns_for<Reader>(json, problem, known), "column");
    return;
  }
  if (json.empty()) {
    path.fault("must name at least one column; {\"record\": {\"every\": 0}} keeps no trajectory", json,
               listed(columns_for<Reader>(json, problem, known)));
    return;
  }
  Names own_names;
  for (std::size_t i = 0; i < json.size() && !path.faults->full(); ++i) {
    if (json[i].is_object()) {
      if (own_names.size() == most_own_columns) {
        path.at(i).fault("is one column of your own too many", json[i], fmt::format("{} at most", most_own_columns));
        return;
      }
      request.columns.push_back(known.size() + own_names.size());
      read_own_column(json[i], path.at(i), known, reader, own_names);
      continue;
    }
    const auto all = all_of_a_kind(json[i], known);
    if (!all.empty()) {
      for (const std::size_t one : all)
        if (std::ranges::find(request.columns, one) == request.columns.end()) request.columns.push_back(one);
      continue;
    }
    const auto place = read_name(json[i], path.at(i), columns_for<Reader>(json[i], problem, known), "column",
                                 ", or {\"name\": …, \"expression\": …}");
    if (!place) continue;
    if (std::ranges::find(request.columns, *place) != request.columns.end())
      path.at(i).fault("the column stands twice", json[i]);
    request.columns.push_back(*place);
  }
  request.measures = reader.made();
}

}  // namespace

int read_way(const Json& object, const FieldPath& path) {
  constexpr int ways[] = {1, -1, 0};
  const Json* direction = find(object, "direction");
  if (direction == nullptr) return 0;
  const Names names(event_directions.begin(), event_directions.end());
  return ways[read_name(*direction, path.at("direction"), names, "direction").value_or(2)];
}

void read_columns(const Json& root, const FieldPath& top, const Members* members, Request& request) {
  const ProblemCard& problem = request.scene->card();
  if (const Json* json = find(root, "columns")) {
    const FieldPath path = top.at("columns");
    if (members) {
      MemberReader reader(*request.scene, members->vary);
      read_list_of_columns(*json, path, problem, reader, request);
    } else {
      MeasureReader reader(*request.scene);
      read_list_of_columns(*json, path, problem, reader, request);
    }
  } else {
    request.columns.reserve(problem.columns.size());
    for (std::size_t i = 0; i < problem.columns.size(); ++i)
      if (problem.columns[i].by_default) request.columns.push_back(i);
  }
  if (const Json* json = find(root, "diagnostics")) {
    request.diagnostics = read_names(*json, top.at("diagnostics"), names_in(problem.diagnostics), "diagnostic");
  } else {
    for (std::size_t i = 0; i < problem.diagnostics.size(); ++i)
      if (problem.diagnostics[i].by_default) request.diagnostics.push_back(i);
  }
}

namespace {

// settable returns what an event may set: variables of the scene, and velocities where a Lagrangian or a potential is
// given.
std::vector<Setting> settable(const Scene& scene) {
  std::vector<Setting> all;
  const auto& variables = scene.card().variables;
  for (std::size_t i = 0; i < variables.size(); ++i)
    if (!variables[i].hidden) all.push_back({variables[i].name, {}, i, false});
  const text::TextScene* const text = scene.mechanics->text();
  if (!text || !text->takes_velocities()) return all;
  const auto& coordinates = text->definition.variables;
  for (std::size_t i = 0; i < coordinates.size(); ++i)
    all.push_back({text::velocity_name(coordinates[i]), {}, i, true});
  return all;
}

std::shared_ptr<const Act> read_act(const Json& event, const FieldPath& path, const Scene& scene) {
  const Json *set = find(event, "set"), *most = find(event, "most");
  if (set == nullptr && most != nullptr) path.at("most").fault("goes with set alone", *most, "{\"set\": {…}}");
  if (set == nullptr) return nullptr;
  auto act = std::make_shared<Act>();
  if (most) act->most = read_integer(*most, path.at("most"), 1, greatest_count).value_or(1);
  const FieldPath place = path.at("set");
  if (!set->is_object() || set->empty()) {
    place.fault("must name variables and what they become", *set, "{\"vx\": \"-0.9*vx\"}");
    return nullptr;
  }
  const std::vector<Setting> all = settable(scene);
  Names names;
  for (const Setting& one : all) names.push_back(one.name);
  MeasureReader reader(scene, true);
  for (const auto& [name, value] : set->items()) {
    const auto known = std::ranges::find(all, name, &Setting::name);
    if (known == all.end()) {
      place.at(name).fault("names nothing that an event can set" + place.meant(name, names), value, listed(names));
      continue;
    }
    if (!value.is_string() && !value.is_number()) {
      place.at(name).fault("must be a number or a formula", value, "\"-0.9*vx\"");
      continue;
    }
    std::string text = value.is_string() ? value.get<std::string>() : shortest(value.get<double>());
    if (auto fault = reader.read(name, text)) {
      place.faults->add(
          {place.at(name).pointer, std::move(fault->detail), shown(value), std::move(fault->allowed), fault->position});
      continue;
    }
    act->settings.push_back(*known);
    act->settings.back().text = std::move(text);
  }
  const auto of_motion = [&](const Setting& one) {
    return !one.velocity && one.index >= scene.card().variables.size() / 2;
  };
  if (std::ranges::any_of(act->settings, &Setting::velocity) &&
      std::ranges::any_of(act->settings, [&](const Setting& one) { return of_motion(one) && one.name != "s"; }))
    place.fault("velocities and momenta exclude each other", *set, "velocities or momenta");
  act->values = reader.made();
  return act;
}

// refuse_beside_acts notes diagnostics and columns that compare a run with a motion without acting events.
void refuse_beside_acts(const Json& root, const FieldPath& top, const Request& request) {
  if (std::ranges::none_of(request.events, [](const EventAsked& event) { return event.act != nullptr; })) return;
  const auto refuse = [&](const char* key, auto&& is_none, const char* allowed) {
    const Json* names = find(root, key);
    // Otherwise it has been refused already
    for (std::size_t i = 0; names && names->is_array() && i < names->size(); ++i)
      if (const Json& name = (*names)[i]; name.is_string() && is_none(name.get_ref<const std::string&>()))
        top.at(key).at(i).fault(name.get<std::string>() + " knows no events that act", name, allowed);
  };
  refuse(
      "diagnostics", [](const std::string& name) { return !knows_acts(name); }, "energy, momenta");
  refuse(
      "columns", [](const std::string& name) { return name == error_column; }, "other columns");
}

// acts_or_names tells whether a list has an acting event, or one of this name.
bool acts_or_names(const Json& events, const Json& name) {
  return std::ranges::any_of(events, [&](const Json& event) {
    const Json* const other = event.is_object() ? find(event, "name") : nullptr;
    return (other && *other == name) || (event.is_object() && find(event, "set"));
  });
}

}  // namespace

// Acting events of a problem of the catalogue belong to its motion: events of a request that only watch are added to
// them, acting ones replace them, and an empty list removes them.
void read_events(const Json& root, const FieldPath& top, Request& request) {
  const Json* json = find(root, "events");
  const Json* const own = own_events(*forward_of(*request.scene).mechanics);
  if (json == nullptr) json = own;
  const FieldPath path = top.at("events");
  if (json == nullptr) return;
  if (!json->is_array()) return path.fault("must be a list of events", *json, std::string(event_shape));
  MeasureReader reader(*request.scene);
  // The plane of the section
  for (const Measure& plane : request.watched.list) reader.read(plane.card.name, plane.text);
  std::vector<const Json*> events;
  if (own != nullptr && own != json && !json->empty())
    for (const Json& event : *own)
      if (event.contains("set") && !acts_or_names(*json, event["name"])) events.push_back(&event);
  const std::size_t of_scene = events.size();  // these have no faults
  if (of_scene + json->size() > most_events)
    return path.fault(fmt::format("holds {} events{}", json->size(),
                                  of_scene > 0 ? fmt::format(", beside {} of the scene", of_scene) : ""),
                      *json, fmt::format("{} at most", most_events - of_scene));
  for (const Json& event : *json) events.push_back(&event);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < events.size() && !path.faults->full(); ++i) {
    const Json& event = *events[i];
    const FieldPath place = i < of_scene ? path : path.at(i - of_scene);
    if (!event.is_object()) place.fault("must be an object", event, std::string(event_shape));
    const Names keys{"name", "expression", "direction", "stop", "set", "most"};
    if (!event.is_object() || !read_object(event, place, keys, "an event")) continue;
    EventAsked& asked = request.events.emplace_back();
    asked.direction = read_way(event, place);
    if (const Json* stop = find(event, "stop")) {
      if (!stop->is_boolean()) place.at("stop").fault("must be true or false", *stop, "true, false");
      asked.stop = stop->is_boolean() && stop->get<bool>();
    }
    asked.act = read_act(event, place, *request.scene);
    std::string name = read_own_name(event, place).value_or("");
    if (!name.empty() && std::ranges::find(names, name) != names.end())
      place.at("name").fault("the event stands twice", event["name"]);
    names.push_back(name);
    read_expression(event, place, std::move(name), reader);
  }
  request.watched = reader.made();
  // In contact scenes the run carries s, to report the effect of an act on the contact form.
  for (std::size_t i = 0; i < request.watched.size() && i < request.events.size(); ++i)
    if (request.events[i].act) request.watched.list[i].card.full_state = true;
  refuse_beside_acts(root, top, request);
}

}  // namespace least::server
