// Linear stability: the step lengths for which a scheme is stable on an oscillator q̈ + αq̇ + ω²q = 0, damped or not. A
// step is a linear map of (q, p), computed by the scheme itself; it is stable if no eigenvalue exceeds 1 in modulus. In
// z = ωh and a = αh the stable set need not be one interval from 0: it is searched along a line, with a closer search
// for extremes where |trace| or the determinant come close to their bounds, so that gaps and islands of a width of 1e-5
// are found. Source: Hairer, Lubich, Wanner, Geometric Numerical Integration, 2006, I.5; Blanes, Casas, Murua, SIAM J.
// Numer. Anal. 46, 552 (2008).
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace least {

/// growth_per_step returns the spectral radius of a step at z and a of the scheme with this index and these settings;
/// infinite where the step fails, 1 for a scheme that sets its own clock and has no bound.
double growth_per_step(std::size_t scheme, std::span<const double> settings, double z, double a);
/// is_stable returns whether that radius is at most 1, to the accuracy of the trace and the determinant (1e-11).
bool is_stable(std::size_t scheme, std::span<const double> settings, double z, double a);

/// How far stability_bound searches by default.
inline constexpr double far_turn = 20;
/// stability_bound returns the first z at which steps grow, at a fixed a: 0 if they grow at every z, infinity if no
/// such z is found up to `needed`, or somewhat further. Results are cached. Thread-safe.
double stability_bound(std::size_t scheme, std::span<const double> settings, double a, double needed = far_turn);

/// flips_from returns the a from which on a step of the scheme reverses the momentum; infinite: never.
double flips_from(std::size_t scheme, std::span<const double> settings);

struct Interval {
  double low, high;
};
/// StableSteps are the stable step lengths up to `longest` for the frequency ω and the damping α ≥ 0.
struct StableSteps {
  double limit = std::numeric_limits<double>::infinity();  ///< every shorter step is stable; infinite: every step
  std::vector<Interval> islands;                           ///< intervals of stable steps beyond `limit`, increasing
};
StableSteps stable_steps(std::size_t scheme, std::span<const double> settings, double omega, double alpha,
                         double longest);

}  // namespace least
