// Starts from which no run is possible.
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

/// start_objection returns why no run from x to the time `end` is possible. `regular`: the first steps do not evaluate
/// the equations of motion at x.
std::optional<StartObjection> start_objection(const ProblemTable& problem, StateView x, double end, bool regular);

}  // namespace least
