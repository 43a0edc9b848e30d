// Schemes for scenes as text alone: no type of a problem tells whether such a scheme fits; that is found from the text
// when it is read. Their positions come after those of core/schemes/list.hpp.
#pragma once

#include <tuple>

#include "core/schemes/adaptive_boris.hpp"
#include "core/schemes/boris.hpp"
#include "core/schemes/harmonic_splitting.hpp"
#include "core/schemes/kepler_splitting.hpp"

namespace least {

using TextSchemeList = std::tuple<KeplerSplitting, Boris, AdaptiveBoris, HarmonicSplitting>;

}  // namespace least
