#include "core/variations/event_slopes.hpp"

#include <algorithm>
#include <limits>

#include "core/run/mechanics.hpp"
#include "core/text/scene.hpp"
#include "core/text/written_out.hpp"
#include "core/variations/start.hpp"

namespace least::variations {

EventSlopes::EventSlopes(const Scene& scene, std::shared_ptr<const ParametricScene> equations, const Measures& watched)
    : equations_(std::move(equations)), rates_(formula_of(*equations_, equations_->rates)) {
  const ProblemCard& card = scene.card();
  tape::Tape tape = equations_->tape;
  const auto unknown_value = std::numeric_limits<double>::quiet_NaN();
  std::vector<text::Word> words;
  for (std::size_t i = 0; i < card.variables.size(); ++i) {
    if (card.variables[i].hidden) continue;
    Symbol meaning = unknown_value;
    for (std::size_t k = 0; k < equations_->components; ++k)
      if (equations_->variables[k] == i) meaning = Symbol(equations_->signs[k]) * Symbol::variable(tape, k);
    words.push_back({card.variables[i].name, meaning, {}});
  }
  words.push_back({"t", Symbol(equations_->sign_of_time()) * Symbol::time(tape), {}});
  const Symbol& energy = equations_->energy;
  words.push_back({"energy", energy.is_constant() ? energy : Symbol::at(tape, energy.place()), {}});
  for (std::size_t i = 0; i < card.parameters.size() && i < equations_->parameters.size(); ++i)
    words.push_back({card.parameters[i].name, Symbol::variable(tape, equations_->components + i), {}});

  std::vector<tape::Index> places;
  for (const Measure& one : watched.list) {
    Symbol meaning = unknown_value;
    auto parsed = text::parse_in_words_of(scene.mechanics->text(), one.text);
    if (const auto* expression = std::get_if<text::Expression>(&parsed)) {
      auto recorded = expression->record(tape, words);
      if (const auto* made = std::get_if<Symbol>(&recorded)) meaning = *made;
    }
    places.push_back(meaning.on(tape));
  }
  watched_ = tape::Formula(tape, places);
}

std::vector<double> EventSlopes::with_parameters(std::span<const double> state) const {
  std::vector<double> all(state.begin(), state.end());
  all.insert(all.end(), equations_->parameters.begin(), equations_->parameters.end());
  return all;
}

std::vector<double> EventSlopes::rates(double t, std::span<const double> state) const {
  std::vector<double> rates(equations_->components);
  rates_.evaluate(with_parameters(state).data(), t, rates.data());
  return rates;
}

double EventSlopes::operator()(std::size_t event, double t, std::span<const double> state,
                               std::span<const double> slope, const Direction& direction) const {
  const std::vector<double> all = with_parameters(state);
  std::vector<Slope> along(all.begin(), all.end()), values(watched_.outputs());
  for (std::size_t i = 0; i < slope.size(); ++i) along[i].slope[0] = slope[i];
  if (direction) along[state.size() + *direction].slope[0] = 1;
  watched_.evaluate(along.data(), Slope(t), values.data());
  const double by_slope = values[event].slope[0];
  std::ranges::copy(all, along.begin());
  const std::vector<double> rate = rates(t, state);
  for (std::size_t i = 0; i < rate.size(); ++i) along[i].slope[0] = rate[i];
  watched_.evaluate(along.data(), Slope{t, {1}}, values.data());
  return -by_slope / values[event].slope[0];
}

}  // namespace least::variations
