#include "core/run/measures.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/run/mechanics.hpp"
#include "core/text/scene.hpp"
#include "core/text/written_out.hpp"

namespace least {

bool Measures::full_state() const {
  return std::ranges::any_of(list, [](const Measure& one) { return one.card.full_state; });
}

void Measures::evaluate(const double* observed, double t, double* values) const {
  formula_.evaluate(observed, t, values);
}

void Measures::evaluate(const Slope* observed, const Slope& t, Slope* values) const {
  formula_.evaluate(observed, t, values);
}

void Measures::enclose(const interval::Enclosure* observed, const interval::Enclosure& t,
                       interval::Enclosure* values) const {
  formula_.evaluate(observed, t, values);
}
void Measures::enclose(const interval::RateEnclosure* observed, const interval::RateEnclosure& t,
                       interval::RateEnclosure* values) const {
  formula_.evaluate(observed, t, values);
}

MeasureReader::MeasureReader(const Scene& scene, bool velocities)
    : card_(scene.card()), text_(scene.mechanics->text()) {
  const auto know = [&](std::string_view name, const Symbol& meaning) { words_.add({name, meaning, {}}); };
  const auto turned = [&](const Symbol& x, bool changes) { return changes ? -x : x; };
  const bool backward = text_ && text_->forward;
  for (std::size_t i = 0; i < card_.variables.size(); ++i)
    if (!card_.variables[i].hidden)
      know(card_.variables[i].name, turned(Symbol::variable(tape_, i), text_ && text_->turns(i)));
  know("t", turned(Symbol::time(tape_), backward));
  if (std::ranges::find(card_.columns, "energy", &ColumnCard::name) != card_.columns.end())
    know("energy", Symbol::variable(tape_, card_.variables.size()));
  for (std::size_t i = 0; i < card_.parameters.size() && i < scene.parameters.size(); ++i) {
    const Kind kind = card_.parameters[i].kind;
    if ((kind == Kind::number || kind == Kind::integer) && std::isfinite(scene.parameters[i]))
      know(card_.parameters[i].name, scene.parameters[i]);
  }
  measures_.reads.assign(card_.variables.size() + 1, false);
  if (!velocities || !text_ || !text_->takes_velocities()) return;
  const auto& coordinates = text_->definition.variables;
  velocities_.reserve(coordinates.size());
  for (std::size_t i = 0; i < coordinates.size(); ++i)
    know(velocities_.emplace_back(text::velocity_name(coordinates[i])),
         turned(Symbol::variable(tape_, card_.variables.size() + 1 + i), backward));
}

std::optional<text::Fault> MeasureReader::read(std::string name, std::string text) {
  auto parsed = text::parse_in_words_of(text_, std::move(text));
  if (auto* fault = std::get_if<text::Fault>(&parsed)) return std::move(*fault);
  const auto& expression = std::get<text::Expression>(parsed);
  auto recorded = expression.record(tape_, words_, text::operations_beside(text_));
  if (auto* fault = std::get_if<text::Fault>(&recorded)) return std::move(*fault);
  Measure one{{std::move(name), false, false, true, {}}, expression.text()};
  for (const text::Token& token : expression.tokens()) {
    if (token.kind != text::Token::Kind::name) continue;
    const auto variable = std::ranges::find(card_.variables, token.word, &VariableCard::name);
    const bool energy = variable == card_.variables.end() && token.word == "energy";
    if (energy || variable != card_.variables.end())
      measures_.reads[static_cast<std::size_t>(variable - card_.variables.begin())] = true;
    const auto column = std::ranges::find(card_.columns, token.word, &ColumnCard::name);
    if ((energy || variable != card_.variables.end()) && column != card_.columns.end())
      one.card.full_state = one.card.full_state || column->full_state;
  }
  measures_.list.push_back(std::move(one));
  outputs_.push_back(std::get<Symbol>(recorded).on(tape_));
  return std::nullopt;
}

std::vector<std::string_view> MeasureReader::names() const {
  std::vector<std::string_view> all;
  for (const text::Word& word : words_.all()) all.push_back(word.name);
  return all;
}

Measures MeasureReader::made() const {
  Measures measures = measures_;
  measures.formula_ = tape::Formula(tape_, outputs_);
  return measures;
}

}  // namespace least
