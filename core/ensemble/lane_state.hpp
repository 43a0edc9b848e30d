// Single states of members: columns, and the path of a step. In the numbers of the lanes, so that they have
// the same bits on every machine. Only the narrowest unit of lanes includes this header.
#pragma once

#include <cmath>

#include "core/ensemble/lane_run.hpp"
#include "core/run/columns.hpp"

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

template <class X, class Stepper>
class BoundPath final : public LanePath {
 public:
  BoundPath(const X& x, const Stepper& stepper) : x_(x), stepper_(stepper) {}
  bool at(double t, double* state) const override {
    X x = x_;
    Stepper stepper = stepper_;
    bool good = all(succeeded(LaneStatuses(stepper.step(x, t - x.t))));
    for (std::size_t i = 0; i < X::size; ++i) {
      state[i] = x[i].v[0];
      good = good && std::isfinite(state[i]);
    }
    return good;
  }

 private:
  X x_;
  Stepper stepper_;
};
template <template <class> class P>
void show_path(const LaneStep& step, LaneHost& host) {
  using X = FullStateOf<P<double>, Lanes>;
  const auto problem = parameters::in<Lanes>(from_values<P<double>>(About<P>::fields, step.parameters));
  X x;
  x.t = step.t;
  for (std::size_t i = 0; i < X::size; ++i) x[i] = i < step.before.size() ? step.before[i] : 0.0;
  with_lane_scheme(step.scheme, step.settings, [&](const auto& scheme) {
    if constexpr (requires { scheme.bind(problem, x); }) host.look(BoundPath(x, scheme.bind(problem, x)));
  });
}

}  // namespace least
