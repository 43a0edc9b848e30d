// Every diagnostic by the function that makes it: the rows of the table in table.cpp.
#pragma once

#include <memory>

#include "core/run/diagnostics/diagnostic.hpp"

namespace least {

class RunBackend;

std::unique_ptr<Diagnostic> energy_diagnostic();
std::unique_ptr<Diagnostic> momenta_diagnostic();
std::unique_ptr<Diagnostic> structure_diagnostic();
std::unique_ptr<Diagnostic> error_diagnostic();
std::unique_ptr<Diagnostic> orbit_diagnostic(const ProblemTraits& traits);
std::unique_ptr<Diagnostic> decay_diagnostic(const RunBackend& backend);
std::unique_ptr<Diagnostic> volume_diagnostic();
std::unique_ptr<Diagnostic> entropy_diagnostic();
std::unique_ptr<Diagnostic> zeros_diagnostic();
std::unique_ptr<Diagnostic> cycle_diagnostic();
std::unique_ptr<Diagnostic> poles_diagnostic();
std::unique_ptr<Diagnostic> moments_diagnostic();
std::unique_ptr<Diagnostic> lyapunov_diagnostic(const RunBackend& backend, const Request& request);

}  // namespace least
