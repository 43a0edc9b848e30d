// Tests for bifurcations of closed orbits by their multipliers. Source: Kuznetsov, Elements of Applied Bifurcation
// Theory, 2004, 10.3.
#pragma once

#include "core/periodic/closed_orbit.hpp"

namespace least::periodic {

/// Crossings are test functions that change sign at a bifurcation: `doubling` where a multiplier is −1, `branching`
/// where one is 1, `torus` where a pair crosses the unit circle. Where products of pairs stay 1, pairs leave the circle
/// by collision of two pairs, and `torus` is only a sign, 1 where a pair is off the circle, else −1.
struct Crossings {
  double doubling = 0, branching = 0, torus = 0;

  double of(Bifurcation kind) const;
};
/// crossings_of evaluates the test functions, without the trivial multipliers.
Crossings crossings_of(const Stability& stability);

/// multipliers_away_from returns the distance of the nearest non-trivial multiplier from its place at such a
/// bifurcation; infinite where no multiplier can get there.
double multipliers_away_from(Bifurcation kind, const Stability& stability);

/// stable_at judges a member at such a bifurcation, where the multipliers that reach the unit circle do not decide:
/// false where another one is outside, else nothing.
std::optional<bool> stable_at(Bifurcation kind, const Stability& stability);

}  // namespace least::periodic
