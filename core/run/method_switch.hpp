// An event of a hybrid: its steps go on in another way.
#pragma once

#include <span>

#include "core/run/outcome.hpp"
#include "core/run/problem_table.hpp"
#include "core/scheme.hpp"

namespace least {

/// What the first step in the other way changes of what the motion keeps, and by how much its discrete energy exceeds
/// that of the step before it; unknown where there was none.
struct SwitchJumps {
  double energy, discrete_energy;
  std::span<const double> invariants;  ///< in the order of the card
};

/// {t, kind: switch | parameter, from, to, parameter, at}: at the time t and the place q, steps are no longer taken in
/// the one way but in the other. from and to are modes, or coordinates where the mode stays; where it does not, also
/// energy_jump, discrete_energy_jump and momentum_jumps {name: …}.
Report method_switch(const ProblemCard& problem, double t, std::span<const double> q, const ActiveMethod& was,
                     const ActiveMethod& now, const SwitchJumps& jumps);

/// Of a step from `left` to x, the first that was taken in the other way.
Report method_switch(const ProblemCard& card, const ProblemTable& problem, const RunState& left, const RunState& x,
                     const ActiveMethod& was, const ActiveMethod& now, double discrete_energy_jump);

}  // namespace least
