// The velocities of a start that is given in momenta.
#pragma once

#include <span>
#include <vector>

#include "core/text/scene.hpp"

namespace least::text {

/// v with ∂L/∂v(q, v, s, t) = p, one per coordinate, of a scene that takes velocities: by Newton's iteration from v =
/// 0, which ends after one step where L is quadratic in the velocities. `state` holds the variables of the card with
/// momenta. Not finite where there is no such v.
std::vector<double> velocities_of(const TextScene& scene, std::span<const double> parameters, double t,
                                  const std::vector<double>& state);

}  // namespace least::text
