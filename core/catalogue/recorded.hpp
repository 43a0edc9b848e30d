// Problems of the catalogue as forms of scenes as text: their mechanics, which is generic in the number, is recorded.
#pragma once

#include <memory>

#include "core/run/mechanics.hpp"
#include "core/text/form.hpp"

namespace least {

/// What moves forward as the scene, a problem of the catalogue, moves backward (core/catalogue/backward.hpp): the form
/// with the scene's parameters as numbers. Null where the scene is none of the catalogue.
std::shared_ptr<const text::Form> recorded_backward(const Scene& scene);

}  // namespace least
