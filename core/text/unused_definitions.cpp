#include "core/text/unused_definitions.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/text/names_in_text.hpp"
#include "core/text/text_reader.hpp"
#include "core/text/text_work.hpp"

namespace least::text {
namespace {

/// stated_names returns the names of the scene that its texts may use, the most telling first.
std::vector<std::string> stated_names(const TypedScene& typed, const Vocabulary& vocabulary) {
  std::vector<std::string> names;
  for (const std::string& declared : typed.scene.variables) {
    names.push_back(declared.substr(0, declared.find('[')));
    if (typed.scene.kind == Definition::Kind::equations) continue;
    names.push_back(velocity_name(names.back()));
    names.push_back(momentum_name(names[names.size() - 2]));
  }
  for (const auto& [name, value] : typed.scene.parameters) names.push_back(name);
  for (const auto& [name, values] : typed.lists) names.push_back(name);
  for (const auto& definition : vocabulary.definitions) names.push_back(definition.name);
  names.insert(names.end(), {"t", "s", "energy", "pi"});
  return names;
}

/// listed joins the first of these names.
std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t most = 50;
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), most); ++i) list.append(i == 0 ? "" : ", ").append(names[i]);
  return names.size() > most ? list + ", …" : list;
}

/// Returns the names that the texts of the mechanics contain.
Names spoken_names(const TypedScene& typed) {
  Names used;
  const auto use = [&](std::string_view text) {
    each_name(text, [&](std::size_t, std::string_view name) { used.emplace(name); });
  };
  const Definition& scene = typed.scene;
  use(scene.formula);
  for (const auto* named : {&scene.masses, &scene.equations, &scene.invariants, &scene.forces})
    for (const auto& [variable, text] : *named) use(text);
  for (const auto* text : {&scene.damping, &scene.action_curvature, &scene.offset, &scene.dissipation})
    use(text->value_or(""));
  return used;
}

/// Returns the names that the mechanics use, those of definitions with the names in their texts.
Names used_names(const TypedScene& typed, const Vocabulary& vocabulary) {
  Names used = spoken_names(typed);
  // A definition uses only those before it.
  std::for_each(vocabulary.definitions.rbegin(), vocabulary.definitions.rend(), [&](const Vocabulary::Defined& one) {
    if (used.contains(one.name)) each_name(one.text, [&](std::size_t, std::string_view name) { used.emplace(name); });
  });
  return used;
}

std::optional<Fault> unknown_name(const Vocabulary::Defined& definition, const Names& known) {
  Names indices = indices_set_in(definition.text);
  indices.insert(definition.indices.begin(), definition.indices.end());
  std::optional<Fault> found;
  each_name(definition.text, [&](std::size_t at, std::string_view name) {
    if (!found && !known.contains(name) && !indices.contains(name))
      found = Fault{at, "nobody knows the name " + std::string(name), {}, std::string(name)};
  });
  return found;
}

}  // namespace

std::vector<DefinitionFault> faults_in_unused(const TypedScene& typed, const Vocabulary& vocabulary) {
  constexpr std::size_t most_told = 100;
  Names spoken = spoken_names(typed);
  for (const auto& [key, text] : typed.definitions)
    each_name(text, [&](std::size_t, std::string_view name) { spoken.emplace(name); });
  std::vector<DefinitionFault> faults;
  const auto pointer_of = [&](std::size_t definition) {
    return pointer_to("/definitions/", typed.definitions[definition].first);
  };
  TextWork work;
  std::size_t left = most_written;
  for (std::size_t i = 0; i < vocabulary.definitions.size() && faults.size() < most_told; ++i) {
    const Vocabulary::Defined& one = vocabulary.definitions[i];
    if (!one.indices.empty() || spoken.contains(one.name)) continue;
    if (!exceeds(one.size, false) && one.size.characters > left) continue;
    auto made = Expansion::of(one.text, vocabulary);
    if (auto* wrong = std::get_if<Expansion::Wrong>(&made)) {
      faults.push_back({pointer_of(wrong->definition.value_or(i)), std::move(wrong->fault)});
      continue;
    }
    auto& expansion = std::get<Expansion>(made);
    left -= std::min(left, expansion.text().size());
    auto parsed = Expression::parse(expansion.text(), most_written);
    if (auto* fault = std::get_if<Fault>(&parsed)) {
      const Expansion::Place place = expansion.origin(fault->position);
      fault->position = place.position;
      faults.push_back({pointer_of(place.definition.value_or(i)), std::move(*fault)});
    }
  }
  return faults;
}

std::vector<DefinitionFault> unknown_names_in_unused(const TypedScene& typed, const Vocabulary& vocabulary) {
  constexpr std::size_t most_told = 100;
  const Names used = used_names(typed, vocabulary);
  const std::vector<std::string> stated = stated_names(typed, vocabulary);
  Names known(stated.begin(), stated.end());
  known.insert({"sum", "prod", "if", "mod", "and", "or", "not"});
  for (const auto function : function_names()) known.emplace(function);
  std::vector<DefinitionFault> faults;
  for (std::size_t i = 0; i < vocabulary.definitions.size() && faults.size() < most_told; ++i) {
    const Vocabulary::Defined& definition = vocabulary.definitions[i];
    if (used.contains(definition.name)) continue;
    auto fault = unknown_name(definition, known);
    if (!fault) continue;
    fault->allowed = listed(stated);
    faults.push_back({pointer_to("/definitions/", typed.definitions[i].first), std::move(*fault)});
  }
  return faults;
}

}  // namespace least::text
