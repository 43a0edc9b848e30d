// Steps of equal length: t = t₀ + n·h, the last one shorter. Errors are looked for only at the end of a block of steps.
// A block in which something went wrong is undone and repeated step by step, so that the last good state is exact and
// good steps cost nothing extra. The steps themselves are those of a kernel: core/run/fixed_step.hpp.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "core/run/integrator.hpp"
#include "core/run/save_schedule.hpp"

namespace least {

class EqualSteps : public Integrator {
 public:
  BlockResult advance(IntegrationState& state, StepTarget target, StepGuard& guard, DiagnosticSet* diagnostics) final;
  BlockResult finish(IntegrationState& state, double end, StepGuard& guard) final;
  void step_back(IntegrationState& state) final;
  RunState left() const final { return left_; }
  /// By a step of the scheme of another length, which is as accurate as the scheme.
  StepStatus state_at(const IntegrationState& state, double t, RunState& x) const final;

  bool starts_regularly(StateView x) final;
  BlockResult check_start(StateView x, StepGuard& guard) const final;

  StepInfo step_info(const IntegrationState&) const final { return {grid_.step}; }
  void keep_last_step() final { keeps_last_step_ = true; }
  double discrete_energy(const IntegrationState& state) const final;
  /// Checks up to 1000 times over the span (over one period, where the damping is periodic): returns the first at which
  /// a step reverses the momentum, else the first at which it does not resolve the damping.
  std::optional<StrongDamping> strong_damping(std::int64_t n) const final;
  Work work() const final;

 protected:
  static constexpr double never = std::numeric_limits<double>::infinity();
  struct DampingLimits {
    double flips = never, stiff = never;
  };
  /// Where a stepper is: at the state, or at left_.
  enum class StepperAt : std::uint8_t { here, left };
  EqualSteps(const ProblemTable& problem, const RunState& x, const Grid& grid)
      : problem_(problem), grid_(grid), left_(x) {}

  /// block takes `count` steps of the grid and returns what went wrong in any of them. `rows` receives the state after
  /// each step, one row each: the time, then the numbers of the state; null if they are not needed.
  virtual BlockResult block(IntegrationState& state, std::int64_t count, StepGuard& guard, double* rows) = 0;
  /// A step of another length h: last_step by the stepper itself, trial_step by a copy of it.
  virtual StepStatus last_step(RunState& x, double h) = 0;
  virtual StepStatus trial_step(StepperAt stands, RunState& x, double h) const = 0;
  /// The same by a new stepper that is bound at x.
  virtual StepStatus bound_step(RunState& x, double h) const = 0;
  virtual void bind_stepper(StateView x) = 0;
  /// keep_stepper copies the stepper for left_; take_stepper_back restores it.
  virtual void keep_stepper() = 0;
  virtual void take_stepper_back() = 0;
  virtual Work stepper_work() const = 0;
  // Properties of the scheme, see core/scheme.hpp.
  virtual bool starts_at_singularity() const = 0;
  /// OfRatesAlone<Scheme>. Otherwise a step uses the exact flow of the part of H that depends on s, with the poles of
  /// that flow.
  virtual bool of_rates_alone() const = 0;
  virtual double energy_of_step(StateView from, double h) const = 0;
  virtual DampingLimits damping_limits() const = 0;

  const ProblemTable& problem_;
  Grid grid_;

 private:
  /// The largest number of states of a block that diagnostics see.
  static constexpr std::int64_t most_rows = 512;

  /// Snapshot holds everything that a block changes, to undo it.
  struct Snapshot {
    IntegrationState state;
    std::optional<StepGuard> guard;
    SignsSeen signs;
  };

  /// reaches_pole returns whether −γ s h > 2 where H has γs²/2: then a step by the exact flow of s reaches the pole of
  /// ṡ = −γs²/2.
  bool reaches_pole(StateView x) const;
  /// damping_pole returns the first time after the start at which the damping is infinite, as 2/t at t = 0: no factor
  /// e^{−∫α} exists across it. The search is that of core/run/damping_pole.hpp, made once, when a step first asks; the
  /// result is infinite where none is found.
  double damping_pole();
  BlockResult take_steps(IntegrationState& state, std::int64_t count, StepGuard& guard, DiagnosticSet* diagnostics);
  BlockResult replay(IntegrationState& state, std::int64_t count, StepGuard& guard, DiagnosticSet* diagnostics);
  /// seen_block takes `count` steps, and shows their signs to the diagnostics if there are any and no step went wrong.
  BlockResult seen_block(IntegrationState& state, std::int64_t count, StepGuard& guard, DiagnosticSet* diagnostics);
  void keep(Snapshot& kept, const IntegrationState& state, const StepGuard& guard, const DiagnosticSet* diagnostics);
  void take_back(const Snapshot& kept, IntegrationState& state, StepGuard& guard, DiagnosticSet* diagnostics);
  /// count_tried keeps the cost of steps that were undone in the total.
  void count_tried(const Work& tried);

  // From a time at which the equations of motion are singular, the series of the regular solution replaces the scheme's
  // steps as far as the series reaches; if the first step reaches further, the scheme takes the rest of it.
  bool on_series(std::int64_t n) const { return along_series_ && n < std::min(series_steps_, grid_.steps); }
  bool covered_by_series(std::int64_t n, double t) const {
    return along_series_ && (n == 0 || t <= problem_.traits.series_until);
  }
  StepStatus from_series(RunState& x, double t) const;
  BlockResult advance_on_series(IntegrationState& state, std::int64_t count, DiagnosticSet* diagnostics);
  StateRows rows(std::int64_t count) const {
    return {rows_.get(), 1 + problem_.traits.numbers, static_cast<std::size_t>(count)};
  }

  RunState left_;
  std::int64_t watched_ = 8;  ///< length of blocks while something is watched, short since one may have to be repeated
  bool along_series_ = false, keeps_last_step_ = false;
  std::int64_t series_steps_ = 0;
  std::optional<double> damping_pole_;  ///< empty until it is searched
  Work before_;                         ///< cost of former steppers and of steps that were undone
  std::unique_ptr<double[]> rows_;      ///< room for most_rows states; allocated when diagnostics first see a block
  Snapshot block_kept_, step_kept_;
};

}  // namespace least
