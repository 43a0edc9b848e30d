#include "core/text/definition.hpp"

#include <array>
#include <bit>

#include "core/text/written_out.hpp"

namespace least::text {
namespace {

std::string in_place_of_q(char letter, std::string_view coordinate) {
  std::string name(1, letter);
  return name.append(coordinate.starts_with('q') ? coordinate.substr(1) : coordinate);
}

}  // namespace

std::string velocity_name(std::string_view coordinate) { return in_place_of_q('v', coordinate); }
std::string momentum_name(std::string_view coordinate) { return in_place_of_q('p', coordinate); }

std::span<const std::string_view> reserved_keys() {
  static constexpr std::array<std::string_view, 20> keys{"id",          "preset",      "title",      "variables",
                                                         "parameters",  "definitions", "lagrangian", "hamiltonian",
                                                         "potential",   "masses",      "damping",    "action_curvature",
                                                         "offset",      "equations",   "invariants", "forces",
                                                         "dissipation", "note",        "views",      "bodies"};
  return keys;
}

std::span<const std::string_view> column_names() {
  static constexpr std::array<std::string_view, 6> names{
      "step_size", "mode", "parameter", "error", "discrete_energy", "mechanical_energy"};
  return names;
}

std::size_t Definition::characters() const {
  std::size_t count = formula.size();
  for (const auto* text : {&damping, &action_curvature, &offset, &dissipation}) count += text->value_or("").size();
  for (const Named* named : {&masses, &equations, &invariants, &forces})
    for (const auto& [name, text] : *named) count += text.size();
  return count;
}

std::string Definition::key() const {
  std::string key = "custom:" + std::to_string(static_cast<int>(kind));
  const auto append = [&](std::string_view part) { key.append(std::to_string(part.size())).append(":").append(part); };
  const auto append_all = [&](const Named& named) {
    append(std::to_string(named.size()));
    for (const auto& [name, text] : named) append(name), append(text);
  };
  append(title);
  append(std::to_string(variables.size()));
  for (const auto& name : variables) append(name);
  append(std::to_string(parameters.size()));
  for (const auto& [name, value] : parameters)
    append(name), append(std::to_string(std::bit_cast<std::uint64_t>(value)));
  append(formula);
  append_all(masses);
  for (const auto* text : {&damping, &action_curvature, &offset}) append(*text ? "=" + **text : "");
  append_all(equations);
  append_all(invariants);
  if (sums) {  // the texts have only the first terms of kept sums, but the typed text determines the others
    append(typed->scene.formula);
    append_all(typed->scene.equations);
    append_all(typed->definitions);
    for (const auto& [name, value] : typed->scene.parameters)
      append(name), append(std::to_string(std::bit_cast<std::uint64_t>(value)));
  }
  if (backward) append("backward");
  if (is_forced()) {
    append_all(forces);
    append(dissipation ? "=" + *dissipation : "");
  }
  return key;
}

}  // namespace least::text
