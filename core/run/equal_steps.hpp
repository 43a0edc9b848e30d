// Steps of equal length: t = t₀ + n·h, the last one shorter. What can go wrong inside a block is looked for at its end,
// and a block that went wrong is taken back and run again step by step, so that the last good state is exact and a good
// step pays nothing. The steps themselves are those of a kernel: core/run/fixed_step.hpp.
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
  bool reaches(const IntegrationState& state, double t) const final { return grid_.step_before(t) <= state.n; }
  /// By the step's own map over a shorter step, which is as accurate as the scheme.
  StepStatus state_at(const IntegrationState& state, double t, RunState& x) const final;

  bool starts_regularly(StateView x) final;
  BlockResult check_start(StateView x, StepGuard& guard) const final;

  StepInfo step_info(const IntegrationState&) const final { return {grid_.step}; }
  void keep_last_step() final { keeps_last_step_ = true; }
  double discrete_energy(const IntegrationState& state) const final;
  /// Looked at over the span, not at each step. The first that turns the momentum over, else the first that is stiff.
  /// Of what repeats one period is enough.
  std::optional<StrongDamping> strong_damping(std::int64_t n) const final;
  Work work() const final;

 protected:
  static constexpr double never = std::numeric_limits<double>::infinity();
  struct DampingLimits {
    double flips = never, stiff = never;
  };
  /// Where a stepper stands: at the state, or at left_.
  enum class StepperAt : std::uint8_t { here, left };
  EqualSteps(const ProblemTable& problem, const RunState& x, const Grid& grid)
      : problem_(problem), grid_(grid), left_(x) {}

  /// `count` steps of the grid; what went wrong, at any of them. `rows`: where the states after them go, one row each:
  /// the time, and the numbers of the state; null where nobody asks for them.
  virtual BlockResult block(IntegrationState& state, std::int64_t count, StepGuard& guard, double* rows) = 0;
  /// One of another length: by the stepper itself, or by a copy of it.
  virtual StepStatus last_step(RunState& x, double h) = 0;
  virtual StepStatus trial_step(StepperAt stands, RunState& x, double h) const = 0;
  /// The same by a stepper bound at x.
  virtual StepStatus bound_step(RunState& x, double h) const = 0;
  virtual void bind_stepper(StateView x) = 0;
  /// For left_; and back.
  virtual void keep_stepper() = 0;
  virtual void take_stepper_back() = 0;
  virtual Work stepper_work() const = 0;
  // What the scheme says of itself.
  virtual bool starts_at_singularity() const = 0;
  /// OfRatesAlone; else a step has in it what s adds to H, with its poles.
  virtual bool of_rates_alone() const = 0;
  virtual double energy_of_step(StateView from, double h) const = 0;
  virtual DampingLimits damping_limits() const = 0;

  const ProblemTable& problem_;
  Grid grid_;

 private:
  /// The most states of a block that diagnostics see.
  static constexpr std::int64_t most_rows = 512;

  /// What a block changes.
  struct Snapshot {
    IntegrationState state;
    std::optional<StepGuard> guard;
    SignsSeen signs;
  };

  /// Whether −γ s h > 2, where H has γs²/2: such a step reaches the pole of ṡ = −γs²/2.
  bool reaches_pole(StateView x) const;
  /// The first time after the start at which the damping is infinite and changes its sign, as 2/t does: there is no
  /// factor e^{−∫α} over it. Looked for once, as closely as a 256th of the way.
  double damping_pole();
  BlockResult take_steps(IntegrationState& state, std::int64_t count, StepGuard& guard, DiagnosticSet* diagnostics);
  BlockResult replay(IntegrationState& state, std::int64_t count, StepGuard& guard, DiagnosticSet* diagnostics);
  /// `count` steps; where diagnostics see them and all went well, the signs there are looked at.
  BlockResult seen_block(IntegrationState& state, std::int64_t count, StepGuard& guard, DiagnosticSet* diagnostics);
  void keep(Snapshot& kept, const IntegrationState& state, const StepGuard& guard, const DiagnosticSet* diagnostics);
  void take_back(const Snapshot& kept, IntegrationState& state, StepGuard& guard, DiagnosticSet* diagnostics);
  /// A step that was taken back has cost what it cost.
  void count_tried(const Work& tried);

  // The regular solution from a time at which the equations of motion are singular stands in for the steps as far as
  // its series reaches; of a first step that reaches further, the rest is the scheme's.
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
  std::int64_t watched_ = 8;  ///< the length of blocks of which something is watched: much of one may be made again
  bool along_series_ = false, keeps_last_step_ = false;
  std::int64_t series_steps_ = 0;
  std::optional<double> damping_pole_;  ///< once it was looked for
  Work before_;                         ///< of steppers that were put aside
  std::unique_ptr<double[]> rows_;      ///< room for most_rows; none before diagnostics see a block
  Snapshot block_kept_, step_kept_;
};

}  // namespace least
