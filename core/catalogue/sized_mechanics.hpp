// Scenes as text of any size, as mechanics.
#pragma once

#include <memory>

#include "core/run/mechanics.hpp"
#include "core/text/scene.hpp"

namespace least {

/// sized_mechanics returns the mechanics of a scene whose form text::SizedScene supports. Throws
/// tape::TooManyOperations if its equations of motion take more operations than those of a scene may.
std::shared_ptr<const Mechanics> sized_mechanics(text::TextScene scene);

}  // namespace least
