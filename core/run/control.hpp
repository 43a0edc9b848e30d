// A control run: how far states of a run are from those of Dormand–Prince 5(4) at a tolerance of 1e-8, from the same
// start, as far as a bounded number of force evaluations goes. Where two schemes that share nothing disagree, one of
// them is wrong, and it is hardly this one; where they agree nothing is proven beyond the time it came to.
#pragma once

#include <cmath>
#include <span>

#include "core/problem_traits.hpp"
#include "core/schemes/odeint.hpp"
#include "core/state_error.hpp"

namespace least {

/// The largest *error* of the states that were reached.
struct Departure {
  double error = 0, t = 0;  ///< and when
  double reached = 0;       ///< the time that the control run came to
};

/// `states` have increasing times. At most so many force evaluations, and those of a step.
template <class P>
Departure departure(const P& problem, StateOf<P> x, std::span<const StateOf<P>> states, std::int64_t most_forces) {
  constexpr double tolerance = 1e-8;
  Departure found;
  if constexpr (HasSeries<P>)
    if (starts_series(problem, x)) x = series_state<StateOf<P>>(problem, P::series_until);
  auto stepper = AnyOdeintScheme{odeint::Method::dormand_prince_5, tolerance}.bind(problem, x);
  for (const StateOf<P>& state : states) {
    if (state.t < x.t && found.reached == 0) continue;  // along a series
    while (x.t < state.t && stepper.work().forces < most_forces)
      if (stepper.step(x) != StepStatus::ok) return found;
    StateOf<P> here = x;
    if (x.t < state.t || (x.t > state.t && !stepper.interpolate(here, state.t))) return found;
    if constexpr (HasDomain<P>)
      if (problem.bounded() && !(problem.inside(here.q) >= 0)) return found;
    found.reached = state.t;
    if (const double error = state_error(state, here); error > found.error) {
      found.error = error;
      found.t = state.t;
    }
  }
  return found;
}

}  // namespace least
