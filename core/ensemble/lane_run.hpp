// The members of a task in lanes, group by group, in as few groups as hold those that have not ended. Only units of
// lanes include this header.
#pragma once

#include <algorithm>
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
              value[lane] = row[std::min(first + j * lane_count + lane, task.count - 1)];
          });
        }
      };
      std::apply([&](const auto&... field) { (set(field), ...); }, About<P>::fields);
    }
    return all;
  }
}

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
/// of a state so many components. Alike: members may go on in lanes of others.
inline void run_members(LaneTask& task, const GroupMaker& maker, std::size_t bytes, std::size_t size, bool alike) {
  constexpr std::size_t cache = std::size_t{1} << 18;
  // Steps of one group after the other: long against what it costs to turn to it.
  constexpr std::int64_t stretch = GroupOfClocks::stretch;
  const std::size_t at_once =
      std::max(cache / (bytes + sizeof(GroupRun) + 3 * group_size * size * sizeof(double)), packs);
  for (std::size_t first = 0; first < task.count;) {
    GroupOfClocks clocks;  // they have the same steps, and where parameters are shared the same times
    std::vector<std::unique_ptr<GroupRun>> groups;
    for (; first < task.count && groups.size() < at_once; first += group_size) {
      groups.push_back(std::make_unique<GroupRun>(task, size, first));
      groups.back()->begin(maker.of(first, groups.back()->start()));
    }
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

/// Of a task of the problem P, by a scheme.
template <template <class> class P, class R>
class ProblemMaker final : public GroupMaker {
 public:
  ProblemMaker(const LaneTask& task, const void* scheme, BindGroup<P<R>> bind)
      : task_(task), scheme_(scheme), bind_(bind) {}
  std::unique_ptr<GroupSteps> of(std::size_t first, const Lanes* x) const override {
    return bind_(scheme_, problems_of<P, R>(task_, first), x, task_.start_time);
  }

 private:
  const LaneTask& task_;
  const void* scheme_;
  BindGroup<P<R>> bind_;
};

/// A task of the problem P.
template <template <class> class P>
bool run_lanes(LaneTask& task) {
  using Problem = P<double>;
  using R = std::conditional_t<general, Lanes, double>;
  using X = std::conditional_t<general, FullStateOf<Problem, Lanes>, StateOf<Problem, Lanes>>;
  if constexpr (HasSeries<Problem>)  // its first steps are not the scheme's
    if (task.start_time >= 0 && task.start_time <= Problem::series_until) return false;
  const bool own = task.full || !task.varied.empty();  // of each lane, or more than the motion needs
  if constexpr (general) {
    if (task.full && !std::is_same_v<FullRunState<Problem>, FullStateOf<Problem>>) return false;
  } else if (own) {
    return false;
  }
  bool ran = false;
  with_bound_scheme<P<R>, X>(task.scheme, task.settings,
                             [&](const void* scheme, BindGroup<P<R>> bind, std::size_t bytes) {
                               run_members(task, ProblemMaker<P, R>(task, scheme, bind), bytes, X::size, !general);
                               task.variables = X::size;
                               ran = true;
                             });
  return ran;
}

}  // namespace least
