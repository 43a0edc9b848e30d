// Tangents of the steps of a class of problems that has room for more coordinates than a scene has, as those of the
// scene: of what the catalogue's problems are recorded as.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "core/run/tangent_map.hpp"

namespace least {

/// Where the components of a scene with n coordinates stand among those of a state with room for more: q, p, and s.
std::vector<std::size_t> places_in(std::size_t n, std::size_t room, bool acting);
/// The same tangents; what they refer to lives as long as they do.
StepTangents keeping(std::shared_ptr<const void> owner, StepTangents tangents);
/// Tangents of a problem with room for `room` coordinates as those of a scene that has n.
StepTangents without_room(StepTangents roomy, std::size_t n, std::size_t room, bool acting);

}  // namespace least
