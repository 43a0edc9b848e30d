// Until when the digits of a run mean something. Where the motion is chaotic, a difference of the last digit grows by
// e^{λt} until it is as large as the motion; what a run says beyond is noise, however small its tolerance. The true
// motion is followed from the start with a tangent to it, as far as a bounded number of operations goes, and held
// against states of the run.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/run/backend.hpp"
#include "core/run/mechanics.hpp"
#include "core/state_error.hpp"

namespace least {

struct Sensitivity {
  double until;  ///< the time beyond which no digit is right
  double rate;   ///< λ, about
};

/// Of a run from x that came to these states, whose times increase. `large`: the error from which none of their digits
/// is right; `sizes`: what such an error is divided by, as state_error has it. Nothing where the last one still has
/// right digits, as far as `most_operations` can tell. Throws TooManyOperations where its derivatives take too many.
std::optional<Sensitivity> sensitivity(const RunBackend& backend, RunState x, std::span<const RunState> states,
                                       Norm norm, std::span<const double> sizes, double large,
                                       std::int64_t most_operations, const KeepGoing& keep_going);

}  // namespace least
