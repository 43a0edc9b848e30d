#include "core/text/written_out.hpp"

#include <algorithm>
#include <cmath>

#include "core/text/characters.hpp"
#include "core/text/scene.hpp"
#include "core/text/text_reader.hpp"
#include "core/text/unused_definitions.hpp"

namespace least::text {
namespace {

constexpr std::array<std::string_view, 4> words_of_expansion{"sum", "prod", "if", "mod"};

std::string_view trimmed(std::string_view text) {
  const auto from = text.find_first_not_of(" \t\n\r");
  return from == std::string_view::npos ? std::string_view()
                                        : text.substr(from, text.find_last_not_of(" \t\n\r") + 1 - from);
}

/// declaration(`d(i,j)`) returns the name and its indices; an empty name where the text is no declaration.
Vocabulary::Defined declaration(std::string_view typed) {
  Vocabulary::Defined made;
  const std::size_t open = typed.find('(');
  const std::string_view name = trimmed(typed.substr(0, open));
  if (!is_name(name) || name.size() > longest_name) return {};
  if (open != std::string_view::npos) {
    if (typed.back() != ')') return {};
    for (std::size_t from = open + 1; from <= typed.size() - 1;) {
      const std::size_t to = std::min(typed.find(',', from), typed.size() - 1);
      const std::string_view letter = trimmed(typed.substr(from, to - from));
      if (!is_name(letter)) return {};
      made.indices.emplace_back(letter);
      from = to + 1;
    }
  }
  made.name = name;
  return made;
}

}  // namespace

/// SceneWriter writes out one scene. It repeats until it is known which whole-number constants are used in bounds and
/// indices: these are numbers everywhere in the scene.
class SceneWriter {
 public:
  explicit SceneWriter(TypedScene typed) : typed_(std::make_shared<const TypedScene>(std::move(typed))) {}

  std::variant<WrittenOut, std::vector<DefinitionFault>> write() {
    count_characters();
    read_vocabulary();
    if (faults_.empty()) declare_variables();
    const bool declared = faults_.empty();
    if (declared) read_definitions();
    if (declared) choose_sums();
    do {
      vocabulary_.fixed = used_;
      if (declared) write_texts();
    } while (faults_.empty() && vocabulary_.fixed != used_);
    if (faults_.empty()) read_unused();
    if (faults_.empty()) faults_ = unknown_names_in_unused(*typed_, vocabulary_);
    if (!faults_.empty()) return std::move(faults_);
    Definition& made = out_.definition_;
    if (!sums_.all.empty()) made.sums = std::make_shared<const KeptSums>(std::move(sums_));
    for (const auto& [name, value] : given().parameters)
      if (!vocabulary_.fixed.contains(name)) made.parameters.emplace_back(name, value);
    for (const auto& [name, values] : typed_->lists)
      for (std::size_t i = 0; i < values.size(); ++i)
        made.parameters.emplace_back(element_name(name, static_cast<std::int64_t>(i) + 1), values[i]);
    const bool more = !typed_->note.empty() || !typed_->pictures.empty();
    if (changed_ || more || !typed_->lists.empty() || !typed_->definitions.empty()) {
      made.typed = typed_;
      made.vocabulary = std::make_shared<const Vocabulary>(vocabulary_);
    }
    return std::move(out_);
  }

 private:
  const Definition& given() const { return typed_->scene; }
  void fault(std::string pointer, std::string detail, std::string allowed) {
    faults_.push_back({std::move(pointer), {0, std::move(detail), std::move(allowed), {}}, false});
  }

  void count_characters() {
    std::size_t count = 0;
    const auto add = [&](const std::string& pointer, const std::string& text) {
      if (count <= most_characters && (count += text.size()) > most_characters)
        fault(pointer, "the texts of the scene are too long together", std::to_string(most_characters) + " characters");
    };
    add(mechanics(), given().formula);
    const std::pair<const char*, const Definition::Named*> all[] = {{"/masses/", &given().masses},
                                                                    {"/equations/", &given().equations},
                                                                    {"/invariants/", &given().invariants},
                                                                    {"/forces/", &given().forces},
                                                                    {"/definitions/", &typed_->definitions}};
    for (const auto& [key, named] : all)
      for (const auto& [name, text] : *named) add(pointer_to(key, name), text);
    add("/damping", given().damping.value_or(""));
    add("/action_curvature", given().action_curvature.value_or(""));
    add("/offset", given().offset.value_or(""));
    add("/dissipation", given().dissipation.value_or(""));
  }
  /// mechanics() returns the JSON pointer of L, H, V or the equations.
  std::string mechanics() const {
    return std::string("/").append(Definition::kind_names[static_cast<std::size_t>(given().kind)]);
  }

  void read_vocabulary() {
    constexpr double largest = 1e9;
    for (const auto& [name, value] : given().parameters)
      if (value == std::floor(value) && std::abs(value) <= largest)
        vocabulary_.constants.emplace(name, static_cast<std::int64_t>(value));
    for (const auto& [name, values] : typed_->lists) {
      if (values.empty() || values.size() > static_cast<std::size_t>(most_parameters)) {
        fault(pointer_to("/parameters/", name), "is a list of too few or too many numbers",
              "1 to " + std::to_string(most_parameters));
      } else if (!is_name(name)) {
        fault(pointer_to("/parameters/", name), "\"" + name.substr(0, 40) + "\" cannot be a name",
              "a letter, then letters, digits, _");
      } else {
        vocabulary_.lists.emplace(name, static_cast<std::int64_t>(values.size()));
      }
    }
  }

  void declare_variables() {
    for (std::size_t i = 0; i < given().variables.size(); ++i) {
      const std::string& typed = given().variables[i];
      const std::string pointer = "/variables/" + std::to_string(i);
      const std::size_t open = typed.find('[');
      if (open == std::string::npos || typed.back() != ']' || !is_name(typed.substr(0, open))) {
        out_.definition_.variables.push_back(typed);
        out_.declared_.push_back(i);
        continue;
      }
      changed_ = true;
      const std::string name = typed.substr(0, open);
      const auto count = read_index(typed, open + 1, typed.size() - 1, vocabulary_, {}, used_);
      if (const auto* wrong = std::get_if<Fault>(&count)) {
        fault(pointer, wrong->detail, wrong->allowed);
        continue;
      }
      const auto most = static_cast<std::int64_t>(most_variables_of_kind());
      if (const auto n = std::get<std::int64_t>(count); n < 1 || n > most) {
        fault(pointer, n < 1 ? "must have at least one element" : "has too many elements",
              "1 to " + std::to_string(most));
        continue;
      }
      const auto n = std::get<std::int64_t>(count);
      std::vector<std::string> names{name};
      if (given().kind != Definition::Kind::equations)
        names.insert(names.end(), {velocity_name(name), momentum_name(name)});
      for (const std::string& one : names)
        if (!vocabulary_.lists.emplace(one, n).second || vocabulary_.constants.contains(one))
          fault(pointer, one + " is two things at once", "names that differ");
      // One variable beyond the limit is enough for a refusal.
      for (std::int64_t k = 1; k <= n && out_.definition_.variables.size() <= most_variables_of_kind(); ++k) {
        out_.definition_.variables.push_back(element_name(name, k));
        out_.declared_.push_back(i);
      }
    }
  }

  void read_definitions() {
    const auto known = function_names();
    const auto taken = [&](const std::string& name) {
      const auto is = [&](std::string_view other) { return other == name; };
      return std::ranges::any_of(known, is) || std::ranges::any_of(words_of_expansion, is) ||
             std::ranges::any_of(given().variables, is) || vocabulary_.lists.contains(name) || name == "t" ||
             name == "s" || name == "pi" || name == "energy" ||
             std::ranges::any_of(given().parameters, is, &std::pair<std::string, double>::first) ||
             std::ranges::any_of(vocabulary_.definitions, is, &Vocabulary::Defined::name);
    };
    for (const auto& [key, text] : typed_->definitions) {
      Vocabulary::Defined made = declaration(key);
      made.text = text;
      if (made.name.empty())
        fault(pointer_to("/definitions/", key), "\"" + key.substr(0, 40) + "\" cannot be a name", "as r or d(i, j)");
      else if (taken(made.name))
        fault(pointer_to("/definitions/", key), made.name + " is something else already", "names that differ");
      else
        vocabulary_.definitions.push_back(std::move(made));
    }
    for (const Vocabulary::Defined& made : vocabulary_.definitions) check_grammar(made);
  }
  /// check_grammar checks a definition without indices, which reads the same wherever it is used.
  void check_grammar(const Vocabulary::Defined& made) {
    const auto expanded = Expansion::of(made.text, vocabulary_);
    const auto* const expansion = std::get_if<Expansion>(&expanded);
    if (!made.indices.empty() || !expansion) return;  // faults are found where the definition is used
    auto parsed = Expression::parse(expansion->text());
    auto* const fault = std::get_if<Fault>(&parsed);
    if (!fault || expansion->origin(fault->position).definition) return;
    fault->position = expansion->origin(fault->position).position;
    faults_.push_back({pointer_to("/definitions/", made.name), std::move(*fault)});
  }

  /// read_unused checks the definitions without indices that no text of the mechanics uses: columns and events may use
  /// them.
  void read_unused() {
    Vocabulary before = vocabulary_;
    before.definitions.clear();
    for (const Vocabulary::Defined& one : vocabulary_.definitions) {
      if (one.indices.empty() && !is_spoken_of(one.name)) {
        const std::string pointer = pointer_of(before.definitions.size());
        auto made = Expansion::of(one.text, before);
        if (auto* wrong = std::get_if<Expansion::Wrong>(&made)) {
          faults_.push_back({wrong->definition ? pointer_of(*wrong->definition) : pointer, std::move(wrong->fault)});
        } else if (auto parsed = Expression::parse(std::get<Expansion>(made).text(), most_written);
                   auto* fault = std::get_if<Fault>(&parsed)) {
          const Expansion::Place place = std::get<Expansion>(made).origin(fault->position);
          fault->position = place.position;
          faults_.push_back({place.definition ? pointer_of(*place.definition) : pointer, std::move(*fault)});
        }
      }
      before.definitions.push_back(one);
    }
  }
  bool is_spoken_of(const std::string& name) const {
    const auto speaks = [&](std::string_view text) { return speaks_of(text, name); };
    const auto any = [&](const Definition::Named& named) {
      return std::ranges::any_of(named, speaks, &Definition::Named::value_type::second);
    };
    return speaks(given().formula) || any(given().masses) || any(given().equations) || any(given().invariants) ||
           any(given().forces) || any(typed_->definitions) || speaks(given().damping.value_or("")) ||
           speaks(given().action_curvature.value_or("")) || speaks(given().offset.value_or("")) ||
           speaks(given().dissipation.value_or(""));
  }

  /// choose_sums decides which sums are kept. Second derivatives by velocities or momenta are taken coordinate by
  /// coordinate, so that sums that contain these are written out.
  void choose_sums() {
    if (given().kind == Definition::Kind::equations) {
      // Each variable has sums of its own: with a hundred variables even short ones would be long together.
      constexpr std::size_t many_variables = 100, few_terms = 64;
      if (out_.definition_.variables.size() >= many_variables) sums_.few_terms = few_terms;
      return;
    }
    for (const std::string& typed : given().variables) {
      const std::string name = typed.substr(0, typed.find('['));
      sums_.not_in_them.insert({velocity_name(name), momentum_name(name)});
    }
    sums_.not_in_them.insert("s");
  }
  std::size_t most_variables_of_kind() const {
    return given().kind == Definition::Kind::equations ? most_variables : most_coordinates;
  }
  /// sums() returns the store for kept sums, null for scenes that fit into lanes, which write all sums out.
  KeptSums* sums() {
    const bool flow = given().kind == Definition::Kind::equations;
    const std::size_t few = static_cast<std::size_t>(flow ? compiled_variables : compiled_coordinates);
    return out_.definition_.variables.size() > few ? &sums_ : nullptr;
  }

  /// write_text returns the text written out; it is empty where the text is wrong, and then the fault has been added.
  std::string write_text(const std::string& pointer, const std::string& written_pointer, std::string_view text,
                         const Indices& indices = {}, KeptSums* sums = nullptr) {
    auto made = Expansion::of(text, vocabulary_, indices, sums);
    if (auto* wrong = std::get_if<Expansion::Wrong>(&made)) {
      faults_.push_back({wrong->definition ? pointer_of(*wrong->definition) : pointer, std::move(wrong->fault)});
      return {};
    }
    auto& expansion = std::get<Expansion>(made);
    used_.insert(expansion.used().begin(), expansion.used().end());
    changed_ = changed_ || expansion.text() != text;
    std::string written = expansion.text();
    out_.sources_[written_pointer] = {pointer, std::move(expansion)};
    return written;
  }
  std::string pointer_of(std::size_t definition) const {
    return pointer_to("/definitions/", typed_->definitions[definition].first);
  }

  void write_texts() {
    Definition& made = out_.definition_;
    std::vector<std::string> variables = std::move(made.variables);
    made = {};
    made.variables = std::move(variables);
    sums_.clear();
    made.kind = given().kind;
    made.title = given().title;
    if (made.variables.size() > most_variables_of_kind())
      return;  // the reader of the definition refuses it, whatever its texts say
    if (given().kind != Definition::Kind::equations)
      made.formula = write_text(mechanics(), mechanics(), given().formula, {}, sums());
    made.masses = write_named("/masses/", given().masses);
    made.equations = write_named("/equations/", given().equations, sums());
    for (const auto& [name, text] : given().invariants) {
      const std::string pointer = pointer_to("/invariants/", name);
      made.invariants.emplace_back(name, write_text(pointer, pointer, text));
    }
    const auto optional = [&](const char* pointer, const std::optional<std::string>& text) {
      return text ? std::optional(write_text(pointer, pointer, *text)) : std::nullopt;
    };
    made.damping = optional("/damping", given().damping);
    made.action_curvature = optional("/action_curvature", given().action_curvature);
    made.offset = optional("/offset", given().offset);
    made.forces = write_named("/forces/", given().forces);
    made.dissipation = optional("/dissipation", given().dissipation);
  }

  /// write_named writes out texts by variable: the name `x` means all elements of a list, `x[i]` each of them.
  Definition::Named write_named(const std::string& key, const Definition::Named& typed, KeptSums* sums = nullptr) {
    Definition::Named made;
    for (const auto& [name, text] : typed) {
      const std::string pointer = pointer_to(key, name);
      const auto one = [&](const std::string& variable, std::string_view of, const Indices& indices) {
        made.emplace_back(variable, write_text(pointer, pointer_to(key, variable), of, indices, sums));
      };
      const std::size_t open = name.find('[');
      const std::string list = name.substr(0, open);
      const auto known = vocabulary_.lists.find(list);
      const bool indexed = open != std::string::npos && name.back() == ']';
      const std::string letter = indexed ? name.substr(open + 1, name.size() - open - 2) : "";
      if (known == vocabulary_.lists.end() || (indexed && !is_name(letter))) {
        one(name, text, {});
        continue;
      }
      changed_ = true;
      const auto values = vocabulary_.lists.find(trimmed(text));
      if (!indexed && values != vocabulary_.lists.end() && values->second != known->second) {
        fault(pointer, "is a list of another length", std::to_string(known->second));
        continue;
      }
      for (std::int64_t k = 1; k <= known->second && faults_.empty(); ++k) {
        if (indexed) {
          one(element_name(list, k), text, {{letter, k}});
        } else {
          one(element_name(list, k), values == vocabulary_.lists.end() ? text : element_name(trimmed(text), k), {});
        }
      }
    }
    return made;
  }

  std::shared_ptr<const TypedScene> typed_;
  Vocabulary vocabulary_;
  Names used_;
  KeptSums sums_;
  std::vector<DefinitionFault> faults_;
  bool changed_ = false;  ///< something had to be written out
  WrittenOut out_;
};

std::variant<WrittenOut, std::vector<DefinitionFault>> WrittenOut::of(TypedScene typed) {
  return SceneWriter(std::move(typed)).write();
}

DefinitionFault WrittenOut::as_typed(DefinitionFault fault) const {
  if (const auto source = sources_.find(fault.pointer); source != sources_.end()) {
    fault.pointer = source->second.pointer;
    if (!fault.in_text) return fault;
    const Expansion::Place place = source->second.expansion.origin(fault.fault.position);
    fault.fault.position = place.position;
    if (place.definition)
      fault.pointer = pointer_to("/definitions/", definition_.typed->definitions[*place.definition].first);
    return fault;
  }
  constexpr std::string_view variables = "/variables/";
  if (fault.pointer.starts_with(variables)) {
    const std::size_t i = std::stoul(fault.pointer.substr(variables.size()));
    if (i < declared_.size()) fault.pointer = std::string(variables) + std::to_string(declared_[i]);
  }
  return fault;
}

std::int64_t length_of_list(const Definition& scene, std::string_view name) {
  if (!scene.vocabulary) return 0;
  const auto list = scene.vocabulary->lists.find(name);
  return list == scene.vocabulary->lists.end() ? 0 : list->second;
}

std::variant<Expression, Fault> parse_in_words_of(const TextScene* scene, std::string text) {
  static const Vocabulary plain;  // without lists and definitions, sums and conditions on indices still work
  const bool own = scene && scene->definition.vocabulary;
  if (!own && text.size() > most_characters) return Expression::parse(std::move(text), most_characters);
  auto made = Expansion::of(text, own ? *scene->definition.vocabulary : plain);
  if (auto* wrong = std::get_if<Expansion::Wrong>(&made)) return std::move(wrong->fault);
  const auto& expansion = std::get<Expansion>(made);
  auto parsed = Expression::parse(expansion.text());
  if (auto* fault = std::get_if<Fault>(&parsed)) fault->position = expansion.origin(fault->position).position;
  return parsed;
}

}  // namespace least::text
