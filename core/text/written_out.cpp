#include "core/text/written_out.hpp"

#include <algorithm>
#include <cmath>

#include "core/text/characters.hpp"
#include "core/text/definitions_reader.hpp"
#include "core/text/scene.hpp"
#include "core/text/text_reader.hpp"
#include "core/text/text_work.hpp"
#include "core/text/unused_definitions.hpp"

namespace least::text {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto from = text.find_first_not_of(" \t\n\r");
  return from == std::string_view::npos ? std::string_view()
                                        : text.substr(from, text.find_last_not_of(" \t\n\r") + 1 - from);
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
    if (declared) faults_ = read_definitions(*typed_, sums() != nullptr, vocabulary_);
    if (declared) choose_sums();
    do {
      vocabulary_.fixed = used_;
      if (declared) write_texts();
    } while (faults_.empty() && vocabulary_.fixed != used_);
    if (faults_.empty()) faults_ = faults_in_unused(*typed_, vocabulary_);
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
    TextWork work;  // for all texts of the scene
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
      if (indexed && !fits(pointer, text, letter, known->second, sums != nullptr)) continue;
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

  /// fits tells whether a text written out for each element of a list may become short enough; otherwise it notes a
  /// fault, before anything is written.
  bool fits(const std::string& pointer, std::string_view text, const std::string& letter, std::int64_t count,
            bool keeps) {
    constexpr std::size_t most_measured = 1'000'000;  // characters; the size of a part is a lower bound, too
    const auto measured = static_cast<std::int64_t>(most_measured / (text.size() + 1));
    TextSize all;
    std::size_t place = 0;
    for (std::int64_t k = 1; k <= std::min(count, measured); ++k) {
      add(all, size_of(text, vocabulary_, {{letter, k}}, keeps, place));
      if (keeps && all.kept > most_kept) {
        faults_.push_back(
            {pointer, {0, "takes too many operations", std::to_string(most_kept) + " in the terms of all sums", {}}});
        return false;
      }
      if (all.characters > most_of_terms || (keeps ? all.with_kept_sums : all.characters) > most_written) {
        faults_.push_back({pointer, too_many_operations_at(place)});
        return false;
      }
    }
    return true;
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

std::size_t operations_beside(const TextScene* scene) {
  return scene && scene->definition.typed ? most_operations_beside : most_operations;
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
