// Problems of the catalogue as forms of scenes as text: their mechanics, which is generic in the number type, is
// recorded.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/run/mechanics.hpp"
#include "core/tape/program.hpp"
#include "core/text/scene.hpp"

namespace least {

/// recorded_text returns a problem of the catalogue as a scene as text that consists of its form alone, with these
/// parameters as numbers; empty if it is not in the catalogue. `backward`: the form of the backward motion
/// (core/catalogue/backward.hpp).
std::optional<text::TextScene> recorded_text(const ProblemCard& problem, std::span<const double> parameters,
                                             bool backward);
/// recorded_in_parameters returns the form of such a scene with the parameters that are `varied`, in the order of the
/// card, and numbers, as variables of the tape; the other parameters have the scene's values. `backward`: the form of
/// the backward motion.
std::shared_ptr<const text::Form> recorded_in_parameters(const Scene& scene, const std::vector<bool>& varied,
                                                         bool backward);
/// recorded_equations returns the equations of motion of a scene of the catalogue as a program for the scheme `taylor`.
/// Parameters that are `varied` are constant variables after those of the motion, in the order of the card; the others
/// are numbers. Empty if the problem is not in the catalogue.
std::optional<tape::Program> recorded_equations(const Scene& scene, const std::vector<bool>& varied);

}  // namespace least
