// Runs the members of a task in lanes, group by group, closing up groups as members end. Only the lane units include
// this header.
#pragma once

#include <algorithm>
#include <vector>

#include "core/ensemble/lane_group.hpp"

namespace least {

/// close_ranks reduces the number of groups when few members are left: members of the last groups move into free lanes
/// of the first ones.
inline void close_ranks(std::vector<std::unique_ptr<GroupRun>>& groups) {
  // A group without members stopped at an earlier step, so that nobody can continue in it
  std::erase_if(groups, [](auto& group) {
    if (!group->anyone()) group->account();
    return !group->anyone();
  });
  std::size_t members = 0, into = 0;
  for (const auto& group : groups) members += group->alive();
  while (groups.size() * group_size >= members + group_size) {
    for (; groups.back()->anyone(); ++into) groups[into]->take(*groups.back());
    into -= into > 0;  // this group may still have room
    groups.back()->account();
    groups.pop_back();
  }
}

/// GroupMaker makes the stepper of the group that begins with member `first`, from its states.
class GroupMaker {
 public:
  virtual ~GroupMaker() = default;
  virtual std::unique_ptr<GroupSteps> of(std::size_t first, const Lanes* x) const = 0;
};
/// run_members runs the members of a task, as many groups at once as fit into a core's own cache. `bytes` is the size
/// of a group's stepper, `size` the number of components of a state.
inline void run_members(LaneTask& task, const GroupMaker& maker, std::size_t bytes, std::size_t size) {
  constexpr std::size_t cache = std::size_t{1} << 18;
  // Steps of one group before turning to the next: long compared with the cost of turning.
  constexpr std::int64_t stretch = GroupOfClocks::stretch;
  const std::size_t at_once =
      std::max(cache / (bytes + sizeof(GroupRun) + 3 * group_size * size * sizeof(double)), packs);
  for (std::size_t first = 0; first < task.count;) {
    GroupOfClocks clocks;  // all groups have the same steps and times
    std::vector<std::unique_ptr<GroupRun>> groups;
    for (; first < task.count && groups.size() < at_once; first += group_size) {
      groups.push_back(std::make_unique<GroupRun>(task, size, first));
      groups.back()->begin(maker.of(first, groups.back()->start()));
    }
    for (std::int64_t n = std::min(stretch, task.steps); !groups.empty(); n = std::min(n + stretch, task.steps)) {
      for (auto& group : groups) group->go(n);
      if (n == task.steps) break;
      close_ranks(groups);
    }
    for (auto& group : groups) {
      group->finish();
      group->account();
    }
  }
}

/// ProblemMaker makes steppers of problem P by a compiled scheme.
template <class P>
class ProblemMaker final : public GroupMaker {
 public:
  ProblemMaker(const LaneTask& task, const P& problem, const void* scheme, BindGroup<P> bind)
      : task_(task), problem_(problem), scheme_(scheme), bind_(bind) {}
  std::unique_ptr<GroupSteps> of(std::size_t, const Lanes* x) const override {
    return bind_(scheme_, problem_, x, task_.start_time);
  }

 private:
  const LaneTask& task_;
  const P problem_;
  const void* scheme_;
  BindGroup<P> bind_;
};

/// run_lanes runs a task of problem P. False: scheme and problem are not compiled together, or the start is a series.
template <template <class> class P>
bool run_lanes(LaneTask& task) {
  using Problem = P<double>;
  using X = StateOf<Problem, Lanes>;
  if constexpr (HasSeries<Problem>)  // the first steps are those of the series
    if (task.start_time >= 0 && task.start_time <= Problem::series_until) return false;
  bool ran = false;
  with_bound_scheme<Problem, X>(task.scheme, task.settings,
                                [&](const void* scheme, BindGroup<Problem> bind, std::size_t bytes) {
                                  const auto problem = from_values<Problem>(About<P>::fields, task.parameters);
                                  run_members(task, ProblemMaker<Problem>(task, problem, scheme, bind), bytes, X::size);
                                  task.variables = X::size;
                                  ran = true;
                                });
  return ran;
}

}  // namespace least
