// When a motion reaches infinity.
#pragma once

#include "core/run/backend.hpp"
#include "core/run/mechanics.hpp"

namespace least {

/// The time at which the action of the motion from x0 becomes infinite, where H is quadratic in s, by the series of
/// reference solutions, in strides no longer than `stride` that shorten towards it; unknown where it does not happen
/// before `latest` or keep_going() gives up. x0: what the motion needs of a state.
double true_blow_up_time(const RunBackend& backend, const RunState& x0, double latest, double stride,
                         const KeepGoing& keep_going);

}  // namespace least
