// Linear stability: the largest ωh that a scheme stands on an oscillator, damped or not.
#pragma once

#include <cstddef>
#include <limits>
#include <span>

namespace least {

/// For the scheme at this position of the list with these settings, and α times the step: the first z = ωh at which
/// powers of its step matrix on q̈ + α q̇ + ω² q = 0 grow, to 1e-6; 0 where they grow at every z, infinity where none is
/// found up to z = 20. Where it lies beyond `needed` that is not looked into, and the answer is infinity as well.
/// Measured once. Thread-safe.
double stability_bound(std::size_t scheme, std::span<const double> settings, double damping_step,
                       double needed = std::numeric_limits<double>::infinity());

/// The longest step below h at which that bound holds for the frequency ω and the damping α.
double longest_stable_step(std::size_t scheme, std::span<const double> settings, double omega, double alpha, double h);

}  // namespace least
