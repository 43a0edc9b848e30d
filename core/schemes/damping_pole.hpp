// Where the damping makes a contact step impossible or wrong: variational steps multiply the momentum by a factor like
// (1 − αh/2)/(1 + αh/2), which has a pole at αh = −2 and turns the momentum over beyond αh = 2.
// Source: Vermeeren, Bravetti, Seri, J. Phys. A 52, 445206 (2019), section 4.
#pragma once

#include <string>

#include "core/composition.hpp"
#include "core/equations.hpp"

namespace least {

/// How near the denominator of that factor may come to zero.
inline constexpr double least_denominator = 1e-8;

/// Returns in words why the scheme cannot take αh; empty if it can. A stage of weight γ has the pole at γαh = −2.
std::string unsupported_by_pole(const Composition& composition, double damping_step);

/// Returns the αh from which on such a step turns the momentum over: its factor is the product of those of the stages,
/// and changes its sign at 2/γ where an odd number of stages has the weight γ > 0. Infinite if there are no such
/// stages.
double flips_from(const Composition& composition);

/// The same for the damping of a scene; empty where it changes in time, and so is not known before the run.
template <class P>
std::string unsupported_by_pole(const P& problem, const Composition& composition, double step) {
  if constexpr (ConstantDamping<P>) return unsupported_by_pole(composition, problem.damping() * step);
  return {};
}

}  // namespace least
