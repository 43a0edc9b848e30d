// A scene as text as charges in a magnetic field: H = Σ (p − a(q))²/2m + V(q, t) with constant masses, found from H
// however it is written. With w = √m v, v the velocity,
//   q̇ = w/√m,  ẇ = Ω(q) w − ∇V/√m,  Ω_ij = (∂_i a_j − ∂_j a_i)/√(m_i m_j),
// Ω antisymmetric: it turns w. Coordinates that it turns into one another form a group of two or three.
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

struct Magnetic {
  /// Coordinates of the largest scene.
  static constexpr std::size_t most_coordinates = 64;

  struct Group {
    std::size_t size;  ///< 2 or 3
    std::array<std::size_t, 3> of;
  };
  std::vector<double> root_mass, inverse_root;  ///< √m and 1/√m of each coordinate
  std::vector<Group> groups;
  std::size_t turns = 0;  ///< numbers that all groups together have in `fields`
  /// Of q, t: −∇V/√m of every coordinate where there is a potential, then of each group Ω_01, or (Ω_12, Ω_20, Ω_01).
  tape::Formula fields;
  bool kicks = false;   ///< V is not a constant
  tape::Formula shift;  ///< a/√m, of q
  /// Where that was asked for, of q: U with U⁴ = ‖M^{−½} V″ M^{−½}‖² + Ω⁴, the fastest that forces and fields change
  /// anything, then ∇U/(U√m) of every coordinate. No outputs: it was not.
  tape::Formula paced;
};
/// Whether `paced` is asked for, which takes derivatives up to the third.
enum class Pace : std::uint8_t { no, yes };

/// Why a scene is none, in words.
struct NotMagnetic {
  std::string why;
};

/// Of a form with these parameters; `names`: of its coordinates.
std::variant<Magnetic, NotMagnetic> magnetic(const Form& form, std::span<const double> parameters,
                                             std::span<const std::string> names, Pace pace = Pace::no);

}  // namespace least::text
