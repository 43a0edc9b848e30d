#include "server/decode/pictures_reader.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/run/measures.hpp"
#include "core/text/expansion.hpp"

namespace least::server {
namespace {

using text::Pictures;

constexpr std::size_t most_views = 8, most_bodies = 256, most_links = 8;
constexpr std::string_view of_place = "two or three columns or expressions, [\"x\", \"y\"]";

// read_place reads two coordinates, or three: in the plane or in space.
std::vector<std::string> read_place(const Json& json, const FieldPath& path) {
  std::vector<std::string> place;
  if (!json.is_array() || json.size() < 2 || json.size() > 3) {
    path.fault("must be a place", json, std::string(of_place));
    return place;
  }
  for (std::size_t i = 0; i < json.size(); ++i) {
    if (!json[i].is_string() && !json[i].is_number())
      path.at(i).fault("must be a column or an expression", json[i], "\"x\", or \"l*sin(theta)\"");
    place.push_back(json[i].is_string() ? json[i].get<std::string>() : json[i].is_number() ? json[i].dump() : "0");
  }
  return place;
}

std::vector<int> read_links(const Json& json, const FieldPath& path, std::size_t bodies) {
  std::vector<int> links;
  const std::string allowed =
      fmt::format("numbers of bodies, 0 to {}, and \"pivot\"; {} at most", bodies - 1, most_links);
  if (!json.is_array() || json.size() > most_links) {
    path.fault("must be a list of what the body is linked to", json, allowed);
    return links;
  }
  for (std::size_t i = 0; i < json.size(); ++i) {
    if (json[i] == "pivot") {
      links.push_back(Pictures::pivot);
    } else if (!json[i].is_number_unsigned() || json[i].get<std::uint64_t>() >= bodies) {
      path.at(i).fault(json[i].is_number() ? "there is no such body" : "is no body", json[i], allowed);
    } else {  // a link of a body to itself would be invisible
      links.push_back(json[i].get<int>());
    }
  }
  return links;
}

// list returns the list if it has at most `most` elements; else an empty one after noting the fault.
const Json& list(const Json& json, const FieldPath& path, std::size_t most, std::string_view shape) {
  static const Json none = Json::array();
  if (json.is_array() && json.size() <= most) return json;
  path.fault(json.is_array() ? fmt::format("holds {}", json.size()) : "must be a list", json,
             fmt::format("{}, {} at most", shape, most));
  return none;
}

// check_entry checks an entry of a view or of a body's place.
// `many`: `x[*]` is allowed, which stands for one column of each element.
void check_entry(const std::string& entry, const FieldPath& path, const ProblemCard& card, MeasureReader& reader,
                 bool many) {
  Names columns;
  for (const auto& column : card.columns)
    if (!column.hidden) columns.push_back(column.name);
  if (std::ranges::find(columns, entry) != columns.end()) return;
  const auto is_of = [&](std::string_view name) {
    const auto element = text::element_of(name);
    return element && entry == std::string(element->first) + "[*]";
  };
  if (many && entry.ends_with("[*]") && std::ranges::any_of(columns, is_of)) return;
  auto fault = reader.read("view", entry);
  if (!fault) return;
  if (!fault->unknown.empty()) {
    Names known = reader.names();
    known.insert(known.end(), columns.begin(), columns.end());
    fault->detail = fmt::format("unknown column or name {}{}", fault->unknown, path.meant(fault->unknown, known));
  }
  path.faults->add(
      {path.pointer, std::move(fault->detail), shown(Json(entry)), std::move(fault->allowed), fault->position});
}

}  // namespace

Pictures read_pictures(const Json& problem, const FieldPath& path) {
  Pictures pictures;
  if (const Json* views = find(problem, "views")) {
    const FieldPath at = path.at("views");
    const Json& all = list(*views, at, most_views, "[[\"x\", \"y\"], …]");
    for (std::size_t i = 0; i < all.size(); ++i) pictures.views.push_back(read_place(all[i], at.at(i)));
  }
  const Json* bodies = find(problem, "bodies");
  if (bodies == nullptr) return pictures;
  const FieldPath at = path.at("bodies");
  const Json& all =
      list(*bodies, at, most_bodies, "[{\"at\": [\"x\", \"y\"], \"linked\": [\"pivot\"], \"kind\": \"bob\"}]");
  for (std::size_t i = 0; i < all.size() && !path.faults->full(); ++i) {
    const FieldPath here = at.at(i);
    Pictures::Body& body = pictures.bodies.emplace_back();
    if (!read_object(all[i], here, {"at", "linked", "kind"}, "a body")) continue;
    if (const Json* place = find(all[i], "at"))
      body.at = read_place(*place, here.at("at"));
    else
      here.at("at").lacks("is required", std::string(of_place));
    if (!body.at.empty() && body.at.size() != pictures.bodies.front().at.size() && !pictures.bodies.front().at.empty())
      here.at("at").fault("is not of as many coordinates as the first body's", all[i]["at"], std::string(of_place));
    if (const Json* links = find(all[i], "linked")) body.linked = read_links(*links, here.at("linked"), all.size());
    if (const Json* kind = find(all[i], "kind"))
      if (const auto index =
              read_name(*kind, here.at("kind"), Names(Pictures::kinds.begin(), Pictures::kinds.end()), "kind"))
        body.kind = *index;
  }
  return pictures;
}

void check_pictures(const Pictures& pictures, const FieldPath& path, const Scene& scene) {
  if (pictures.empty()) return;
  MeasureReader reader(scene);
  const auto check = [&](const std::vector<std::string>& place, const FieldPath& at, bool many) {
    for (std::size_t k = 0; k < place.size() && !path.faults->full(); ++k)
      check_entry(place[k], at.at(k), scene.card(), reader, many);
  };
  for (std::size_t i = 0; i < pictures.views.size(); ++i) check(pictures.views[i], path.at("views").at(i), true);
  for (std::size_t i = 0; i < pictures.bodies.size(); ++i)
    check(pictures.bodies[i].at, path.at("bodies").at(i).at("at"), false);
}

}  // namespace least::server
