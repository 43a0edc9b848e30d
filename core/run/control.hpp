// A control run: how far states of a run are from those of Dormand–Prince 5(4), from the same start, as far as a
// bounded number of force evaluations goes. Where two schemes that share nothing disagree, one of them is wrong; that
// it is not the control is believed only where a second one, at a tolerance a hundred times smaller, agrees with it.
// Where they agree nothing is proven beyond the time it came to.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/run/backend.hpp"
#include "core/run/mechanics.hpp"
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

/// What errors along a motion are divided by, of ComponentSizes; nothing in the absolute norm.
std::vector<double> divisors_along(const RunBackend& backend, const RunState& x, std::vector<RunState> states,
                                   Norm norm, std::span<const std::size_t> kinds, const KeepGoing& keep_going);

/// `large`: the error from which closer controls have to agree. `tolerance`, `most_forces`: of the first; each closer
/// one has a hundredth, and four times as many. It is not to be that of a run of Dormand–Prince 5(4), which it would
/// follow step by step. `kinds`: of the variables, kinds_of the card.
Departure departure(const RunBackend& backend, RunState x, std::span<const RunState> states, Norm norm,
                    std::span<const std::size_t> kinds, double large, double tolerance, std::int64_t most_forces,
                    const KeepGoing& keep_going);

}  // namespace least
