// The members of a task in lanes, group by group, in as few groups as hold those that have not ended. Only units of
// lanes include this header.
#pragma once

#include <algorithm>
#include <memory>
#include <tuple>
#include <vector>

#include "core/ensemble/lane_group.hpp"
#include "core/parameters.hpp"

namespace least {

/// The problems of a group: of parameters that all share, or each lane of its own.
template <template <class> class P, class R>
Group<P<R>> problems_of(const LaneTask& task, std::size_t first) {
  const auto shared = from_values<P<double>>(About<P>::fields, task.parameters);
  if constexpr (std::is_same_v<R, double>) {
    Group<P<R>> all;
    all.fill(shared);
    return all;
  } else {
    Group<P<R>> all;
    for (std::size_t j = 0; j < packs; ++j) {
      all[j] = parameters::in<R>(shared);
      std::size_t index = 0;
      const auto set = [&]<class M>(const Field<P<double>, M>& field) {
        const auto varied = std::ranges::find(task.varied, index++);
        if constexpr (std::is_same_v<M, double>) {
          if (varied == task.varied.end()) return;
          const double* row = task.values + static_cast<std::size_t>(varied - task.varied.begin()) * task.count;
          parameters::with_member(all[j], field, [&](R& value) {
            for (std::size_t lane = 0; lane < lane_count; ++lane)
              value.v[lane] = row[std::min(first + j * lane_count + lane, task.count - 1)];
          });
        }
      };
      std::apply([&](const auto&... field) { (set(field), ...); }, About<P>::fields);
    }
    return all;
  }
}

/// Fewer groups where their members are fewer: the last ones go on in lanes of the first.
template <class Run>
void close_ranks(std::vector<std::unique_ptr<Run>>& groups) {
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

/// Runs the members of a task, so many groups at once. make(first) → the run of the group that begins with that member.
template <class Make>
void run_members(LaneTask& task, std::size_t groups_at_once, bool alike, Make&& make) {
  constexpr std::int64_t stretch =
      1000;  // steps of one group after the other: long against what it costs to turn to it
  for (std::size_t first = 0; first < task.count;) {
    std::vector<decltype(make(first))> groups;
    for (; first < task.count && groups.size() < groups_at_once; first += group_size) groups.push_back(make(first));
    for (std::int64_t n = std::min(stretch, task.steps); !groups.empty(); n = std::min(n + stretch, task.steps)) {
      for (auto& group : groups) group->go(n);
      if (n == task.steps) break;
      if (alike) close_ranks(groups);
    }
    for (auto& group : groups) {
      group->finish();
      group->account();
    }
  }
}
/// As many groups as fit the cache that is a core's own.
inline std::size_t groups_of(std::size_t bytes) {
  constexpr std::size_t cache = std::size_t{1} << 20;
  return std::max(cache / bytes, packs);
}

template <template <class> class P, class R, class X, class Scheme>
bool run_groups(LaneTask& task, const Scheme& scheme) {
  if constexpr (requires { typename StepperOf<Scheme, P<R>, X>; }) {
    using Run = GroupRun<P<R>, X>;
    using Steps = BoundGroup<P<R>, X, Scheme>;
    const GroupOfClocks
        one;  // of all members: they have the same steps, and where parameters are shared the same times
    run_members(task, groups_of(sizeof(Run) + sizeof(Steps)), !general, [&](std::size_t first) {
      auto run = std::make_unique<Run>(task, problems_of<P, R>(task, first), first);
      run->begin([&](const auto& problems, const auto& x) { return std::make_unique<Steps>(scheme, problems, x); });
      return run;
    });
    task.variables = X::size;
    return true;
  }
  return false;
}

/// A task of the problem P.
template <template <class> class P>
bool run_lanes(LaneTask& task) {
  if constexpr (HasSeries<P<double>>)  // its first steps are not the scheme's
    if (task.start_time >= 0 && task.start_time <= P<double>::series_until) return false;
  using Problem = P<double>;
  const bool own = task.full || !task.varied.empty();  // of each lane, or more than the motion needs
  if constexpr (general) {
    if (task.full && !std::is_same_v<FullRunState<Problem>, FullStateOf<Problem>>) return false;
  } else if (own) {
    return false;
  }
  bool ran = false;
  with_lane_scheme(task.scheme, task.settings, [&](const auto& scheme) {
    if constexpr (general) {
      ran = run_groups<P, Lanes, FullStateOf<Problem, Lanes>>(task, scheme);
    } else {
      ran = run_groups<P, double, StateOf<Problem, Lanes>>(task, scheme);
    }
  });
  return ran;
}

}  // namespace least
