// Schemes for scenes as text alone: whether one fits no type of problem says, it is found in the text when it is read.
// Their positions come after those of core/schemes/list.hpp.
#pragma once

#include <tuple>

#include "core/schemes/adaptive_boris.hpp"
#include "core/schemes/boris.hpp"
#include "core/schemes/harmonic_splitting.hpp"
#include "core/schemes/kepler_splitting.hpp"

namespace least {

using TextSchemeList = std::tuple<KeplerSplitting, Boris, AdaptiveBoris, HarmonicSplitting>;

}  // namespace least
