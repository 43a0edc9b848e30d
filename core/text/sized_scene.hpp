// The mechanics of a scene as text of any size, which is known when it runs: what the classes of core/text/scenes.hpp
// are for few coordinates. Components of a state stand one after the other: coordinates, momenta, and s where the scene
// has it; of a flow its variables. Variables on the tapes have the same numbers.
#pragma once

#include <span>
#include <vector>

#include "core/tape/formula.hpp"
#include "core/text/form.hpp"

namespace least::text {

/// A form with numbers in the place of its parameters.
class SizedScene {
 public:
  /// Operations of its equations of motion, with their common parts written once.
  static constexpr tape::Index most_equations = 1 << 17;

  /// Whether there is one of a form: its kinetic metric is constant, or it is a general Hamiltonian or a flow.
  static bool has(const Form& form);
  /// Of such a form. Throws tape::TooManyOperations where its equations of motion take more than those of a scene may.
  SizedScene(const Form& form, std::span<const double> parameters);

  FormKind kind;
  std::size_t coordinates, components;
  bool flow, acting, reads_action, constant_damping, autonomous, keeps_energy;

  tape::Tape equations;            ///< ẋ of all components
  std::vector<tape::Index> rates;  ///< their places
  tape::Formula rate;              ///< of the components: ẋ
  tape::Formula potential, gradient, damping;
  tape::Formula hamiltonian;  ///< of a general one: H, and H_s
  tape::Formula invariants;   ///< most_invariants; those that the scene has not are 0

  /// v = g⁻¹p of a constant metric, to n numbers.
  void velocity(const double* p, double* v) const;
  bool has_full_mass() const { return !inverse_matrix_.empty(); }
  std::span<const double> inverse_mass() const { return inverse_mass_; }

 private:
  void set_mass(const std::vector<Symbol>& mass, const std::vector<double>& second, bool of_velocities);

  std::vector<double> inverse_mass_;    ///< of each coordinate
  std::vector<double> inverse_matrix_;  ///< where the metric is not diagonal: g⁻¹, row by row
};

}  // namespace least::text
