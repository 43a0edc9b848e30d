// Problems of the catalogue as forms of scenes as text: their mechanics, which is generic in the number, is recorded.
#pragma once

#include <memory>
#include <vector>

#include "core/run/mechanics.hpp"
#include "core/text/form.hpp"

namespace least {

/// What moves forward as the scene, a problem of the catalogue, moves backward (core/catalogue/backward.hpp): the form
/// with the scene's parameters as numbers. Null where the scene is none of the catalogue.
std::shared_ptr<const text::Form> recorded_backward(const Scene& scene);
/// The form of such a scene with those parameters as variables of the tape that are `varied`, in the order of the card,
/// and numbers; the others are those of the scene. `backward`: of what moves forward as it moves backward.
std::shared_ptr<const text::Form> recorded_in_parameters(const Scene& scene, const std::vector<bool>& varied,
                                                         bool backward);

}  // namespace least
