// Members in lanes: the units for several instruction sets, and the way of a block of members through one.
#pragma once

#include <span>
#include <string_view>

#include "core/ensemble/ensemble.hpp"
#include "core/ensemble/lane_task.hpp"
#include "core/ensemble/member_columns.hpp"

namespace least {

/// A unit of lanes, compiled for one instruction set.
struct LaneUnit {
  std::string_view name;
  std::size_t width = 0;                            ///< doubles in a register
  LaneMechanics (*mechanics)(std::string_view id);  ///< of a problem; null pointers where it has none
  LaneMechanics (*programs)();                      ///< of what is given as a program
};
/// Those that this machine can run, the widest first; the last can do whatever lanes can.
std::span<const LaneUnit> lane_units();
/// What a program makes of a point, with the same bits on every machine.
void evaluate_in_lanes(const LaneProgram& program, const LanePoint& point, double* out);

/// Runs the members of a block as run_lone_members does, in the first of the units that can. False: none can.
/// `columns`: of the plan.
bool run_lane_members(const EnsemblePlan& plan, const MemberColumns& columns, Block& block,
                      const std::atomic<bool>& cancelled, std::span<const LaneUnit> units = lane_units());

}  // namespace least
