// When a motion reaches infinity.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/reference/reference.hpp"

namespace least {

/// The time at which the action of the motion from x0 becomes infinite, by the series of reference solutions, in
/// strides no longer than `stride` that shorten towards it; unknown where it does not happen before `latest` or
/// keep_going() gives up.
template <QuadraticContact P, class KeepGoing>
double true_blow_up_time(const P& problem, const StateOf<P>& x0, double latest, double stride, KeepGoing&& keep_going) {
  tape::Tape tape;
  const auto rates = taylor::write_equations<StateOf<P>>(problem, tape);
  if (!TrueMotion::covers(tape)) return unknown;
  TrueMotion truth(std::move(tape), rates, 1e-20);
  truth.start(digits_of(problem, x0), x0.t);
  for (StateOf<P> x = x0; x.t <= latest;) {
    const double when = blow_up_time(problem, x), wait = when - x.t;
    if (wait < 1e-13 * std::max(std::abs(when), when - x0.t)) return when;
    x.t += wait > 0 ? std::min(stride, 0.8 * wait) : stride;
    const auto reached = truth.at(x.t, keep_going);
    if (reached.empty()) break;
    for (std::size_t i = 0; i < StateOf<P>::size; ++i) x[i] = reached[i].high();
  }
  return unknown;
}

}  // namespace least
