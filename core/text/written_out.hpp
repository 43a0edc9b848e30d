// A scene whose texts speak of many of a kind, written out: a definition in which every coordinate, every parameter and
// every term has a name of its own.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/text/definition.hpp"
#include "core/text/expansion.hpp"

namespace least::text {

struct TextScene;

/// A scene as its author typed it.
struct TypedScene {
  Definition scene;  ///< variables as declared, `x[5]`; parameters that are numbers; texts as typed
  std::vector<std::pair<std::string, std::vector<double>>> lists{};  ///< parameters that are lists
  Definition::Named definitions{};                                   ///< `r`, `d(i,j)`
};

/// What is written out, and where each of its texts comes from.
class WrittenOut {
 public:
  static std::variant<WrittenOut, std::vector<DefinitionFault>> of(TypedScene typed);

  const Definition& definition() const { return definition_; }
  /// What is wrong with the definition, said of what was typed.
  DefinitionFault as_typed(DefinitionFault fault) const;

 private:
  friend class SceneWriter;
  struct Source {
    std::string pointer;  ///< of the typed text
    Expansion expansion;
  };
  Definition definition_;
  std::map<std::string, Source> sources_;  ///< by the pointer of what is written out
  std::vector<std::size_t> declared_;      ///< of each variable: among those that were typed
};

/// How many elements the list of this name has; 0 where the scene knows none.
std::int64_t length_of_list(const Definition& scene, std::string_view name);

/// An expression beside a scene, as that of a column, in the words of the scene if it was given as text (else null).
std::variant<Expression, Fault> parse_in_words_of(const TextScene* scene, std::string text);

}  // namespace least::text
