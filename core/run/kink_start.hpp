// Starts on a kink: where a formula changes its side the force may jump, and the forces of both sides may lead back to
// the border, as those of V = |x| at x = 0. The motion is then that of Filippov: it rests there, or slides along the
// border; steps go back and forth over it, and those that set their length by an error become ever shorter.
// Source: Filippov, Differential Equations with Discontinuous Righthand Sides, 1988.
#pragma once

#include <string_view>

#include "core/run/mechanics.hpp"
#include "core/run/problem_table.hpp"

namespace least {

inline constexpr std::string_view starts_on_kink =
    "the run begins on a kink from which the forces of both sides lead back to it: the motion rests there or slides "
    "along it, and steps go back and forth over it";

/// Whether a run of the scene that begins at x and takes about the time `span` goes back and forth over a kink from its
/// start on. Only a scene as text can, and only one whose formulas choose.
bool begins_on_kink(const Scene& scene, const ProblemTable& problem, const RunState& x, double span);

}  // namespace least
