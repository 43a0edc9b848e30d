// Starts that are given in momenta, or in momenta of some coordinates and velocities of the others.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "core/text/scene.hpp"

namespace least::text {

/// What stays of a start where one number of it, or a parameter, changes.
inline constexpr std::array<std::string_view, 2> held_names{"momenta", "velocities"};

/// v with ∂L/∂v(q, v, s, t) = p, one per coordinate, of a scene that takes velocities: by Newton's iteration from v =
/// 0, which ends after one step where L is quadratic in the velocities. `state` holds the variables of the card with
/// momenta. Not finite where there is no such v.
std::vector<double> velocities_of(const TextScene& scene, std::span<const double> parameters, double t,
                                  const std::vector<double>& state);

/// All momenta of a start of which the coordinates in `places` have momenta and the others have velocities. `state`
/// holds the variables of the card with velocities in the place of momenta, which they become; those at `places` are
/// where the search begins. Whether velocities were found that these momenta have.
bool make_momenta_of_start(const TextScene& scene, std::span<const double> parameters, double t,
                           const std::vector<std::size_t>& places, const std::vector<double>& momenta,
                           std::vector<double>& state);

}  // namespace least::text
