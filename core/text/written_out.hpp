// A scene whose texts speak of many of a kind, written out: a definition in which every coordinate, every parameter and
// every term has a name of its own.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/text/definition.hpp"
#include "core/text/expansion.hpp"

namespace least::text {

struct TextScene;

/// What is to be drawn of a scene: nothing that moves depends on it.
struct Pictures {
  static constexpr std::array<std::string_view, 3> kinds{"bob", "planet", "sun"};
  static constexpr int pivot = -1;  ///< a link to where the coordinates of a place are 0
  struct Body {
    std::vector<std::string> at{};  ///< its place, in the plane or in space: columns or expressions
    std::vector<int> linked{};      ///< by a rod each: to bodies by their number, or to the pivot
    std::size_t kind = 0;           ///< which of `kinds`
  };
  std::vector<std::vector<std::string>> views{};  ///< two or three columns or expressions each, with equal axes
  std::vector<Body> bodies{};

  bool empty() const { return views.empty() && bodies.empty(); }
};

/// A scene as its author typed it.
struct TypedScene {
  Definition scene;  ///< variables as declared, `x[5]`; parameters that are numbers; texts as typed
  std::vector<std::pair<std::string, std::vector<double>>> lists{};  ///< parameters that are lists
  Definition::Named definitions{};                                   ///< `r`, `d(i,j)`
  std::string note{};                                                ///< what its author says of it
  Pictures pictures{};
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
