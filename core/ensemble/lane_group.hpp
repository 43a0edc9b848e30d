// A group of members in lanes, eight packs of them in flight. What can go wrong is looked for every so many steps, and
// steps in which something did are taken back and taken again one by one, as of a lone run. A member that ended leaves
// its lane to one of another group. Only units of lanes include this header.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "core/ensemble/lane_steps.hpp"

namespace least {

/// The group of a task that begins with its member `first`. Lanes beyond the last member do what that does.
template <class P, class X>
class GroupRun {
 public:
  GroupRun(LaneTask& task, const Group<P>& problems, std::size_t first) : task_(task), problems_(problems) {
    const std::size_t lanes = std::min(group_size, task.count - first);
    started_ = static_cast<std::int64_t>(lanes);
    for (std::size_t j = 0; j < packs; ++j) {
      x_[j].t = task.start_time;
      for (std::size_t lane = 0; lane < lane_count; ++lane) {
        const std::size_t at = j * lane_count + lane;
        const bool begins = at < lanes && task.ended[first + at] == static_cast<std::uint8_t>(cancelled);
        alive_[j].on[static_cast<int>(lane)] = begins ? -1 : 0;
        members_[at] = first + at;
        for (std::size_t i = 0; i < X::size; ++i)
          x_[j][i].v[static_cast<int>(lane)] = task.start[i * task.count + first + std::min(at, lanes - 1)];
      }
    }
  }

  /// bind(problems, states) → GroupSteps from there
  template <class Bind>
  void begin(Bind&& bind) {
    check_start();
    steps_ = bind(problems_, x_);
    forces_at_start_ = steps_->work().forces;
  }
  std::size_t alive() const {
    std::size_t count = 0;
    for (const LaneMask& m : alive_)
      for (std::size_t lane = 0; lane < lane_count; ++lane) count += m.on[lane] != 0;
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
      std::int64_t until = std::min({task_.steps, task_.step_limit, bound, n_ + block});
      if (next_ < task_.times.size())  // to the last step at or before it
        while (until > n_ + 1 && grid_time(until) > task_.times[next_]) --until;
      if (task_.watches && task_.watched < 0) {
        step_one_by_one(until);
        continue;
      }
      const Group<X> before = x_;
      steps_->keep();
      Seen seen;
      advance(until, seen);
      if (faultless(seen)) {
        tell();
        taken_ += (until - n_) * static_cast<std::int64_t>(alive());
        made_ += until - n_;
        n_ = until;
        continue;
      }
      x_ = before;
      steps_->take_back();
      passages_.clear();
      step_one_by_one(until);
    }
  }
  /// After the last whole step.
  void finish() {
    if (task_.tail > 0 && anyone()) {
      if (n_ >= task_.step_limit) return end_all(step_limit);
      step_alone(task_.tail, task_.end);
    }
    for (X& x : x_) x.t = task_.end;
    for (; next_ < task_.times.size() && !task_.cancelled->load(std::memory_order_relaxed); ++next_) say(task_.end);
    each_alive([&](std::size_t j, std::size_t lane) {
      task_.ended[member(j, lane)] = static_cast<std::uint8_t>(completed);
      for (std::size_t i = 0; i < X::size; ++i) task_.final[i * task_.count + member(j, lane)] = x_[j][i].v[lane];
    });
  }
  /// Members of the other group, which made as many steps, go on in lanes of this one in which nobody does: as many as
  /// there is room for.
  void take(GroupRun& other) {
    std::size_t to = 0;
    other.each_alive([&](std::size_t j, std::size_t lane) {
      while (to < group_size && alive_[to / lane_count].on[to % lane_count]) ++to;
      if (to == group_size) return;
      const std::size_t pack = to / lane_count, here = to % lane_count;
      for (std::size_t i = 0; i < X::size; ++i) x_[pack][i].v[here] = other.x_[j][i].v[lane];
      limit_[pack].v[here] = other.limit_[j].v[lane];
      steps_->take_lane(*other.steps_, j, lane, pack, here);
      members_[to] = other.member(j, lane);
      alive_[pack].on[here] = -1;
      other.alive_[j].on[lane] = 0;
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
  using Narrow = typename X::template in<double, double>;
  static constexpr double largest_component = 1e75;
  static constexpr std::int64_t block = 50;
  using enum ReturnCode;
  struct Passage {
    std::size_t member;
    double from, to;
    std::array<double, X::size> before{}, after{};
    Passage(std::size_t of, double start, double end) : member(of), from(start), to(end) {}
  };

  /// Those of the mask that were going on until now.
  void end(std::size_t j, const LaneMask& which, ReturnCode why) {
    const LaneMask now = which & alive_[j];
    if (!any(now)) return;
    for (std::size_t lane = 0; lane < lane_count; ++lane)
      if (now.on[lane]) task_.ended[member(j, lane)] = static_cast<std::uint8_t>(why);
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
        if (alive_[j].on[lane]) f(j, lane);
  }
  static Narrow in_lane(const X& x, std::size_t lane) {
    Narrow y;
    y.t = x.t;
    for (std::size_t i = 0; i < X::size; ++i) y[i] = x[i].v[lane];
    return y;
  }
  static LaneMask finite(const X& x) {
    LaneMask good{LaneMask::Vector{} - 1};
    for (std::size_t i = 0; i < X::size; ++i) good = good & (abs(x[i]) < Lanes(largest_component));
    return good;
  }
  template <class R>
  static double lane_of(const R& x, std::size_t lane) {
    if constexpr (std::is_same_v<R, Lanes>) {
      return x.v[lane];
    } else {
      return x;
    }
  }
  double damping_step(std::size_t j, std::size_t lane) const {
    if constexpr (HasFrequency<P> && ConstantDamping<P>)
      return std::max(lane_of(problems_[j].damping(), lane), 0.0) * task_.step;
    return 0;
  }

  void check_start() {
    const double square = task_.step * task_.step;
    for (std::size_t j = 0; j < packs; ++j) {
      end(j, !finite(x_[j]), not_finite);
      if constexpr (HasDomain<P>)
        if (problems_[j].bounded()) end(j, problems_[j].inside(x_[j].q) < Lanes(0), left_domain);
      if constexpr (VectorField<P>) end(j, !finite(derivative(problems_[j], x_[j])), singular);
      if constexpr (QuadraticContact<P>)
        if (task_.steps > 0) end(j, pole(j, x_[j].action.s), singular);
      if constexpr (HasFrequency<P>) {
        const Lanes turn(problems_[j].frequency_squared(position(x_[j])));
        for (std::size_t lane = 0; lane < lane_count; ++lane) {
          const double alpha = damping_step(j, lane);
          const std::size_t twin = lane > 0 ? lane - 1 : 0;
          if constexpr (ConstantFrequency<P>) {
            LaneMask here{};
            here.on[lane] = -1;
            if (task_.steps > 0 && task_.host->is_too_fast(turn.v[lane] * square, alpha)) end(j, here, unstable_step);
          } else {
            limit_[j].v[lane] =
                lane > 0 && alpha == damping_step(j, twin) ? limit_[j].v[twin] : task_.host->turn_limit(alpha) / square;
          }
        }
        if constexpr (!ConstantFrequency<P>)
          if (task_.steps > 0) end(j, turn > limit_[j], unstable_step);
      }
    }
  }
  LaneMask pole(std::size_t j, const Lanes& s) const requires QuadraticContact<P> {
    return -(problems_[j].action_curvature() * s * task_.step) > Lanes(2);
  }

  /// What went wrong with the pack, in the order in which a lone run looks for it.
  template <class F>
  void faults(std::size_t j, const Seen& seen, F&& fault) {
    fault(seen.failed[j], singular);
    if constexpr (QuadraticContact<P>) fault(pole(j, seen.lowest[j]), singular);
    const LaneMask good = finite(x_[j]);
    if constexpr (HasDomain<P>)
      if (problems_[j].bounded()) fault(seen.left[j] & good, left_domain);
    fault(!good, not_finite);
    if constexpr (HasFrequency<P> && !ConstantFrequency<P>) fault(seen.turn[j] > limit_[j], unstable_step);
  }
  bool faultless(const Seen& seen) {
    LaneMask wrong{};
    for (std::size_t j = 0; j < packs; ++j)
      faults(j, seen, [&](const LaneMask& which, ReturnCode) { wrong = wrong | (which & alive_[j]); });
    return !any(wrong);
  }

  /// One step, from which members that fail are brought back.
  void step_alone(double h, double t) {
    const Group<X> before = x_;
    Seen seen;
    steps_->advance(x_, task_.start_time, task_.step, n_, 1, h, seen);
    ++made_;
    for (std::size_t j = 0; j < packs; ++j) {
      x_[j].t = t;
      faults(j, seen, [&](const LaneMask& which, ReturnCode why) { end(j, which, why); });
      for (std::size_t i = 0; i < X::size; ++i) x_[j][i] = select(alive_[j], x_[j][i], before[j][i]);
    }
    taken_ += static_cast<std::int64_t>(alive());
    if (task_.watches) watch(before);
    tell();
  }
  /// Notes who may have passed what is watched within the last step.
  void watch(const Group<X>& before) {
    for (std::size_t j = 0; j < packs; ++j) {
      LaneMask passed = alive_[j];
      if (task_.watched >= 0) {
        const auto i = static_cast<std::size_t>(task_.watched);
        const LaneMask was = before[j][i] < Lanes(task_.level), is = x_[j][i] < Lanes(task_.level);
        passed = passed & ((was & !is) | (is & !was));
      }
      if (!any(passed)) continue;
      for (std::size_t lane = 0; lane < lane_count; ++lane) {
        if (!passed.on[lane]) continue;
        Passage& passage = passages_.emplace_back(member(j, lane), before[j].t, x_[j].t);
        for (std::size_t k = 0; k < X::size; ++k) {
          passage.before[k] = before[j][k].v[lane];
          passage.after[k] = x_[j][k].v[lane];
        }
      }
    }
  }
  void tell() {
    for (const Passage& p : passages_) task_.host->at_step(p.member, p.from, p.before, p.to, p.after);
    passages_.clear();
  }

  double grid_time(std::int64_t n) const { return task_.start_time + static_cast<double>(n) * task_.step; }

  void step_one_by_one(std::int64_t until) {
    for (; n_ < until && anyone(); ++n_) step_alone(task_.step, grid_time(n_ + 1));
  }
  /// Steps up to the one with this number, in all of which passages of a level are noted.
  void advance(std::int64_t until, Seen& seen) {
    if (!task_.watches) return steps_->advance(x_, task_.start_time, task_.step, n_, until - n_, task_.step, seen);
    for (std::int64_t n = n_; n < until; ++n) {
      const Group<X> before = x_;
      steps_->advance(x_, task_.start_time, task_.step, n, 1, task_.step, seen);
      watch(before);
    }
  }
  /// The time of the next state on the way; what is asked for before it is told from the one before.
  double upcoming() const { return n_ < task_.steps ? grid_time(n_ + 1) : task_.end; }

  /// The states at the time t, by a shorter step of which the run itself knows nothing.
  void say(double t) {
    const Group<X> here = x_;
    const double part = t - x_[0].t;
    if (part > 0) {
      steps_->keep();
      Seen seen;
      steps_->advance(x_, task_.start_time, task_.step, n_, 1, part, seen);
      steps_->take_back();
    }
    each_alive([&](std::size_t j, std::size_t lane) {
      const Narrow y = in_lane(x_[j], lane);
      std::array<double, X::size> values;
      for (std::size_t i = 0; i < X::size; ++i) values[i] = y[i];
      task_.host->at_time(member(j, lane), t, values.data());
    });
    x_ = here;
  }

  LaneTask& task_;
  Group<P> problems_;
  std::unique_ptr<GroupSteps<P, X>> steps_;
  std::array<std::size_t, group_size> members_{};  ///< of each lane
  Group<X> x_;
  Group<LaneMask> alive_;
  Group<Lanes> limit_{};  ///< of ω²
  std::vector<Passage> passages_;
  std::int64_t n_ = 0;                 ///< steps so far
  std::size_t next_ = 0;               ///< of the times asked for
  std::int64_t taken_ = 0, made_ = 0;  ///< steps of members, of the group
  std::int64_t started_ = 0, forces_at_start_ = 0;
};

}  // namespace least
