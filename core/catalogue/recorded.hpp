// Problems of the catalogue as forms of scenes as text: their mechanics, which is generic in the number, is recorded.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/run/mechanics.hpp"
#include "core/tape/program.hpp"
#include "core/text/scene.hpp"

namespace least {

/// A problem of the catalogue as a text that nobody wrote, whose form is all that there is, with these parameters as
/// numbers; none where it is none of the catalogue. `backward`: what moves forward as it moves backward
/// (core/catalogue/backward.hpp).
std::optional<text::TextScene> recorded_text(const ProblemCard& problem, std::span<const double> parameters,
                                             bool backward);
/// The form of such a scene with those parameters as variables of the tape that are `varied`, in the order of the card,
/// and numbers; the others are those of the scene. `backward`: of what moves forward as it moves backward.
std::shared_ptr<const text::Form> recorded_in_parameters(const Scene& scene, const std::vector<bool>& varied,
                                                         bool backward);
/// The equations of motion of a scene of the catalogue, as the scheme `taylor` has them, with its parameters as numbers
/// but for those that are `varied`, which are variables that rest, after those of the motion in the order of the card.
/// None where velocities are found by iteration.
std::optional<tape::Program> recorded_equations(const Scene& scene, const std::vector<bool>& varied);

}  // namespace least
