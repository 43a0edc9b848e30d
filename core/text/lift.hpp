// A Hamiltonian that is a sum of two whose steps are explicit contact maps:
//   H = S(q, p, t) + p·X(q, s, t) − g(q, s, t),   S = ½ pᵀM⁻¹p + V(q, t)
// Of the first s only adds up; the second is the lift of the motion q̇ = X, ṡ = g. Rotating frames (X the rotation),
// magnetic fields (|p − A|²/2m: X = −A/m), any friction that is not linear in s. What depends neither on p nor on s is
// V; where nothing is quadratic in p all of it is g, so that one motion is left and nothing is split.
// Source: Kevrekidis, arXiv 2605.09103 (2026), which shows that maps of these two kinds generate all polynomials in p.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/problem_traits.hpp"
#include "core/tape/formula.hpp"
#include "core/text/form.hpp"

namespace least::text {

/// A number with its slope, or without it.
template <class T>
T number_in(const Slope& x) {
  if constexpr (std::is_same_v<T, double>) {
    return x.value;
  } else {
    return x;
  }
}
/// Numbers of a scene that may change along a direction of its parameters.
class VariedNumbers {
 public:
  VariedNumbers() = default;
  explicit VariedNumbers(std::vector<Slope> all);
  template <class T>
  const std::vector<T>& in() const {
    if constexpr (std::is_same_v<T, double>) {
      return plain_;
    } else {
      return all_;
    }
  }

 private:
  std::vector<double> plain_;
  std::vector<Slope> all_;
};

/// Such a Hamiltonian with numbers in the place of its parameters. Its formulas read a point y of q, then s, then the
/// parameter that moves; never changed once it is made.
class Lift {
 public:
  /// Coordinates of the largest scene: steps solve for all of them at once.
  static constexpr std::size_t most_coordinates = 64;

  /// What speaks against it of a general Hamiltonian, in words that go on from "a Hamiltonian …"; `variables`: the
  /// names of its coordinates. Empty: nothing.
  static std::string objection(const Form& form, const std::vector<std::string>& variables);
  /// Whether q̇ = X, ṡ = g is linear with constant coefficients, of a form that nothing speaks against.
  static bool is_linear(const Form& form);
  /// Null where something speaks against it. `moved`: the parameter that has a slope.
  static std::shared_ptr<const Lift> of(const Form& form, std::span<const double> parameters,
                                        std::optional<std::size_t> moved = {});

  std::size_t coordinates = 0;
  std::size_t width = 0;      ///< of the lifted motion: q, and s where it acts
  std::size_t variables = 0;  ///< of a point
  bool reads_action = false;  ///< the motion depends on s
  bool acts = false;          ///< g is not 0, or X depends on s
  bool kinetic = false;       ///< M⁻¹ is not 0
  bool diagonal = true;
  VariedNumbers inverse_mass;  ///< M⁻¹: its diagonal, or row by row
  bool kicks = false;          ///< V is not 0
  tape::Formula kick;          ///< ∇V and, where the motion reads s, V
  tape::Formula rates;         ///< X and, where it acts, g
  tape::Formula jets;          ///< the same with its Jacobian, row by row
  bool linear = false;         ///< the lifted motion is ẏ = B y + b
  VariedNumbers matrix, offset;
  Slope parameter = 0;  ///< the one that moves
};

}  // namespace least::text
