// A scene as its author typed it, and faults in it.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/text/expression.hpp"

namespace least::text {

/// Upper limits of a scene: degrees of freedom of mechanics, variables of equations, parameters and invariants.
inline constexpr int most_coordinates = 1024, most_variables = 2048, most_parameters = 1024, most_invariants = 8;
/// Most degrees of freedom, or variables of a flow, for which the lanes of an ensemble (core/ensemble) have room, and
/// for which maps of implicit schemes can be differentiated (core/variations).
inline constexpr int compiled_coordinates = 8, compiled_variables = 16;
inline constexpr std::size_t longest_name = 16, longest_parameter = 40;

struct TypedScene;
struct Vocabulary;
struct KeptSums;

/// Definition is a scene in which every coordinate, every parameter and every term has a name of its own: lists and
/// sums are written out (core/text/written_out.hpp).
struct Definition {
  enum class Kind : std::uint8_t { lagrangian, hamiltonian, potential, equations };
  static constexpr std::array<std::string_view, 4> kind_names{"lagrangian", "hamiltonian", "potential", "equations"};
  using Named = std::vector<std::pair<std::string, std::string>>;

  Kind kind = Kind::lagrangian;
  std::string title{};
  std::vector<std::string> variables{};
  std::vector<std::pair<std::string, double>> parameters{};  ///< with their default values
  std::string formula{};                                     ///< L, H or V
  Named masses{};                                            ///< by coordinate; 1 where none is given
  std::optional<std::string> damping{}, action_curvature{}, offset{};
  Named equations{};   ///< ẋ of every variable
  Named invariants{};  ///< quantities that the author declares to be conserved
  /// The texts describe the time reversal of a scene: their t, velocities, momenta and s have the opposite sign of the
  /// forward ones
  bool backward = false;
  // Beside L, H or V: the generalised force on each coordinate, a function of q, t and v (of p where H is given); and
  // Rayleigh's dissipation function D(q, v, t), which adds the force −∂D/∂v.
  Named forces{};
  std::optional<std::string> dissipation{};

  // Only of a scene that was written out (core/text/written_out.hpp): what its author typed, and the vocabulary in
  // which further texts (columns, events) are read.
  std::shared_ptr<const TypedScene> typed{};
  std::shared_ptr<const Vocabulary> vocabulary{};
  std::shared_ptr<const KeptSums> sums{};  ///< the sums that the texts refer to by number; null where there are none

  bool is_forced() const { return !forces.empty() || dissipation; }
  /// characters() returns the total length of all texts.
  std::size_t characters() const;
  /// key() returns equal strings for definitions of equal content, and only for these.
  std::string key() const;
};

/// reserved_keys() returns the keys of a scene's JSON object, which no parameter may be named.
std::span<const std::string_view> reserved_keys();

/// column_names() returns the columns that every scene has, which no variable and no invariant may be named.
std::span<const std::string_view> column_names();

/// Names of the velocity and of the momentum of a coordinate: vx and px for x, v1 and p1 for q1.
std::string velocity_name(std::string_view coordinate);
std::string momentum_name(std::string_view coordinate);

struct DefinitionFault {
  std::string pointer;  ///< JSON pointer within the definition, such as `/lagrangian` or `/equations/x`
  Fault fault;
  bool in_text = true;  ///< fault.position is a position in that text; false where the fault has none
};

}  // namespace least::text
