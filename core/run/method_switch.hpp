// An event of a hybrid: its steps go on in another way.
#pragma once

#include <span>

#include "core/problem_traits.hpp"
#include "core/run/outcome.hpp"
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
template <class P, class X>
Report method_switch(const ProblemCard& card, const P& problem, const X& left, const X& x, const ActiveMethod& was,
                     const ActiveMethod& now, double discrete_energy_jump) {
  SwitchJumps jumps{energy(problem, x) - energy(problem, left), discrete_energy_jump, {}};
  if constexpr (HasInvariants<P>) {
    auto change = problem.invariants(x.q, x.p, x.t);
    const auto before = problem.invariants(left.q, left.p, left.t);
    for (std::size_t i = 0; i < change.size(); ++i) change[i] -= before[i];
    jumps.invariants = change;
    return method_switch(card, left.t, left.q, was, now, jumps);
  }
  return method_switch(card, left.t, left.q, was, now, jumps);
}

}  // namespace least
