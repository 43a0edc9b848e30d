#include "core/variations/event_slopes.hpp"

#include <algorithm>
#include <limits>

#include "core/run/acts.hpp"
#include "core/run/mechanics.hpp"
#include "core/tape/derivative.hpp"
#include "core/text/scene.hpp"
#include "core/text/written_out.hpp"
#include "core/variations/start.hpp"

namespace least::variations {
namespace {

/// Recorder records the expressions of events on a copy of the equations' tape.
class Recorder {
 public:
  Recorder(const Scene& scene, const ParametricScene& equations)
      : scene_(scene), equations_(equations), tape_(equations.tape) {
    const ProblemCard& card = scene.card();
    const text::TextScene* const text = scene.mechanics->text();
    for (std::size_t i = 0; i < card.variables.size(); ++i)
      if (!card.variables[i].hidden) know(card.variables[i].name, variable(i));
    know("t", Symbol(equations.sign_of_time()) * Symbol::time(tape_));
    know("energy", here(equations.energy));
    for (std::size_t i = 0; i < card.parameters.size() && i < equations.parameters.size(); ++i)
      know(card.parameters[i].name, component(equations.components + i));
    if (!text || !text->takes_velocities()) return;
    const auto& coordinates = text->definition.variables;
    velocities_.reserve(coordinates.size());
    for (std::size_t i = 0; i < coordinates.size(); ++i)
      know(velocities_.emplace_back(text::velocity_name(coordinates[i])),
           Symbol(sign_of_velocity(i)) * here(equations.rates[i]));
  }

  Symbol expression(const std::string& words) {
    auto parsed = text::parse_in_words_of(scene_.mechanics->text(), words);
    if (const auto* expression = std::get_if<text::Expression>(&parsed)) {
      auto recorded = expression->record(tape_, words_);
      if (const auto* made = std::get_if<Symbol>(&recorded)) return *made;
    }
    return unknown;
  }

  /// after(act) returns all components of the state after an event acts.
  std::vector<Symbol> after(const Act& act) {
    const std::size_t n = equations_.coordinates;
    std::vector<Symbol> values, state, velocities;
    for (const Setting& setting : act.settings) values.push_back(expression(setting.text));
    for (std::size_t i = 0; i < equations_.components; ++i) state.push_back(component(i));
    for (std::size_t i = 0; i < n; ++i) velocities.push_back(here(equations_.rates[i]));
    bool by_velocities = false;
    for (std::size_t k = 0; k < values.size(); ++k) {
      const Setting& setting = act.settings[k];
      by_velocities = by_velocities || setting.velocity;
      if (setting.velocity) {
        velocities[setting.index] = Symbol(sign_of_velocity(setting.index)) * values[k];
      } else if (const auto i = place_of(setting.index)) {
        state[*i] = Symbol(equations_.signs[*i]) * values[k];
      }
    }
    if (!by_velocities) return state;
    tape::Substitution momentum(equations_.tape, tape_, [&](int k) {
      const auto i = static_cast<std::size_t>(k);
      if (i >= equations_.components) return component(i);
      return i >= n && i < 2 * n ? velocities[i - n] : state[i];
    });
    std::vector<Symbol> momenta;
    for (const Symbol& p : equations_.momenta) momenta.push_back(momentum(p));
    std::ranges::copy(momenta, state.begin() + static_cast<std::ptrdiff_t>(n));
    return state;
  }

  tape::Formula formula(const std::vector<Symbol>& all) {
    std::vector<tape::Index> places;
    places.reserve(all.size());
    for (const Symbol& y : all) places.push_back(y.on(tape_));
    return {tape_, places};
  }

 private:
  void know(std::string_view name, const Symbol& meaning) { words_.push_back({name, meaning, {}}); }
  Symbol component(std::size_t i) { return Symbol::variable(tape_, i); }
  /// here(y) returns a symbol of the equations' tape as one of this tape.
  Symbol here(const Symbol& y) { return y.is_constant() ? y : Symbol::at(tape_, y.place()); }
  std::optional<std::size_t> place_of(std::size_t variable) const {
    const auto found = std::ranges::find(equations_.variables, variable);
    if (found == equations_.variables.end()) return std::nullopt;
    return static_cast<std::size_t>(found - equations_.variables.begin());
  }
  Symbol variable(std::size_t i) {
    const auto place = place_of(i);
    return place ? Symbol(equations_.signs[*place]) * component(*place) : Symbol(unknown);
  }
  double sign_of_velocity(std::size_t i) const { return equations_.signs[equations_.coordinates + i]; }

  const Scene& scene_;
  const ParametricScene& equations_;
  tape::Tape tape_;
  std::vector<std::string> velocities_;  ///< names of velocities
  std::vector<text::Word> words_;
};

}  // namespace

EventSlopes::EventSlopes(const Request& request, std::shared_ptr<const ParametricScene> equations)
    : equations_(std::move(equations)), rates_(formula_of(*equations_, equations_->rates)) {
  Recorder record(*request.scene, *equations_);
  std::vector<Symbol> watched;
  for (const Measure& one : request.watched.list) watched.push_back(record.expression(one.text));
  watched_ = record.formula(watched);
  for (const EventAsked& event : request.events) {
    auto& act = acts_.emplace_back();
    if (event.act) act = record.formula(record.after(*event.act));
  }
}

std::vector<Slope> EventSlopes::with_parameters(std::span<const double> state) const {
  std::vector<Slope> all(state.begin(), state.end());
  all.insert(all.end(), equations_->parameters.begin(), equations_->parameters.end());
  return all;
}

std::vector<Slope> EventSlopes::along(const tape::Formula& formula, double t, std::span<const double> state,
                                      std::span<const double> slope, const Direction& direction, double dt) const {
  std::vector<Slope> x = with_parameters(state), values(formula.outputs());
  for (std::size_t i = 0; i < slope.size(); ++i) x[i].slope[0] = slope[i];
  for (const auto& [parameter, by] : direction) x[state.size() + parameter].slope[0] = by;
  formula.evaluate(x.data(), Slope{t, {dt}}, values.data());
  return values;
}

std::vector<double> EventSlopes::rates(double t, std::span<const double> state) const {
  std::vector<double> rates;
  for (const Slope& rate : along(rates_, t, state, {}, {}, 0)) rates.push_back(rate.value);
  return rates;
}

double EventSlopes::time_slope(std::size_t event, double t, std::span<const double> state,
                               std::span<const double> slope, const Direction& direction) const {
  const double by_slope = along(watched_, t, state, slope, direction, 0)[event].slope[0];
  return -by_slope / along(watched_, t, state, rates(t, state), {}, 1)[event].slope[0];
}

double EventSlopes::missing(std::size_t event, double t, std::span<const double> state) const {
  const Slope value = along(watched_, t, state, rates(t, state), {}, 1)[event];
  return -value.value / value.slope[0];
}

std::vector<double> EventSlopes::state_after(std::size_t event, double t, std::span<const double> state) const {
  std::vector<double> after;
  for (const Slope& component : along(*acts_[event], t, state, {}, {}, 0)) after.push_back(component.value);
  return after;
}

std::vector<double> EventSlopes::slope_after(std::size_t event, double t, std::span<const double> state,
                                             std::span<const double> slope, const Direction& direction) const {
  const double later = time_slope(event, t, state, slope, direction);
  const std::vector<Slope> moved = along(*acts_[event], t, state, slope, direction, 0),
                           on_the_way = along(*acts_[event], t, state, rates(t, state), {}, 1);
  const std::vector<double> rates_after = rates(t, state_after(event, t, state));
  std::vector<double> after(state.size());
  for (std::size_t i = 0; i < after.size(); ++i)
    after[i] = moved[i].slope[0] + (on_the_way[i].slope[0] - rates_after[i]) * later;
  return after;
}

std::vector<EventSlopes::Second> EventSlopes::along_both(const tape::Formula& formula, const Second& t,
                                                         std::vector<Second> x, const Direction& a,
                                                         const Direction& b) const {
  const std::size_t size = x.size();
  x.insert(x.end(), equations_->parameters.begin(), equations_->parameters.end());
  for (const auto& [parameter, by] : a) x[size + parameter].value.slope[0] = by;
  for (const auto& [parameter, by] : b) x[size + parameter].slope[0].value = by;
  std::vector<Second> values(formula.outputs());
  formula.evaluate(x.data(), t, values.data());
  return values;
}

std::vector<double> EventSlopes::rates_of_rates(double t, std::span<const double> state) const {
  std::vector<double> slopes;
  for (const Slope& rate : along(rates_, t, state, rates(t, state), {}, 1)) slopes.push_back(rate.slope[0]);
  return slopes;
}

EventSlopes::Meeting EventSlopes::meeting(std::size_t event, double t, std::span<const double> state,
                                          const DirectedSlope& a, const DirectedSlope& b,
                                          std::span<const double> second) const {
  std::vector<Second> before;
  for (std::size_t i = 0; i < state.size(); ++i)
    before.push_back({Slope{state[i], {a.slope[i]}}, {Slope{b.slope[i], {second[i]}}}});
  const std::vector<Second> rates_before = along_both(rates_, Second(t), before, a.direction, b.direction);
  // Terms of second order in the shift of the event's time need the acceleration as a number only, because the shift
  // itself is of first order.
  const std::vector<double> acceleration = rates_of_rates(t, state);
  Second later{Slope{0, {time_slope(event, t, state, a.slope, a.direction)}},
               {Slope{time_slope(event, t, state, b.slope, b.direction)}}};
  const auto state_then = [&] {
    std::vector<Second> x = before;
    for (std::size_t i = 0; i < x.size(); ++i)
      x[i] += rates_before[i] * later + Second(0.5 * acceleration[i]) * (later * later);
    return x;
  };
  const Second missed = along_both(watched_, Second(t) + later, state_then(), a.direction, b.direction)[event];
  later.slope[0].slope[0] =
      -missed.slope[0].slope[0] / along(watched_, t, state, rates(t, state), {}, 1)[event].slope[0];
  return {later, state_then()};
}

std::vector<double> EventSlopes::second_at(std::size_t event, double t, std::span<const double> state,
                                           const DirectedSlope& a, const DirectedSlope& b,
                                           std::span<const double> second) const {
  std::vector<double> then;
  for (const Second& x : meeting(event, t, state, a, b, second).state) then.push_back(x.slope[0].slope[0]);
  return then;
}

std::vector<double> EventSlopes::second_after(std::size_t event, double t, std::span<const double> state,
                                              const DirectedSlope& a, const DirectedSlope& b,
                                              std::span<const double> second, bool led_back) const {
  const auto [later, before] = meeting(event, t, state, a, b, second);
  const Second then = Second(t) + later;
  const std::vector<Second> made = along_both(*acts_[event], then, before, a.direction, b.direction),
                            rates_after = along_both(rates_, then, made, a.direction, b.direction);
  const std::vector<double> acceleration_after = rates_of_rates(t, state_after(event, t, state));
  std::vector<double> after;
  for (std::size_t i = 0; i < made.size(); ++i) {
    const Second back = made[i] - rates_after[i] * later + Second(0.5 * acceleration_after[i]) * (later * later);
    after.push_back((led_back ? back : made[i]).slope[0].slope[0]);
  }
  return after;
}

}  // namespace least::variations
