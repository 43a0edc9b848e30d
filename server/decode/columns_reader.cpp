#include "server/decode/columns_reader.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/ensemble/ensemble.hpp"
#include "core/ensemble/member_columns.hpp"
#include "core/text/expansion.hpp"

namespace least::server {
namespace {

constexpr std::size_t longest_own_name = 32, most_own_columns = 100;
constexpr std::string_view event_shape =
    "{\"name\": …, \"expression\": …, \"direction\": \"up|down|both\", \"stop\": true|false}";

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

// A name that the caller gives to an expression.
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

// What stands beside columns in the finals and the section of an ensemble's answer.
constexpr std::string_view beside_columns[] = {"index", "member",     "crossing", "period",
                                               "phase", "expression", "direction"};

// What `x[*]` stands for: the columns of all elements of x.
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
  if (!name) return read_expression(json, path, {}, reader);  // for its faults
  const std::string_view word = json["name"].get_ref<const std::string&>();
  if (std::ranges::find(known, word) != known.end())
    path.at("name").fault("is the name of a column of the scene", json["name"]);
  if (std::ranges::find(own_names, word) != own_names.end())
    path.at("name").fault("the column stands twice", json["name"]);
  if (std::is_same_v<Reader, MemberReader> && std::ranges::find(beside_columns, word) != std::end(beside_columns))
    path.at("name").fault("is what the answer calls something else", json["name"]);
  own_names.push_back(word);
  read_expression(json, path, std::move(*name), reader);
}

// What may stand where `json` does: of members what follows from a final state, and what is named, which is refused in
// words of its own.
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

void read_events(const Json& root, const FieldPath& top, Request& request) {
  const Json* json = find(root, "events");
  const FieldPath path = top.at("events");
  if (json == nullptr) return;
  if (!json->is_array()) return path.fault("must be a list of events", *json, std::string(event_shape));
  if (json->size() > most_events)
    return path.fault(fmt::format("holds {} events", json->size()), *json, fmt::format("{} at most", most_events));
  MeasureReader reader(*request.scene);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < json->size() && !path.faults->full(); ++i) {
    const Json& event = (*json)[i];
    const FieldPath place = path.at(i);
    if (!event.is_object()) place.fault("must be an object", event, std::string(event_shape));
    if (!event.is_object() || !read_object(event, place, {"name", "expression", "direction", "stop"}, "an event"))
      continue;
    EventAsked& asked = request.events.emplace_back();
    if (const Json* direction = find(event, "direction")) {
      constexpr int signs[] = {1, -1, 0};
      const auto way = read_name(*direction, place.at("direction"),
                                 Names(event_directions.begin(), event_directions.end()), "direction");
      asked.direction = signs[way.value_or(2)];
    }
    if (const Json* stop = find(event, "stop")) {
      if (!stop->is_boolean()) place.at("stop").fault("must be true or false", *stop, "true, false");
      asked.stop = stop->is_boolean() && stop->get<bool>();
    }
    std::string name = read_own_name(event, place).value_or("");
    if (!name.empty() && std::ranges::find(names, name) != names.end())
      place.at("name").fault("the event stands twice", event["name"]);
    names.push_back(name);
    read_expression(event, place, std::move(name), reader);
  }
  request.watched = reader.made();
}

}  // namespace least::server
