#include "server/decode/section_reader.hpp"

#include <cmath>

#include "core/run/save_schedule.hpp"
#include "server/decode/columns_reader.hpp"

namespace least::server {

void read_section(const Json& root, const FieldPath& top, const ProblemCard& problem, const SchemeCard* scheme,
                  EnsemblePlan& plan) {
  const Json* json = find(root, "section");
  const FieldPath path = top.at("section");
  const std::string shape = "{\"period\": …, \"phase\": …}, {\"expression\": …, \"direction\": …}";
  if (json == nullptr) {
    if (plan.section) path.lacks("is required where sections are kept", shape);
    return;
  }
  Section section;
  Names keys{"period", "phase", "expression", "direction", "member", "crossing"};  // the last two: of an answer
  for (const auto& column : problem.columns) keys.push_back(column.name);
  for (const auto& own : plan.request.measures.list) keys.push_back(own.card.name);
  if (!read_object(*json, path, keys, "a section")) return;
  const Json *period = find(*json, "period"), *expression = find(*json, "expression");
  if ((period == nullptr) == (expression == nullptr)) {
    path.fault("must hold either period or expression", *json, shape);
    return;
  }
  section.plane = expression != nullptr;
  if (section.plane) {
    if (find(*json, "phase")) path.at("phase").fault("goes with period", (*json)["phase"]);
    EventAsked asked;
    if (const Json* direction = find(*json, "direction")) {
      constexpr int signs[] = {1, -1, 0};
      const auto way = read_name(*direction, path.at("direction"),
                                 Names(event_directions.begin(), event_directions.end()), "direction");
      asked.direction = signs[way.value_or(2)];
    }
    MeasureReader reader(*plan.request.scene);
    read_expression(*json, path, "section", reader);
    if (!plan.section) return;
    plan.request.watched = reader.made();
    plan.request.events = {asked};
  } else {
    if (find(*json, "direction")) path.at("direction").fault("goes with expression", (*json)["direction"]);
    section.period = read_number(*period, path.at("period"), {0, anywhere.high, true, true}).value_or(1);
    if (const Json* phase = find(*json, "phase")) {
      section.phase = read_number(*phase, path.at("phase"), anywhere).value_or(0);
    }
    const double start = plan.request.scene->start;
    const auto step = scheme ? scheme->find("step") : std::nullopt;
    const double end = !plan.request.until_steps ? plan.request.end
                       : step                    ? Grid(plan.request, plan.request.settings[*step]).end
                                                 : start;
    if (section.period > 0 && !((end - start) / section.period <= 1e9)) {
      path.at("period").fault("a member would meet it more than 1e9 times", *period);
    } else if (!(std::abs(start - section.phase) / section.period <= 1e15)) {
      path.at("phase").fault("lies too many periods from the start for a double to tell them apart",
                             Json(section.phase));
    }
  }
  if (plan.section) plan.section = section;
}

}  // namespace least::server
