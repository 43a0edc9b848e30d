// What no run can begin with.
#pragma once

#include <cmath>
#include <optional>
#include <string>

#include "core/run/integrator.hpp"
#include "core/run/mechanics.hpp"
#include "core/run/messages.hpp"

namespace least {

struct StartObjection {
  ReturnCode reason;
  std::string detail;
  double singular_at = unknown;
};

/// Against a run from x to the time `end`. `regular`: its first steps do not follow the equations of motion.
template <class P, class X>
std::optional<StartObjection> start_objection(const P& problem, const X& x, [[maybe_unused]] double end, bool regular) {
  if constexpr (HasSeries<P>)
    if (x.t < 0 && end >= 0)
      return StartObjection{ReturnCode::singular, "the equations of motion are singular at t = 0, which lies ahead", 0};
  bool small = std::isfinite(x.t);
  for (std::size_t i = 0; i < X::size; ++i) small = small && std::abs(value_of(x[i])) < largest_component;
  if (!small) return StartObjection{ReturnCode::not_finite, "the start lies beyond 1e75, where energies overflow"};
  if constexpr (HasDomain<P>)
    if (problem.bounded() && problem.inside(x.q) < 0)
      return StartObjection{ReturnCode::left_domain, "the start lies outside the domain of the motion"};
  if (regular) return std::nullopt;
  const auto slope = derivative(problem, plain(x));
  bool finite = std::isfinite(slope.t);
  for (std::size_t i = 0; i < X::size; ++i) finite = finite && std::isfinite(slope[i]);
  if constexpr (SaysEnergy<P, X>) finite = finite && std::isfinite(energy_of(problem, x));
  if (!finite) return StartObjection{ReturnCode::singular, "the equations of motion are not finite at the start", x.t};
  return std::nullopt;
}

}  // namespace least
