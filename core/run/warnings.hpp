// What a run says against itself when it is over: a code and a sentence where its own evidence is that the result is
// worthless, or soon will be.
#pragma once

#include <vector>

#include "core/run/backend.hpp"
#include "core/run/evidence.hpp"
#include "core/run/mechanics.hpp"
#include "core/run/request.hpp"

namespace least {

/// A run that is over.
struct FinishedRun {
  const RunBackend& backend;
  const Request& request;
  const SchemeCard& scheme;
  const IntegrationState& state;
  double step;  ///< the length of every step; 0 where the scheme sets its own clock
  const Integrator& integrator;
  const StepGuard& guard;
  const Evidence& evidence;
  bool acted;  ///< an event did, once at least
  const KeepGoing& keep_going;
};

/// What a control run is asked for first: where it agrees up to the end, steps that look long were short enough.
void warn_of_run(const FinishedRun& run, std::vector<Warning>& warnings);

}  // namespace least
