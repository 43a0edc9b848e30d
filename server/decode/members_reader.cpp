#include "server/decode/members_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/text/scene.hpp"
#include "server/decode/scene_reader.hpp"
#include "server/decode/sensitivities_reader.hpp"

namespace least::server {
namespace {

constexpr double most_grid = 1e12;

// Variable is what a variation may change, by its pointer.
struct Variable {
  std::string pointer;
  Varied of = Varied::variable;
  std::size_t index = 0;
  Range range;
};
// If members share the start's velocities, these can vary, and momenta cannot.
std::vector<Variable> variables_of(const Scene& scene, bool holds_velocities) {
  const ProblemCard& problem = scene.card();
  const text::TextScene* const text = scene.mechanics->text();
  std::vector<Variable> all;
  for (std::size_t i = 0; i < problem.variables.size(); ++i) {
    const auto& variable = problem.variables[i];
    if (variable.hidden) continue;
    const std::size_t coordinate = holds_velocities ? i - static_cast<std::size_t>(text->capacity) : i;
    if (holds_velocities && coordinate < text->definition.variables.size())
      all.push_back({"/initial/" + text::velocity_name(text->definition.variables[coordinate]), Varied::velocity,
                     coordinate, anywhere});
    else
      all.push_back({"/initial/" + variable.name, Varied::variable, i, variable.range});
  }
  for (std::size_t i = 0; i < problem.parameters.size(); ++i) {
    if (problem.parameters[i].kind != Kind::number) continue;
    all.push_back({"/problem/" + problem.parameters[i].name, Varied::parameter, i, problem.parameters[i].range});
  }
  return all;
}

// why_fixed says why something that a client may have meant cannot vary, with a specific message for each case.
std::string why_fixed(std::string_view pointer, const Scene& scene, bool holds_velocities) {
  const ProblemCard& problem = scene.card();
  if (const text::TextScene* const text = scene.mechanics->text(); text && text->takes_velocities())
    for (const std::string& name : text->definition.variables) {
      const std::string p = text::momentum_name(name), v = text::velocity_name(name);
      if (holds_velocities && pointer == "/initial/" + p)
        return "is a momentum, and members have velocities in common: vary " + v + ", or say \"holds\": \"momenta\"";
      if (!holds_velocities && pointer == "/initial/" + v)
        return "is a velocity, and members have momenta in common: vary " + p + ", or say \"holds\": \"velocities\"";
    }
  if (pointer.starts_with("/scheme")) return "the scheme and its settings are the same for all members";
  if (pointer == "/initial/t") return "all members start at the same time";
  for (const auto& parameter : problem.parameters) {
    if (pointer == "/problem/" + parameter.name) return parameter.name + " is no number, and the same for all members";
  }
  return {};
}

constexpr std::string_view shapes[] = {"{\"grid\": [first, last, how many]}", "{\"values\": [x1, x2, …]}",
                                       "{\"uniform\": [from, to]}", "{\"normal\": [mean, deviation]}",
                                       "{\"logistic\": [mean, scale]}"};

// read_numbers reads the numbers of a variation. False: a fault was noted.
bool read_numbers(const Json& json, const FieldPath& path, const Range& range, Variation& variation) {
  const std::string shape(shapes[static_cast<std::size_t>(variation.spread)]);
  const std::size_t wanted = variation.spread == Spread::values ? json.size()
                             : variation.spread == Spread::grid ? 3
                                                                : 2;
  if (!json.is_array() || json.empty() || json.size() != wanted) {
    path.fault("must be a list of numbers: " + shape, json, shape);
    return false;
  }
  const bool within = variation.spread == Spread::values || variation.spread == Spread::uniform;
  variation.numbers = read_list(json, path, within ? range : anywhere);
  if (variation.spread != Spread::grid && variation.numbers.size() != json.size()) return false;
  const auto& n = variation.numbers;
  switch (variation.spread) {
    case Spread::values:
      return true;
    case Spread::uniform:
      if (n[0] < n[1]) return true;
      path.fault(fmt::format("goes the wrong way: from {} to {}", shortest(n[0]), shortest(n[1])), json, shape);
      return false;
    case Spread::grid:
      for (const std::size_t end : {0U, 1U}) read_number(json[end], path.at(end), range);
      read_whole(json[2], path.at(2), {1, most_grid});
      if (path.faults->within(path.pointer)) return false;
      if (n[2] == 1 ? n[0] <= n[1] : n[0] < n[1]) return true;
      path.fault(fmt::format("goes the wrong way: from {} to {}", shortest(n[0]), shortest(n[1])), json, shape);
      return false;
    case Spread::normal:
    case Spread::logistic:
      if (!read_number(json[1], path.at(1), positive)) return false;
      if (!std::isfinite(range.low) && !std::isfinite(range.high)) return true;
      path.fault("reaches any number, and here only " + interval(range) + " is allowed: take uniform, grid or values",
                 json, interval(range));
      return false;
  }
  return false;
}

void read_vary(const Json& json, const FieldPath& path, const Scene& scene, Members& members) {
  if (!json.is_object()) {
    path.fault("must be an object of pointers and how they vary", json, "{\"/initial/q\": {\"uniform\": [-1, 1]}, …}");
    return;
  }
  const auto variables = variables_of(scene, members.holds_velocities);
  Names pointers;
  for (const auto& variable : variables) pointers.push_back(variable.pointer);
  for (const auto& [pointer, how] : json.items()) {
    if (path.faults->full()) return;
    const FieldPath place = path.at(pointer);
    const std::string one_way = pointer_in_one_way(pointer);
    const auto found = std::ranges::find(variables, one_way, &Variable::pointer);
    if (found == variables.end()) {
      const std::string fixed = why_fixed(one_way, scene, members.holds_velocities);
      place.fault(!fixed.empty() ? fixed : "names nothing that can vary" + did_you_mean(pointer, pointers), how,
                  listed(pointers));
      continue;
    }
    if (std::ranges::any_of(members.vary, [&](const Variation& other) {
          return other.of == found->of && other.index == found->index;
        })) {
      place.fault("varies what varies already", how, "each number once");
      continue;
    }
    if (!how.is_object() || how.size() != 1) {
      place.fault("must say in one way how it varies", how, fmt::format("{}", fmt::join(shapes, " or ")));
      continue;
    }
    const std::string& spread = how.begin().key();
    const auto kind = read_name(spread, place.at(spread), Names(spread_names.begin(), spread_names.end()), "variation");
    if (!kind) continue;
    Variation variation{found->of, found->index, static_cast<Spread>(*kind), {}};
    if (read_numbers(how.begin().value(), place.at(spread), found->range, variation)) {
      members.vary.push_back(std::move(variation));
    }
  }
}

// velocities_in_common tells whether members share the start's velocities, not its momenta: as the request says, else
// as the varied quantities require, else as the start is given.
bool velocities_in_common(const Json& root, const Json& members, const FieldPath& path, const Scene& scene,
                          const Json* vary) {
  const text::TextScene* const text = scene.mechanics->text();
  if (text && text->takes_velocities() && vary && vary->is_object() && !find(members, "holds")) {
    std::set<std::string> pointers;
    for (const auto& entry : vary->items()) pointers.insert(pointer_in_one_way(entry.key()));
    for (const auto& name : text->definition.variables)
      for (const bool velocities : {false, true})
        if (pointers.contains("/initial/" + (velocities ? text::velocity_name(name) : text::momentum_name(name))))
          return velocities;
  }
  return holds_velocities(root, members, path, text);
}

}  // namespace

std::vector<double> read_list(const Json& json, const FieldPath& path, const Range& range) {
  std::vector<double> numbers;
  for (std::size_t i = 0; i < json.size() && !path.faults->full(); ++i) {
    if (const auto x = read_number(json[i], path.at(i), range)) numbers.push_back(*x);
  }
  return numbers;
}

void read_members(const Json& root, const FieldPath& top, const Scene* scene, EnsemblePlan& plan) {
  const Json* json = find(root, "members");
  const FieldPath path = top.at("members");
  const std::string shape = "{\"count\": …, \"seed\": …, \"vary\": {…}, \"holds\": …}";
  if (json == nullptr) {
    path.lacks("is required", shape);
    return;
  }
  if (!read_object(*json, path, {"count", "seed", "vary", "holds"}, "members")) return;
  Members& members = plan.members;
  if (const Json* seed = find(*json, "seed")) {
    members.seed = static_cast<std::uint64_t>(read_integer(*seed, path.at("seed"), 0, greatest_count).value_or(0));
  }
  const Json* vary = find(*json, "vary");
  if (scene != nullptr) members.holds_velocities = velocities_in_common(root, *json, path, *scene, vary);
  // `holds` is faulty, so that it is unknown what may vary, and how many members there are
  const bool unclear = path.faults->within(path.at("holds").pointer);
  if (vary != nullptr && scene != nullptr && !unclear) read_vary(*vary, path.at("vary"), *scene, members);
  const Json* count = find(*json, "count");
  if (count != nullptr) members.count = read_integer(*count, path.at("count"), 1, greatest_count).value_or(1);
  if (unclear || path.faults->within(path.at("vary").pointer)) return;
  double product = 1;
  bool listed_values = false, drawn = false;
  for (const Variation& variation : members.vary) {
    drawn = drawn || variation.drawn();
    if (variation.drawn()) continue;
    listed_values = true;
    product *= static_cast<double>(variation.size());
  }
  if (product > static_cast<double>(greatest_count)) {
    path.at("vary").lacks(fmt::format("the grids make {} members, more than can be counted", shortest(product)));
    return;
  }
  if (count == nullptr) {
    if (!listed_values) path.at("count").lacks("is required where no grid and no values make it", "[1, 2^53]");
    members.count = static_cast<std::int64_t>(product);
    return;
  }
  if (path.faults->within(path.at("count").pointer)) return;
  // Further members repeat the product, each with draws of its own.
  const auto given = static_cast<double>(members.count);
  if (listed_values && given != product && !(drawn && given > product)) {
    path.at("count").fault(fmt::format("grids and values make {} members", shortest(product)), *count,
                           drawn ? shortest(product) + " or more" : shortest(product));
  }
}

}  // namespace least::server
