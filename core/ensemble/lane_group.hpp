// A group of members in lanes, packs of them in flight. What can go wrong is looked for every so many steps, and
// steps in which something did are taken back and taken again one by one, as of a lone run. A member that ended leaves
// its lane to one of another group. Only units of lanes include this header.
#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "core/ensemble/lane_steps.hpp"

namespace least {

/// The group of a task that begins with its member `first`. Lanes beyond the last member do what that does.
class GroupRun {
 public:
  /// States of so many components.
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

  /// The states that it begins with.
  const Lanes* start() const { return before_.data(); }
  /// Steps from there.
  void begin(std::unique_ptr<GroupSteps> steps) {
    steps_ = std::move(steps);
    if (task_.count < group_size) steps_->use((task_.count + lane_count - 1) / lane_count);  // nobody else comes
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
  /// Takes its steps up to the one with this number, or as many as there are.
  void go(std::int64_t bound) {
    while (anyone()) {
      for (; next_ < task_.times.size() && task_.times[next_] < upcoming(); ++next_) {
        if (task_.cancelled->load(std::memory_order_relaxed)) return end_all(cancelled);
        say(task_.times[next_]);
      }
      if (n_ >= std::min(task_.steps, bound)) return;
      if (n_ >= task_.step_limit) return end_all(step_limit);
      if (task_.cancelled->load(std::memory_order_relaxed)) return end_all(cancelled);
      std::int64_t until = std::min({task_.steps, task_.step_limit, bound, n_ + block_});
      if (next_ < task_.times.size())  // to the last step at or before it
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
  /// After the last whole step.
  void finish() {
    if (task_.tail > 0 && anyone()) {
      if (n_ >= task_.step_limit) return end_all(step_limit);
      step_alone(task_.tail, task_.end);
    }
    t_ = task_.end;
    for (; next_ < task_.times.size() && !task_.cancelled->load(std::memory_order_relaxed); ++next_) say(task_.end);
    each_alive([&](std::size_t j, std::size_t lane) {
      task_.ended[member(j, lane)] = static_cast<std::uint8_t>(completed);
      for (std::size_t i = 0; i < size_; ++i) task_.final[i * task_.count + member(j, lane)] = pack(j)[i][lane];
    });
  }
  /// Members of the other group, which made as many steps, go on in lanes of this one in which nobody does: as many as
  /// there is room for.
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
  /// What it cost, when all is done.
  void account() {
    task_.taken += taken_;
    task_.forces += forces_at_start_ * started_;
    if (made_ > 0)
      task_.forces += taken_ * std::max<std::int64_t>((steps_->work().forces - forces_at_start_) / made_, 1);
  }

 private:
  /// Steps between two looks at whether the task is cancelled; of steps that are long programs there are fewer.
  static std::int64_t block_of(const LaneTask& task) {
    constexpr std::int64_t steps = 50, operations = 20'000;
    if (!task.program) return steps;
    const auto one = static_cast<std::int64_t>(task.program->step.of_lanes.size());
    return std::clamp<std::int64_t>(operations / std::max<std::int64_t>(one, 1), 1, steps);
  }
  using enum ReturnCode;
  /// Of a member, from one time to another.
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
  /// Those of the mask that were going on until now.
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
  void each_alive(F&& f) {
    for (std::size_t j = 0; j < packs; ++j)
      for (std::size_t lane = 0; lane < lane_count; ++lane)
        if (alive_[j][lane]) f(j, lane);
  }
  bool faultless(const StepObservations& seen) {
    LaneMask wrong{};
    for (std::size_t j = 0; j < packs; ++j)
      for (const auto& fault : steps_->after(j, seen, task_.step, false)) wrong = wrong | (fault.where & alive_[j]);
    return !any(wrong);
  }

  /// One step, from which members that fail are brought back.
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
  /// Notes who may have passed what is watched within the step to the time t, or have come back from it: as of a lone
  /// run, of the first step nothing is known.
  void watch(const std::vector<Lanes>& before, double t) {
    const Lanes level(task_.level), part((t - t_) / task_.step);  // of a step like the one before
    for (std::size_t j = 0; j < packs; ++j) {
      const Lanes *was = before.data() + j * size_, *is = pack(j);
      LaneMask passed = alive_[j];
      if (task_.watched >= 0) {  // on which side it was and is, and would be had it gone on as in the step before
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
  /// Steps up to the one with this number, in all of which passages of a level are noted.
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
  /// The time of the next state on the way; what is asked for before it is told from the one before.
  double upcoming() const { return n_ < task_.steps ? grid_time(n_ + 1) : task_.end; }

  /// The states at the time t, by a shorter step of which the run itself knows nothing.
  void say(double t) {
    note(before_);
    const double part = t - t_;
    if (part > 0) {
      steps_->keep();
      StepObservations seen;
      steps_->advance(t_, task_.start_time, task_.step, n_, 1, part, seen);
      steps_->take_back();
    }
    std::vector<double> state(size_);
    each_alive([&](std::size_t j, std::size_t lane) {
      for (std::size_t i = 0; i < size_; ++i) state[i] = pack(j)[i][lane];
      task_.host->at_time(member(j, lane), t, state.data());
    });
    go_back(before_);
  }

  LaneTask& task_;
  const std::int64_t block_ = block_of(task_);
  std::size_t size_;
  std::unique_ptr<GroupSteps> steps_;
  std::array<std::size_t, group_size> members_{};  ///< of each lane
  std::vector<Lanes> before_, last_;               ///< states with which a block or a step began
  double t_;                                       ///< time of the states
  Group<LaneMask> alive_;
  Group<Lanes> earlier_;  ///< what is watched, a step before the states
  std::vector<Passage> passages_;
  std::vector<double> passed_;         ///< of each passage the states before and after
  std::int64_t n_ = 0;                 ///< steps so far
  std::size_t next_ = 0;               ///< of the times asked for
  std::int64_t taken_ = 0, made_ = 0;  ///< steps of members, of the group
  std::int64_t started_ = 0, forces_at_start_ = 0;
};

}  // namespace least
