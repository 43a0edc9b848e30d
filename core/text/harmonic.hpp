// A scene as text as coupled oscillators: H = ½ pᵀM⁻¹p + V(q, t) with the
// quadratic part ½ qᵀKq of V at the origin, K = V″(0), however V is written,
// and what else V is. In normal modes z, ρ, q = Tz and p = T⁻ᵀρ with TTᵀ = M⁻¹
// and TᵀKT diagonal, H = Σ (ρ² + ω²z²)/2 + the rest. A negative ω² is a
// direction in which V falls. Source: Goldstein, Poole, Safko, Classical
// Mechanics, 2002, 6.2 and 6.3.
#pragma once

#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/tape/formula.hpp"
#include "core/text/form.hpp"

namespace least::text {

struct Harmonic {
  /// Coordinates of the largest scene: what each force is turned into modes
  /// with takes as many squared.
  static constexpr std::size_t most_coordinates = 256;

  std::vector<double> squares;  ///< ω² of each mode
  bool mixed = false;           ///< a mode is more than a coordinate
  /// T, T⁻ᵀ and T⁻¹, row by row; where modes are coordinates the diagonals
  /// alone.
  std::vector<double> to_places, to_momenta, from_places;
  tape::Formula gradient;  ///< ∇V(q, t), of all of V
};

/// Of a form with these parameters, or why it is none, in words.
std::variant<Harmonic, std::string> harmonic(const Form& form, std::span<const double> parameters);

}  // namespace least::text
