// An event of a hybrid: its steps go on in another way.
#pragma once

#include <span>

#include "core/describe.hpp"
#include "core/run/outcome.hpp"
#include "core/scheme.hpp"

namespace least {

/// {t, kind: switch | parameter, from, to, parameter, at}: at the time t and the place q, steps are no longer taken in
/// the one way but in the other. from and to are modes, or coordinates where the mode stays.
Report method_switch(const ProblemCard& problem, double t, std::span<const double> q, const ActiveMethod& was,
                     const ActiveMethod& now);

}  // namespace least
