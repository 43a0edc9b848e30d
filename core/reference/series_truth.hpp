// The true motion of a scene whose size is known at run time, by Taylor series alone: in double-double, or in double
// where the equations are long.
#pragma once

#include <span>
#include <vector>

#include "core/run/backend.hpp"
#include "core/run/mechanics.hpp"
#include "core/tape/double_double.hpp"

namespace least {

/// Returns the states at increasing times from the start on, by two runs whose difference is the uncertainty. The truth
/// is not complete where the equations take too many operations or have no series, or where the motion does not go on.
/// `digits`: the variables of the equations at the start, those of the state and then velocities that were found.
/// `kinds`: the kinds of the variables, kinds_of the card.
Truth truth_by_series(const RunBackend& backend, const RunState& start, const std::vector<DoubleDouble>& digits,
                      const std::vector<double>& times, const KeepGoing& keep_going,
                      std::span<const std::size_t> kinds);

}  // namespace least
