#include "server/decode/custom_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/catalogue/custom.hpp"
#include "server/decode/further_faults.hpp"
#include "server/decode/pictures_reader.hpp"

namespace least::server {
namespace {

using text::Definition;

constexpr std::string_view text_or_number = "a formula as text, or a number";
constexpr auto& kinds = Definition::kind_names;

// read_text returns a formula; a number may stand for one where `numbers` is set.
std::optional<std::string> read_text(const Json& json, const FieldPath& path, bool numbers) {
  if (json.is_string()) return json.get<std::string>();
  if (numbers && json.is_number()) {
    if (const auto value = read_number(json, path, anywhere)) return fmt::format("{:.17g}", *value);
    return std::nullopt;
  }
  path.fault("must be a formula", json, numbers ? std::string(text_or_number) : "a formula as text");
  return std::nullopt;
}

void read_variables(const Json& json, const FieldPath& path, Definition& definition) {
  if (!json.is_array()) return path.fault("must be a list of names", json, "[\"x\", \"y\"], or [\"x[5]\"]");
  for (std::size_t i = 0; i < json.size() && !path.faults->full(); ++i) {
    if (json[i].is_string()) {
      definition.variables.push_back(json[i].get<std::string>());
    } else {
      path.at(i).fault("must be a name", json[i]);
    }
  }
}

// Faulty numbers and formulas are replaced by 1, so that further faults are found, too.
void read_parameters(const Json& json, const FieldPath& path, text::TypedScene& typed) {
  if (!json.is_object()) return path.fault("must be an object of numbers", json, "{\"mu\": 1, \"m\": [3, 4, 5]}");
  for (const auto& [name, entry] : json.items()) {
    if (path.faults->full()) return;
    if (!entry.is_array()) {
      typed.scene.parameters.emplace_back(name, read_number(entry, path.at(name), anywhere).value_or(1));
      continue;
    }
    auto& values = typed.lists.emplace_back(name, std::vector<double>()).second;
    for (std::size_t i = 0; i < entry.size() && !path.faults->full(); ++i)
      values.push_back(read_number(entry[i], path.at(name).at(i), anywhere).value_or(1));
  }
}

void read_texts(const Json& json, const FieldPath& path, bool numbers, Definition::Named& texts) {
  if (!json.is_object()) return path.fault("must be an object of formulas", json, "{\"x\": \"…\"}");
  for (const auto& [name, entry] : json.items()) {
    if (path.faults->full()) return;
    texts.emplace_back(name, read_text(entry, path.at(name), numbers).value_or("1"));
  }
}

// kind_of returns which of the four kinds of mechanics is given; nothing where it is none or several.
std::optional<std::size_t> kind_of(const Json& problem, const FieldPath& path) {
  std::optional<std::size_t> kind;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (find(problem, kinds[i]) == nullptr) continue;
    if (kind) {
      path.at(kinds[i]).fault(fmt::format("and {} exclude each other", kinds[*kind]), problem[std::string(kinds[i])],
                              "exactly one of " + listed(kinds));
      return std::nullopt;
    }
    kind = i;
  }
  if (!kind) path.lacks("is a scene as text and says no mechanics", "exactly one of " + listed(kinds));
  return kind;
}

void add_fault(const text::DefinitionFault& wrong, const FieldPath& path) {
  const auto& [pointer, fault, in_text] = wrong;
  std::string detail = fault.detail;
  if (!fault.unknown.empty()) {
    Names known;
    for (std::size_t from = 0; from < fault.allowed.size();) {
      const std::size_t to = std::min(fault.allowed.find(", ", from), fault.allowed.size());
      known.push_back(std::string_view(fault.allowed).substr(from, to - from));
      from = to + 2;
    }
    detail += path.meant(fault.unknown, known);
  }
  path.faults->add({path.pointer + pointer,
                    std::move(detail),
                    {},
                    fault.allowed,
                    in_text ? std::optional(fault.position) : std::nullopt});
}

// take_sizes reads parameters of a known scene that are sizes of lists, given beside the id: they do not change numbers
// of the mechanics but lead to another one. Returns whether there are any.
bool take_sizes(const Json& problem, const FieldPath& path, const Mechanics* made, text::TypedScene& typed) {
  const text::TextScene* const text = made ? made->text() : nullptr;
  const text::Vocabulary* const words = text ? text->definition.vocabulary.get() : nullptr;
  bool any = false;
  for (auto& [name, value] : typed.scene.parameters) {
    const Json* const given = find(problem, name);
    if (given == nullptr || std::ranges::find(text::reserved_keys(), name) != text::reserved_keys().end()) continue;
    if (made && !(words && words->fixed.contains(name))) continue;
    if (const auto number = read_number(*given, path.at(name), anywhere)) value = *number;
    any = true;
  }
  return any;
}

std::shared_ptr<const Mechanics> made_of(text::TypedScene typed, const Json& problem, const FieldPath& path) {
  auto made = custom_mechanics(typed);
  const auto mechanics = [&] {
    const auto* const one = std::get_if<std::shared_ptr<const Mechanics>>(&made);
    return one ? *one : nullptr;
  };
  if (take_sizes(problem, path, mechanics().get(), typed)) made = custom_mechanics(typed);
  if (auto* const wrong = std::get_if<std::vector<text::DefinitionFault>>(&made)) {
    for (const auto& fault : *wrong) add_fault(fault, path);
    auto further = further_faults(std::move(typed), std::move(*wrong));
    for (const auto& fault : further.faults) add_fault(fault, path);
    return further.stand_in;
  }
  return mechanics();
}

// Whether a number that says how many there are of a kind could not be read: then nothing is known of the variables.
bool lacks_a_size(const Mechanics& mechanics, const FieldPath& path) {
  const text::Vocabulary* const words = mechanics.text()->definition.vocabulary.get();
  return words && std::ranges::any_of(words->fixed, [&](const auto& name) {
           return path.faults->within(path.at("parameters").at(name).pointer) ||
                  path.faults->within(path.at(name).pointer);
         });
}

}  // namespace

std::shared_ptr<const Mechanics> read_custom(const Json& problem, const FieldPath& path) {
  if (!problem.is_object()) {
    path.fault("is a scene as text: it needs its text", problem,
               "{\"id\": \"custom\", \"variables\": [\"x\"], \"potential\": \"x^2/2\"}");
    return nullptr;
  }
  Faults faults;
  const FieldPath here{path.pointer, &faults};
  text::TypedScene typed;
  Definition& definition = typed.scene;
  const auto kind = kind_of(problem, here);
  const auto with = [&](std::string_view key, auto&& read) {
    if (const Json* json = find(problem, key)) read(*json, here.at(key));
  };
  if (const Json* variables = find(problem, "variables")) {
    read_variables(*variables, here.at("variables"), definition);
  } else {
    here.at("variables").lacks("is required", "[\"x\", \"y\"]");
  }
  with("parameters", [&](const Json& json, const FieldPath& at) { read_parameters(json, at, typed); });
  with("definitions", [&](const Json& json, const FieldPath& at) { read_texts(json, at, true, typed.definitions); });
  with("invariants",
       [&](const Json& json, const FieldPath& at) { read_texts(json, at, false, definition.invariants); });
  with("forces", [&](const Json& json, const FieldPath& at) { read_texts(json, at, true, definition.forces); });
  with("dissipation",
       [&](const Json& json, const FieldPath& at) { definition.dissipation = read_text(json, at, true); });
  const auto with_text = [&](std::string_view key, std::size_t most, std::string& text) {
    with(key, [&](const Json& json, const FieldPath& at) {
      if (json.is_string() && json.get_ref<const std::string&>().size() <= most)
        text = json.get<std::string>();
      else
        at.fault("must be a text", json, fmt::format("at most {} characters", most));
    });
  };
  with_text("title", 200, definition.title);
  with_text("note", 1000, typed.note);
  typed.pictures = read_pictures(problem, here);
  if (kind) {
    definition.kind = static_cast<Definition::Kind>(*kind);
    with(kinds[*kind], [&](const Json& json, const FieldPath& at) {
      if (definition.kind == Definition::Kind::equations) {
        read_texts(json, at, true, definition.equations);
      } else {
        auto text = read_text(json, at, false);
        definition.formula = text ? std::move(*text) : simplest_formula(definition, {});
      }
    });
  }
  constexpr std::string_view of_potentials[] = {"masses", "damping", "action_curvature", "offset"};
  for (const auto key : of_potentials) {
    if (kind && definition.kind != Definition::Kind::potential)
      with(key, [&](const Json& json, const FieldPath& at) {
        at.fault("goes with a potential only", json, fmt::format("a term of the {}", kinds[*kind]));
      });
  }
  if (kind && definition.kind == Definition::Kind::potential) {
    with("masses", [&](const Json& json, const FieldPath& at) { read_texts(json, at, true, definition.masses); });
    with("damping", [&](const Json& json, const FieldPath& at) { definition.damping = read_text(json, at, true); });
    with("action_curvature",
         [&](const Json& json, const FieldPath& at) { definition.action_curvature = read_text(json, at, true); });
    with("offset", [&](const Json& json, const FieldPath& at) { definition.offset = read_text(json, at, true); });
  }
  const bool readable = kind && !faults.within(here.at("variables").pointer) &&
                        !faults.at(here.at("parameters").pointer) &&
                        !(definition.kind == Definition::Kind::equations && faults.at(here.at(kinds[*kind]).pointer));
  std::shared_ptr<const Mechanics> mechanics;
  if (readable) {
    mechanics = made_of(std::move(typed), problem, here);
    if (mechanics && !faults.empty() && lacks_a_size(*mechanics, here)) mechanics = nullptr;
  }
  if (!mechanics) {  // for a scene that could be read, the reader of its parameters checks the keys
    const auto reserved = text::reserved_keys();
    Names keys(reserved.begin(), reserved.end());
    if (const Json* parameters = find(problem, "parameters"); parameters && parameters->is_object())
      for (const auto& entry : parameters->items()) keys.push_back(entry.key());
    read_object(problem, here, keys, "custom");
  }
  for (const Fault& fault : faults.list()) path.faults->add(fault);
  return mechanics;
}

}  // namespace least::server
