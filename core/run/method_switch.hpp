// The event of a hybrid scheme that changes the method of its steps.
#pragma once

#include <span>

#include "core/run/outcome.hpp"
#include "core/run/problem_table.hpp"
#include "core/scheme.hpp"

namespace least {

/// SwitchJumps are the changes of conserved quantities in the first step by the other method, and the excess of its
/// discrete energy over that of the step before; unknown where there was none.
struct SwitchJumps {
  double energy, discrete_energy;
  std::span<const double> invariants;  ///< changes of the invariants, in the order of the card
};

/// method_switch returns {t, kind: switch | parameter, from, to, parameter, at}: at the time t and the place q, the
/// method of the steps changes. `from` and `to` are modes (kind switch), or coordinates where the mode stays (kind
/// parameter); kind switch has also energy_jump, discrete_energy_jump and momentum_jumps {name: …}.
Report method_switch(const ProblemCard& problem, double t, std::span<const double> q, const ActiveMethod& was,
                     const ActiveMethod& now, const SwitchJumps& jumps);

/// The same for the step from `left` to x, the first by the new method.
Report method_switch(const ProblemCard& card, const ProblemTable& problem, const RunState& left, const RunState& x,
                     const ActiveMethod& was, const ActiveMethod& now, double discrete_energy_jump);

}  // namespace least
