// Steps of equal length: t = t₀ + n·h, the last one shorter. What can go wrong inside a block is looked for at its end,
// and a block that went wrong is taken back and run again step by step, so that the last good state is exact and a good
// step pays nothing.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/phases.hpp"
#include "core/run/discrete_energy.hpp"
#include "core/run/integrator.hpp"
#include "core/run/save_schedule.hpp"

namespace least {

/// What surrounds the steps of a scheme, compiled once for a problem and not once for each of its pairs.
template <class P, class X>
class EqualSteps : public BoundIntegrator<P, X> {
 public:
  BlockResult advance(IntegrationState<X>& state, StepTarget target, StepGuard& guard,
                      DiagnosticSet<P, X>* diagnostics) final {
    std::int64_t count = std::min(target.n, grid_.step_before(target.t)) - state.n;
    if (count <= 0) return {};
    if (on_series(state.n)) return advance_on_series(state, count, diagnostics);
    if (diagnostics && diagnostics->watches()) count = std::min(count, watched_);
    if (keeps_last_step_) {  // where the last one begins is to be known
      if (count > 1)
        if (const BlockResult result = take_steps(state, count - 1, guard, diagnostics);
            !result || (diagnostics && diagnostics->crossed))
          return result;
      left_ = state.x;
      count = 1;
    }
    return take_steps(state, count, guard, diagnostics);
  }

  BlockResult finish(IntegrationState<X>& state, double end, StepGuard& guard) final {
    if (!(state.x.t < end)) return {};
    const State last = state;
    left_ = last.x;
    keep_stepper();
    BlockResult result;
    result.status = covered_by_series(state.n, end) ? from_series(state.x, end) : last_step(state.x, grid_.tail);
    state.x.t = end;
    ++state.n;
    if constexpr (Sloped<X>) normalise(state.x);
    if (result.status != StepStatus::ok) result.end = BlockEnd::step_failed;
    if (result && !is_finite_state(state.x)) result.end = BlockEnd::not_finite;
    if (result && this->left_domain(state.x)) result.end = BlockEnd::left_domain;
    if (!result) {
      const Work tried = work();
      state = last;
      take_stepper_back();
      count_tried(tried);
    } else if constexpr (HasFrequency<P>) {
      guard.see(problem_.frequency_squared(position(state.x)) * grid_.step * grid_.step);
    }
    return result;
  }

  void step_back(IntegrationState<X>& state) final {
    if (!(left_.t < state.x.t)) return;
    const Work tried = work();
    state = {left_, state.n - 1};
    take_stepper_back();
    count_tried(tried);
  }
  const X& left() const final { return left_; }
  bool reaches(const IntegrationState<X>& state, double t) const final { return grid_.step_before(t) <= state.n; }
  /// By the step's own map over a shorter step, which is as accurate as the scheme.
  StepStatus state_at(const IntegrationState<X>& state, double t, X& x) const final {
    const bool ahead = !(t < state.x.t);
    if (ahead ? covered_by_series(state.n, t) : along_series_ && state.n <= series_steps_) return from_series(x, t);
    x = ahead ? state.x : left_;
    const double part = t - x.t;
    const StepStatus status = part > 0 ? trial_step(ahead ? Stands::here : Stands::left, x, part) : StepStatus::ok;
    x.t = t;
    return status;
  }

  bool starts_regularly(const X& x) final {
    if constexpr (HasSeries<P>) {
      if (starts_at_singularity()) return x.t == 0 && dot(x.p, x.p) == 0;
      along_series_ = starts_series(problem_, x);
      if (along_series_)
        series_steps_ = std::max<std::int64_t>(whole_steps(grid_.start, P::series_until, grid_.step), 1);
    }
    return along_series_;
  }
  BlockResult check_start(const X& x, StepGuard& guard) const final {
    if constexpr (QuadraticContact<P>)
      if (pole_ratio(x) > 2 && grid_.steps > 0) return BlockResult::failed(StepStatus::singular);
    if constexpr (HasFrequency<P>) {
      guard.see(problem_.frequency_squared(position(x)) * grid_.step * grid_.step);
      if (grid_.steps > 0 && guard.exceeded()) return {BlockEnd::too_fast};
    }
    return {};
  }

  StepInfo step_info(const IntegrationState<X>&) const final { return {grid_.step}; }
  void keep_last_step() final { keeps_last_step_ = true; }
  double discrete_energy(const IntegrationState<X>& state) const final {
    if (state.n == 0 || (along_series_ && state.n <= series_steps_)) return unknown;
    return energy_of_step(left_, state.n > grid_.steps ? grid_.tail : grid_.step);
  }
  /// Looked at over the span, not at each step. The first that turns the momentum over, else the first that is stiff.
  /// Of what repeats one period is enough.
  std::optional<StrongDamping> strong_damping([[maybe_unused]] std::int64_t n) const final {
    std::optional<StrongDamping> found;
    if constexpr (LinearContact<P>) {
      const auto [flips, stiff] = damping_limits();
      if (flips == never && stiff == never) return found;
      constexpr std::int64_t most = 1000;
      n = std::min(n, grid_.steps);
      if constexpr (Periodic<P>)
        if (const double steps = std::ceil(problem_.period() / grid_.step); steps > 0 && steps < double(n))
          n = static_cast<std::int64_t>(steps) + 1;
      const std::int64_t looks = std::min(n, most);
      for (std::int64_t k = 1; k <= looks && !(found && found->flips); ++k) {
        const auto step =
            static_cast<std::int64_t>(static_cast<double>(n) * static_cast<double>(k) / static_cast<double>(looks));
        const double t = grid_.time(std::max<std::int64_t>(step, 2));  // the first may begin where damping is singular
        const double strength = damping(problem_, phase(problem_, t)) * grid_.step;
        const bool over = strength >= flips;
        if (over || (strength > stiff && !found)) found = {t, strength, over ? flips : stiff, over};
      }
    }
    return found;
  }
  Work work() const final {
    const Work here = stepper_work();
    return {before_.forces + here.forces, before_.iterations + here.iterations};
  }

 protected:
  using BoundIntegrator<P, X>::is_finite_state, BoundIntegrator<P, X>::problem_;
  using State = IntegrationState<X>;
  static constexpr double never = std::numeric_limits<double>::infinity();
  struct DampingLimits {
    double flips = never, stiff = never;
  };
  /// Where a stepper stands: at the state, or at left_.
  enum class Stands : std::uint8_t { here, left };

  EqualSteps(const P& problem, const X& x, const Grid& grid) : BoundIntegrator<P, X>(problem), grid_(grid), left_(x) {}

  /// `count` steps of the grid; what went wrong, at any of them.
  virtual BlockResult block(State& state, std::int64_t count, StepGuard& guard, DiagnosticSet<P, X>* diagnostics) = 0;
  /// One of another length: by the stepper itself, or by a copy of it.
  virtual StepStatus last_step(X& x, double h) = 0;
  virtual StepStatus trial_step(Stands stands, X& x, double h) const = 0;
  /// The same by a stepper bound at x.
  virtual StepStatus bound_step(X& x, double h) const = 0;
  virtual void bind_stepper(const X& x) = 0;
  /// For left_; and back.
  virtual void keep_stepper() = 0;
  virtual void take_stepper_back() = 0;
  virtual Work stepper_work() const = 0;
  // What the scheme says of itself.
  virtual bool starts_at_singularity() const = 0;
  virtual double energy_of_step(const X& from, double h) const = 0;
  virtual DampingLimits damping_limits() const = 0;

  Grid grid_;

 private:
  /// −γ s h, where H has γs²/2: from 2 on a step reaches the pole of ṡ = −γs²/2.
  double pole_ratio(const X& x) const requires QuadraticContact<P> {
    return -problem_.action_curvature() * x.action.s * grid_.step;
  }

  BlockResult take_steps(State& state, std::int64_t count, StepGuard& guard, DiagnosticSet<P, X>* diagnostics) {
    const Kept before = keep(state, guard, diagnostics);
    const bool many = diagnostics && count > 1;
    if (many) diagnostics->begin_block();
    const BlockResult result = block(state, count, guard, diagnostics);
    if (many) diagnostics->end_block();
    if (result && !(diagnostics && diagnostics->crossed)) {
      watched_ = std::min<std::int64_t>(2 * watched_, 256);
      return result;
    }
    const std::int64_t first = before.state.n;
    if (result && count == 1) {
      left_ = before.state.x;
      watched_ = 1;
      return result;
    }
    take_back(before, state, guard, diagnostics);
    const BlockResult again = replay(state, count, guard, diagnostics);
    watched_ = std::clamp<std::int64_t>(state.n - first, 1, 8);
    return again;
  }
  /// The same steps one by one, up to the first in which something happened.
  BlockResult replay(State& state, std::int64_t count, StepGuard& guard, DiagnosticSet<P, X>* diagnostics) {
    for (; count > 0; --count) {
      const Kept before = keep(state, guard, diagnostics);
      left_ = state.x;
      const BlockResult result = block(state, 1, guard, diagnostics);
      if (result && !(diagnostics && diagnostics->crossed)) continue;
      if (!result) {
        const StepGuard seen = guard;  // also of the step that went wrong
        const Work tried = work();
        take_back(before, state, guard, diagnostics);
        guard = seen;
        count_tried(tried);
      }
      return result;
    }
    return {};
  }

  /// What a block changes.
  struct Kept {
    State state;
    StepGuard guard;
    std::optional<DiagnosticSet<P, X>> diagnostics;
  };
  Kept keep(const State& state, const StepGuard& guard, const DiagnosticSet<P, X>* diagnostics) {
    keep_stepper();
    return {state, guard, diagnostics ? std::optional(*diagnostics) : std::nullopt};
  }
  void take_back(const Kept& before, State& state, StepGuard& guard, DiagnosticSet<P, X>* diagnostics) {
    take_stepper_back();
    state = before.state;
    guard = before.guard;
    if (diagnostics) *diagnostics = *before.diagnostics;
  }

  /// A step that was taken back has cost what it cost.
  void count_tried(const Work& tried) {
    const Work here = stepper_work();
    before_ = {tried.forces - here.forces, tried.iterations - here.iterations};
  }

  // The regular solution from a time at which the equations of motion are singular stands in for the steps as far as
  // its series reaches; of a first step that reaches further, the rest is the scheme's.
  static constexpr double series_reach() {
    if constexpr (HasSeries<P>) return P::series_until;
    return 0;
  }
  bool on_series(std::int64_t n) const { return along_series_ && n < std::min(series_steps_, grid_.steps); }
  bool covered_by_series(std::int64_t n, double t) const { return along_series_ && (n == 0 || t <= series_reach()); }
  StepStatus from_series([[maybe_unused]] X& x, [[maybe_unused]] double t) const {
    if constexpr (HasSeries<P>) {
      const double until = std::min(t, series_reach());
      x = series_state<X>(problem_, until);
      if (t > until)
        if (const StepStatus status = bound_step(x, t - until); status != StepStatus::ok) return status;
      x.t = t;
    }
    return StepStatus::ok;
  }
  BlockResult advance_on_series(State& state, std::int64_t count, DiagnosticSet<P, X>* diagnostics) {
    for (; count > 0 && on_series(state.n); --count) {
      X x = state.x;
      const bool last = state.n + 1 == grid_.steps && grid_.tail == 0;
      if (const StepStatus status = from_series(x, last ? grid_.end : grid_.time(state.n + 1));
          status != StepStatus::ok)
        return BlockResult::failed(status);
      if (!is_finite_state(x)) return {BlockEnd::not_finite};
      left_ = state.x;
      state = {x, state.n + 1};
      if (diagnostics) diagnostics->see(problem_, x);
      if (diagnostics && diagnostics->crossed) break;
    }
    if (!on_series(state.n)) {
      before_ = work();
      bind_stepper(state.x);
    }
    return {};
  }

  X left_;
  std::int64_t watched_ = 8;  ///< the length of blocks of which something is watched: much of one may be made again
  bool along_series_ = false, keeps_last_step_ = false;
  std::int64_t series_steps_ = 0;
  Work before_;  ///< of steppers that were put aside
};

template <class P, class Scheme, class X>
class FixedStepIntegrator final : public EqualSteps<P, X> {
  using Base = EqualSteps<P, X>;
  using Base::is_finite_state, Base::problem_, Base::grid_;
  using typename Base::State, typename Base::Stands, typename Base::DampingLimits;

 public:
  FixedStepIntegrator(const P& problem, const Scheme& scheme, const X& x, const Grid& grid)
      : Base(problem, x, grid), scheme_(scheme), stepper_(scheme.bind(problem, x)), left_stepper_(stepper_) {}

  std::string unsupported_reason() const override {
    if constexpr (requires { scheme_.unsupported_reason(problem_); }) return scheme_.unsupported_reason(problem_);
    return {};
  }

 private:
  using Stepper = StepperOf<Scheme, P, X>;

  BlockResult block(State& state, std::int64_t count, StepGuard& guard, DiagnosticSet<P, X>* diagnostics) override {
    return diagnostics ? loop<true>(state, count, guard, diagnostics) : loop<false>(state, count, guard, nullptr);
  }
  /// In line with what surrounds it, a step passes through memory: 6.7 instead of 4.8 ns for a harmonic oscillator.
  template <bool Observed>
  [[gnu::noinline]] BlockResult loop(State& state, std::int64_t count, StepGuard& guard,
                                     DiagnosticSet<P, X>* diagnostics) noexcept {
    const Grid grid = grid_;
    auto stepper = stepper_;
    auto x = state.x;
    [[maybe_unused]] double frequency = 0;  // the largest, squared
    [[maybe_unused]] bool left = false;
    [[maybe_unused]] double lowest = 0;  // action
    StepStatus status = StepStatus::ok;
    std::int64_t n = state.n;
    const std::int64_t end = n + count;
    while (n < end) {
      status = stepper.step(x, grid.step);
      if (status != StepStatus::ok) break;
      x.t = grid.time(++n);
      if constexpr (HasFrequency<P>) {
        const double here = problem_.frequency_squared(position(x));
        frequency = here > frequency ? here : frequency;
      }
      if constexpr (QuadraticContact<P>) lowest = x.action.s < lowest ? x.action.s : lowest;
      if constexpr (HasDomain<P>) left = left || !(problem_.inside(position(x)) >= 0);
      if constexpr (Sloped<X>) normalise(x);
      if constexpr (Observed) diagnostics->see(problem_, x);
    }
    if (n == grid_.steps && grid_.tail == 0) x.t = grid_.end;
    stepper_ = stepper;
    state = {x, n};
    if constexpr (HasFrequency<P>) guard.see(frequency * grid_.step * grid_.step);
    if (status != StepStatus::ok) return BlockResult::failed(status);
    if constexpr (QuadraticContact<P>)
      if (-problem_.action_curvature() * lowest * grid_.step > 2) return BlockResult::failed(StepStatus::singular);
    const bool finite = is_finite_state(x);
    if constexpr (HasDomain<P>)
      if (left && finite && problem_.bounded()) return {BlockEnd::left_domain};
    if (!finite) return {BlockEnd::not_finite};
    return guard.exceeded() ? BlockResult{BlockEnd::too_fast} : BlockResult{};
  }

  StepStatus last_step(X& x, double h) override { return stepper_.step(x, h); }
  StepStatus trial_step(Stands stands, X& x, double h) const override {
    auto stepper = stands == Stands::here ? stepper_ : left_stepper_;
    return stepper.step(x, h);
  }
  StepStatus bound_step(X& x, double h) const override { return scheme_.bind(problem_, x).step(x, h); }
  void bind_stepper(const X& x) override { stepper_ = scheme_.bind(problem_, x); }
  void keep_stepper() override { left_stepper_ = stepper_; }
  void take_stepper_back() override { stepper_ = left_stepper_; }
  Work stepper_work() const override { return stepper_.work(); }
  bool starts_at_singularity() const override {
    if constexpr (requires { scheme_.starts_at_singularity(problem_); }) return scheme_.starts_at_singularity(problem_);
    return false;
  }
  double energy_of_step(const X& from, double h) const override {
    return least::discrete_energy(scheme_, problem_, from, h);
  }
  DampingLimits damping_limits() const override {
    DampingLimits limits;
    if constexpr (requires { scheme_.flips_from(); }) limits.flips = scheme_.flips_from();
    if constexpr (requires { scheme_.stiff_from(problem_); }) limits.stiff = scheme_.stiff_from(problem_);
    return limits;
  }

  Scheme scheme_;
  Stepper stepper_, left_stepper_;  ///< at the state, and where the last block, or step, began
};

}  // namespace least
