// Starts at which the mechanics of a scene as text is not finite although its motion is: the pole of a sphere, where
// the angle around it means nothing. A motion that goes through the pole has no momentum around it, and the terms that
// are 0/0 there vanish identically beside it. Such a run may begin beside the pole instead, so close that the state is
// the same to twelve digits: where that is right is found out by runs from both sides and from another distance, which
// have to come to the same states. Where it is not, as with a momentum around the pole, there is no limit.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/run/mechanics.hpp"

namespace least {

/// Of a scene whose start is objected to: the start beside it, in the order of the card. Empty where the motion has no
/// limit there.
std::optional<std::vector<double>> start_beside(const Scene& scene);

/// Of a scene as text the coordinates, of a flow the variables, from which at rest a motion can begin: all 0, else one
/// of the first at 1, else 1, 2, 3 … . Empty where it cannot from there either.
std::optional<std::vector<double>> regular_start(const Scene& scene);

/// What to do about such a start where there is none, as a sentence; empty where nothing near by is any better.
std::string advice_on_start(const Scene& scene);

}  // namespace least
