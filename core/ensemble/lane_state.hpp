// Single states of members: columns, and where within a step a variable passes a level. In the numbers of the lanes, so
// that they have the same bits on every machine. Only the narrowest unit of lanes includes this header.
#pragma once

#include <algorithm>

#include "core/ensemble/lane_run.hpp"
#include "core/run/columns.hpp"
#include "core/run/hermite.hpp"

namespace least {

template <class X>
X lane_state(const double* values, double t) {
  X x;
  x.t = t;
  for (std::size_t i = 0; i < X::size; ++i) x[i] = values[i];
  return x;
}

template <template <class> class P, class X>
void columns_of_state(const LaneState& state) {
  static const auto all = columns_of<P<double>, X>(About<P>::card());
  const auto problem = from_values<P<double>>(About<P>::fields, state.parameters);
  const X x = lane_state<X>(state.values, state.t);
  for (std::size_t i = 0; i < state.columns.size(); ++i) {
    const auto& column = all[state.columns[i]];
    state.out[i] = column.value(problem, x, {}, column.index);
  }
}
template <template <class> class P>
void lane_columns(const LaneState& state) {
  state.full ? columns_of_state<P, FullStateOf<P<double>>>(state) : columns_of_state<P, StateOf<P<double>>>(state);
}

/// By bisection of the dense output until the times are neighbours.
template <template <class> class P, class X>
void locate_in_step(LaneCrossing& crossing) {
  const auto problem = from_values<P<double>>(About<P>::fields, crossing.parameters);
  const X a = lane_state<X>(crossing.before, crossing.t_before), b = lane_state<X>(crossing.after, crossing.t_after);
  const HermitePath<P<double>, X> path(problem, a, b);
  const std::size_t i = crossing.variable;
  const bool up = a[i] < crossing.level;
  double low = a.t, high = b.t;
  for (;;) {
    const double middle = low + (high - low) / 2;
    if (!(middle > low && middle < high)) break;
    ((path(middle)[i] < crossing.level) == up ? low : high) = middle;
  }
  const X x = path(high);
  crossing.t = high;
  for (std::size_t k = 0; k < X::size; ++k) crossing.out[k] = x[k];
}
template <template <class> class P>
void locate_crossing(LaneCrossing& crossing) {
  crossing.full ? locate_in_step<P, FullStateOf<P<double>>>(crossing) : locate_in_step<P, StateOf<P<double>>>(crossing);
}

}  // namespace least
