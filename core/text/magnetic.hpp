// Charges in a magnetic field in a scene given as text: H = Σ (p − a(q))²/2m + V(q, t) with constant masses, recognised
// in H however it is written. With w = √m v, v being the velocity,
//   q̇ = w/√m,  ẇ = Ω(q) w − ∇V/√m,  Ω_ij = (∂_i a_j − ∂_j a_i)/√(m_i m_j),
// Ω is antisymmetric, so that it rotates w. Coordinates that Ω rotates into one another form a group of two or three.
// Source: Goldstein, Poole, Safko, Classical Mechanics, 2002, 1.5.
#pragma once

#include <array>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/tape/formula.hpp"
#include "core/text/form.hpp"

namespace least::text {

/// Magnetic is the field of a scene and the groups of coordinates that it rotates.
struct Magnetic {
  /// Largest number of coordinates for which a field is looked for.
  static constexpr std::size_t most_coordinates = 64;

  struct Group {
    std::size_t size;  ///< 2 or 3
    std::array<std::size_t, 3> of;
  };
  std::vector<double> root_mass, inverse_root;  ///< √m and 1/√m of each coordinate
  std::vector<Group> groups;
  /// How many numbers Ω of all groups together take in `fields`: 1 for each group of two, 3 for each of three
  std::size_t turns = 0;
  /// Functions of (q, t): −∇V/√m of every coordinate where V is not constant, then of each group Ω_01, or (Ω_12, Ω_20,
  /// Ω_01).
  tape::Formula fields;
  bool kicks = false;   ///< V is not a constant
  tape::Formula shift;  ///< a/√m as a function of q
  /// Functions of q, only where Pace::yes was asked for (else without outputs): U with U⁴ = ‖M^{−½} V″ M^{−½}‖² + Ω⁴,
  /// the fastest rate at which forces and fields change anything, then ∇U/(U√m) of every coordinate.
  tape::Formula paced;
};
/// Pace says whether `paced` is wanted, which takes derivatives of V and a up to the third.
enum class Pace : std::uint8_t { no, yes };

/// NotMagnetic says in words why a scene has no such form.
struct NotMagnetic {
  std::string why;
};

/// magnetic returns the field of a form with these parameters; `names` are those of its coordinates, for the message.
std::variant<Magnetic, NotMagnetic> magnetic(const Form& form, std::span<const double> parameters,
                                             std::span<const std::string> names, Pace pace = Pace::no);

}  // namespace least::text
