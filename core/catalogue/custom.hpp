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

/// The mechanics of a scene that was read, or what is wrong with it.
std::variant<std::shared_ptr<const Mechanics>, std::vector<text::DefinitionFault>> mechanics_of(text::TextScene scene);

/// The mechanics that a definition describes, or everything that is wrong with it.
std::variant<std::shared_ptr<const Mechanics>, std::vector<text::DefinitionFault>> custom_mechanics(
    text::Definition definition);
/// The same of a scene as it was typed, whose texts may speak of many of a kind.
std::variant<std::shared_ptr<const Mechanics>, std::vector<text::DefinitionFault>> custom_mechanics(
    text::TypedScene typed);

}  // namespace least
