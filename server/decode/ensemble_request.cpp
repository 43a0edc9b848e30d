#include "server/decode/ensemble_request.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text/scene.hpp"
#include "server/decode/plan_reader.hpp"
#include "server/decode/scene_files.hpp"
#include "server/decode/scene_reader.hpp"
#include "server/decode/section_reader.hpp"

namespace least::server {
namespace {

constexpr double most_grid = 1e12;
constexpr std::int64_t most_bins = 100'000;

// What a variation may change, by its pointer.
struct Variable {
  std::string pointer;
  Varied of = Varied::variable;
  std::size_t index = 0;
  Range range;
};
// Of a start in velocities, which members have in common, these and not the momenta.
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

// What a client may have meant that members cannot have: each in words of its own.
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

std::vector<double> read_list(const Json& json, const FieldPath& path, const Range& range) {
  std::vector<double> numbers;
  for (std::size_t i = 0; i < json.size() && !path.faults->full(); ++i) {
    if (const auto x = read_number(json[i], path.at(i), range)) numbers.push_back(*x);
  }
  return numbers;
}

// False: a fault was noted.
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
  if (variation.numbers.size() != json.size()) return false;
  const auto& n = variation.numbers;
  switch (variation.spread) {
    case Spread::values:
      return true;
    case Spread::uniform:
      if (n[0] < n[1]) return true;
      path.fault(fmt::format("goes the wrong way: from {} to {}", shortest(n[0]), shortest(n[1])), json, shape);
      return false;
    case Spread::grid:
      if (!read_number(json[0], path.at(0), range) || !read_number(json[1], path.at(1), range)) return false;
      if (!read_whole(json[2], path.at(2), {1, most_grid})) return false;
      if (n[2] == 1 ? n[0] <= n[1] : n[0] < n[1]) return true;
      path.fault(fmt::format("goes the wrong way: from {} to {}", shortest(n[0]), shortest(n[1])), json, shape);
      return false;
    case Spread::normal:
    case Spread::logistic:
      if (!read_number(json[1], path.at(1), {0, anywhere.high, true, true})) return false;
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
    const auto found = std::ranges::find(variables, pointer, &Variable::pointer);
    if (found == variables.end()) {
      const std::string fixed = why_fixed(pointer, scene, members.holds_velocities);
      place.fault(!fixed.empty() ? fixed : "names nothing that can vary" + did_you_mean(pointer, pointers), how,
                  listed(pointers));
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

// Whether members have the velocities of the start in common, and not its momenta: as is said, or as what varies needs
// it, or as the start says.
bool velocities_in_common(const Json& root, const Json& members, const FieldPath& path, const Scene& scene,
                          const Json* vary) {
  const text::TextScene* const text = scene.mechanics->text();
  if (text && text->takes_velocities() && vary && vary->is_object() && !find(members, "holds"))
    for (const auto& name : text->definition.variables)
      for (const bool velocities : {false, true})
        if (find(*vary, "/initial/" + (velocities ? text::velocity_name(name) : text::momentum_name(name))))
          return velocities;
  return holds_velocities(root, members, path, text);
}

// `scene`: null where what it is of is not known.
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
  if (vary != nullptr && scene != nullptr) read_vary(*vary, path.at("vary"), *scene, members);
  const Json* count = find(*json, "count");
  if (count != nullptr) members.count = read_integer(*count, path.at("count"), 1, greatest_count).value_or(1);
  if (path.faults->within(path.at("vary").pointer)) return;
  double product = 1;
  bool listed_values = false;
  for (const Variation& variation : members.vary) {
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
  if (listed_values && static_cast<double>(members.count) != product) {
    path.at("count").fault(fmt::format("grids and values make {} members", shortest(product)), *count,
                           shortest(product));
  }
}

void read_range(const Json& root, const FieldPath& top, EnsemblePlan& plan) {
  plan.first = 0;
  plan.last = plan.members.count;
  const Json* json = find(root, "range");
  if (json == nullptr) return;
  const FieldPath path = top.at("range");
  const std::string allowed = fmt::format("[first, last], 0 <= first < last <= {}", plan.members.count);
  if (!json->is_array() || json->size() != 2) {
    path.fault("must be the first member and the one after the last", *json, allowed);
    return;
  }
  const auto first = read_integer((*json)[0], path.at(0), 0, greatest_count);
  const auto last = read_integer((*json)[1], path.at(1), 0, greatest_count);
  if (!first || !last) return;
  if (!(*first < *last && *last <= plan.members.count)) {
    path.fault(fmt::format("is none of members 0 to {}", plan.members.count), *json, allowed);
    return;
  }
  plan.first = *first;
  plan.last = *last;
}

// Whether points of a section are kept.
bool read_keep(const Json& root, const FieldPath& top, EnsemblePlan& plan) {
  const Json* json = find(root, "keep");
  if (json == nullptr) return false;
  const Names parts{"statistics", "final", "section", "trajectories"};
  const auto kept = read_names(*json, top.at("keep"), parts, "part");
  const auto keeps = [&](std::size_t what) { return std::ranges::find(kept, what) != kept.end(); };
  if (json->is_array() && json->empty()) top.at("keep").fault("must keep something", *json, listed(parts));
  plan.statistics = keeps(0);
  plan.final = keeps(1);
  plan.trajectories = keeps(3);
  return keeps(2);
}

// What stands there is looked at in every case.
void read_plane_of_all(const Json& root, const FieldPath& top, const SchemeCard* scheme, bool kept, Request& request) {
  read_section(root, top, scheme, request);
  if (kept && find(root, "section") == nullptr)
    top.at("section").lacks("is required where sections are kept", std::string(section_shape));
  if (kept) return;
  request.section.reset();
  request.watched = {};
  request.events.clear();
}

// Of a request without fault: whether as many rows of all members as it records have room.
void check_trajectories(const Json& root, const FieldPath& top, const EnsemblePlan& plan) {
  if (!plan.trajectories) return;
  const Record& record = plan.request.record;
  const FieldPath path = top.at("record");
  constexpr const char* rows_asked = "{\"every\": …}, {\"samples\": …}, {\"times\": […]}";
  if (record.mode == Record::Mode::curve)
    return path.at("curve").fault("looks at every member at times of its own, and members have theirs in common",
                                  root["record"]["curve"], rows_asked);
  const std::int64_t members = plan.last - plan.first, rows = static_cast<std::int64_t>(row_count(plan));
  if (rows == 0) return path.fault("keeps no row of the trajectories that are to be kept", root["record"], rows_asked);
  const std::int64_t most = plan.request.most_rows();
  if (members <= most / rows) return;
  const std::string allowed = rows <= most ? fmt::format("{} members with so many rows each", most / rows)
                                           : fmt::format("{} rows of one member", most);
  path.lacks(fmt::format("would keep {} trajectories of {} rows of {} columns, more numbers than limits.samples = {}; "
                         "record fewer rows, or take a range of members",
                         members, rows, plan.request.columns.size(), plan.request.limits.samples),
             allowed);
}

void check_finals(const Json& root, const FieldPath& top, const EnsemblePlan& plan) {
  const std::int64_t count = plan.last - plan.first, most = plan.request.most_rows();
  if (!plan.final || count <= most) return;
  top.at("keep").fault(
      fmt::format("would keep {} final states of {} columns, more numbers than limits.samples = {}; take a range of "
                  "members, or their statistics and histograms",
                  count, plan.request.columns.size(), plan.request.limits.samples),
      root["keep"], "statistics, section");
}

void read_histograms(const Json& root, const FieldPath& top, EnsemblePlan& plan) {
  const Json* json = find(root, "histograms");
  if (json == nullptr) return;
  const FieldPath path = top.at("histograms");
  const bool refused = top.faults->within("/columns");  // then a name may be that of a column which has no card
  const std::size_t cards = plan.request.scene->card().columns.size() + plan.request.measures.size();
  Names columns;
  for (const auto column : plan.request.columns)
    columns.push_back(column < cards ? std::string_view(plan.request.column(column).name) : std::string_view());
  if (refused ? !json->is_object() : !read_object(*json, path, columns, "histograms, which are of the columns")) return;
  for (const auto& [name, entry] : json->items()) {
    const auto column = std::ranges::find(columns, name);
    const FieldPath place = path.at(name);
    const bool known = column != columns.end() && !column->empty();
    if (!known && !refused) continue;
    if (!read_object(entry, place, {"range", "bins", "counts", "below", "above"}, "a histogram")) continue;
    const Json *range = find(entry, "range"), *bins = find(entry, "bins");
    if (range == nullptr || bins == nullptr) {
      place.fault("must hold range and bins", entry, "{\"range\": [low, high], \"bins\": 50}");
      continue;
    }
    HistogramAsked asked;
    asked.column = static_cast<std::size_t>(column - columns.begin());
    const auto numbers = range->is_array() ? read_list(*range, place.at("range"), anywhere) : std::vector<double>();
    if (!range->is_array() || numbers.size() != 2 || !(numbers[0] < numbers[1])) {
      if (!place.faults->within(place.at("range").pointer)) {
        place.at("range").fault("must be two numbers, the lower first", *range, "[low, high]");
      }
      continue;
    }
    asked.low = numbers[0];
    asked.high = numbers[1];
    if (!std::isfinite(asked.high - asked.low)) {
      place.at("range").fault("is wider than a double can say", *range);
      continue;
    }
    asked.bins = read_integer(*bins, place.at("bins"), 1, most_bins).value_or(1);
    if (known) plan.histograms.push_back(asked);
  }
}

void check_columns(const Json& root, const FieldPath& top, const ProblemCard& problem) {
  const Json* json = find(root, "columns");
  if (json == nullptr || !json->is_array()) return;
  Names fitting;
  for (const auto& column : problem.columns) {
    if (is_of_state(column)) fitting.push_back(column.name);
  }
  for (std::size_t i = 0; i < json->size() && !top.faults->full(); ++i) {
    const Json& name = (*json)[i];
    const auto column =
        std::ranges::find(problem.columns, name.is_string() ? name.get<std::string>() : "", &ColumnCard::name);
    if (column == problem.columns.end() || is_of_state(*column)) continue;
    top.at("columns").at(i).fault("does not follow from a final state alone", name, listed(fitting));
  }
}

// A scheme that members cannot have is known all the same, and refused in words of its own.
NamedEntry read_scheme(const Json* json, const FieldPath& path, const Cards& cards) {
  const Json* id = json != nullptr && json->is_object() ? find(*json, "id") : json;
  if (id != nullptr && *id == auto_card().id) {
    path.fault("auto chooses for one run, and members have one scheme in common: name it", *json);
    return {std::nullopt, path};
  }
  Names names = names_of(cards.schemes);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!ensemble_objection(cards.schemes[i]).empty() && !(id != nullptr && *id == names[i])) names[i] = {};
  }
  return read_entry(json, path, "scheme", names);
}

void check_scheme(const Cards& cards, const ProblemCard& problem, std::size_t scheme, const FieldPath& path) {
  const std::string why = ensemble_objection(cards.schemes[scheme]);
  if (why.empty()) return;
  Names fitting;
  for (const auto index : problem.schemes) {
    if (ensemble_objection(cards.schemes[index]).empty()) fitting.push_back(cards.schemes[index].id);
  }
  path.fault(fmt::format("{} {}", cards.schemes[scheme].id, why), Json(cards.schemes[scheme].id), listed(fitting));
}

}  // namespace

Result<EnsemblePlan, Faults> decode_ensemble(ParsedJson body, const Cards& cards, const Caps& caps) {
  Faults faults = std::move(body.faults);
  const Json& root = body.tree;
  const FieldPath top{"", &faults};
  EnsemblePlan plan;
  Request& request = plan.request;
  if (root.is_null() && !faults.empty()) return faults;
  const Names keys{"problem", "initial", "scheme",  "until",   "record", "limits",
                   "members", "range",   "section", "columns", "keep",   "histograms"};
  if (!read_object(root, top, keys, "the request")) return faults;

  const auto problem = read_problem(root, top, cards);
  const Json* asked = find(root, "scheme");
  const NamedEntry scheme = read_scheme(asked, top.at("scheme"), cards);
  const auto scene = std::make_shared<Scene>();
  request.scene = scene;
  scene->mechanics = problem;
  const ProblemCard* card = problem ? &scene->card() : nullptr;
  const PresetCard* preset = card ? read_scene(root, top, *scene) : nullptr;
  if (card) refuse_own_events(*problem, top.at("problem"));
  const SchemeCard* scheme_card = scheme.index ? &cards.schemes[*scheme.index] : nullptr;
  if (scheme_card) {
    request.scheme = *scheme.index;
    request.settings = read_settings(*asked, top.at("scheme"), *scheme_card, scene.get(), preset);
    if (card) {
      check_pair(cards, *scene, *scheme.index, scheme.path);
      check_scheme(cards, *card, *scheme.index, scheme.path);
      check_settings(*scheme_card, *card, request.settings, top.at("scheme"));
    }
  }
  read_members(root, top, card ? scene.get() : nullptr, plan);
  read_plan(root, top, card, scheme_card, preset, caps, &plan.members, request);
  request.diagnostics.clear();
  if (card && plan.members.vary.empty()) check_start(*scene, top);
  read_range(root, top, plan);
  const bool keeps_section = read_keep(root, top, plan);
  check_finals(root, top, plan);
  if (card) {
    check_columns(root, top, *card);
    read_plane_of_all(root, top, scheme_card, keeps_section, request);
    read_histograms(root, top, plan);
  }
  if (faults.empty()) check_trajectories(root, top, plan);
  if (!faults.empty()) return faults;
  return plan;
}

}  // namespace least::server
