// Mechanics of scenes given as text: which class of problem a form is.
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

/// A class of problem: its form and its capacity, as `metric_2`.
struct TextForm {
  std::string_view name;
  std::shared_ptr<const Mechanics> (*make)(text::TextScene scene);
};
/// Those of this build; it may leave some out.
std::span<const TextForm> text_forms();

/// The mechanics of a scene that was read, or what is wrong with it. Throws as the next.
std::variant<std::shared_ptr<const Mechanics>, std::vector<text::DefinitionFault>> mechanics_of(text::TextScene scene);

/// The mechanics that a definition describes, or everything that is wrong with it. Throws std::runtime_error where this
/// build leaves the form out.
std::variant<std::shared_ptr<const Mechanics>, std::vector<text::DefinitionFault>> custom_mechanics(
    text::Definition definition);
/// The same of a scene as it was typed, whose texts may speak of many of a kind.
std::variant<std::shared_ptr<const Mechanics>, std::vector<text::DefinitionFault>> custom_mechanics(
    text::TypedScene typed);

}  // namespace least
