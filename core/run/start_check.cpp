#include "core/run/start_check.hpp"

namespace least {

std::optional<StartObjection> start_objection(const ProblemTable& problem, StateView x, double end, bool regular) {
  const ProblemTraits& traits = problem.traits;
  if (traits.has_series && x.t < 0 && end >= 0)
    return StartObjection{ReturnCode::singular, "the equations of motion are singular at t = 0, which lies ahead", 0};
  if (!is_finite_state(traits, x))
    return StartObjection{ReturnCode::not_finite, "the start lies beyond 1e75, where energies overflow"};
  if (problem.outside(x) && problem.inside(x) < 0)
    return StartObjection{ReturnCode::left_domain, "the start lies outside the domain of the motion"};
  if (regular) return std::nullopt;
  StateNumbers slope(traits.numbers);
  problem.rates(x, slope.data());
  bool finite = true;
  for (std::size_t i = 0; i < traits.components; ++i) finite = finite && std::isfinite(slope[i]);
  if (traits.says_energy()) finite = finite && std::isfinite(problem.energy_of(x));
  if (!finite) return StartObjection{ReturnCode::singular, "the equations of motion are not finite at the start", x.t};
  return std::nullopt;
}

}  // namespace least
