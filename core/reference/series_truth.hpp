// The true motion of a scene whose size is known when it runs: by Taylor series in double-double alone.
#pragma once

#include <span>
#include <vector>

#include "core/run/backend.hpp"
#include "core/run/mechanics.hpp"
#include "core/tape/double_double.hpp"

namespace least {

/// The states at increasing times from the start on, by two runs of which one is finer; their difference is the
/// uncertainty. Not complete where its equations take too many operations, have no series, or the motion does not go
/// on. `digits`: the variables of the equations at the start, which are those of the state and velocities that were
/// found. `kinds`: of the variables, kinds_of the card.
Truth truth_by_series(const RunBackend& backend, const RunState& start, const std::vector<DoubleDouble>& digits,
                      const std::vector<double>& times, const KeepGoing& keep_going,
                      std::span<const std::size_t> kinds);

}  // namespace least
