// Members one after the other, each a run of its own.
#pragma once

#include "core/ensemble/ensemble.hpp"
#include "core/ensemble/member_columns.hpp"

namespace least {

/// Runs the members of the block: their endings, the columns at the ends of those that completed, their sections.
/// `columns`: of the plan.
void run_lone_members(const EnsemblePlan& plan, const MemberColumns& columns, Block& block,
                      const std::atomic<bool>& cancelled);

/// What runs of a few members, spread over all, say against themselves: of each code how many do, and which is the
/// first. It follows from the plan alone, and costs a bounded number of steps, however many and long the members are.
/// None of their numbers: they take elementary functions from the C library, whose last bits are those of a machine.
std::vector<Warning> warnings_of_few(const EnsemblePlan& plan, const std::atomic<bool>& cancelled);

}  // namespace least
