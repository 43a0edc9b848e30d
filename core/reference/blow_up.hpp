// When a motion reaches infinity.
#pragma once

#include "core/run/backend.hpp"
#include "core/run/mechanics.hpp"

namespace least {

/// Returns the time at which the action s of the motion from x0 becomes infinite, where H is quadratic in s. The motion
/// is computed by the series of reference solutions, in strides of at most `stride` that shorten towards that time.
/// Returns `unknown` where s stays finite until `latest`, where there are no series, or where keep_going() gives up.
/// x0: what the motion needs of a state.
double true_blow_up_time(const RunBackend& backend, const RunState& x0, double latest, double stride,
                         const KeepGoing& keep_going);

}  // namespace least
