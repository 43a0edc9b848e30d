// A scene as its author typed it, and what is wrong with it.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/text/expression.hpp"

namespace least::text {

/// Degrees of freedom of mechanics, variables of equations, parameters: at most so many.
inline constexpr int most_coordinates = 1024, most_variables = 2048, most_parameters = 1024, most_invariants = 8;
/// Degrees of freedom, or variables, for which lanes have room, and derivatives of implicit steps by what a scheme
/// makes of parameters and starts.
inline constexpr int compiled_coordinates = 8, compiled_variables = 16;
inline constexpr std::size_t longest_name = 16, longest_parameter = 40;

struct TypedScene;
struct Vocabulary;
struct KeptSums;

/// A scene in which every coordinate, every parameter and every term has a name of its own.
struct Definition {
  enum class Kind : std::uint8_t { lagrangian, hamiltonian, potential, equations };
  static constexpr std::array<std::string_view, 4> kind_names{"lagrangian", "hamiltonian", "potential", "equations"};
  using Named = std::vector<std::pair<std::string, std::string>>;

  Kind kind = Kind::lagrangian;
  std::string title{};
  std::vector<std::string> variables{};
  std::vector<std::pair<std::string, double>> parameters{};  ///< with the values that stand in the definition
  std::string formula{};                                     ///< L, H or V
  Named masses{};                                            ///< of coordinates; 1 where none is given
  std::optional<std::string> damping{}, action_curvature{}, offset{};
  Named equations{};      ///< ẋ of every variable
  Named invariants{};     ///< what the motion keeps, as its author says
  bool backward = false;  ///< t, velocities, momenta and s of its texts are −t, … of what moves forward
  // Beside L, H or V: the generalised force on a coordinate, of q, t and v, or p where H is given; and Rayleigh's D of
  // q, v, t, which adds −∂D/∂v.
  Named forces{};
  std::optional<std::string> dissipation{};

  // Of a scene that was written out (core/text/written_out.hpp): what its author typed, and the words of further texts.
  std::shared_ptr<const TypedScene> typed{};
  std::shared_ptr<const Vocabulary> vocabulary{};
  std::shared_ptr<const KeptSums> sums{};  ///< that its texts speak of by their numbers; none: there are none

  bool is_forced() const { return !forces.empty() || dissipation; }
  /// Of all of its texts.
  std::size_t characters() const;
  /// The same for definitions of the same content and for no others.
  std::string key() const;
};

/// Keys of a scene as text, which no parameter can be called.
std::span<const std::string_view> reserved_keys();

/// Columns of every scene, which no variable and no invariant can be called.
std::span<const std::string_view> column_names();

/// The velocity and the momentum of a coordinate: of x they are vx and px, of q1 v1 and p1.
std::string velocity_name(std::string_view coordinate);
std::string momentum_name(std::string_view coordinate);

struct DefinitionFault {
  std::string pointer;  ///< within the definition, as `/lagrangian` or `/equations/x`
  Fault fault;
  bool in_text = true;  ///< its position means something
};

}  // namespace least::text
