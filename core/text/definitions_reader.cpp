#include "core/text/definitions_reader.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/text/names_in_text.hpp"
#include "core/text/text_reader.hpp"
#include "core/text/text_work.hpp"

namespace least::text {
namespace {

constexpr std::size_t most_told_of_definitions = 100;

std::string_view without_blanks(std::string_view text) {
  const auto from = text.find_first_not_of(" \t\n\r");
  return from == std::string_view::npos ? std::string_view()
                                        : text.substr(from, text.find_last_not_of(" \t\n\r") + 1 - from);
}

/// declaration(`d(i,j)`) returns the name and its indices; an empty name where the text is no declaration.
Vocabulary::Defined declaration(std::string_view typed) {
  Vocabulary::Defined made;
  const std::size_t open = typed.find('(');
  const std::string_view name = without_blanks(typed.substr(0, open));
  if (!is_name(name) || name.size() > longest_name) return {};
  if (open != std::string_view::npos) {
    if (typed.back() != ')') return {};
    for (std::size_t from = open + 1; from <= typed.size() - 1;) {
      const std::size_t to = std::min(typed.find(',', from), typed.size() - 1);
      const std::string_view letter = without_blanks(typed.substr(from, to - from));
      if (!is_name(letter)) return {};
      made.indices.emplace_back(letter);
      from = to + 1;
    }
  }
  made.name = name;
  return made;
}

using Taken = std::map<std::string, std::string_view, std::less<>>;

/// taken_names returns the names that no definition can have, and what they are.
Taken taken_names(const TypedScene& typed, const Vocabulary& vocabulary) {
  Taken taken{{"t", "the time"}, {"s", "the action"}, {"pi", "the constant"}, {"energy", "the energy"}};
  for (const auto function : function_names()) taken.emplace(function, "a function");
  for (const auto* const word : {"sum", "prod", "if", "mod"}) taken.emplace(word, "a word of the language");
  for (const std::string& declared : typed.scene.variables) {
    const std::string name = declared.substr(0, declared.find('['));
    taken.emplace(name, "a variable");
    if (typed.scene.kind == Definition::Kind::equations) continue;
    taken.emplace(velocity_name(name), "a velocity");
    taken.emplace(momentum_name(name), "a momentum");
  }
  for (const auto& [name, value] : typed.scene.parameters) taken.emplace(name, "a parameter");
  for (const auto& [name, count] : vocabulary.lists) taken.emplace(name, "a list");
  return taken;
}

/// name_below returns a fault where a definition uses itself or one that is not above it. `stated` has the names of
/// all definitions, `one` the definition itself, `above` those above it.
std::optional<Fault> name_below(const Vocabulary::Defined& one, const Definitions& above, const Names& stated) {
  Names indices = indices_set_in(one.text);
  indices.insert(one.indices.begin(), one.indices.end());
  std::optional<Fault> found;
  each_name(one.text, [&](std::size_t at, std::string_view name) {
    if (found || !stated.contains(name) || indices.contains(name) || above.number_of(name) < above.size()) return;
    found = Fault{at,
                  name == one.name ? std::string(name) + " is this definition itself, and none may use itself"
                                   : std::string(name) + " is a definition further down",
                  "definitions above this one"};
  });
  return found;
}

}  // namespace

std::vector<DefinitionFault> read_definitions(const TypedScene& typed, bool keeps, Vocabulary& vocabulary) {
  std::vector<DefinitionFault> faults;
  const auto refuse = [&](const std::string& key, Fault fault, bool in_text) {
    if (faults.size() < most_told_of_definitions)
      faults.push_back({pointer_to("/definitions/", key), std::move(fault), in_text});
  };
  Taken taken = taken_names(typed, vocabulary);
  Names stated;
  std::vector<Vocabulary::Defined> read;
  for (const auto& [key, text] : typed.definitions) {
    Vocabulary::Defined& made = read.emplace_back(declaration(key));
    made.text = text;
    if (made.name.empty()) {
      refuse(key, {0, "\"" + key.substr(0, 40) + "\" cannot be a name", "as r or d(i, j)", {}}, false);
    } else if (const auto [known, is_new] = taken.emplace(made.name, "a definition"); !is_new) {
      refuse(
          key,
          {0,
           made.name + " is something else already, " + std::string(known->second) + ": it cannot be a definition, too",
           "names that differ",
           {}},
          false);
      made.name.clear();
    } else {
      stated.insert(made.name);
    }
  }
  TextWork work;
  Vocabulary brief = vocabulary;  // its definitions are as short as can be
  bool fits = true;
  for (std::size_t i = 0; i < read.size(); ++i) {
    Vocabulary::Defined& one = read[i];
    const std::string& key = typed.definitions[i].first;
    std::size_t place = 0;
    one.size = size_of(one.text, vocabulary, {}, keeps, place);
    if (one.name.empty()) {
      // Its fault is known. It keeps its number, and no text can name it.
    } else if (auto below = name_below(one, vocabulary.definitions, stated)) {
      refuse(key, std::move(*below), true);
    } else if (!fits || exceeds(one.size, keeps)) {
      // Those below are too large, too, if they use it: none of them is read.
      if (std::exchange(fits, false)) refuse(key, too_many_operations_at(place), true);
      one.text = "1";
      one.size = {};
    } else if (one.indices.empty()) {
      const auto expanded = Expansion::of(one.text, brief);
      // Other faults are found where the definition is used.
      if (const auto* const expansion = std::get_if<Expansion>(&expanded)) {
        auto parsed = Expression::parse(expansion->text());
        if (auto* const fault = std::get_if<Fault>(&parsed); fault && !expansion->origin(fault->position).definition) {
          fault->position = expansion->origin(fault->position).position;
          refuse(key, std::move(*fault), true);
        }
      }
    }
    brief.definitions.push_back({one.name, one.indices, "0"});
    vocabulary.definitions.push_back(std::move(one));
  }
  return faults;
}

}  // namespace least::text
