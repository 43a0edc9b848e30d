// The columns that can be asked of a scene, one row each: the card, and the value at a state.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/describe.hpp"
#include "core/exact/elements.hpp"
#include "core/problem_traits.hpp"
#include "core/scheme.hpp"

namespace least {

/// How a state was reached. Unknown: it was not reached by a step, or the scheme has no modes.
struct StepInfo {
  double step_size = unknown, mode = unknown, parameter = unknown, discrete_energy = unknown;
};

template <class P, class X>
struct Column {
  ColumnCard card;
  /// Null: the caller's own, which is no function of the scene's alone.
  double (*value)(const P& problem, const X& x, const StepInfo& step, std::size_t index);
  std::size_t index = 0;  ///< among those of its kind
};

/// Of the state at each sample, against the truth: what a state alone cannot say, and the writer fills in.
inline constexpr std::string_view error_column = "error";

/// An angle in [−π, π).
inline double wrapped(double angle) {
  constexpr double pi = std::numbers::pi;
  const double rest = std::remainder(angle, 2 * pi);
  return rest < pi ? rest : -pi;
}

/// Every column, in the order of the catalogue. `card` names variables, invariants and quantities.
template <class P, class X>
std::vector<Column<P, X>> columns_of(const ProblemCard& card) {
  std::vector<Column<P, X>> all;
  all.push_back({{"t", true}, [](const P&, const X& x, const StepInfo&, std::size_t) { return double(x.t); }});
  for (std::size_t i = 0; i < card.variables.size(); ++i) {
    const VariableCard& variable = card.variables[i];
    const bool pole = CarriesSlope<P> && variable.optional;  // a slope at its pole is unknown, not infinite
    const bool by_default = !variable.optional && !variable.hidden;
    all.push_back({{variable.name, by_default, variable.optional, pole, {}, variable.hidden},
                   [](const P&, const X& x, const StepInfo&, std::size_t k) { return least::variable(x, k); },
                   i});
  }
  all.push_back({{"step_size", false, false, true},
                 [](const P&, const X&, const StepInfo& step, std::size_t) { return step.step_size; }});
  if constexpr (HasEnergy<P>)
    all.push_back({{"energy", false, true}, [](const P& m, const X& x, const StepInfo&, std::size_t) {
                     if constexpr (std::is_same_v<X, FullRunState<P>>) return energy_of(m, x);
                     return unknown;
                   }});
  if constexpr (Contact<P>)
    all.push_back({{"mechanical_energy"}, [](const P& m, const X& x, const StepInfo&, std::size_t) {
                     return mechanical_energy(m, x.q, x.p, phase(m, x.t));
                   }});
  if constexpr (HasInvariants<P>)
    for (std::size_t i = 0; i < card.invariants.size(); ++i)
      all.push_back(
          {{card.invariants[i].name},
           [](const P& m, const X& x, const StepInfo&, std::size_t k) { return invariants_at(m, plain(x))[k]; },
           i});
  if constexpr (HasQuantities<P>)
    for (std::size_t i = 0; i < card.quantities.size(); ++i)
      all.push_back({{card.quantities[i].name},
                     [](const P& m, const X& x, const StepInfo&, std::size_t k) { return m.quantities(x.y, x.t)[k]; },
                     i});
  if constexpr (TwoBody<P>)
    for (std::size_t i = 0; i < two_body::elements_in<P::dof>; ++i) {
      const std::string name(two_body::element_names[i]);
      if (std::ranges::find(card.invariants, name, &QuantityCard::name) != card.invariants.end()) continue;
      all.push_back({{name, false, false, true},
                     [](const P& m, const X& x, const StepInfo&, std::size_t k) {
                       return two_body::element(two_body::elements(x.q, x.p, m.gravitational_parameter()), k);
                     },
                     i});
    }
  all.push_back({{std::string(error_column), false, false, true},
                 [](const P&, const X&, const StepInfo&, std::size_t) { return unknown; }});
  for (std::size_t i = 0; i < card.variables.size(); ++i)
    if (card.variables[i].angle)
      all.push_back(
          {{card.variables[i].name + "_wrapped"},
           [](const P&, const X& x, const StepInfo&, std::size_t k) { return wrapped(least::variable(x, k)); },
           i});
  if constexpr (Conservative<P>) {
    std::vector<std::string> modes(mode_names.begin(), mode_names.end()), coordinates;
    for (std::size_t i = 0; i < std::size_t(P::dof); ++i) coordinates.push_back(card.variables[i].name);
    all.push_back({{"mode", false, false, true, modes},
                   [](const P&, const X&, const StepInfo& step, std::size_t) { return step.mode; }});
    all.push_back({{"parameter", false, false, true, coordinates},
                   [](const P&, const X&, const StepInfo& step, std::size_t) { return step.parameter; }});
  }
  if constexpr (Potential<P> || GeneralLagrangian<P>)
    all.push_back({{"discrete_energy", false, Contact<P>, true},
                   [](const P&, const X&, const StepInfo& step, std::size_t) { return step.discrete_energy; }});
  return all;
}

}  // namespace least
