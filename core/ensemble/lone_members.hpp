// Members run one after the other, each as a run of its own.
#pragma once

#include "core/ensemble/ensemble.hpp"
#include "core/ensemble/member_columns.hpp"

namespace least {

/// run_lone_members runs the members of the block and adds their endings, final columns and section points. `columns`
/// are those of the plan.
void run_lone_members(const EnsemblePlan& plan, const MemberColumns& columns, Block& block,
                      const std::atomic<bool>& cancelled);

/// warnings_of_few returns the warnings of runs of a few members, spread over all: by code, how many members have it
/// and which is the first. They depend on the plan alone, and cost a bounded number of steps, however many and long the
/// members are. No numbers of these runs are returned, as runs use the C library, whose last bits depend on the
/// machine.
std::vector<Warning> warnings_of_few(const EnsemblePlan& plan, const std::atomic<bool>& cancelled);

}  // namespace least
