// The mechanics that a text describes: its form, recognised on the tape. A Lagrangian and a Hamiltonian of the same
// motion lead to the same form.
//   natural: L = ½ vᵀg v − V − (terms with s), H = ½ pᵀg⁻¹p + V + (the same terms)
// Any further term, such as one linear in the velocities with H = ½ (p − a)ᵀg⁻¹(p − a) + V, makes it a general
// Hamiltonian. A Lagrangian that is not quadratic in the velocities stays a Lagrangian: its velocities are found from
// the momenta by iteration.
// Source: Goldstein, Poole, Safko, Classical Mechanics, 2002, 8.1; Vermeeren, Bravetti, Seri, J. Phys. A 52, 445206
// (2019), section 2.
#pragma once

#include <algorithm>
#include <memory>

#include "core/text/definition.hpp"
#include "core/text/symbol_matrix.hpp"

namespace least::text {

/// FormKind is the structure of a form; contact_linear has friction α s, contact_quadratic γs²/2.
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

/// Limit of operations that a search through the derivatives of many values looks at: some hundredths of a second.
inline constexpr std::size_t most_looked_at = std::size_t(1) << 18;

/// Numbering gives the numbers of the variables on a form's tape: coordinates (of a flow, all variables) from 0, then
/// momenta or velocities, s, and the parameters. Mechanics always leaves room for compiled_coordinates of them.
struct Numbering {
  int momentum = compiled_coordinates;  ///< number of the first momentum or velocity
  int action = 2 * compiled_coordinates;
  int parameter = action + 1;  ///< number of the first parameter

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

/// Form is what was recognised in a definition. It is shared, and immutable once it is shared.
struct Form {
  FormKind kind = FormKind::separable;
  bool autonomous = true;         ///< nothing depends on t explicitly
  bool keeps_energy = false;      ///< the motion conserves H
  bool reads_action = false;      ///< the motion depends on s
  bool constant_damping = false;  ///< α is a number, not a function of t
  bool forced = false;            ///< forces or a dissipation function are given beside it
  std::size_t coordinates = 0;    ///< of a flow: the number of variables
  Numbering numbers;

  /// is_compiled tells whether the form fits the classes compiled for eight coordinates (sixteen variables of a flow).
  /// Forced scenes never do; SizedScene runs them.
  bool is_compiled() const {
    return !forced &&
           coordinates <= static_cast<std::size_t>(kind == FormKind::flow ? compiled_variables : compiled_coordinates);
  }

  tape::Tape tape;
  // Which of these are set depends on the kind; those that a text leaves out are zero.
  Symbol potential, damping, action_curvature, offset, hamiltonian, lagrangian;
  bool full_mass = false;    ///< of separable and contact forms: the metric is constant and not diagonal, see `hessian`
  std::vector<Symbol> mass;  ///< of forms with a diagonal metric: the masses, which depend on parameters alone
  SymbolMatrix metric;
  std::vector<Symbol> rates;  ///< of a flow
  /// where a Lagrangian or a potential is given: ∂L/∂v as functions of (q, v, s, t); else empty
  std::vector<Symbol> momenta;
  /// ∂²L/∂v² of a Lagrangian; ∂²H/∂p² where H is given and the metric is not diagonal; else empty
  SymbolMatrix hessian;
  // Of a forced scene, by coordinate:
  std::vector<Symbol> forces;      ///< functions of q, t and v; of p instead of v where `momenta` is empty
  std::vector<Symbol> friction;    ///< −∂D/∂v, functions of (q, v, t)
  std::vector<Symbol> invariants;  ///< functions of (q, p, s, t); of a flow, of its variables
  std::vector<std::string> invariant_names;
  Held held = HeldByThread::take(0);  ///< the memory that the tape takes
};

/// with_sums_written_out returns the same form on a tape without kept sums; null where that takes too many operations.
std::shared_ptr<const Form> with_sums_written_out(std::shared_ptr<const Form> form);

/// form_of returns the form that the definition describes, or everything that is wrong with the definition.
std::variant<std::shared_ptr<const Form>, std::vector<DefinitionFault>> form_of(const Definition& definition);

}  // namespace least::text
