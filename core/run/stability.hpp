// Linear stability: the largest ωh that a scheme stands on an oscillator, damped or not.
#pragma once

#include <cstddef>
#include <span>

namespace least {

/// For the scheme at this position of the list with these settings, and α times the step: the first z = ωh at which
/// powers of its step matrix on q̈ + α q̇ + ω² q = 0 grow, to 1e-6; 0 where they grow at every z, infinity where none is
/// found up to z = 20. Measured once per question. Thread-safe.
double stability_bound(std::size_t scheme, std::span<const double> settings, double damping_step);

}  // namespace least
