// Scenes with lists, sums and definitions, written out as a Definition in which every coordinate, every parameter and
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

/// Pictures is what a page is to draw of a scene; the motion does not depend on it.
struct Pictures {
  static constexpr std::array<std::string_view, 3> kinds{"bob", "planet", "sun"};
  static constexpr int pivot = -1;  ///< in `linked`: a rod to the place where all coordinates are 0
  struct Body {
    std::vector<std::string> at{};  ///< its position in the plane or in space: two or three columns or expressions
    std::vector<int> linked{};      ///< rods to other bodies, by number, or to the pivot
    std::size_t kind = 0;           ///< index in `kinds`
  };
  std::vector<std::vector<std::string>> views{};  ///< axes of each view: two or three columns or expressions
  std::vector<Body> bodies{};

  bool empty() const { return views.empty() && bodies.empty(); }
};

/// TypedScene is a scene as its author typed it.
struct TypedScene {
  Definition scene;  ///< variables as declared, `x[5]`; the parameters that are numbers; texts as typed
  std::vector<std::pair<std::string, std::vector<double>>> lists{};  ///< parameters that are lists
  Definition::Named definitions{};                                   ///< `r`, `d(i,j)`
  std::string note{};                                                ///< the author's remark
  Pictures pictures{};
};

/// WrittenOut is a scene written out, together with the origin of each of its texts.
class WrittenOut {
 public:
  static std::variant<WrittenOut, std::vector<DefinitionFault>> of(TypedScene typed);

  const Definition& definition() const { return definition_; }
  /// as_typed translates a fault of the written-out definition to the text that was typed.
  DefinitionFault as_typed(DefinitionFault fault) const;

 private:
  friend class SceneWriter;
  struct Source {
    std::string pointer;  ///< JSON pointer of the typed text
    Expansion expansion;
  };
  Definition definition_;
  std::map<std::string, Source> sources_;  ///< by JSON pointer of the written-out text
  /// By variable of the definition, the index of its declaration in the typed scene
  std::vector<std::size_t> declared_;
};

/// length_of_list returns how many elements the list of this name has; 0 where the scene has no such list.
std::int64_t length_of_list(const Definition& scene, std::string_view name);

/// Operations of all expressions of a kind that accompany a scene, such as those of columns, with their sums written
/// out. Derivatives are taken of them, for which a tape has twice the room.
inline constexpr std::size_t most_operations_beside = std::size_t{1} << 15;

/// operations_beside returns how many operations all expressions of a kind that accompany this scene may take together.
std::size_t operations_beside(const TextScene* scene);

/// parse_in_words_of parses an expression that accompanies a scene, such as that of a column, with the scene's lists
/// and definitions; `scene` is null for scenes that were not given as text.
std::variant<Expression, Fault> parse_in_words_of(const TextScene* scene, std::string text);

}  // namespace least::text
