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
/// rate, for as long as it goes on making it: for no longer than the span, than the component lasts by itself, or than
/// the inverse of the frequency at which it and another one drive each other. `states`: some of the motion, in the
/// order of time.
template <class P>
void settle_still_components(const P& problem, std::span<const StateOf<P>> states, ComponentSizes& sizes) {
  constexpr double rounding = 0x1p-45;
  constexpr std::size_t size = StateOf<P>::size;
  std::vector<double> changes(size, 0), most_rate(size, 1 / (states.back().t - states.front().t));  // by kind
  const auto raise = [](double& most, double x) {
    if (std::isfinite(x)) most = std::max(most, x);
  };
  for (const StateOf<P>* x : {&states.front(), &states[states.size() / 2], &states.back()}) {
    Mat<int(size)> slopes;  // of the rate i by the component j
    for (std::size_t j = 0; j < size; ++j) {
      auto beside = convert<Slope, double>(*x);
      beside[j].slope[0] = 1;
      const auto rate = derivative(problem, beside);
      for (std::size_t i = 0; i < size; ++i) slopes[i][j] = rate[i].slope[0];
    }
    for (std::size_t i = 0; i < size; ++i)
      for (std::size_t j = 0; j < size; ++j) {
        raise(changes[sizes.kind(i)], std::abs(slopes[i][j]) * sizes.largest(j));
        raise(most_rate[sizes.kind(i)], std::sqrt(std::abs(slopes[i][j] * slopes[j][i])));  // i = j: its own
      }
  }
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t kind = sizes.kind(i);
    const double natural = changes[kind] / most_rate[kind];
    if (kind == i && sizes.largest(i) <= rounding * natural && std::isfinite(natural)) sizes.set(i, natural);
  }
}

}  // namespace least
