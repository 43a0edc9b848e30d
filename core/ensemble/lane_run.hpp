// The members of a task in lanes, group by group, in as few groups as hold those that have not ended. Only units of
// lanes include this header.
#pragma once

#include <algorithm>
#include <vector>

#include "core/ensemble/lane_group.hpp"

namespace least {

/// Fewer groups where their members are fewer: the last ones go on in lanes of the first.
inline void close_ranks(std::vector<std::unique_ptr<GroupRun>>& groups) {
  std::erase_if(groups, [](auto& group) {  // it stands still where its last member ended: nobody can go on from there
    if (!group->anyone()) group->account();
    return !group->anyone();
  });
  std::size_t members = 0, into = 0;
  for (const auto& group : groups) members += group->alive();
  while (groups.size() * group_size >= members + group_size) {
    for (; groups.back()->anyone(); ++into) groups[into]->take(*groups.back());
    into -= into > 0;  // there may be room left
    groups.back()->account();
    groups.pop_back();
  }
}

/// Makes the steps of the group that begins with that member, from its states.
class GroupMaker {
 public:
  virtual ~GroupMaker() = default;
  virtual std::unique_ptr<GroupSteps> of(std::size_t first, const Lanes* x) const = 0;
};
/// Runs the members of a task, as many groups at once as fit the cache that is a core's own: of a group so many bytes,
/// of a state so many components.
inline void run_members(LaneTask& task, const GroupMaker& maker, std::size_t bytes, std::size_t size) {
  constexpr std::size_t cache = std::size_t{1} << 18;
  // Steps of one group after the other: long against what it costs to turn to it.
  constexpr std::int64_t stretch = GroupOfClocks::stretch;
  const std::size_t at_once =
      std::max(cache / (bytes + sizeof(GroupRun) + 3 * group_size * size * sizeof(double)), packs);
  for (std::size_t first = 0; first < task.count;) {
    GroupOfClocks clocks;  // they have the same steps and the same times
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

/// Of a task of the problem P, by a scheme.
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

/// A task of the problem P.
template <template <class> class P>
bool run_lanes(LaneTask& task) {
  using Problem = P<double>;
  using X = StateOf<Problem, Lanes>;
  if constexpr (HasSeries<Problem>)  // its first steps are not the scheme's
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
