// A control run: how far states of a run are from those of Dormand–Prince 5(4), from the same start, as far as a
// bounded number of force evaluations goes. Where two schemes that share nothing disagree, one of them is wrong; that
// it is not the control is believed only where a second one, at a tolerance a hundred times smaller, agrees with it.
// Where they agree nothing is proven beyond the time it came to.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/problem_traits.hpp"
#include "core/run/still_components.hpp"
#include "core/schemes/odeint.hpp"
#include "core/state_error.hpp"

namespace least {

/// The largest *error* of the states that were reached.
struct Departure {
  double error = 0, t = 0;  ///< and when
  double reached = 0;       ///< the time that the control run came to
  /// From here on the run is far from either control, and they from each other.
  std::optional<double> parted_at{};
  /// Where both controls come to a standstill and the run went on.
  std::optional<double> stands_at{};
};

template <class X>
struct ControlRun {
  std::vector<X> states;
  /// The time beyond which there is no step worth the name, as before a singularity: however stiff a motion is, its
  /// steps are longer against the time that they took until now.
  std::optional<double> stands_at{};
};

/// The motion at the times of states, which increase, as far as it gets with so many force evaluations and those of a
/// step, and before it is cancelled.
template <class P>
ControlRun<StateOf<P>> control_run(const P& problem, StateOf<P> x, std::span<const StateOf<P>> states, double tolerance,
                                   std::int64_t most_forces, const std::atomic<bool>& cancelled) {
  constexpr double standstill = 1e-9;
  ControlRun<StateOf<P>> motion;
  double before = x.t;
  const double start = x.t;
  auto stepper = AnyOdeintScheme{odeint::Method::dormand_prince_5, tolerance}.bind(problem, x);
  for (const StateOf<P>& state : states) {
    while (x.t < state.t && stepper.work().forces < most_forces && !cancelled.load(std::memory_order_relaxed)) {
      before = x.t;
      if (stepper.step(x) == StepStatus::ok) continue;
      motion.stands_at = x.t;
      return motion;
    }
    if (x.t < state.t && x.t - before < standstill * (x.t - start)) motion.stands_at = x.t;
    StateOf<P> here = x;
    if (x.t < state.t || (x.t > state.t && !stepper.interpolate(here, state.t))) return motion;
    if constexpr (HasDomain<P>)
      if (problem.bounded() && !(problem.inside(here.q) >= 0)) return motion;
    motion.states.push_back(here);
  }
  return motion;
}

/// What errors along a motion are divided by, of ComponentSizes; nothing in the absolute norm.
template <class P>
std::vector<double> divisors_along(const P& problem, const StateOf<P>& x, std::vector<StateOf<P>> states, Norm norm,
                                   std::span<const std::size_t> kinds) {
  if (norm == Norm::absolute) return {};
  states.insert(states.begin(), x);
  ComponentSizes sizes(kinds, StateOf<P>::size);
  for (const auto& state : states) sizes.see(state);
  settle_still_components<P>(problem, states, sizes);
  return sizes.divisors();
}

/// `large`: the error from which closer controls have to agree. `most_forces`: of the first; each closer one has four
/// times as many. `kinds`: of the variables, kinds_of the card.
template <class P>
Departure departure(const P& problem, StateOf<P> x, std::span<const StateOf<P>> states, Norm norm,
                    std::span<const std::size_t> kinds, double large, std::int64_t most_forces,
                    const std::atomic<bool>& cancelled) {
  if constexpr (HasSeries<P>)
    if (starts_series(problem, x)) x = series_state<StateOf<P>>(problem, P::series_until);
  while (!states.empty() && states.front().t < x.t) states = states.subspan(1);  // along a series
  double tolerance = 1e-8, size = 0;
  for (std::size_t i = 0; i < StateOf<P>::size; ++i) size = std::max(size, std::abs(x[i]));
  if (norm == Norm::relative && size > 0 && size < 1) tolerance = std::max(tolerance * size, 1e-300);
  auto motion = control_run(problem, x, states, tolerance, most_forces, cancelled);
  const std::vector<double> sizes = divisors_along(problem, x, motion.states, norm, kinds);
  Departure found;
  const auto hold = [&](std::size_t count, const std::vector<StateOf<P>>& truth) {
    found = {};
    for (std::size_t i = 0; i < count; ++i) {
      found.reached = truth[i].t;
      const double error = state_error(states[i], truth[i], sizes);
      if (error <= found.error || std::isnan(found.error)) continue;
      found.error = error;
      found.t = truth[i].t;
    }
  };
  hold(motion.states.size(), motion.states);
  if (found.error <= large) {
    constexpr double beyond = 0.01, near = 1e-3;  // of the time until there
    if (!motion.stands_at || !(states.back().t - *motion.stands_at > beyond * (*motion.stands_at - x.t))) return found;
    const auto closer = control_run(problem, x, states, tolerance / 100, 4 * most_forces, cancelled).stands_at;
    if (closer && std::abs(*closer - *motion.stands_at) < near * (*closer - x.t)) found.stands_at = closer;
    return found;
  }
  for (int closer_ones = 0; closer_ones < 2; ++closer_ones) {
    tolerance /= 100;
    most_forces *= 4;
    auto closer = control_run(problem, x, states, tolerance, most_forces, cancelled);
    const std::size_t both = std::min(closer.states.size(), motion.states.size());
    std::size_t agreed = 0;
    while (agreed < both && state_error(motion.states[agreed], closer.states[agreed], sizes) < 0.1 * large) ++agreed;
    hold(agreed, closer.states);
    if (agreed == both || !(found.error <= large) || state_error(states[agreed], closer.states[agreed], sizes) <= large)
      return found;
    found.parted_at = states[agreed].t;
    motion = std::move(closer);
  }
  return found;
}

}  // namespace least
