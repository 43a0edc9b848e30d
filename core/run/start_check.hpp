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
std::optional<StartObjection> start_objection(const ProblemTable& problem, StateView x, double end, bool regular);

}  // namespace least
