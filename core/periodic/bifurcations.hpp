// What multipliers say of bifurcations of closed orbits. Source: Kuznetsov, Elements of Applied Bifurcation Theory,
// 2004, 10.3.
#pragma once

#include "core/periodic/closed_orbit.hpp"

namespace least::periodic {

/// Zero where a multiplier is −1, where one is 1, and where a pair goes through the unit circle: of what keeps the
/// products of pairs the last has a sign alone, which changes where two pairs meet.
struct Crossings {
  double doubling = 0, branching = 0, torus = 0;

  double of(Bifurcation kind) const;
};
Crossings crossings_of(const Stability& stability);

/// How far the nearest of the multipliers that are not explained is from where such a bifurcation has one; infinite
/// where none could come there.
double multipliers_away_from(Bifurcation kind, const Stability& stability);

}  // namespace least::periodic
