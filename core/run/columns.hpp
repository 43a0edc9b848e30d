// The columns that can be asked of a scene, one row each: the card, and the value at a state.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/describe.hpp"
#include "core/exact/elements.hpp"
#include "core/run/problem_table.hpp"
#include "core/scheme.hpp"

namespace least {

/// StepInfo says how a state was reached; values are unknown if no step led to it, or the scheme has no modes.
struct StepInfo {
  double step_size = unknown, mode = unknown, parameter = unknown, discrete_energy = unknown;
};

struct Column {
  ColumnCard card;
  /// Null for an expression of the caller's own (Measures).
  double (*value)(const ProblemTable& problem, StateView x, const StepInfo& step, std::size_t index);
  std::size_t index = 0;  ///< index within its kind (variables, invariants, …)
};

/// The column with the error of each sample against the true motion. A state alone does not tell it: the writer of the
/// rows fills it in.
inline constexpr std::string_view error_column = "error";

/// An angle in [−π, π).
inline double wrapped(double angle) {
  constexpr double pi = std::numbers::pi;
  const double rest = std::remainder(angle, 2 * pi);
  return rest < pi ? rest : -pi;
}

/// columns_of returns every column of scenes of a problem, in the order of the catalogue. `card` names variables,
/// invariants and quantities. Code that computes columns in lanes compiles this function again, with functions for
/// lanes.
inline std::vector<Column> columns_of(const ProblemTraits& traits, const ProblemCard& card) {
  using Table = ProblemTable;
  std::vector<Column> all;
  all.push_back({{"t", true}, [](const Table&, StateView x, const StepInfo&, std::size_t) { return x.t; }});
  for (std::size_t i = 0; i < card.variables.size(); ++i) {
    const VariableCard& known = card.variables[i];
    const bool pole = traits.carries_slope && known.optional;  // a slope at its pole is unknown, not infinite
    const bool by_default = !known.optional && !known.hidden;
    all.push_back({{known.name, by_default, known.optional, pole, {}, known.hidden},
                   [](const Table& m, StateView x, const StepInfo&, std::size_t k) { return variable(m.traits, x, k); },
                   i});
  }
  all.push_back({{"step_size", false, false, true},
                 [](const Table&, StateView, const StepInfo& step, std::size_t) { return step.step_size; }});
  if (traits.has_energy)
    all.push_back({{"energy", false, true}, [](const Table& m, StateView x, const StepInfo&, std::size_t) {
                     return m.traits.full ? m.energy_of(x) : unknown;
                   }});
  if (traits.contact)
    all.push_back({{"mechanical_energy"},
                   [](const Table& m, StateView x, const StepInfo&, std::size_t) { return m.mechanical_energy(x); }});
  if (traits.invariants > 0)
    for (std::size_t i = 0; i < card.invariants.size(); ++i)
      all.push_back({{card.invariants[i].name},
                     [](const Table& m, StateView x, const StepInfo&, std::size_t k) {
                       StateNumbers values(m.traits.invariants);
                       m.invariants(x, values.data());
                       return values[k];
                     },
                     i});
  if (traits.quantities > 0)
    for (std::size_t i = 0; i < card.quantities.size(); ++i)
      all.push_back({{card.quantities[i].name},
                     [](const Table& m, StateView x, const StepInfo&, std::size_t k) { return m.quantity(x, k); },
                     i});
  for (std::size_t i = 0; i < traits.elements; ++i) {
    const std::string name(two_body::element_names[i]);
    if (std::ranges::find(card.invariants, name, &QuantityCard::name) != card.invariants.end()) continue;
    all.push_back({{name, false, false, true},
                   [](const Table& m, StateView x, const StepInfo&, std::size_t k) { return m.element(x, k); },
                   i});
  }
  all.push_back({{std::string(error_column), false, false, true},
                 [](const Table&, StateView, const StepInfo&, std::size_t) { return unknown; }});
  for (std::size_t i = 0; i < card.variables.size(); ++i)
    if (card.variables[i].angle)
      all.push_back({{card.variables[i].name + "_wrapped"},
                     [](const Table& m, StateView x, const StepInfo&, std::size_t k) {
                       return wrapped(variable(m.traits, x, k));
                     },
                     i});
  if (traits.conservative) {
    std::vector<std::string> modes(mode_names.begin(), mode_names.end()), coordinates;
    for (std::size_t i = 0; i < traits.dof; ++i) coordinates.push_back(card.variables[i].name);
    all.push_back({{"mode", false, false, true, modes},
                   [](const Table&, StateView, const StepInfo& step, std::size_t) { return step.mode; }});
    all.push_back({{"parameter", false, false, true, coordinates},
                   [](const Table&, StateView, const StepInfo& step, std::size_t) { return step.parameter; }});
  }
  if (traits.potential || traits.general_lagrangian)
    all.push_back({{"discrete_energy", false, traits.contact, true},
                   [](const Table&, StateView, const StepInfo& step, std::size_t) { return step.discrete_energy; }});
  return all;
}

}  // namespace least
