// A Hamiltonian that is the sum of two parts whose steps are explicit contact maps:
//   H = S(q, p, t) + p·X(q, s, t) − g(q, s, t),   S = ½ pᵀM⁻¹p + V(q, t)
// In the motion of S, s only accumulates; the second part is the lift of the motion q̇ = X, ṡ = g. Examples are
// rotating frames (X is the rotation), magnetic fields (|p − A|²/2m: X = −A/m) and friction that is not linear in s.
// Terms without p and s belong to V; where nothing is quadratic in p they belong to g, so that one part is left and
// nothing is split.
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

/// number_in<T> returns x with its slope, or its value alone where T is double.
template <class T>
T number_in(const Slope& x) {
  if constexpr (std::is_same_v<T, double>) {
    return x.value;
  } else {
    return x;
  }
}
/// VariedNumbers are numbers of a scene together with their slopes along one direction of its parameters; in<double>()
/// returns the values alone.
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

/// Lift is such a Hamiltonian with numbers in the place of its parameters. Its formulas read a point y = (q, s, moved
/// parameter). Immutable once it is made.
class Lift {
 public:
  /// Largest number of coordinates: steps solve for all of them at once.
  static constexpr std::size_t most_coordinates = 64;

  /// objection returns why a general Hamiltonian has no lift, as a phrase that continues "a Hamiltonian …"; empty where
  /// it has one. `variables` are the names of its coordinates.
  static std::string objection(const Form& form, const std::vector<std::string>& variables);
  /// is_linear tells whether q̇ = X, ṡ = g is linear with constant coefficients, of a form without objection.
  static bool is_linear(const Form& form);
  /// of returns the lift, or null where there is an objection. `moved` is the parameter along which numbers have
  /// slopes.
  static std::shared_ptr<const Lift> of(const Form& form, std::span<const double> parameters,
                                        std::optional<std::size_t> moved = {});

  std::size_t coordinates = 0;
  std::size_t width = 0;      ///< dimension of the lifted motion: q, and s where `acts`
  std::size_t variables = 0;  ///< length of a point y
  bool reads_action = false;  ///< the motion depends on s
  bool acts = false;          ///< g is not 0, or X depends on s
  bool kinetic = false;       ///< M⁻¹ is not 0
  bool diagonal = true;
  VariedNumbers inverse_mass;  ///< M⁻¹: its diagonal, or row by row
  bool kicks = false;          ///< V is not 0
  tape::Formula kick;          ///< ∇V and, where the motion reads s, V
  tape::Formula rates;         ///< X and, where `acts`, g
  tape::Formula jets;          ///< `rates`, then their Jacobian, row-major
  bool linear = false;         ///< the lifted motion is ẏ = B y + b
  VariedNumbers matrix, offset;
  Slope parameter = 0;  ///< the value and slope of the moved parameter
};

}  // namespace least::text
