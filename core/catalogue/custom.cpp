#include "core/catalogue/custom.hpp"

#include <string>

#include "core/catalogue/found_schemes.hpp"
#include "core/catalogue/sized_mechanics.hpp"
#include "core/memory_budget.hpp"
#include "core/text/large_scene_turn.hpp"
#include "core/text/sized_scene.hpp"

namespace least {
namespace {

using Made = std::variant<std::shared_ptr<const Mechanics>, std::vector<text::DefinitionFault>>;

Made too_many_operations(tape::Index limit) {
  const std::string most = std::to_string(limit) + " when all of them are written out";
  return std::vector<text::DefinitionFault>{{"", {0, "its equations of motion take too many operations", most}, false}};
}

}  // namespace

std::variant<std::shared_ptr<const Mechanics>, std::vector<text::DefinitionFault>> custom_mechanics(
    text::Definition definition) {
  auto read = text::TextScene::read(std::move(definition));
  if (auto* faults = std::get_if<std::vector<text::DefinitionFault>>(&read)) return std::move(*faults);
  return mechanics_of(std::get<text::TextScene>(std::move(read)));
}

std::variant<std::shared_ptr<const Mechanics>, std::vector<text::DefinitionFault>> mechanics_of(text::TextScene scene) {
  if (!text::SizedScene::has(*scene.form))
    return std::vector<text::DefinitionFault>{
        {"/lagrangian",
         {0, "couples the velocities of too many coordinates",
          "at most " + std::to_string(text::Velocities::most_coupled) + " where it is not quadratic in them"},
         false}};
  // Derivatives by velocities go through the tape operation by operation.
  if (scene.form->kind == text::FormKind::lagrangian && scene.form->tape.has_terms())
    scene.form = text::with_sums_written_out(scene.form);
  if (!scene.form) return too_many_operations(tape::most_of_equations);
  const bool inverts = scene.form->full_mass && !scene.form->momenta.empty();
  try {
    return with_found_schemes(sized_mechanics(std::move(scene)));
  } catch (const tape::TooManyOperations&) {
    if (inverts)
      return std::vector<text::DefinitionFault>{
          {"/lagrangian",
           {0, "its masses couple too many coordinates: the inverse of their matrix takes too many operations",
            std::to_string(text::SizedScene::most_equations) +
                ", enough for some 330 coordinates that all hang together"},
           false}};
    return too_many_operations(text::SizedScene::most_equations);
  }
}

std::variant<std::shared_ptr<const Mechanics>, std::vector<text::DefinitionFault>> custom_mechanics(
    text::TypedScene typed) {
  const text::LargeSceneTurn turn;
  auto read = text::WrittenOut::of(std::move(typed));
  if (auto* faults = std::get_if<std::vector<text::DefinitionFault>>(&read)) return std::move(*faults);
  const auto& written = std::get<text::WrittenOut>(read);
  constexpr std::size_t bytes_of_character = 24;  // with the origin of each character
  if (written.definition().characters() > text::most_characters) text::LargeSceneTurn::take();
  const Held held = HeldByThread::take_soon(bytes_of_character * written.definition().characters());
  auto made = custom_mechanics(written.definition());
  if (auto* faults = std::get_if<std::vector<text::DefinitionFault>>(&made))
    for (auto& fault : *faults) fault = written.as_typed(std::move(fault));
  return made;
}

}  // namespace least
