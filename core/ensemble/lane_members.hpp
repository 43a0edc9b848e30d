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
  std::size_t width = 0;                     ///< doubles in a register
  RunLanes (*problem)(std::string_view id);  ///< of a problem of the catalogue; null: there is none
  LanePrograms (*programs)();
};
/// Those that this machine can run, the widest first.
std::span<const LaneUnit> lane_units();
/// What a program makes of a point, with the same bits on every machine.
void evaluate_in_lanes(const LaneProgram& program, const LanePoint& point, double* out);

/// Runs the members of a block as run_lone_members does, in a unit of lanes. False: they cannot. `columns`: of the
/// plan.
bool run_lane_members(const EnsemblePlan& plan, const MemberColumns& columns, Block& block,
                      const std::atomic<bool>& cancelled, const LaneUnit& unit = lane_units().front());

}  // namespace least
