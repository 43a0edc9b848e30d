// Schemes that set their own clock: a step determines its length, and states in between come from the dense output of
// the step in which they lie. The end is overshot, unless the scheme accepts a largest length of a step (step_within):
// then the last step ends there. Each step is checked by itself: steps are few and expensive.
#pragma once

#include <functional>
#include <limits>
#include <optional>

#include "core/run/hermite.hpp"
#include "core/run/integrator.hpp"
#include "core/run/messages.hpp"
#include "core/run/standstill.hpp"

namespace least {

template <class P, class Scheme, class X>
class SelfTimedIntegrator final : public Integrator {
  using State = IntegrationState;

 public:
  /// `end` of the run: diagnostics see no state beyond it.
  SelfTimedIntegrator(const RunBackend& backend, const P& problem, const Scheme& scheme, const X& x, double end)
      : backend_(backend),
        problem_(problem),
        scheme_(scheme),
        energy_(energy_level(scheme, problem, x)),
        stepper_(scheme.bind(problem, x, energy_)),
        left_(x),
        end_(end),
        standstill_(x.t, std::isfinite(end) ? end - x.t : 0) {}

  BlockResult advance(State& state, StepTarget target, StepGuard& guard, DiagnosticSet* diagnostics) override {
    if (along_series_ && state.n == 0 && advance_on_series(state, diagnostics)) return {};
    // A stepper that is cheap to copy is copied, so that it may stay in registers meanwhile.
    using Working = std::conditional_t<std::is_trivially_copyable_v<Stepper>, Stepper, Stepper&>;
    Working stepper = stepper_;
    X x = state_from<X>(state.x), left = left_;
    auto memory = memory_, left_memory = left_memory_;
    double late = late_;
    BlockResult result;
    std::int64_t n = state.n;
    const ActiveMethod method = method_of(stepper);
    [[maybe_unused]] double last_frequency = 0;
    if constexpr (hybrid && HasFrequency<P>) last_frequency = problem_.frequency_squared(x.q);
    while (n < target.n && x.t < target.t) {
      X y = x;
      if (compensated && !told_time) y.t = 0;
      const double most = end_ - x.t + late;
      result = step(stepper, y, most, late);
      if (!result) break;
      const double h = duration(stepper, x, y), part = h - late;
      const double t = within && h == most ? end_ : compensated ? x.t + part : y.t;
      result = judge(y, h, t);
      if constexpr (hybrid && HasFrequency<P>) {  // for steps in time: the motion may be too fast at either end
        const double frequency = problem_.frequency_squared(y.q);
        const bool in_time = stepper.active_method().mode == Mode::hamilton || stepper.active_method().parameter < 0;
        if (result && in_time) guard.see((frequency > last_frequency ? frequency : last_frequency) * h * h);
        last_frequency = frequency;
        if (result && guard.exceeded()) result = {BlockEnd::too_fast};
      }
      if (!result) break;
      if (compensated) late = (t - x.t) - part;
      if constexpr (hybrid) before_left_ = left;
      left = x;
      left_memory = memory;
      memory = memory_of(stepper);
      x = y;
      x.t = t;
      normalise_slope(x);
      ++n;
      if constexpr (reads_time || told_time)
        if (standstill_.see(left.t, h) && !still_moves(x, h)) {
          result = {BlockEnd::stands_still};
          break;
        }
      if (diagnostics && x.t <= end_) {
        if constexpr (step_parts > 1)
          if (diagnostics->looks_within()) look_within(stepper, left, x, *diagnostics);
        see(stepper, left, x, *diagnostics);
      }
      if (method_of(stepper) != method || (diagnostics && diagnostics->crossed())) break;
    }
    if constexpr (!std::is_reference_v<Working>) stepper_ = stepper;
    left_ = left;
    memory_ = memory;
    left_memory_ = left_memory;
    late_ = late;
    assign_numbers(x, state.x);
    state.n = n;
    return result;
  }

  BlockResult finish(State& state, double end, StepGuard&) override {
    if (!(state.x.t > end)) return {};
    X x;
    const StepStatus status = interpolate(state, end, x, &between_);
    if (status != StepStatus::ok) return BlockResult::failed(status);
    if (outside(x)) return {BlockEnd::left_domain};
    assign_numbers(x, state.x);
    return {};
  }

  RunState left() const override { return run_state(left_); }
  int parts() const override { return step_parts; }
  StepStatus state_at(const State& state, double t, RunState& to) const override {
    X x = state_from<X>(state.x);
    StepStatus status = StepStatus::solver_failed;
    if (t <= x.t) {
      status = interpolate(state, t, x, nullptr);
    } else if constexpr (requires(Stepper s) { s.reach(x, t); }) {
      status = stepper_at(x, memory_).reach(x, t);
    } else {
      return status;
    }
    assign_numbers(x, to);
    return status;
  }
  void step_back(State& state) override { state = {run_state(left_), state.n - 1}; }

  bool starts_regularly(StateView x) override { return along_series_ = table_.starts_series(x); }
  std::string unsupported_reason() const override {
    if constexpr (requires { scheme_.unsupported_reason(problem_, energy_); })
      return scheme_.unsupported_reason(problem_, energy_);
    return {};
  }

  StepInfo step_info(const State& state) const override {
    StepInfo info;
    if (state.n > 0) info.step_size = state.x.t - left_.t;
    if constexpr (hybrid) {
      const ActiveMethod course = stepper_.active_method();
      info.mode = static_cast<double>(course.mode);
      if (course.parameter >= 0) info.parameter = course.parameter;
    }
    return info;
  }
  double discrete_energy(const State& state) const override {
    if (state.n > 0) {
      const X x = state_from<X>(state.x);
      if constexpr (hybrid) return stepper_.discrete_energy(left_, x, stepper_.active_method());
      if constexpr (requires { stepper_.discrete_energy(left_, left_); }) return stepper_.discrete_energy(left_, x);
    }
    return unknown;
  }
  double discrete_energy_jump([[maybe_unused]] const State& state,
                              [[maybe_unused]] const ActiveMethod& was) const override {
    if constexpr (hybrid)
      if (state.n > 1) return discrete_energy(state) - stepper_.discrete_energy(before_left_, left_, was);
    return unknown;
  }
  std::optional<ActiveMethod> method() const override {
    if constexpr (hybrid) return stepper_.active_method();
    return std::nullopt;
  }
  std::int64_t fallback_steps() const override {
    if constexpr (requires { stepper_.fallback_steps(); }) return stepper_.fallback_steps();
    return 0;
  }
  std::string accuracy_warning() const override {
    constexpr double most = 0.5;
    if constexpr (requires { stepper_.strain(); })
      if (stepper_.strain() > most) return messages::strain(stepper_.strain());
    return {};
  }
  double blur() const override {
    if constexpr (requires { stepper_.blur(); }) return stepper_.blur();
    return 0;
  }
  std::string failure() const override {
    if constexpr (requires { stepper_.failure(); }) return stepper_.failure();
    return {};
  }
  Work work() const override {
    const Work here = stepper_.work();
    return {here.forces + between_.forces, here.iterations + between_.iterations};
  }

 private:
  using Stepper = SelfTimedStepperOf<Scheme, P, X>;
  static constexpr bool hybrid = requires(const Stepper& s) { s.active_method(); };
  static constexpr bool reads_time = requires { requires Scheme::reads_time; };
  static constexpr int step_parts = [] {
    if constexpr (requires { Stepper::parts; }) return Stepper::parts;
    return 1;
  }();
  /// Whether a step accepts a largest length.
  static constexpr bool within = requires(Stepper & s, X& x, double most) { s.step_within(x, most); };

  /// The scheme returns the length of each step: the sum of the lengths is compensated for rounding (late_).
  static constexpr bool compensated = !reads_time;
  /// Its steps read the time at which they begin.
  static constexpr bool told_time = requires { requires Stepper::reads_time; };

  struct Nothing {};

  static ActiveMethod method_of(const Stepper& stepper) {
    if constexpr (hybrid) return stepper.active_method();
    return {};
  }
  struct NoMemory {};
  /// memory_of returns what a stepper remembers between steps beside the state.
  static auto memory_of([[maybe_unused]] const Stepper& stepper) {
    if constexpr (requires { stepper.memory(); }) {
      return stepper.memory();
    } else {
      return NoMemory{};
    }
  }
  using Memory = decltype(memory_of(std::declval<const Stepper&>()));
  /// bound returns a stepper at x. A stepper that depends only on the problem need not be bound again.
  Stepper bound(const X& x) const {
    if constexpr (requires { stepper_.anew(); }) {
      return stepper_.anew();
    } else {
      return scheme_.bind(problem_, x, energy_);
    }
  }
  /// stepper_at returns a stepper that continues from x.
  Stepper stepper_at(const X& x, [[maybe_unused]] const Memory& memory) const {
    Stepper stepper = bound(x);
    if constexpr (requires { stepper.resume(x, memory); }) stepper.resume(x, memory);
    return stepper;
  }
  static double duration([[maybe_unused]] const Stepper& stepper, const X& x, const X& y) {
    if constexpr (compensated && told_time) {
      return stepper.elapsed();
    } else {
      return compensated ? y.t : y.t - x.t;
    }
  }

  static BlockResult step(Stepper& stepper, X& y, [[maybe_unused]] double most, [[maybe_unused]] double late) {
    StepStatus status;
    if constexpr (requires { stepper.step_within(y, most, late); }) {
      status = stepper.step_within(y, most, late);
    } else if constexpr (within) {
      status = stepper.step_within(y, most);
    } else {
      status = stepper.step(y);
    }
    return status == StepStatus::ok ? BlockResult{} : BlockResult::failed(status);
  }
  /// judge checks a step of length h that ended in y at the time t.
  BlockResult judge(const X& y, double h, double t) const {
    constexpr double largest_square = largest_component * largest_component;
    double size = 0;
    for (std::size_t i = 0; i < table_.traits.moving; ++i) size += value_of(y[i]) * value_of(y[i]);
    if (!(size < largest_square) || !(h > 0) || !std::isfinite(t)) return {BlockEnd::not_finite};
    return outside(y) ? BlockResult{BlockEnd::left_domain} : BlockResult{};
  }
  bool outside(const X& x) const {
    if constexpr (std::is_same_v<X, RunState>) return table_.outside(x);
    if constexpr (!std::is_same_v<X, RunState>) return least::outside(problem_, x);
  }
  /// Rescales the tangent direction that a state carries; only its direction has a meaning.
  void normalise_slope(X& x) const {
    if constexpr (Sloped<X>) normalise(x);
    if constexpr (std::is_same_v<X, RunState>)
      if (table_.traits.sloped) normalise_slopes(x.numbers.data() + table_.traits.components, table_.traits.components);
  }

  /// still_moves returns whether the motion goes on from x at all, where steps of length h no longer advance the run.
  bool still_moves(const X& x, double h) {
    constexpr double few = 64;  // steps
    if (!goes_on(backend_, moving_part(backend_, run_state(x)), few * h)) return false;
    standstill_.go_on();
    return true;
  }

  /// look_within shows the diagnostics states within the last step, if the scheme has dense output.
  void look_within(const Stepper& stepper, const X& left, const X& x, DiagnosticSet& diagnostics) const {
    X state = x;
    for (int i = 1; i < step_parts; ++i) {
      if (!stepper.interpolate(state, left.t + i * (x.t - left.t) / step_parts)) return;
      diagnostics.look(run_state(state));
    }
  }
  /// see shows the diagnostics the state x, and lets them search the step for zeros: by the scheme's dense output, or
  /// by the Hermite polynomial between both ends.
  void see(const Stepper& stepper, const X& left, const X& x, DiagnosticSet& diagnostics) const {
    const RunState from = run_state(left), to = run_state(x);
    std::optional<HermitePath> path;
    const auto between = [&](double t, RunState& state) {
      if constexpr (requires(X & y) { stepper.interpolate(y, t); }) {
        X y = x;
        if (stepper.interpolate(y, t)) {
          assign_numbers(y, state);
          return true;
        }
      }
      if (!path) path.emplace(table_, from, to);
      state = (*path)(t);
      return true;
    };
    diagnostics.see(from, to, std::max(step_parts / 4, 2), std::ref(between));
  }

  /// interpolate sets x to the state at t within the last step, which ended in `state`. `work` receives the cost, may
  /// be null.
  StepStatus interpolate([[maybe_unused]] const State& state, double t, X& x, Work* work) const {
    x = state_from<X>(state.x);
    if (!(t < x.t)) return StepStatus::ok;
    if (along_series_ && state.n == 1) {
      x = t > left_.t ? state_from<X>(table_.series_state(t)) : left_;
      return StepStatus::ok;
    }
    if constexpr (requires(const Stepper& s) { s.interpolate(x, t); })
      if (stepper_.interpolate(x, t)) return StepStatus::ok;
    if constexpr (requires(Stepper s) { s.reach(x, t); }) {
      auto stepper = stepper_at(left_, left_memory_);
      X y = left_;
      const bool from_zero = compensated && !told_time;
      if (from_zero) y.t = 0;
      if (const StepStatus status = stepper.reach(y, from_zero ? t - left_.t : t); status != StepStatus::ok)
        return status;
      x = y;
      if (work) *work = stepper.work();
    } else {
      x = state_from<X>(HermitePath(table_, run_state(left_), state.x)(t));
      if (work) *work = {4, 0};
    }
    x.t = t;
    return StepStatus::ok;
  }

  /// advance_on_series takes the first step from a time at which the equations of motion are singular: along the
  /// regular solution, as far as its series or the run goes. False if that is no further than the start.
  bool advance_on_series(State& state, DiagnosticSet* diagnostics) {
    const RunState x = table_.series_state(std::min(table_.traits.series_until, end_));
    if (!(x.t > state.x.t)) return along_series_ = false;
    left_ = state_from<X>(state.x);
    stepper_ = bound(state_from<X>(x));
    memory_ = memory_of(stepper_);
    state = {x, 1};
    if (diagnostics) diagnostics->see(x);
    return true;
  }

  const RunBackend& backend_;
  const ProblemTable& table_ = backend_.table();
  P problem_;
  Scheme scheme_;
  double energy_;
  Stepper stepper_;
  X left_;
  Memory memory_ = memory_of(stepper_), left_memory_ = memory_;  ///< of the stepper at the last state, and at left_
  [[no_unique_address]] std::conditional_t<hybrid, X, Nothing>
      before_left_{};  ///< the state at which the step before the last began
  double end_;
  StandstillWatch standstill_;
  double late_ = 0;  ///< by how much rounding has made the time of the state too late
  bool along_series_ = false;
  Work between_;
};

}  // namespace least
