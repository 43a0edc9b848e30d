// Zeros within a step, located by the dense output of the integrator that took it.
#pragma once

#include <utility>
#include <vector>

#include "core/run/diagnostics/watch.hpp"
#include "core/run/integrator.hpp"

namespace least {

/// locate_sections adds the zeros of the scene's sections within the last step, which ended in `state`, to `events`.
void locate_sections(const ProblemTable& problem, const Integrator& integrator, const IntegrationState& state,
                     Events& events);

/// look_within shows the diagnostics states within the last step up to the time `until`, or within the next step if
/// `until` lies there.
void look_within(const Integrator& integrator, const IntegrationState& state, double until, DiagnosticSet& diagnostics);

/// watched_zeros returns the zeros of the expressions that the caller watches, with the states there, between two
/// states of the last or of the next step: in order of time, up to the first that ends the run. Once keep_going() is
/// false it finds no more zeros: in a large scene one state within a step may take milliseconds, and a search asks for
/// hundreds.
std::vector<std::pair<Zero, RunState>> watched_zeros(const ProblemTable& problem, const Integrator& integrator,
                                                     const IntegrationState& state, Watch& watch, const RunState& from,
                                                     const RunState& to, const KeepGoing& keep_going);

/// reached_at_end returns the watched expressions whose zero the run reaches exactly at its end, see Watch::reached.
std::vector<std::size_t> reached_at_end(const ProblemTable& problem, const Integrator& integrator,
                                        const IntegrationState& state, const Watch& watch);

}  // namespace least
