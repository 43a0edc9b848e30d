#include "core/catalogue/custom.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "core/catalogue/found_schemes.hpp"
#include "core/catalogue/sized_mechanics.hpp"
#include "core/memory_budget.hpp"
#include "core/text/large_scene_turn.hpp"
#include "core/text/sized_scene.hpp"

namespace least {
namespace {

std::string class_of(const text::Form& form, int capacity) {
  const bool quadratic = form.kind == text::FormKind::contact_quadratic;
  const std::string_view name = text::form_names[static_cast<std::size_t>(form.kind)];
  return std::string(quadratic ? "quadratic" : name) + "_" + std::to_string(capacity);
}

using Made = std::variant<std::shared_ptr<const Mechanics>, std::vector<text::DefinitionFault>>;

Made too_many_operations(tape::Index limit) {
  const std::string most = std::to_string(limit) + " when all of them are written out";
  return std::vector<text::DefinitionFault>{{"", {0, "its equations of motion take too many operations", most}, false}};
}

Made of_any_size(text::TextScene scene) {
  if (!text::SizedScene::has(*scene.form))
    return std::vector<text::DefinitionFault>{
        {"/variables",
         {0, "are more than a Lagrangian not quadratic in the velocities or a term quadratic in s goes with",
          "1 to " + std::to_string(text::compiled_coordinates) + " of those"},
         false}};
  try {
    return with_found_schemes(sized_mechanics(std::move(scene)));
  } catch (const tape::TooManyOperations&) {
    return too_many_operations(text::SizedScene::most_equations);
  }
}

}  // namespace

std::variant<std::shared_ptr<const Mechanics>, std::vector<text::DefinitionFault>> custom_mechanics(
    text::Definition definition) {
  auto read = text::TextScene::read(std::move(definition));
  if (auto* faults = std::get_if<std::vector<text::DefinitionFault>>(&read)) return std::move(*faults);
  return mechanics_of(std::get<text::TextScene>(std::move(read)));
}

std::variant<std::shared_ptr<const Mechanics>, std::vector<text::DefinitionFault>> mechanics_of(text::TextScene scene) {
  if (!scene.form->has_class()) return of_any_size(std::move(scene));
  const std::string wanted = class_of(*scene.form, scene.capacity);
  auto form = std::ranges::find(text_forms(), wanted, &TextForm::name);
  if (form == text_forms().end() && scene.capacity < text::compiled_coordinates) {
    scene.capacity = text::compiled_coordinates;
    form = std::ranges::find(text_forms(), class_of(*scene.form, scene.capacity), &TextForm::name);
  }
  if (form == text_forms().end()) throw std::runtime_error("this build leaves out scenes of the form " + wanted);
  try {
    return with_found_schemes(form->make(std::move(scene)));
  } catch (const tape::TooManyOperations&) {
    return too_many_operations(tape::most_of_equations);
  }
}

std::variant<std::shared_ptr<const Mechanics>, std::vector<text::DefinitionFault>> custom_mechanics(
    text::TypedScene typed) {
  const text::LargeSceneTurn turn;
  auto read = text::WrittenOut::of(std::move(typed));
  if (auto* faults = std::get_if<std::vector<text::DefinitionFault>>(&read)) return std::move(*faults);
  const auto& written = std::get<text::WrittenOut>(read);
  constexpr std::size_t bytes_of_character = 24;  // with where each comes from
  if (written.definition().characters() > text::most_characters) text::LargeSceneTurn::take();
  const Held held = HeldByThread::take_soon(bytes_of_character * written.definition().characters());
  auto made = custom_mechanics(written.definition());
  if (auto* faults = std::get_if<std::vector<text::DefinitionFault>>(&made))
    for (auto& fault : *faults) fault = written.as_typed(std::move(fault));
  return made;
}

}  // namespace least
