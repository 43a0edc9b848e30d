// Multipliers of a closed orbit.
#pragma once

#include "core/periodic/closed_orbit.hpp"
#include "core/periodic/shooting.hpp"

namespace least::periodic {

/// stability_of computes the multipliers. The known unit ones, most of which belong to Jordan blocks, are split off
/// first, so that the others keep full precision. In contact scenes the multipliers are those of (q, p), which
/// parametrise the contact hyperplanes.
Stability stability_of(const Shooting& shooting, Motion& motion, const Setting& setting, const Trial& trial,
                       const Look& look, Effort& effort);

}  // namespace least::periodic
