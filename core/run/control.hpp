// A control run compares states of a run with those of Dormand–Prince 5(4) from the same start, as far as a bounded
// number of force evaluations goes. Where two unrelated schemes disagree, one of them is wrong; the control run is
// trusted only where a second one, with a hundredth of the tolerance, agrees with it. Where run and control agree,
// nothing is proven beyond the time that the control reached.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/run/backend.hpp"
#include "core/run/mechanics.hpp"
#include "core/state_error.hpp"

namespace least {

/// Departure is the largest *error* of the states of a run that a control run reached.
struct Departure {
  double error = 0, t = 0;  ///< the largest error, and its time
  double reached = 0;       ///< the time up to which the control run compared states
  /// The time from which the run differs from both controls, and the controls from each other.
  std::optional<double> parted_at{};
  /// The time at which both controls come to a standstill although the run went on.
  std::optional<double> stands_at{};
};

/// divisors_along returns the divisors of errors along a motion (ComponentSizes::divisors) from x and these states;
/// empty for the absolute norm.
std::vector<double> divisors_along(const RunBackend& backend, const RunState& x, std::vector<RunState> states,
                                   Norm norm, std::span<const std::size_t> kinds, const KeepGoing& keep_going);

/// departure compares the states of a run from x with control runs. `large` is the error from which on closer controls
/// have to agree. `tolerance` and `most_forces` are those of the first control; each closer one has a hundredth of the
/// tolerance and four times the evaluations. `tolerance` must differ from that of a run of Dormand–Prince 5(4), which
/// the control would repeat step by step. `kinds` is kinds_of the card.
Departure departure(const RunBackend& backend, RunState x, std::span<const RunState> states, Norm norm,
                    std::span<const std::size_t> kinds, double large, double tolerance, std::int64_t most_forces,
                    const KeepGoing& keep_going);

}  // namespace least
