// Sizes of components that have none along a motion, for the relative norm.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "core/problem_traits.hpp"
#include "core/state_error.hpp"

namespace least {

/// Where a component is nothing but rounding along a motion, as the radial momentum on a circular orbit, its kind has
/// no size of its own there. It gets one in its own unit: what a relative change of the whole state by 1 makes of its
/// rate, for as long as it goes on making it. `states`: some of the motion, in the order of time.
template <class P>
void settle_still_components(const P& problem, std::span<const StateOf<P>> states, ComponentSizes& sizes) {
  constexpr double apart = 0x1p-10, rounding = 0x1p-45;
  constexpr std::size_t size = StateOf<P>::size;
  std::vector<double> changes(size, 0), own(size, 0);  // by kind
  for (const StateOf<P>* x : {&states.front(), &states[states.size() / 2], &states.back()}) {
    const StateOf<P> rate = derivative(problem, *x);
    for (std::size_t j = 0; j < size; ++j) {
      const double moved = apart * sizes.largest(j);
      if (!(moved > 0)) continue;
      StateOf<P> beside = *x;
      beside[j] += moved;
      const StateOf<P> other = derivative(problem, beside);
      for (std::size_t i = 0; i < size; ++i) {
        const double change = std::abs(other[i] - rate[i]), kind_change = change / apart;
        if (!std::isfinite(change)) continue;
        changes[sizes.kind(i)] = std::max(changes[sizes.kind(i)], kind_change);
        if (i == j) own[sizes.kind(i)] = std::max(own[sizes.kind(i)], change / moved);
      }
    }
  }
  const double span = states.back().t - states.front().t;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t kind = sizes.kind(i);
    const double natural = changes[kind] * (own[kind] * span > 1 ? 1 / own[kind] : span);
    if (kind == i && sizes.largest(i) <= rounding * natural && std::isfinite(natural)) sizes.set(i, natural);
  }
}

}  // namespace least
