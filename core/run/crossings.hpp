// What vanishes within a step, located by the dense output of the integrator that took it.
#pragma once

#include <utility>
#include <vector>

#include "core/run/diagnostics/watch.hpp"
#include "core/run/integrator.hpp"

namespace least {

/// The zeros of the scene's sections within the last step, which ended in the state.
void locate_sections(const ProblemTable& problem, const Integrator& integrator, const IntegrationState& state,
                     Events& events);

/// Shows the diagnostics what lies within the last step up to this time, and nothing beyond; or within the next one.
void look_within(const Integrator& integrator, const IntegrationState& state, double until, DiagnosticSet& diagnostics);

/// The zeros of what the caller watches, with the states there, between two states of the last step or of the next one:
/// in their order, up to the first that ends the run. Of a large scene one state within a step may take milliseconds,
/// and a search asks for hundreds: once it is not to go on, it finds no more.
std::vector<std::pair<Zero, RunState>> watched_zeros(const ProblemTable& problem, const Integrator& integrator,
                                                     const IntegrationState& state, Watch& watch, const RunState& from,
                                                     const RunState& to, const KeepGoing& keep_going);

/// What the caller watches and the run reaches from above exactly where it ends: see Watch::reached.
std::vector<std::size_t> reached_at_end(const ProblemTable& problem, const Integrator& integrator,
                                        const IntegrationState& state, const Watch& watch);

}  // namespace least
