// Steps of equal length by one scheme on one problem: the kernel of the steps, which is all that is compiled for each
// pair.
#pragma once

#include <cmath>

#include "core/phases.hpp"
#include "core/run/discrete_energy.hpp"
#include "core/run/equal_steps.hpp"

namespace least {

template <class P, class Scheme, class X>
class FixedStepIntegrator final : public EqualSteps {
 public:
  FixedStepIntegrator(const ProblemTable& table, const P& problem, const Scheme& scheme, const RunState& x,
                      const Grid& grid)
      : EqualSteps(table, x, grid),
        kernel_problem_(problem),
        scheme_(scheme),
        stepper_(scheme.bind(problem, state_from<X>(x))),
        left_stepper_(stepper_) {}

  std::string unsupported_reason() const override {
    if constexpr (requires { scheme_.unsupported_reason(kernel_problem_); })
      return scheme_.unsupported_reason(kernel_problem_);
    return {};
  }

 private:
  using Stepper = StepperOf<Scheme, P, X>;
  static constexpr bool with_pole = QuadraticContact<P> && !OfRatesAlone<Scheme>;

  BlockResult block(IntegrationState& state, std::int64_t count, StepGuard& guard, double* rows) override {
    return rows ? loop<true>(state, count, guard, rows) : loop<false>(state, count, guard, nullptr);
  }
  /// Not inlined: inlined into its caller, the state would go through memory at each step: 6.7 instead of 4.8 ns for a
  /// harmonic oscillator.
  template <bool Observed>
  [[gnu::noinline]] BlockResult loop(IntegrationState& state, std::int64_t count, StepGuard& guard,
                                     [[maybe_unused]] double* row) noexcept {
    const Grid grid = grid_;
    auto stepper = stepper_;
    auto x = state_from<X>(state.x);
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
        const double here = kernel_problem_.frequency_squared(position(x));
        frequency = here > frequency ? here : frequency;
      }
      if constexpr (with_pole) lowest = x.action.s < lowest ? x.action.s : lowest;
      if constexpr (HasDomain<P>) left = left || !(kernel_problem_.inside(position(x)) >= 0);
      if constexpr (Sloped<X>) normalise(x);
      if constexpr (Observed) {
        *row = x.t;
        write_numbers(x, row + 1);
        row += 1 + numbers_in<X>;
      }
    }
    if (n == grid_.steps && grid_.tail == 0) x.t = grid_.end;
    stepper_ = stepper;
    state.x.t = x.t;
    write_numbers(x, state.x.numbers.data());
    state.n = n;
    if constexpr (HasFrequency<P>) guard.see(frequency * grid_.step * grid_.step);
    if (status != StepStatus::ok) return BlockResult::failed(status);
    if constexpr (with_pole)
      if (-kernel_problem_.action_curvature() * lowest * grid_.step > 2)
        return BlockResult::failed(StepStatus::singular);
    const bool finite = is_finite_state(problem_.traits, state.x);
    if constexpr (HasDomain<P>)
      if (left && finite && kernel_problem_.bounded()) return {BlockEnd::left_domain};
    if (!finite) return {BlockEnd::not_finite};
    return guard.exceeded() ? BlockResult{BlockEnd::too_fast} : BlockResult{};
  }

  /// Not inlined: three ways of taking a single step share the code of one.
  [[gnu::noinline]] StepStatus move(Stepper& stepper, RunState& state, double h) const {
    auto x = state_from<X>(state);
    const StepStatus status = stepper.step(x, h);
    write_numbers(x, state.numbers.data());
    return status;
  }
  StepStatus last_step(RunState& x, double h) override {
    const StepStatus status = move(stepper_, x, h);
    if constexpr (Sloped<X>) {
      auto y = state_from<X>(x);
      normalise(y);
      write_numbers(y, x.numbers.data());
    }
    return status;
  }
  StepStatus trial_step(StepperAt stands, RunState& x, double h) const override {
    auto stepper = stands == StepperAt::here ? stepper_ : left_stepper_;
    return move(stepper, x, h);
  }
  StepStatus bound_step(RunState& x, double h) const override {
    auto stepper = scheme_.bind(kernel_problem_, state_from<X>(x));
    return move(stepper, x, h);
  }
  void bind_stepper(StateView x) override { stepper_ = scheme_.bind(kernel_problem_, state_from<X>(x)); }
  void keep_stepper() override { left_stepper_ = stepper_; }
  void take_stepper_back() override { stepper_ = left_stepper_; }
  Work stepper_work() const override { return stepper_.work(); }
  bool starts_at_singularity() const override {
    if constexpr (requires { scheme_.starts_at_singularity(kernel_problem_); })
      return scheme_.starts_at_singularity(kernel_problem_);
    return false;
  }
  bool of_rates_alone() const override { return OfRatesAlone<Scheme>; }
  double energy_of_step(StateView from, double h) const override {
    return least::discrete_energy(scheme_, kernel_problem_, state_from<X>(from), h);
  }
  DampingLimits damping_limits() const override {
    DampingLimits limits;
    if constexpr (requires { scheme_.flips_from(); }) limits.flips = scheme_.flips_from();
    if constexpr (requires { scheme_.stiff_from(kernel_problem_); }) limits.stiff = scheme_.stiff_from(kernel_problem_);
    return limits;
  }

  P kernel_problem_;
  Scheme scheme_;
  Stepper stepper_, left_stepper_;  ///< at the state, and where the last block (or step) began
};

}  // namespace least
