#include "server/decode/section_reader.hpp"

#include <algorithm>
#include <cmath>

#include "core/catalogue/backward.hpp"
#include "core/run/save_schedule.hpp"
#include "server/decode/columns_reader.hpp"

namespace least::server {
namespace {

// read_period reads the period, and the phase, a time of the request that is converted to the run's forward time.
void read_period(const Json& json, const FieldPath& path, const SchemeCard* scheme, Request& request,
                 Section& section) {
  if (find(json, "direction")) path.at("direction").fault("goes with expression", json["direction"]);
  section.period = read_number(json["period"], path.at("period"), positive).value_or(1);
  if (const Json* phase = find(json, "phase")) {
    const double told = read_number(*phase, path.at("phase"), anywhere).value_or(0);
    section.phase = goes_backward(*request.scene) ? 0 - told : told;
  }
  const double start = request.scene->start;
  const auto step = scheme && !scheme->own_clock ? scheme->find("step") : std::nullopt;
  const double end = !request.until_steps                      ? request.end
                     : step && request.settings.size() > *step ? Grid(request, request.settings[*step]).end
                                                               : start;
  if (section.period > 0 && !((end - start) / section.period <= 1e9)) {
    path.at("period").fault("a run would meet it more than 1e9 times", json["period"]);
  } else if (!(std::abs(start - section.phase) / section.period <= 1e15)) {
    path.at("phase").fault("lies too many periods from the start for a double to tell them apart",
                           find(json, "phase") ? json["phase"] : Json(0));
  }
}

}  // namespace

void read_section(const Json& root, const FieldPath& top, const SchemeCard* scheme, Request& request) {
  const Json* json = find(root, "section");
  const FieldPath path = top.at("section");
  if (json == nullptr) return;
  Section section;
  Names keys(std::begin(names_of_a_section), std::end(names_of_a_section));
  const std::size_t known = request.scene->card().columns.size() + request.measures.size();
  for (const std::size_t place : request.section_columns()) {
    if (place >= known) continue;  // a column that was refused
    const std::string_view name = request.column(place).name;
    if (std::ranges::find(names_of_a_section, name) != std::end(names_of_a_section))
      path.lacks(std::string(name) + " is a column here, and what a section of an answer calls something else");
    keys.push_back(name);
  }
  if (!read_object(*json, path, keys, "a section")) return;
  section.plane = find(*json, "expression") != nullptr;
  if (section.plane == (find(*json, "period") != nullptr)) {
    path.fault("must hold either period or expression", *json, std::string(section_shape));
    return;
  }
  if (section.plane) {
    if (find(*json, "phase")) path.at("phase").fault("goes with period", (*json)["phase"]);
    const EventAsked asked{read_way(*json, path)};
    MeasureReader reader(*request.scene);
    read_expression(*json, path, "section", reader);
    request.watched = reader.made();
    request.events = {asked};
  } else {
    read_period(*json, path, scheme, request, section);
  }
  request.section = section;
}

}  // namespace least::server
