// Linear stability: the steps that a scheme stands on an oscillator q̈ + αq̇ + ω²q = 0, damped or not. A step is a linear
// map of (q, p), computed by the scheme itself; it is stable where neither eigenvalue is larger than 1. In z = ωh and
// a = αh the stable set need not be one interval from 0: it is searched along a line, and where |trace| or the
// determinant come close to their bounds between two looks, at their extremes as well, so that gaps and islands of a
// width of 1e-5 are found. Source: Hairer, Lubich, Wanner, Geometric Numerical Integration, 2006, I.5; Blanes, Casas,
// Murua, SIAM J. Numer. Anal. 46, 552 (2008).
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace least {

/// The spectral radius of a step of the scheme at this position of the list with these settings, at z and a; infinite
/// where the step fails, 1 where the scheme sets its own clock and has no bound.
double growth_per_step(std::size_t scheme, std::span<const double> settings, double z, double a);
/// Whether it is at most 1, to the accuracy of the trace and the determinant (1e-11).
bool is_stable(std::size_t scheme, std::span<const double> settings, double z, double a);

/// How far a search goes that nobody limits.
inline constexpr double far_turn = 20;
/// At a fixed a, the first z at which steps grow: 0 where they grow at every z, infinity where none is found up to
/// `needed`, and further only as is convenient. Measured once. Thread-safe.
double stability_bound(std::size_t scheme, std::span<const double> settings, double a, double needed = far_turn);

/// The a from which a step of the scheme turns the momentum over; infinite: never.
double flips_from(std::size_t scheme, std::span<const double> settings);

struct Interval {
  double low, high;
};
/// Steps up to `longest` for the frequency ω and the damping α ≥ 0.
struct StableSteps {
  double limit = std::numeric_limits<double>::infinity();  ///< every shorter step is stable; infinite: every step
  std::vector<Interval> islands;                           ///< of stable steps beyond it, increasing
};
StableSteps stable_steps(std::size_t scheme, std::span<const double> settings, double omega, double alpha,
                         double longest);

}  // namespace least
