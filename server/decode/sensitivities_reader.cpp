#include "server/decode/sensitivities_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/catalogue/catalogue.hpp"
#include "core/text/expansion.hpp"
#include "core/text/scene.hpp"
#include "core/variations/run_events.hpp"
#include "core/variations/scheme_map.hpp"
#include "core/variations/varied_motion.hpp"
#include "server/decode/scene_reader.hpp"

namespace least::server {
namespace {

using variations::Quantity;
using variations::SensitivitiesAsked;

constexpr std::string_view shape_of_sensitivities =
    "{\"by\": [\"/initial/x\", \"/problem/mu\"] or \"initial\", \"order\": 1, \"of\": \"motion\", "
    "\"at\": \"final|samples\", \"holds\": \"momenta|velocities\"}";

// Candidate is what `by` may contain, as the answer names it.
struct Candidate {
  std::string pointer;
  Quantity quantity;
};

class ByReader {
 public:
  ByReader(const Scene& scene, bool in_velocities, bool by_time)
      : card_(scene.card()), text_(scene.mechanics->text()), in_velocities_(in_velocities) {
    for (std::size_t i = 0; i < card_.variables.size(); ++i)
      if (!card_.variables[i].hidden && !(in_velocities_ && is_momentum(i)))
        candidates_.push_back({"/initial/" + card_.variables[i].name, {Quantity::Kind::variable, i}});
    if (in_velocities_)
      for (std::size_t i = 0; i < text_->definition.variables.size(); ++i)
        candidates_.push_back(
            {"/initial/" + text::velocity_name(text_->definition.variables[i]), {Quantity::Kind::velocity, i}});
    if (by_time) candidates_.push_back({"/initial/t", {Quantity::Kind::time, 0}});
    for (std::size_t i = 0; i < card_.parameters.size(); ++i)
      if (card_.parameters[i].kind == Kind::number)
        candidates_.push_back({"/problem/" + card_.parameters[i].name, {Quantity::Kind::parameter, i}});
  }

  void read(const Json& json, const FieldPath& path, const Scene& scene, SensitivitiesAsked& asked) const {
    if (!json.is_string())
      return path.fault("must be a JSON pointer to a number of initial, or to a parameter", json, allowed());
    const auto& typed = json.get_ref<const std::string&>();
    const std::string pointer = pointer_in_one_way(typed);
    const auto found = std::ranges::find(candidates_, pointer, &Candidate::pointer);
    if (found == candidates_.end()) {
      Names pointers;
      std::string meant;
      for (const Candidate& one : candidates_) {
        pointers.push_back(one.pointer);
        if (meant.empty() && one.pointer.ends_with("/" + typed))
          meant = fmt::format("; did you mean \"{}\"?", one.pointer);
      }
      if (meant.empty()) meant = path.meant(typed, pointers);
      const std::string why = why_not(pointer);
      return path.fault(!why.empty() ? why : "names no number that derivatives can be by" + meant, json, allowed());
    }
    if (found->quantity.kind == Quantity::Kind::parameter && !std::isfinite(scene.parameters[found->quantity.index]))
      return path.fault("is no number in this request", json, allowed());
    if (std::ranges::find(asked.names, found->pointer) != asked.names.end()) return path.fault("stands twice", json);
    asked.by.push_back(found->quantity);
    asked.names.push_back(found->pointer);
  }

 private:
  bool is_momentum(std::size_t variable) const {
    const auto capacity = static_cast<std::size_t>(text_->capacity);
    return variable >= capacity && variable < 2 * capacity;
  }

  std::string why_not(const std::string& pointer) const {
    if (pointer == "/initial/t") return "moves the steps of the scheme: there is no derivative of its map by it";
    if (pointer.starts_with("/scheme")) return "is a setting of the scheme: derivatives are by starts and parameters";
    for (const ParameterCard& parameter : card_.parameters)
      if (pointer == "/problem/" + parameter.name)
        return parameter.name + (parameter.kind == Kind::integer ? " is a whole number: there is no derivative by it"
                                                                 : " is a choice: there is no derivative by it");
    if (!text_ || !text_->takes_velocities()) return {};
    for (const std::string& variable : text_->definition.variables) {
      if (in_velocities_ && pointer == "/initial/" + text::momentum_name(variable))
        return "velocities are held, and momenta follow: name " + text::velocity_name(variable) +
               ", or say \"holds\": \"momenta\"";
      if (!in_velocities_ && pointer == "/initial/" + text::velocity_name(variable))
        return "momenta are held, and velocities follow: name " + text::momentum_name(variable) +
               ", or say \"holds\": \"velocities\"";
    }
    return {};
  }

  std::string allowed() const {
    constexpr std::size_t most = 40;
    Names pointers;
    for (const Candidate& one : candidates_)
      if (pointers.size() < most) pointers.push_back(one.pointer);
    return listed(pointers) + (candidates_.size() > most ? ", …" : "");
  }

  const ProblemCard& card_;
  const text::TextScene* text_;
  bool in_velocities_;
  std::vector<Candidate> candidates_;
};

// take_whole_start differentiates by all variables of the motion, in momenta however the start is given.
void take_whole_start(const Scene& scene, SensitivitiesAsked& asked) {
  asked.whole_start = true;
  asked.keeps_velocities = false;
  for (const std::size_t place : asked.equations->variables) {
    asked.by.push_back({Quantity::Kind::variable, place});
    asked.names.push_back("/initial/" + scene.card().variables[place].name);
  }
}

// write_equations sets the equations to differentiate; false where there are none, which is a fault at `path`.
bool write_equations(const Scene& scene, bool with_action, SensitivitiesAsked& asked, const FieldPath& path,
                     const Json& json) {
  const std::vector<bool> varied = varied_parameters(asked, scene.card().parameters.size());
  try {
    auto made = variations::parametric_scene(scene, varied, with_action);
    if (auto* why = std::get_if<std::string>(&made)) {
      path.fault(std::move(*why), json);
      return false;
    }
    asked.equations = std::get<std::shared_ptr<const variations::ParametricScene>>(std::move(made));
    return true;
  } catch (const tape::TooManyOperations&) {
    path.fault("the equations of the derivatives of this scene are too long", json);
    return false;
  }
}

}  // namespace

std::string pointer_in_one_way(std::string pointer) {
  constexpr std::string_view long_way = "/problem/parameters/";
  if (pointer.starts_with(long_way)) pointer.replace(0, long_way.size(), "/problem/");
  const std::size_t last = pointer.rfind('/');
  const std::string index = last == std::string::npos ? "" : pointer.substr(last + 1);
  const bool is_index =
      !index.empty() && index.size() < 6 && std::ranges::all_of(index, [](char c) { return c >= '0' && c <= '9'; });
  if (!is_index || std::ranges::count(pointer, '/') != 3) return pointer;
  return fmt::format("{}[{}]", pointer.substr(0, last), std::stoll(index) + 1);
}

void read_sensitivities(const Json& root, const FieldPath& top, const SchemeCard* scheme, SimulateRequest& decoded) {
  const Json* json = find(root, "sensitivities");
  const FieldPath path = top.at("sensitivities");
  if (json == nullptr || !read_object(*json, path, {"by", "order", "of", "at", "holds"}, "sensitivities")) return;
  const Request& request = decoded.run;
  const Scene& scene = *request.scene;
  SensitivitiesAsked asked;
  if (const Json* order = find(*json, "order"))
    asked.order = static_cast<int>(read_integer(*order, path.at("order"), 1, 2).value_or(1));
  const bool equal_steps = scheme && !scheme->own_clock && scheme->id != auto_card().id;
  const bool acts = std::ranges::any_of(request.events, [](const EventAsked& event) { return event.act != nullptr; });
  const bool by_steps = request.record.mode == Record::Mode::every;
  if (const Json* at = find(*json, "at"))
    asked.at_samples = read_name(*at, path.at("at"), {"final", "samples"}, "place").value_or(0) == 1;
  const Json* const named = find(*json, "by");
  const bool moves_start_time =
      named && named->is_array() && std::ranges::find(*named, Json("/initial/t")) != named->end();
  // By default the scheme's own map is differentiated where it has the requested derivatives: at whole steps, and not
  // at an end that an event moves.
  const bool stops = std::ranges::any_of(request.events, &EventAsked::stop);
  asked.of_scheme =
      equal_steps && asked.order == 1 && !acts && !moves_start_time && (asked.at_samples ? by_steps : !stops);
  const Json* const of = find(*json, "of");
  if (of) {
    const Names names(variations::map_names.begin(), variations::map_names.end());
    asked.of_scheme = read_name(*of, path.at("of"), names, "map").value_or(0) == 1;
    if (asked.of_scheme && scheme && !equal_steps)
      path.at("of").fault(scheme->id + " sets its steps itself: of its own map there is no derivative", *of, "motion");
  }
  const bool known_samples = scheme && !top.faults->within("/record");
  if (known_samples && asked.at_samples && by_steps && request.record.count == 0)
    path.at("at").fault("there are no samples: record keeps none", (*json)["at"], "final");
  else if (known_samples && asked.at_samples && asked.of_scheme && !by_steps)
    path.at("at").fault("of the map of a scheme at whole steps alone", (*json)["at"],
                        "final, or record: {\"every\": …}");

  const Json* by = find(*json, "by");
  const FieldPath place = path.at("by");
  if (by == nullptr) return place.lacks("is required", std::string(shape_of_sensitivities));
  const bool whole = by->is_string() && *by == "initial";
  const text::TextScene* const text = scene.mechanics->text();
  asked.keeps_velocities = holds_velocities(root, *json, path, text, !whole);
  const ByReader reader(scene, asked.keeps_velocities, !asked.of_scheme);
  if (by->is_array() && !by->empty()) {
    if (by->size() > variations::most_quantities)
      return place.fault(fmt::format("holds {} pointers", by->size()), *by,
                         fmt::format("{} at most", variations::most_quantities));
    for (std::size_t i = 0; i < by->size(); ++i) reader.read((*by)[i], place.at(i), scene, asked);
  } else if (!whole) {
    place.fault("must be a list of JSON pointers, or \"initial\"", *by, std::string(shape_of_sensitivities));
  }
  if (acts && asked.of_scheme)
    path.fault("of the map of a scheme know no events that act", *json, "\"of\": \"motion\"");
  if (!top.faults->empty()) return;

  // Of the scheme's map, times of events are not differentiated
  const bool events_need_action = variations::events_read_action(request);
  if (!write_equations(scene, !asked.of_scheme && events_need_action, asked, path, *json)) return;
  if (asked.of_scheme) {
    std::string why = variations::no_walk(scene, *scheme, *asked.equations, asked.by);
    if (of && !why.empty()) return path.at("of").fault(std::move(why), *of, "motion");
    asked.of_scheme = why.empty();
    if (!asked.of_scheme && events_need_action && !write_equations(scene, true, asked, path, *json)) return;
  }
  if (whole) take_whole_start(scene, asked);
  if (asked.order == 2) {
    if (asked.of_scheme)
      return path.at("order").fault("of the map of a scheme there are no second derivatives", (*json)["order"],
                                    "1, or \"of\": \"motion\"");
    if (switches(*asked.equations))
      return path.at("order").fault("the equations switch sides: there are no second derivatives", (*json)["order"],
                                    "1");
    if (asked.by.size() > variations::most_in_pairs)
      return place.fault(fmt::format("second derivatives by {} numbers are too many", asked.by.size()), *by,
                         fmt::format("{} at most", variations::most_in_pairs));
    for (std::size_t i = 0; i < asked.by.size(); ++i)
      if (asked.by[i].kind == Quantity::Kind::time)
        return place.at(i).fault("there is no second derivative by /initial/t", (*by)[i], "order 1, or others");
  }
  if (asked.by.size() > variations::most_quantities)
    return place.fault(fmt::format("the motion has {} variables", asked.by.size()), *by,
                       fmt::format("{} at most: name some", variations::most_quantities));
  decoded.sensitivities = std::make_shared<const SensitivitiesAsked>(std::move(asked));
}

}  // namespace least::server
