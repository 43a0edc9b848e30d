// A group of members in lanes, in several packs. Faults are looked for once in a block of steps; if there is one, the
// block is undone and repeated step by step, as in a lone run. A lane whose member has ended can take a member of
// another group. Only the lane units include this header.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "core/ensemble/lane_steps.hpp"

namespace least {

/// GroupRun runs the group of a task that begins with member `first`. Lanes beyond the last member repeat that member.
class GroupRun {
 public:
  /// `size` is the number of components of a state.
  GroupRun(LaneTask& task, std::size_t size, std::size_t first)
      : task_(task), size_(size), before_(packs * size), last_(before_), t_(task.start_time) {
    const std::size_t lanes = std::min(group_size, task.count - first);
    started_ = static_cast<std::int64_t>(lanes);
    for (std::size_t j = 0; j < packs; ++j)
      for (std::size_t lane = 0; lane < lane_count; ++lane) {
        const std::size_t at = j * lane_count + lane;
        const bool begins = at < lanes && task.ended[first + at] == static_cast<std::uint8_t>(cancelled);
        alive_[j].set(lane, begins);
        members_[at] = first + at;
        for (std::size_t i = 0; i < size; ++i)
          before_[j * size + i][lane] = task.start[i * task.count + first + std::min(at, lanes - 1)];
      }
  }

  /// start() returns the initial states, pack by pack.
  const Lanes* start() const { return before_.data(); }
  /// begin(steps) takes the stepper and checks the initial states.
  void begin(std::unique_ptr<GroupSteps> steps) {
    steps_ = std::move(steps);
    // No member of another group can come
    if (task_.count < group_size) steps_->use((task_.count + lane_count - 1) / lane_count);
    for (std::size_t j = 0; j < packs; ++j)
      for (const auto& fault : steps_->at_start(task_, j)) end(j, fault.where, fault.why);
    forces_at_start_ = steps_->work().forces;
  }
  std::size_t alive() const {
    std::size_t count = 0;
    for (const LaneMask& m : alive_)
      for (std::size_t lane = 0; lane < lane_count; ++lane) count += m[lane] != 0;
    return count;
  }
  bool anyone() const {
    return std::ranges::any_of(alive_, [](const LaneMask& m) { return any(m); });
  }
  /// go(bound) takes steps up to number `bound`, or to the end of the task.
  void go(std::int64_t bound) {
    while (anyone()) {
      if (!say_due()) return end_all(cancelled);
      if (n_ >= std::min(task_.steps, bound)) return;
      if (n_ >= task_.step_limit) return end_all(step_limit);
      if (task_.cancelled->load(std::memory_order_relaxed)) return end_all(cancelled);
      std::int64_t until = std::min({task_.steps, task_.step_limit, bound, n_ + block_});
      if (next_ < task_.times.size())  // up to the last step that ends at or before the next time asked for
        while (until > n_ + 1 && grid_time(until) > task_.times[next_]) --until;
      if (task_.watches && task_.watched < 0) {
        step_one_by_one(until);
        continue;
      }
      note(before_);
      steps_->keep();
      const Group<Lanes> earlier = earlier_;
      StepObservations seen;
      const double t = t_;
      advance(until, seen);
      if (faultless(seen)) {
        tell();
        taken_ += (until - n_) * static_cast<std::int64_t>(alive());
        made_ += until - n_;
        n_ = until;
        continue;
      }
      go_back(before_);
      t_ = t;
      earlier_ = earlier;
      steps_->take_back();
      forget();
      step_one_by_one(until);
    }
  }
  /// finish() is called after the last whole step.
  void finish() {
    if (task_.tail > 0 && anyone()) {
      if (n_ >= task_.step_limit) return end_all(step_limit);
      step_alone(task_.tail, task_.end);
    }
    t_ = task_.end;
    for (; next_ < task_.times.size() && !task_.cancelled->load(std::memory_order_relaxed); ++next_)
      say(task_.end, alive_);
    each_alive([&](std::size_t j, std::size_t lane) {
      task_.ended[member(j, lane)] = static_cast<std::uint8_t>(completed);
      for (std::size_t i = 0; i < size_; ++i) task_.final[i * task_.count + member(j, lane)] = pack(j)[i][lane];
    });
  }
  /// take(other) moves members of another group, which has made as many steps, into free lanes of this one, as many as
  /// fit.
  void take(GroupRun& other) {
    std::size_t to = 0;
    other.each_alive([&](std::size_t j, std::size_t lane) {
      while (to < group_size && alive_[to / lane_count][to % lane_count]) ++to;
      if (to == group_size) return;
      const std::size_t into = to / lane_count, here = to % lane_count;
      for (std::size_t i = 0; i < size_; ++i) pack(into)[i][here] = other.pack(j)[i][lane];
      steps_->take_lane(*other.steps_, j, lane, into, here);
      earlier_[into][here] = other.earlier_[j][lane];
      members_[to] = other.member(j, lane);
      alive_[into].set(here, true);
      other.alive_[j].set(lane, false);
    });
  }
  /// account() adds the group's costs to the task; called once at the end.
  void account() {
    task_.taken += taken_;
    task_.forces += forces_at_start_ * started_;
    if (made_ > 0)
      task_.forces += taken_ * std::max<std::int64_t>((steps_->work().forces - forces_at_start_) / made_, 1);
  }

 private:
  /// Steps between two checks for cancellation; long programs take fewer.
  static std::int64_t block_of(const LaneTask& task) {
    constexpr std::int64_t steps = 50, operations = 20'000;
    if (!task.program) return steps;
    const auto one = static_cast<std::int64_t>(task.program->step.of_lanes.size());
    return std::clamp<std::int64_t>(operations / std::max<std::int64_t>(one, 1), 1, steps);
  }
  using enum ReturnCode;
  /// Passage is a step of a member, from one time to another, that may have crossed the plane.
  struct Passage {
    std::size_t member;
    double from, to;
  };

  Lanes* pack(std::size_t j) { return steps_->state(j); }
  void note(std::vector<Lanes>& x) {
    for (std::size_t j = 0; j < packs; ++j) std::copy_n(pack(j), size_, x.data() + j * size_);
  }
  void go_back(const std::vector<Lanes>& x) {
    for (std::size_t j = 0; j < packs; ++j) std::copy_n(x.data() + j * size_, size_, pack(j));
  }
  /// end(j, which, why) ends those members of the mask that were still running.
  void end(std::size_t j, const LaneMask& which, ReturnCode why) {
    const LaneMask now = which & alive_[j];
    if (!any(now)) return;
    for (std::size_t lane = 0; lane < lane_count; ++lane)
      if (now[lane]) task_.ended[member(j, lane)] = static_cast<std::uint8_t>(why);
    alive_[j] = alive_[j] & !now;
  }
  void end_all(ReturnCode why) {
    for (std::size_t j = 0; j < packs; ++j) end(j, alive_[j], why);
  }
  std::size_t member(std::size_t j, std::size_t lane) const { return members_[j * lane_count + lane]; }
  template <class F>
  static void each(const Group<LaneMask>& members, F&& f) {
    for (std::size_t j = 0; j < packs; ++j)
      for (std::size_t lane = 0; lane < lane_count; ++lane)
        if (members[j][lane]) f(j, lane);
  }
  template <class F>
  void each_alive(F&& f) {
    each(alive_, f);
  }
  bool faultless(const StepObservations& seen) {
    LaneMask wrong{};
    for (std::size_t j = 0; j < packs; ++j)
      for (const auto& fault : steps_->after(j, seen, task_.step, false)) wrong = wrong | (fault.where & alive_[j]);
    return !any(wrong);
  }

  /// step_alone takes one step; members that fail in it keep the state before.
  void step_alone(double h, double t) {
    note(before_);
    StepObservations seen;
    steps_->advance(t_, task_.start_time, task_.step, n_, 1, h, seen);
    ++made_;
    for (std::size_t j = 0; j < packs; ++j) {
      for (const auto& fault : steps_->after(j, seen, task_.step, true)) end(j, fault.where, fault.why);
      for (std::size_t i = 0; i < size_; ++i) pack(j)[i] = select(alive_[j], pack(j)[i], before_[j * size_ + i]);
    }
    taken_ += static_cast<std::int64_t>(alive());
    if (task_.watches) watch(before_, t);
    t_ = t;
    tell();
  }
  /// watch notes members that may have crossed the level within the step to the time t, or crossed it twice. As in a
  /// lone run, nothing is known in the first step.
  void watch(const std::vector<Lanes>& before, double t) {
    const Lanes level(task_.level), part((t - t_) / task_.step);  // of a step as long as the one before
    for (std::size_t j = 0; j < packs; ++j) {
      const Lanes *was = before.data() + j * size_, *is = pack(j);
      LaneMask passed = alive_[j];
      // On which side of the level it was, is, and would be by linear extrapolation of the step before
      if (task_.watched >= 0) {
        const Lanes first = was[task_.watched], ahead = first + (first - earlier_[j]) * part;
        const LaneMask below = first < level, then = is[task_.watched] < level, straight = ahead < level;
        if (t_ > task_.start_time) passed = passed & (below | then | straight) & !(below & then & straight);
        earlier_[j] = first;
      }
      if (!any(passed)) continue;
      for (std::size_t lane = 0; lane < lane_count; ++lane) {
        if (!passed[lane]) continue;
        passages_.push_back({member(j, lane), t_, t});
        for (std::size_t k = 0; k < size_; ++k) passed_.push_back(was[k][lane]);
        for (std::size_t k = 0; k < size_; ++k) passed_.push_back(is[k][lane]);
      }
    }
  }
  void tell() {
    std::span<const double> states(passed_);
    for (const Passage& p : passages_) {
      task_.host->at_step(p.member, p.from, states.first(size_), p.to, states.subspan(size_, size_));
      states = states.subspan(2 * size_);
    }
    forget();
  }
  void forget() {
    passages_.clear();
    passed_.clear();
  }

  double grid_time(std::int64_t n) const { return task_.start_time + static_cast<double>(n) * task_.step; }

  void step_one_by_one(std::int64_t until) {
    for (; n_ < until && anyone(); ++n_) step_alone(task_.step, grid_time(n_ + 1));
  }
  /// advance takes steps up to number `until`; passages are noted in each.
  void advance(std::int64_t until, StepObservations& seen) {
    const auto take_steps = [&](std::int64_t from, std::int64_t to) {
      steps_->advance(t_, task_.start_time, task_.step, from, to - from, task_.step, seen);
    };
    if (!task_.watches) {
      take_steps(n_, until);
      t_ = grid_time(until);
      return;
    }
    for (std::int64_t n = n_; n < until; ++n) {
      note(last_);
      take_steps(n, n + 1);
      watch(last_, grid_time(n + 1));
      t_ = grid_time(n + 1);
    }
  }
  /// upcoming() returns the time of the next state on the grid; times asked for before it are served from the present
  /// state.
  double upcoming() const { return n_ < task_.steps ? grid_time(n_ + 1) : task_.end; }

  /// say_due() reports states at the times asked for before the next state on the grid. A member that fails in the step
  /// ahead has none within it. False: the task was cancelled.
  bool say_due() {
    std::optional<Group<LaneMask>> sound;
    for (; next_ < task_.times.size() && task_.times[next_] < upcoming(); ++next_) {
      if (task_.cancelled->load(std::memory_order_relaxed)) return false;
      const bool within = task_.times[next_] > t_;
      if (within && !sound) sound = sound_ahead();
      say(task_.times[next_], within ? *sound : alive_);
    }
    return true;
  }
  /// sound_ahead() returns the members that will take the step ahead, found by a trial that does not affect the run.
  Group<LaneMask> sound_ahead() {
    if (n_ >= task_.step_limit) return {};
    note(before_);
    steps_->keep();
    StepObservations seen;
    steps_->advance(t_, task_.start_time, task_.step, n_, 1, n_ < task_.steps ? task_.step : task_.tail, seen);
    Group<LaneMask> sound = alive_;
    for (std::size_t j = 0; j < packs; ++j)
      for (const auto& fault : steps_->after(j, seen, task_.step, true)) sound[j] = sound[j] & !fault.where;
    steps_->take_back();
    go_back(before_);
    return sound;
  }

  /// say(t, whom) reports states at the time t by a shorter step that does not affect the run.
  void say(double t, const Group<LaneMask>& whom) {
    note(before_);
    const double part = t - t_;
    if (part > 0) {
      steps_->keep();
      StepObservations seen;
      steps_->advance(t_, task_.start_time, task_.step, n_, 1, part, seen);
      steps_->take_back();
    }
    std::vector<double> state(size_);
    each(whom, [&](std::size_t j, std::size_t lane) {
      for (std::size_t i = 0; i < size_; ++i) state[i] = pack(j)[i][lane];
      task_.host->at_time(member(j, lane), t, state.data());
    });
    go_back(before_);
  }

  LaneTask& task_;
  const std::int64_t block_ = block_of(task_);
  std::size_t size_;
  std::unique_ptr<GroupSteps> steps_;
  std::array<std::size_t, group_size> members_{};  ///< by lane
  std::vector<Lanes> before_, last_;               ///< states at the beginning of a block, and of a step
  double t_;                                       ///< time of the states
  Group<LaneMask> alive_;
  Group<Lanes> earlier_;  ///< the watched variable, one step before the states
  std::vector<Passage> passages_;
  std::vector<double> passed_;         ///< by passage, the states before and after
  std::int64_t n_ = 0;                 ///< steps so far
  std::size_t next_ = 0;               ///< index of the next time asked for
  std::int64_t taken_ = 0, made_ = 0;  ///< steps summed over members, and of the group
  std::int64_t started_ = 0, forces_at_start_ = 0;
};

}  // namespace least
