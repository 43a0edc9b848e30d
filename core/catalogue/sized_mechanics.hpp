// Scenes as text of any size, as mechanics.
#pragma once

#include <memory>

#include "core/run/mechanics.hpp"
#include "core/text/scene.hpp"

namespace least {

/// Of a form that text::SizedScene has. Throws tape::TooManyOperations where its equations of motion take more than
/// those of a scene may.
std::shared_ptr<const Mechanics> sized_mechanics(text::TextScene scene);

}  // namespace least
