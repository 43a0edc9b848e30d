// Reference solutions: the closed form where a problem has one, else the problem's own equations of motion integrated
// in quad precision by extrapolation at two tolerances, whose difference is the uncertainty.
#pragma once

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "core/extrapolation.hpp"
#include "core/number/quad.hpp"
#include "core/problem_traits.hpp"
#include "core/run/mechanics.hpp"
#include "core/state_error.hpp"

namespace least {

template <class P>
struct Reference {
  std::vector<StateOf<P>> states;         ///< at the times asked for, rounded to double
  double uncertainty = 0x1p-53;           ///< as a state_error in the absolute norm
  double relative_uncertainty = 0x1p-53;  ///< in the relative one
  std::string_view how = "closed form";
  bool complete = true;  ///< false: it was told to give up, or the solution ceased to be finite
};

/// The closed form at these times; a state that is not finite is the last.
template <HasExact P>
Reference<P> closed_form(const P& problem, const StateOf<P>& x0, const std::vector<double>& times) {
  Reference<P> result;
  result.states.reserve(times.size());
  const auto start = convert<Quad, Quad>(x0);
  for (const double t : times) {
    result.states.push_back(convert<double, double>(problem.exact(start, Quad(t))));
    if (!std::isfinite(state_error(result.states.back(), x0))) {
      result.complete = false;
      break;
    }
  }
  return result;
}

/// Two runs in quad precision to these times, the finer of them and how far the other is from it.
template <class P, class KeepGoing>
Reference<P> quad_precision_run(const P& problem, const StateOf<P>& x0, const std::vector<double>& times,
                                KeepGoing&& keep_going) {
  Reference<P> result;
  result.how = "quad precision run";
  result.states.reserve(times.size());
  const auto start = convert<Quad, Quad>(x0);
  Extrapolation<P> fine(problem, start, 1e-27), coarse(problem, start, 1e-23);
  for (const double t : times) {
    if (!fine.advance(Quad(t), keep_going) || !coarse.advance(Quad(t), keep_going)) {
      result.complete = false;
      break;
    }
    const auto truth = convert<double, double>(fine.state());
    // The difference is taken in quad, where it is not rounded away.
    StateOf<P> difference = truth;
    for (std::size_t i = 0; i < StateOf<P>::size; ++i)
      difference[i] = truth[i] + static_cast<double>(coarse.state()[i] - fine.state()[i]);
    result.uncertainty = std::max(result.uncertainty, 0x1p-53 + state_error(difference, truth));
    result.relative_uncertainty =
        std::max(result.relative_uncertainty, 0x1p-53 + state_error(difference, truth, Norm::relative));
    result.states.push_back(truth);
  }
  return result;
}

/// Whether the problem has a closed form for this start.
template <class P>
bool has_closed_form(const P& problem, const StateOf<P>& x0) {
  if constexpr (requires { problem.exact_applies(x0); }) return problem.exact_applies(x0);
  return HasExact<P>;
}

/// The true states at increasing times from x0 on. keep_going() is asked now and then by a run, never by a closed form,
/// which takes no time; false gives up.
template <class P, class KeepGoing>
Reference<P> reference_solution(const P& problem, const StateOf<P>& x0, const std::vector<double>& times,
                                KeepGoing&& keep_going) {
  if constexpr (HasExact<P>)
    if (has_closed_form(problem, x0)) return closed_form(problem, x0, times);
  return quad_precision_run(problem, x0, times, keep_going);
}

/// The same, their type forgotten.
template <class P>
Truth true_states(const P& problem, const StateOf<P>& x0, const std::vector<double>& times,
                  const KeepGoing& keep_going) {
  const auto reference = reference_solution(problem, x0, times, keep_going);
  Truth truth{{}, reference.uncertainty, reference.relative_uncertainty, reference.how, reference.complete};
  for (const auto& x : reference.states) {
    auto& state = truth.states.emplace_back();
    for (std::size_t i = 0; i < StateOf<P>::size; ++i) state.push_back(x[i]);
  }
  return truth;
}

}  // namespace least
