#include "server/decode/ensemble_request.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "server/decode/members_reader.hpp"
#include "server/decode/plan_reader.hpp"
#include "server/decode/scene_files.hpp"
#include "server/decode/scene_reader.hpp"
#include "server/decode/section_reader.hpp"

namespace least::server {
namespace {

constexpr std::int64_t most_bins = 100'000;

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

// read_keep returns whether points of a section are kept.
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

// read_plane_of_all checks the section in any case, and drops it where it is not kept.
void read_plane_of_all(const Json& root, const FieldPath& top, const SchemeCard* scheme, bool kept, Request& request) {
  read_section(root, top, scheme, request);
  if (kept && find(root, "section") == nullptr)
    top.at("section").lacks("is required where sections are kept", std::string(section_shape));
  if (kept) return;
  request.section.reset();
  request.watched = {};
  request.events.clear();
}

// check_trajectories notes, in a request without faults, whether the rows of all members exceed the limit of samples.
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

// How a column is to be counted, without the column; nothing after noting what is wrong.
std::optional<HistogramAsked> read_histogram(const Json& entry, const FieldPath& place) {
  if (!read_object(entry, place, {"range", "bins", "counts", "below", "above"}, "a histogram")) return std::nullopt;
  const Json *range = find(entry, "range"), *bins = find(entry, "bins");
  if (range == nullptr || bins == nullptr)
    place.fault("must hold range and bins", entry, "{\"range\": [low, high], \"bins\": 50}");
  HistogramAsked asked;
  if (bins) asked.bins = read_integer(*bins, place.at("bins"), 1, most_bins).value_or(1);
  if (range == nullptr) return std::nullopt;
  const FieldPath ends = place.at("range");
  const auto numbers = range->is_array() ? read_list(*range, ends, anywhere) : std::vector<double>();
  if (ends.faults->within(ends.pointer)) return std::nullopt;
  if (numbers.size() != 2 || !(numbers[0] < numbers[1])) {
    ends.fault("must be two numbers, the lower first", *range, "[low, high]");
  } else if (!std::isfinite(numbers[1] - numbers[0])) {
    ends.fault("is wider than a double can say", *range);
  } else {
    asked.low = numbers[0];
    asked.high = numbers[1];
  }
  if (place.faults->within(place.pointer)) return std::nullopt;
  return asked;
}

void read_histograms(const Json& root, const FieldPath& top, EnsemblePlan& plan) {
  const Json* json = find(root, "histograms");
  if (json == nullptr) return;
  const FieldPath path = top.at("histograms");
  const bool refused = top.faults->within("/columns");  // then a name may refer to a column that was refused
  Names columns;
  if (plan.request.scene->mechanics) {
    const std::size_t cards = plan.request.scene->card().columns.size() + plan.request.measures.size();
    for (const auto column : plan.request.columns)
      columns.push_back(column < cards ? std::string_view(plan.request.column(column).name) : std::string_view());
  }
  const bool known = plan.request.scene->mechanics && !refused;  // what columns there are
  if (known && !read_object(*json, path, columns, "histograms, which are of the columns")) return;
  if (!json->is_object()) return path.fault("must be an object", *json, "{\"x\": {\"range\": …, \"bins\": …}}");
  for (const auto& [name, entry] : json->items()) {
    auto asked = read_histogram(entry, path.at(name));
    const auto column = std::ranges::find(columns, name);
    if (!asked || column == columns.end() || column->empty()) continue;
    asked->column = static_cast<std::size_t>(column - columns.begin());
    plan.histograms.push_back(*asked);
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

// Schemes that members cannot have are known too, so that they are refused with a specific message.
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
  const PresetCard* preset = card ? read_scene(root, top, *scene, &plan.members.velocities) : nullptr;
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
  if (card && plan.members.vary.empty()) check_start(root, top, *scene);
  read_range(root, top, plan);
  const bool keeps_section = read_keep(root, top, plan);
  check_finals(root, top, plan);
  if (card) {
    check_columns(root, top, *card);
    read_plane_of_all(root, top, scheme_card, keeps_section, request);
  }
  read_histograms(root, top, plan);
  if (faults.empty()) check_trajectories(root, top, plan);
  if (!faults.empty()) return faults;
  return plan;
}

}  // namespace least::server
