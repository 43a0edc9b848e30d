// When a motion reaches infinity.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/reference/reference.hpp"

namespace least {

/// The time at which the action of the motion from x0 becomes infinite, by the reference integrator, in strides no
/// longer than `stride` that shorten towards it; unknown where it does not happen before `latest` or keep_going() gives
/// up.
template <QuadraticContact P, class KeepGoing>
double true_blow_up_time(const P& problem, const StateOf<P>& x0, double latest, double stride, KeepGoing&& keep_going) {
  Extrapolation<P> truth(problem, convert<Quad, Quad>(x0), 1e-20);
  while (true) {
    const auto x = convert<double, double>(truth.state());
    const double when = blow_up_time(problem, x), wait = when - x.t;
    if (wait < 1e-13 * std::max(1.0, std::abs(when))) return when;
    const double ahead = wait > 0 ? std::min(stride, 0.8 * wait) : stride;
    if (x.t > latest || !truth.advance(Quad(x.t + ahead), keep_going)) return unknown;
  }
}

}  // namespace least
