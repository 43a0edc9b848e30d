// Mechanics of scenes given as text.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "core/run/mechanics.hpp"
#include "core/text/scene.hpp"
#include "core/text/written_out.hpp"

namespace least {

/// mechanics_of returns the mechanics of a scene that was read, or what is wrong with it.
std::variant<std::shared_ptr<const Mechanics>, std::vector<text::DefinitionFault>> mechanics_of(text::TextScene scene);

/// custom_mechanics returns the mechanics that a definition describes, or everything that is wrong with it.
std::variant<std::shared_ptr<const Mechanics>, std::vector<text::DefinitionFault>> custom_mechanics(
    text::Definition definition);
/// The same for a scene as it was typed, whose texts may define many of a kind at once.
std::variant<std::shared_ptr<const Mechanics>, std::vector<text::DefinitionFault>> custom_mechanics(
    text::TypedScene typed);

}  // namespace least
