// Sizes of components that have none along a motion, for the relative norm.
#pragma once

#include <functional>
#include <span>

#include "core/run/problem_table.hpp"
#include "core/state_error.hpp"

namespace least {

/// Where a component is nothing but rounding along a motion, as the radial momentum on a circular orbit, its kind has
/// no size of its own there. It gets one in its own unit: what a relative change of the whole state by 1 makes of its
/// rate, for as long as it goes on making it: for no longer than the span, than the component lasts by itself, or than
/// the inverse of the frequency at which it and another one drive each other. `states`: some of the motion, in the
/// order of time, that have what it needs and no more, as the table does. Where keep_going(), asked now and then, says
/// no, sizes stay as they are. Throws MemoryShortage.
void settle_still_components(const ProblemTable& problem, std::span<const RunState> states, ComponentSizes& sizes,
                             const std::function<bool()>& keep_going);

}  // namespace least
