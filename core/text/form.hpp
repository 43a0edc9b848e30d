// The mechanics that a text describes: what form it has, found on the tape. A Lagrangian and a Hamiltonian of the same
// motion lead to the same form.
//   natural: L = ½ vᵀg v − V − (what s adds), H = ½ pᵀg⁻¹p + V + (the same)
// With anything else, as a term linear in the velocities, H = ½ (p − a)ᵀg⁻¹(p − a) + V, it is a general Hamiltonian; a
// Lagrangian that is not quadratic in the velocities stays one, its velocities are found from the momenta by iteration.
// Source: Goldstein, Poole, Safko, Classical Mechanics, 2002, 8.1; Vermeeren, Bravetti, Seri, J. Phys. A 52, 445206
// (2019), section 2.
#pragma once

#include <algorithm>
#include <memory>

#include "core/text/definition.hpp"
#include "core/text/symbol_matrix.hpp"

namespace least::text {

enum class FormKind : std::uint8_t {
  separable,
  metric,
  contact_linear,
  contact_quadratic,
  lagrangian,
  hamiltonian,
  flow
};
inline constexpr std::array<std::string_view, 7> form_names{
    "separable", "metric", "contact_linear", "contact_quadratic", "lagrangian", "hamiltonian", "flow"};

/// Operations that derivatives of many values may go through together: some hundredths of a second.
inline constexpr std::size_t most_looked_at = std::size_t(1) << 18;

/// Numbers of the variables on a form's tape: coordinates (of a flow all variables) from 0, then momenta or velocities,
/// s, and the parameters. Forms that are compiled leave room for all coordinates that their class may have.
struct Numbering {
  int momentum = compiled_coordinates;  ///< the first
  int action = 2 * compiled_coordinates;
  int parameter = action + 1;  ///< the first

  static constexpr Numbering of_mechanics(std::size_t coordinates) {
    const int half = std::max(compiled_coordinates, static_cast<int>(coordinates));
    return {half, 2 * half, 2 * half + 1};
  }
  static constexpr Numbering of_flow(std::size_t variables) {
    Numbering numbering;
    numbering.parameter = std::max(numbering.parameter, static_cast<int>(variables));
    return numbering;
  }
};

class Lift;  // core/text/lift.hpp

/// Shared, and never changed once it is shared.
struct Form {
  FormKind kind = FormKind::separable;
  bool autonomous = true;         ///< nothing depends on time
  bool keeps_energy = false;      ///< H is kept
  bool reads_action = false;      ///< the motion depends on s
  bool constant_damping = false;  ///< α is a number
  bool forced = false;            ///< forces stand beside it
  std::size_t coordinates = 0;    ///< of a flow: variables
  Numbering numbers;              ///< of the variables on the tape

  /// Whether it has few enough coordinates for what is compiled with room for eight (sixteen variables of a flow).
  /// Forced scenes run by what knows their size when they run.
  bool is_compiled() const {
    return !forced &&
           coordinates <= static_cast<std::size_t>(kind == FormKind::flow ? compiled_variables : compiled_coordinates);
  }

  tape::Tape tape;
  // By kind; what is left out is zero.
  Symbol potential, damping, action_curvature, offset, hamiltonian, lagrangian;
  bool full_mass = false;    ///< of separable and contact: the metric is constant and not diagonal; see hessian
  std::vector<Symbol> mass;  ///< of those with a diagonal metric: each depends on parameters alone
  SymbolMatrix metric;
  std::vector<Symbol> rates;    ///< of a flow
  std::vector<Symbol> momenta;  ///< where a Lagrangian or a potential is given, as functions of q, v, s, t; else empty
  SymbolMatrix hessian;  ///< ∂²L/∂v² of a Lagrangian, ∂²H/∂p² where that is a metric's inverse that is not
                         ///< diagonal; else empty
  // Of a forced scene, of every coordinate:
  std::vector<Symbol> forces;      ///< of q, t and what stands in the text: v, or p where there are no `momenta`
  std::vector<Symbol> friction;    ///< −∂D/∂v, of q, v, t
  std::vector<Symbol> invariants;  ///< of q, p, s, t; of a flow of its variables
  std::vector<std::string> invariant_names;
  Held held = HeldByThread::take(0);  ///< for the tape
};

/// The same form on a tape that keeps no terms; null where that takes too many operations.
std::shared_ptr<const Form> with_sums_written_out(std::shared_ptr<const Form> form);

/// What the definition describes, or everything that is wrong with it.
std::variant<std::shared_ptr<const Form>, std::vector<DefinitionFault>> form_of(const Definition& definition);

}  // namespace least::text
