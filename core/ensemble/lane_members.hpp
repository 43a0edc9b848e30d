// Members in lanes: the units for several instruction sets, and running a block of members by one of them.
#pragma once

#include <span>
#include <string_view>

#include "core/ensemble/ensemble.hpp"
#include "core/ensemble/lane_task.hpp"
#include "core/ensemble/member_columns.hpp"

namespace least {

/// LaneUnit is the lane code compiled for one instruction set.
struct LaneUnit {
  std::string_view name;
  std::size_t width = 0;  ///< doubles in a register
  /// Runs members of a problem of the catalogue; returns null where the unit has none
  RunLanes (*problem)(std::string_view id);
  LanePrograms (*programs)();
};
/// lane_units() returns the units that this machine can run, the widest first.
std::span<const LaneUnit> lane_units();
/// evaluate_in_lanes writes a program's values at a point, bitwise the same on every machine.
void evaluate_in_lanes(const LaneProgram& program, const LanePoint& point, double* out);

/// run_lane_members runs the members of a block in a unit of lanes, with the results of run_lone_members. False: they
/// cannot run in lanes. `columns` are those of the plan.
bool run_lane_members(const EnsemblePlan& plan, const MemberColumns& columns, Block& block,
                      const std::atomic<bool>& cancelled, const LaneUnit& unit = lane_units().front());

}  // namespace least
