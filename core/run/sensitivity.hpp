// The time up to which the digits of a run mean something. In a chaotic motion a difference in the last digit grows as
// e^{λt} until it is as large as the motion; beyond, a run gives only noise, however small its tolerance. The true
// motion is followed from the start with a tangent vector, as far as a bounded number of operations goes, and compared
// with states of the run.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/run/backend.hpp"
#include "core/run/mechanics.hpp"
#include "core/state_error.hpp"

namespace least {

struct Sensitivity {
  double until;  ///< the time beyond which no digit of the state is right
  double rate;   ///< estimate of λ
};

/// sensitivity compares a run from x with the true motion; `states` of the run are at increasing times. `large` is the
/// error from which on no digit of a state is right, divided by `sizes` as in state_error. Empty where the last state
/// still has right digits, as far as `most_operations` tell. `own_noise` is the relative size of the differences that
/// the run's own steps make, at least that of rounding: beyond what the operations suffice for, they tell when no digit
/// will be left. Throws TooManyOperations where the derivatives of the equations take too many.
std::optional<Sensitivity> sensitivity(const RunBackend& backend, RunState x, std::span<const RunState> states,
                                       Norm norm, std::span<const double> sizes, double large, double own_noise,
                                       std::int64_t most_operations, const KeepGoing& keep_going);

}  // namespace least
