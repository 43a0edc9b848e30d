// Coupled oscillators in a scene given as text: H = ½ pᵀM⁻¹p + V(q, t) with the quadratic part ½ qᵀKq of V at the
// origin, K = V″(0), however V is written, and the rest of V. Normal modes z, ρ with q = Tz and p = T⁻ᵀρ, where TTᵀ =
// M⁻¹ and TᵀKT is diagonal, give H = Σ (ρ² + ω²z²)/2 + the rest. A negative ω² is a direction in which V falls. Source:
// Goldstein, Poole, Safko, Classical Mechanics, 2002, 6.2 and 6.3.
#pragma once

#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/tape/formula.hpp"
#include "core/text/form.hpp"

namespace least::text {

/// Harmonic is the decomposition of a scene into normal modes.
struct Harmonic {
  /// Largest number n of coordinates: turning a force into modes takes n² multiplications.
  static constexpr std::size_t most_coordinates = 256;

  std::vector<double> squares;  ///< ω² of each mode
  bool mixed = false;           ///< some mode is a combination of several coordinates
  /// T, T⁻ᵀ and T⁻¹, n × n row-major; only their diagonals (n numbers) where no mode is mixed.
  std::vector<double> to_places, to_momenta, from_places;
  tape::Formula gradient;  ///< ∇V(q, t) of the whole V
};

/// harmonic returns the modes of a form with these parameters, or a phrase that says why it has none.
std::variant<Harmonic, std::string> harmonic(const Form& form, std::span<const double> parameters);

}  // namespace least::text
