// How a scheme walks: for core/variations/walk_….cpp.
#pragma once

#include <tuple>

#include "core/from_values.hpp"
#include "core/schemes/list.hpp"
#include "core/variations/scheme_map.hpp"

namespace least::variations {

/// States of a problem with a slope.
template <class V>
using VariedState = typename FullStateOf<V>::template in<Slope, double>;

/// Where the i-th component of a scene stands in such a state, which has room for more.
template <class V>
std::size_t place_of(std::size_t i, std::size_t coordinates) {
  if constexpr (requires { V::dof; }) {
    constexpr auto room = static_cast<std::size_t>(V::dof);
    return i < coordinates ? i : i < 2 * coordinates ? room + i - coordinates : 2 * room;
  } else {
    return i;
  }
}

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

/// With the scheme of this id among some.
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
