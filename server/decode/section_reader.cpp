#include "server/decode/section_reader.hpp"

#include <algorithm>
#include <cmath>

#include "core/run/save_schedule.hpp"

namespace least::server {
namespace {

// `r`, `r - 0.5` or `r + 2`: a variable, or one minus a number.
bool read_expression(const Json& json, const FieldPath& path, const ProblemCard& problem, Section& section) {
  Names names;
  for (const auto& variable : problem.variables) {
    if (!variable.optional && !variable.hidden) names.push_back(variable.name);
  }
  const std::string allowed =
      listed(names) + ", or one of them minus a number: \"" + std::string(names[0]) + " - 0.5\"";
  if (!json.is_string()) {
    path.fault("must be a string", json, allowed);
    return false;
  }
  std::string text = json.get<std::string>();
  std::erase(text, ' ');
  const std::size_t sign = text.find_first_of("+-", 1);
  const std::string name = text.substr(0, sign);
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) {
    path.fault("must begin with a variable" + did_you_mean(name, names), json, allowed);
    return false;
  }
  const auto at = std::ranges::find(problem.variables, name, &VariableCard::name);
  section.variable = static_cast<std::size_t>(at - problem.variables.begin());
  if (sign == std::string::npos) return true;
  const Json level = Json::parse(text.substr(sign + 1), nullptr, false);
  if (!level.is_number() || !std::isfinite(level.get<double>())) {
    path.fault("only a number may stand after the variable, for now", json, allowed);
    return false;
  }
  section.level = (text[sign] == '-' ? 1 : -1) * level.get<double>();
  return true;
}

}  // namespace

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
  if (!read_object(*json, path, keys, "a section")) return;
  const Json *period = find(*json, "period"), *expression = find(*json, "expression");
  if ((period == nullptr) == (expression == nullptr)) {
    path.fault("must hold either period or expression", *json, shape);
    return;
  }
  section.plane = expression != nullptr;
  if (section.plane) {
    if (find(*json, "phase")) path.at("phase").fault("goes with period", (*json)["phase"]);
    if (!read_expression(*expression, path.at("expression"), problem, section)) return;
    if (const Json* direction = find(*json, "direction")) {
      constexpr int signs[] = {1, -1, 0};
      const auto way = read_name(*direction, path.at("direction"), {"up", "down", "both"}, "direction");
      section.direction = signs[way.value_or(2)];
    }
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
