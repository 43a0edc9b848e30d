// Starts at which the mechanics of a scene as text is not finite although its motion is: the pole of a sphere, where
// the azimuth is undefined. A motion through the pole has no momentum around it, and terms that are 0/0 at the pole
// vanish identically next to it. Such a run may start next to the pole instead, so close that the state agrees in
// twelve digits. Whether that is right is tested by runs from both sides and from another distance, which have to reach
// the same states. Otherwise, as with a momentum around the pole, there is no limit.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/run/mechanics.hpp"

namespace least {

/// start_beside returns a start next to that of a scene whose start is not regular, in the order of the card. Empty if
/// the motion has no limit there.
std::optional<std::vector<double>> start_beside(const Scene& scene);

/// regular_start returns coordinates (for a flow, variables) from which a motion at rest can start: all 0, else one of
/// the first four at 1 and the others 0, else 1, 2, 3, … Empty if none of these is regular.
std::optional<std::vector<double>> regular_start(const Scene& scene);

/// advice_on_start returns a sentence that suggests a regular start near by or a little later; empty if there is none.
std::string advice_on_start(const Scene& scene);

}  // namespace least
