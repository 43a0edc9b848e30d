// The functions that make each diagnostic for a run, whose problem and request have to outlive it: the rows of the
// table in table.cpp. Long computations between two states ask `keep_going`, which returns false if the run has no time
// left or nobody waits for it any more.
#pragma once

#include <memory>

#include "core/run/diagnostics/diagnostic.hpp"

namespace least {

std::unique_ptr<Diagnostic> energy_diagnostic(const RunBackend& backend, const Request& request,
                                              const KeepGoing& keep_going);
std::unique_ptr<Diagnostic> momenta_diagnostic(const RunBackend& backend, const Request& request,
                                               const KeepGoing& keep_going);
std::unique_ptr<Diagnostic> structure_diagnostic(const RunBackend& backend, const Request& request,
                                                 const KeepGoing& keep_going);
std::unique_ptr<Diagnostic> error_diagnostic(const RunBackend& backend, const Request& request,
                                             const KeepGoing& keep_going);
std::unique_ptr<Diagnostic> orbit_diagnostic(const RunBackend& backend, const Request& request,
                                             const KeepGoing& keep_going);
std::unique_ptr<Diagnostic> decay_diagnostic(const RunBackend& backend, const Request& request,
                                             const KeepGoing& keep_going);
std::unique_ptr<Diagnostic> volume_diagnostic(const RunBackend& backend, const Request& request,
                                              const KeepGoing& keep_going);
std::unique_ptr<Diagnostic> entropy_diagnostic(const RunBackend& backend, const Request& request,
                                               const KeepGoing& keep_going);
std::unique_ptr<Diagnostic> zeros_diagnostic(const RunBackend& backend, const Request& request,
                                             const KeepGoing& keep_going);
std::unique_ptr<Diagnostic> cycle_diagnostic(const RunBackend& backend, const Request& request,
                                             const KeepGoing& keep_going);
std::unique_ptr<Diagnostic> poles_diagnostic(const RunBackend& backend, const Request& request,
                                             const KeepGoing& keep_going);
std::unique_ptr<Diagnostic> moments_diagnostic(const RunBackend& backend, const Request& request,
                                               const KeepGoing& keep_going);
std::unique_ptr<Diagnostic> lyapunov_diagnostic(const RunBackend& backend, const Request& request,
                                                const KeepGoing& keep_going);

}  // namespace least
