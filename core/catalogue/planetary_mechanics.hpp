// kepler_splitting for scenes as text, whatever class they are of: runs by it take the scene as one whose size is known
// when it runs, and everything else is that of its class.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "core/run/mechanics.hpp"

namespace least {

/// The same mechanics, with kepler_splitting where the text has what that needs.
std::shared_ptr<const Mechanics> with_kepler_splitting(std::shared_ptr<const Mechanics> made);

/// What a scheme that is found in the text of a scene has against this one, with its parameters, in words; empty:
/// nothing, or it is another kind of scheme or scene.
std::string objection_to_scheme(const Scene& scene, std::string_view scheme);

}  // namespace least
