// Members in lanes, eight packs of them in flight. What can go wrong is looked for every so many steps, and steps in
// which something did are taken back and taken again one by one, as of a lone run. A member that ended stays where it
// is, while the others of its group go on. Only units of lanes include this header.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include "core/ensemble/lane_steps.hpp"
#include "core/parameters.hpp"

namespace least {

/// The group of a task that begins with its member `first`. Lanes beyond the last member do what that does.
template <class P, class X>
class GroupRun {
 public:
  GroupRun(LaneTask& task, const Group<P>& problems, std::size_t first)
      : task_(task), problems_(problems), first_(first), lanes_(std::min(group_size, task.count - first)) {
    for (std::size_t j = 0; j < packs; ++j) {
      x_[j].t = task.start_time;
      for (std::size_t lane = 0; lane < lane_count; ++lane) {
        const std::size_t at = j * lane_count + lane;
        const bool begins = at < lanes_ && task.ended[first + at] == static_cast<std::uint8_t>(cancelled);
        alive_[j].on[static_cast<int>(lane)] = begins ? -1 : 0;
        for (std::size_t i = 0; i < X::size; ++i)
          x_[j][i].v[static_cast<int>(lane)] = task.start[i * task.count + first + std::min(at, lanes_ - 1)];
      }
    }
  }

  /// bind(problems, states) → GroupSteps from there
  template <class Bind>
  void run(Bind&& bind) {
    check_start();
    auto steps = bind(problems_, x_);
    move(steps);
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

  bool anyone() const {
    return std::ranges::any_of(alive_, [](const LaneMask& m) { return any(m); });
  }
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
  std::size_t member(std::size_t j, std::size_t lane) const { return first_ + j * lane_count + lane; }
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
  void step_alone(GroupSteps<P, X>& steps, std::int64_t n, double h, double t) {
    const Group<X> before = x_;
    Seen seen;
    steps.advance(x_, task_.start_time, task_.step, n, 1, h, seen);
    for (std::size_t j = 0; j < packs; ++j) {
      x_[j].t = t;
      faults(j, seen, [&](const LaneMask& which, ReturnCode why) { end(j, which, why); });
      for (std::size_t i = 0; i < X::size; ++i) x_[j][i] = select(alive_[j], x_[j][i], before[j][i]);
    }
    each_alive([&](std::size_t, std::size_t) { ++task_.taken; });
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

  void move(GroupSteps<P, X>& steps) {
    const std::int64_t bound = steps.work().forces, taken = task_.taken;
    std::int64_t n = 0;
    std::size_t next = 0;  // of the times asked for
    while (anyone()) {
      for (; next < task_.times.size() && task_.times[next] < upcoming(n); ++next) {
        if (task_.cancelled->load(std::memory_order_relaxed)) return end_all(cancelled);
        say(steps, n, task_.times[next]);
      }
      if (n >= task_.steps) break;
      if (n >= task_.step_limit) return end_all(step_limit);
      if (task_.cancelled->load(std::memory_order_relaxed)) return end_all(cancelled);
      std::int64_t until = std::min({task_.steps, task_.step_limit, n + block});
      if (next < task_.times.size())  // to the last step at or before it
        while (until > n + 1 && grid_time(until) > task_.times[next]) --until;
      if (task_.watches && task_.watched < 0) {
        for (; n < until && anyone(); ++n) step_alone(steps, n, task_.step, grid_time(n + 1));
        continue;
      }
      const Group<X> before = x_;
      steps.keep();
      Seen seen;
      advance(steps, n, until, seen);
      if (faultless(seen)) {
        tell();
        each_alive([&](std::size_t, std::size_t) { task_.taken += until - n; });
        n = until;
        continue;
      }
      x_ = before;
      steps.take_back();
      passages_.clear();
      for (; n < until && anyone(); ++n) step_alone(steps, n, task_.step, grid_time(n + 1));
    }
    finish(steps, n, next);
    const std::int64_t all = steps.work().forces;
    const std::int64_t made = n + (task_.tail > 0 ? 1 : 0);
    if (made > 0) task_.forces += (task_.taken - taken) * std::max<std::int64_t>((all - bound) / made, 1);
    task_.forces += bound * static_cast<std::int64_t>(lanes_);
  }
  /// Steps up to the n-th, in all of which passages of a level are noted.
  void advance(GroupSteps<P, X>& steps, std::int64_t n, std::int64_t until, Seen& seen) {
    if (!task_.watches) return steps.advance(x_, task_.start_time, task_.step, n, until - n, task_.step, seen);
    for (; n < until; ++n) {
      const Group<X> before = x_;
      steps.advance(x_, task_.start_time, task_.step, n, 1, task_.step, seen);
      watch(before);
    }
  }
  /// The time of the next state on the way; what is asked for before it is told from the one before.
  double upcoming(std::int64_t n) const { return n < task_.steps ? grid_time(n + 1) : task_.end; }

  void finish(GroupSteps<P, X>& steps, std::int64_t n, std::size_t next) {
    if (task_.tail > 0 && anyone()) {
      if (n >= task_.step_limit) return end_all(step_limit);
      step_alone(steps, n, task_.tail, task_.end);
    }
    for (X& x : x_) x.t = task_.end;
    for (; next < task_.times.size() && !task_.cancelled->load(std::memory_order_relaxed); ++next)
      say(steps, n, task_.end);
    each_alive([&](std::size_t j, std::size_t lane) {
      task_.ended[member(j, lane)] = static_cast<std::uint8_t>(completed);
      for (std::size_t i = 0; i < X::size; ++i) task_.final[i * task_.count + member(j, lane)] = x_[j][i].v[lane];
    });
  }

  /// The states at the time t, by a shorter step from the n-th, of which the run itself knows nothing.
  void say(GroupSteps<P, X>& steps, std::int64_t n, double t) {
    const Group<X> here = x_;
    const double part = t - x_[0].t;
    if (part > 0) {
      steps.keep();
      Seen seen;
      steps.advance(x_, task_.start_time, task_.step, n, 1, part, seen);
      steps.take_back();
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
  std::size_t first_, lanes_;
  Group<X> x_;
  Group<LaneMask> alive_;
  Group<Lanes> limit_{};  ///< of ω²
  std::vector<Passage> passages_;
};

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

template <template <class> class P, class R, class X, class Scheme>
bool run_groups(LaneTask& task, const Scheme& scheme) {
  if constexpr (requires { typename StepperOf<Scheme, P<R>, X>; }) {
    for (std::size_t first = 0; first < task.count; first += group_size)
      GroupRun<P<R>, X>(task, problems_of<P, R>(task, first), first).run([&](const auto& problems, const auto& x) {
        return BoundGroup<P<R>, X, Scheme>(scheme, problems, x);
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
