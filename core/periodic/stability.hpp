// Multipliers of a closed orbit.
#pragma once

#include "core/periodic/closed_orbit.hpp"
#include "core/periodic/shooting.hpp"

namespace least::periodic {

/// What a closed orbit's motion says of its multipliers; the others are found in what is left when the unit ones that
/// are explained, of which most stand in Jordan blocks, are taken out: so they keep their digits. Of contact scenes
/// they are those of (q, p), which stand for directions of the contact hyperplanes.
Stability stability_of(const Shooting& shooting, Motion& motion, const Setting& setting, const Trial& trial,
                       const Look& look, Effort& effort);

}  // namespace least::periodic
