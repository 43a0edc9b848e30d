#include "core/catalogue/backward.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/catalogue/custom.hpp"
#include "core/catalogue/recorded.hpp"
#include "core/run/columns.hpp"
#include "core/run/request.hpp"
#include "core/text/scene.hpp"

namespace least {
namespace {

/// −x, and 0 for 0.
double opposite(double x) { return 0 - x; }

const VariableCard* find_variable(const ProblemCard& card, std::string_view name) {
  const auto found = std::ranges::find(card.variables, name, &VariableCard::name);
  return found == card.variables.end() ? nullptr : &*found;
}

/// turn changes the signs of times, rates by time and variables in a report and its parts. The diagnostic `orbit` also
/// derives the sense of the motion, and in a plane the sign of the angular momentum, from the reversed momenta.
void turn(const Scene& scene, Report& report, std::string_view within = {}) {
  const bool in_a_plane = scene.mechanics->text()->form->coordinates == 2;
  const bool of_sense = report.key == "apsidal_rotation" || (report.key == "angular_momentum" && in_a_plane);
  if (auto* number = std::get_if<double>(&report.value);
      number && (sign_of(scene, report.key) < 0 || (within == "orbit" && of_sense)))
    *number = opposite(*number);
  if (auto* parts = std::get_if<std::vector<Report>>(&report.value))
    for (Report& part : *parts) turn(scene, part, report.key);
}

}  // namespace

std::variant<Scene, std::string> backward(const Scene& scene) {
  text::TextScene text;
  if (const text::TextScene* typed = scene.mechanics->text()) {
    text::Definition definition = typed->definition;
    definition.backward = true;
    auto read = text::TextScene::read(std::move(definition));
    if (auto* faults = std::get_if<std::vector<text::DefinitionFault>>(&read)) return faults->front().fault.detail;
    text = std::get<text::TextScene>(std::move(read));
    if (typed->known) text.known = scene.card();
  } else {
    auto recorded = recorded_text(scene.card(), scene.parameters, true);
    if (!recorded) return "this problem runs forward in time alone";
    text = std::move(*recorded);
    text.definition.title = "backward:" + scene.key();
    text.known = scene.card();
  }
  text.forward = std::make_shared<const Scene>(scene);
  const ProblemCard& known = scene.card();
  auto made = mechanics_of(std::move(text));
  if (auto* faults = std::get_if<std::vector<text::DefinitionFault>>(&made)) return faults->front().fault.detail;

  Scene turned{std::get<std::shared_ptr<const Mechanics>>(made), scene.parameters, {}, opposite(scene.start)};
  const text::TextScene& layout = *turned.mechanics->text();
  const auto& variables = turned.card().variables;
  for (std::size_t i = 0; i < variables.size(); ++i) {
    const VariableCard* variable = variables[i].hidden ? nullptr : find_variable(known, variables[i].name);
    const double value = variable ? scene.initial[static_cast<std::size_t>(variable - known.variables.data())] : 0;
    if (std::isnan(value)) return "the start of this problem says no " + variables[i].name;
    turned.initial.push_back(layout.turns(i) ? opposite(value) : value);
  }
  return turned;
}

const Scene& forward_of(const Scene& scene) {
  const text::TextScene* text = scene.mechanics ? scene.mechanics->text() : nullptr;
  return text && text->forward ? *text->forward : scene;
}

double sign_of(const Scene& scene, std::string_view name) {
  if (!goes_backward(scene)) return 1;
  if (name == "t" || name == "max_at" || name == "drift_per_time") return -1;
  const auto& variables = scene.card().variables;
  const auto found = std::ranges::find(variables, name, &VariableCard::name);
  if (found == variables.end()) return 1;
  return scene.mechanics->text()->turns(static_cast<std::size_t>(found - variables.begin())) ? -1 : 1;
}

TurnedRows::TurnedRows(const Request& request, RowSink& sink) : sink_(sink) {
  const std::size_t known = request.scene->card().columns.size();
  const auto sign = [&](std::size_t place) {  // expressions of the caller's own refer to the forward scene
    return place < known ? sign_of(*request.scene, request.column(place).name) : 1;
  };
  std::ranges::transform(request.columns, std::back_inserter(signs_), sign);
  std::ranges::transform(request.section_columns(), std::back_inserter(section_signs_), sign);
}

std::span<const double> TurnedRows::turned(std::span<const double> rows, const std::vector<double>& signs) {
  turned_.assign(rows.begin(), rows.end());
  for (std::size_t i = 0; i < turned_.size(); ++i)
    if (signs[i % signs.size()] < 0) turned_[i] = opposite(turned_[i]);
  return turned_;
}

void turn(const Scene& scene, Solution& outcome) {
  if (!goes_backward(scene)) return;
  const text::TextScene& text = *scene.mechanics->text();
  outcome.t = opposite(outcome.t);
  outcome.stop.t = opposite(outcome.stop.t);
  if (outcome.stop.singular_at) outcome.stop.singular_at = opposite(*outcome.stop.singular_at);
  outcome.stop.detail.turn_times();
  for (std::size_t i = 0; i < outcome.final.size(); ++i)
    if (text.turns(i)) outcome.final[i] = opposite(outcome.final[i]);
  for (Report& event : outcome.events) turn(scene, event);
  for (Report& diagnostic : outcome.diagnostics) turn(scene, diagnostic);
  for (Warning& warning : outcome.warnings) warning.detail.turn_times();
}

}  // namespace least
