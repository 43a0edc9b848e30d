// Warnings of a finished run: a code and a sentence if its own evidence shows that the result is worthless, or soon
// will be.
#pragma once

#include <string_view>
#include <vector>

#include "core/run/backend.hpp"
#include "core/run/evidence.hpp"
#include "core/run/mechanics.hpp"
#include "core/run/request.hpp"

namespace least {

/// FinishedRun is the data of a finished run.
struct FinishedRun {
  const RunBackend& backend;
  const Request& request;
  const SchemeCard& scheme;
  const IntegrationState& state;
  double step;  ///< the length of every step; 0 where the scheme sets its own clock
  const Integrator& integrator;
  const StepGuard& guard;
  const Evidence& evidence;
  bool acted;  ///< at least one event has acted
  const KeepGoing& keep_going;
};

/// Said of a scene given as text that starts at 0 in all variables and rests there: most likely its start was
/// forgotten.
inline constexpr std::string_view nothing_moves =
    "nothing moves: what `initial` does not say is 0, and there the scene rests in an equilibrium";

/// warn_of_run adds the warnings of a run. A control run comes first: where it agrees with the run up to the end, steps
/// that look too long were short enough.
void warn_of_run(const FinishedRun& run, std::vector<Warning>& warnings);

}  // namespace least
