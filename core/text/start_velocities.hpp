// Starts that give momenta, or momenta of some coordinates and velocities of the others.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "core/text/scene.hpp"

namespace least::text {

/// Which half of a start is held fixed while one number of the start, or a parameter, changes.
inline constexpr std::array<std::string_view, 2> held_names{"momenta", "velocities"};

/// velocities_of returns v with ∂L/∂v(q, v, s, t) = p, one per coordinate, of a scene that takes velocities. Newton's
/// iteration begins at v = 0 and ends after one step where L is quadratic in the velocities. `state` has the order of
/// the card's variables, with momenta. The result is not finite where there is no such v.
std::vector<double> velocities_of(const TextScene& scene, std::span<const double> parameters, double t,
                                  const std::vector<double>& state);

/// make_momenta_of_start converts a start that gives momenta for the coordinates in `places` and velocities for the
/// others. `state` has the order of the card's variables, with velocities in the place of momenta, and is converted to
/// momenta; its velocities at `places` are the initial guess. Returns whether velocities with these momenta were found.
bool make_momenta_of_start(const TextScene& scene, std::span<const double> parameters, double t,
                           const std::vector<std::size_t>& places, const std::vector<double>& momenta,
                           std::vector<double>& state);

}  // namespace least::text
