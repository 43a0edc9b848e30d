// Sizes for the relative norm of components that stay at 0 along a motion.
#pragma once

#include <functional>
#include <span>

#include "core/run/problem_table.hpp"
#include "core/state_error.hpp"

namespace least {

/// settle_still_components gives a size to kinds of components that are only rounding along a motion, as the radial
/// momentum on a circular orbit. The size has the unit of the component: the change of its rate by a relative change 1
/// of the whole state, times how long that change acts. This time is at most the span, the decay time of the component,
/// or the inverse of the frequency at which it and another component drive each other. `states` are some of the motion,
/// in order of time, with only those components that the motion needs, as is `problem`. Sizes stay as they are if
/// keep_going() returns false. Throws MemoryShortage.
void settle_still_components(const ProblemTable& problem, std::span<const RunState> states, ComponentSizes& sizes,
                             const std::function<bool()>& keep_going);

}  // namespace least
