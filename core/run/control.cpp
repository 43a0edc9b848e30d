#include "core/run/control.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/run/control_stepper.hpp"
#include "core/run/still_components.hpp"

namespace least {
namespace {

struct ControlRun {
  std::vector<RunState> states;
  /// The time beyond which steps make no progress, as before a singularity: even in a stiff motion steps are longer in
  /// relation to the time integrated so far.
  std::optional<double> stands_at{};
  RunState last{};  ///< the last state that it reached
};

/// rates_go_on returns whether a motion at which control runs came to a standstill has regular rates beyond that point,
/// as beyond a jump of forces that holds it there: along the rates at that point, rates are bounded, and change the
/// less the shorter the way. At a singularity they grow, vary on each scale or are undefined.
bool rates_go_on(const RunBackend& backend, const RunState& start, const ControlRun& stood) {
  constexpr int scales = 4;
  constexpr double first = 1e-3, ratio = 0.1, smooth = 0.3, grown = 10, rounding = 1e-9;
  const ProblemTable& problem = backend.motion();
  const RunState& x = stood.last;
  const std::size_t n = x.size();
  const auto rates_at = [&](const RunState& y) {
    StateNumbers rates(std::max(n, problem.traits.components));
    problem.rates(y, rates.data());
    return rates;
  };
  const auto largest = [n](const StateNumbers& rates) { return largest_of(std::span(rates).first(n)); };
  const StateNumbers here = rates_at(x);
  double usual = largest(rates_at(start));
  for (const RunState& before : stood.states) usual = std::max(usual, largest(rates_at(before)));
  if (!(largest(here) <= grown * usual)) return false;
  double way = first * (x.t - start.t), last_change = std::numeric_limits<double>::infinity();
  std::optional<StateNumbers> last;
  for (int k = 0; k < scales; ++k, way *= ratio) {
    RunState beyond = x;
    beyond.t += way;
    for (std::size_t i = 0; i < n; ++i) beyond[i] += way * here[i];
    StateNumbers rates = rates_at(beyond);
    if (!(largest(rates) <= grown * usual)) return false;
    double change = 0;
    for (std::size_t i = 0; i < n && last; ++i) change = std::max(change, std::abs(rates[i] - (*last)[i]));
    if (last && !(change <= smooth * last_change + rounding * usual)) return false;
    if (last) last_change = change;
    last = std::move(rates);
  }
  return true;
}

/// control_run returns the motion at the increasing times of `states`, as far as it gets with so many force evaluations
/// (and those of one step), while keep_going().
ControlRun control_run(const RunBackend& backend, RunState x, std::span<const RunState> states, double tolerance,
                       std::int64_t most_forces, const KeepGoing& keep_going) {
  constexpr double standstill = 1e-9;
  ControlRun motion;
  double before = x.t;
  const double start = x.t;
  ControlStepper stepper(backend, tolerance);
  for (const RunState& state : states) {
    while (x.t < state.t && stepper.work().forces < most_forces && keep_going()) {
      before = x.t;
      if (stepper.step(x) == StepStatus::ok) continue;
      motion.stands_at = x.t;
      motion.last = x;
      return motion;
    }
    motion.last = x;
    if (x.t < state.t && x.t - before < standstill * (x.t - start)) motion.stands_at = x.t;
    RunState here = x;
    if (x.t < state.t || (x.t > state.t && !stepper.interpolate(here, state.t))) return motion;
    if (backend.motion().outside(here)) return motion;
    motion.states.push_back(here);
  }
  return motion;
}

}  // namespace

std::vector<double> divisors_along(const RunBackend& backend, const RunState& x, std::vector<RunState> states,
                                   Norm norm, std::span<const std::size_t> kinds, const KeepGoing& keep_going) {
  if (norm == Norm::absolute) return {};
  states.insert(states.begin(), x);
  ComponentSizes sizes(kinds, x.size());
  for (const auto& state : states) sizes.see(state);
  settle_still_components(backend.motion(), states, sizes, keep_going);
  return sizes.divisors();
}

Departure departure(const RunBackend& backend, RunState x, std::span<const RunState> states, Norm norm,
                    std::span<const std::size_t> kinds, double large, double tolerance, std::int64_t most_forces,
                    const KeepGoing& keep_going) {
  const ProblemTable& problem = backend.motion();
  if (problem.starts_series(x)) x = problem.series_state(problem.traits.series_until);
  while (!states.empty() && states.front().t < x.t) states = states.subspan(1);  // times covered by the series
  auto motion = control_run(backend, x, states, tolerance, most_forces, keep_going);
  const std::vector<double> sizes = divisors_along(backend, x, motion.states, norm, kinds, keep_going);
  Departure found;
  const auto hold = [&](std::size_t count, const std::vector<RunState>& truth) {
    found = {};
    for (std::size_t i = 0; i < count; ++i) {
      found.reached = truth[i].t;
      const double error = state_error(states[i], truth[i], x.size(), sizes);
      if (error <= found.error || std::isnan(found.error)) continue;
      found.error = error;
      found.t = truth[i].t;
    }
  };
  hold(motion.states.size(), motion.states);
  if (found.error <= large) {
    constexpr double beyond = 0.01, near = 1e-3;  // relative to the time integrated until there
    if (!motion.stands_at || !(states.back().t - *motion.stands_at > beyond * (*motion.stands_at - x.t))) return found;
    const ControlRun other = control_run(backend, x, states, tolerance / 100, 4 * most_forces, keep_going);
    const auto closer = other.stands_at;
    if (closer && std::abs(*closer - *motion.stands_at) < near * (*closer - x.t) && !rates_go_on(backend, x, other))
      found.stands_at = closer;
    return found;
  }
  for (int closer_ones = 0; closer_ones < 2; ++closer_ones) {
    tolerance /= 100;
    most_forces *= 4;
    auto closer = control_run(backend, x, states, tolerance, most_forces, keep_going);
    const std::size_t both = std::min(closer.states.size(), motion.states.size());
    std::size_t agreed = 0;
    while (agreed < both && state_error(motion.states[agreed], closer.states[agreed], x.size(), sizes) < 0.1 * large)
      ++agreed;
    hold(agreed, closer.states);
    if (agreed == both || !(found.error <= large) ||
        state_error(states[agreed], closer.states[agreed], x.size(), sizes) <= large)
      return found;
    found.parted_at = states[agreed].t;
    motion = std::move(closer);
  }
  return found;
}

}  // namespace least
