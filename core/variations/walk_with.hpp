// walk() for one scheme and one class of problem; included by core/variations/walk_….cpp.
#pragma once

#include <tuple>

#include "core/from_values.hpp"
#include "core/schemes/list.hpp"
#include "core/variations/scheme_map.hpp"

namespace least::variations {

/// VariedState is the state of problem V with slopes in its components, not in its time.
template <class V>
using VariedState = typename FullStateOf<V>::template in<Slope, double>;

/// place_of returns the index of the scene's i-th component in the state of V, which may have room for more
/// coordinates.
template <class V>
std::size_t place_of(std::size_t i, std::size_t coordinates) {
  if constexpr (requires { V::dof; }) {
    constexpr auto room = static_cast<std::size_t>(V::dof);
    return i < coordinates ? i : i < 2 * coordinates ? room + i - coordinates : 2 * room;
  } else {
    return i;
  }
}

/// walk_with walks one scheme with one class of problem.
template <class V, class Scheme>
Walked walk_with(const Walk& on, const V& problem, const Scheme& scheme) {
  Walked made;
  const std::size_t size = on.start.size(), n = problem.coordinates();
  VariedState<V> y;
  y.t = on.grid.start;
  for (std::size_t i = 0; i < size; ++i) y[place_of<V>(i, n)] = Slope{on.start[i], {on.slope[i]}};
  const auto look = [&] {
    auto& state = made.states.emplace_back(size);
    auto& slope = made.slopes.emplace_back(size);
    for (std::size_t i = 0; i < size; ++i) {
      const Slope& component = y[place_of<V>(i, n)];
      state[i] = component.value;
      slope[i] = component.slope[0];
    }
  };
  auto stepper = scheme.bind(problem, y);
  made.reason = go_over(on, look, [&](double t, double h) {
    y.t = t;
    return stepper.step(y, h);
  });
  return made;
}

/// walk_among walks the scheme with this id, if it is one of Scheme… and can be walked with V.
template <class V, class... Scheme>
std::optional<Walked> walk_among(const Walk* on, std::string_view id,
                                 const std::shared_ptr<const VariedFormulas>& formulas, std::tuple<Scheme...>*) {
  std::optional<Walked> made;
  const auto with = [&]<class S>(S*) {
    if constexpr (!SelfTimed<S>) {
      if constexpr (FixedStepSchemeFor<S, V, VariedState<V>>) {
        if (made || S::card().id != id) return;
        V problem;
        problem.formulas = formulas;
        made = on ? walk_with(*on, problem, from_values<S>(S::fields, on->request.settings)) : Walked{};
      }
    }
  };
  (with(static_cast<Scheme*>(nullptr)), ...);
  return made;
}

template <class V>
std::optional<Walked> walk_among_all(const Walk* on, std::string_view id,
                                     const std::shared_ptr<const VariedFormulas>& formulas) {
  return walk_among<V>(on, id, formulas, static_cast<SchemeList*>(nullptr));
}

}  // namespace least::variations
