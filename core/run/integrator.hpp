// A scheme bound to a problem, their types forgotten: called once per block of steps, so that what a run does around
// its steps is compiled once. Two policies of the clock stand behind it: steps of equal length (fixed_step.hpp) and
// schemes that set their own clock (self_timed.hpp).
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "core/run/columns.hpp"
#include "core/run/diagnostics/table.hpp"
#include "core/run/root.hpp"
#include "core/run/save_schedule.hpp"
#include "core/run/step_guard.hpp"
#include "core/scheme.hpp"

namespace least {

/// Fourth powers of what is smaller do not overflow: an energy can be said.
inline constexpr double largest_component = 1e75;

/// Where a run is: a state, and how many steps it has behind it.
struct IntegrationState {
  RunState x;
  std::int64_t n = 0;
};

/// How far a block of steps goes: to the n-th step, or as far as the state at the time t asks for, whichever comes
/// first.
struct StepTarget {
  std::int64_t n;
  double t;
};

/// What ended a block of steps.
enum class BlockEnd : std::uint8_t { target, step_failed, not_finite, left_domain, too_fast, stands_still };
struct BlockResult {
  BlockEnd end = BlockEnd::target;
  StepStatus status = StepStatus::ok;  ///< of the step that failed

  static BlockResult failed(StepStatus why) { return {BlockEnd::step_failed, why}; }
  explicit operator bool() const { return end == BlockEnd::target; }
};

/// A step that turns the momentum over where the motion only damps it, or does not resolve the damping.
struct StrongDamping {
  double t, damping_step;  ///< αh
  double limit;            ///< the αh from which on it does
  bool flips;
};

class Integrator {
 public:
  virtual ~Integrator() = default;

  /// Takes steps towards the target and shows them to the diagnostics, where there are any. Returns early after a step
  /// in which a section changed its sign, or that was taken by another method than the one before it, and where the
  /// next step goes wrong. In every case the state is the last good one.
  virtual BlockResult advance(IntegrationState& state, StepTarget target, StepGuard& guard,
                              DiagnosticSet* diagnostics) = 0;
  /// Brings the state to the time `end`, which lies within the last step or one step ahead.
  virtual BlockResult finish(IntegrationState& state, double end, StepGuard& guard) = 0;

  /// The state before the last step: where steps are of equal length, only after `keep_last_step`, and after a step
  /// that ended a block early, or the run.
  virtual RunState left() const = 0;
  /// In how many parts a step is to be looked at, so that nothing changes its sign twice in one.
  virtual int parts() const { return 1; }
  /// Whether the state at t can be told from here: it lies no further than steps have come, or will come by the next.
  virtual bool reaches(const IntegrationState& state, double t) const = 0;
  /// x becomes the state at the time t: within the last step, or ahead by a trial step. Never part of the run.
  virtual StepStatus state_at(const IntegrationState& state, double t, RunState& x) const = 0;
  /// To the last state that is known to lie before what went wrong within the last step.
  virtual void step_back(IntegrationState&) {}

  /// Whether the motion from x is regular although its equations may not be; decides how the first steps are taken.
  virtual bool starts_regularly(StateView x) = 0;
  /// What already speaks against a first step from x.
  virtual BlockResult check_start(StateView, StepGuard&) const { return {}; }
  /// What the scheme has against this scene, in words; empty: nothing.
  virtual std::string unsupported_reason() const = 0;

  /// How the last step, which ended in x, was taken.
  virtual StepInfo step_info(const IntegrationState& state) const = 0;
  /// To be called before the first step where `discrete_energy`, or `left` after any block, is going to be asked for.
  virtual void keep_last_step() {}
  /// E_d of the last step, which ended in the state; unknown before the first one, and where the scheme has none.
  virtual double discrete_energy(const IntegrationState&) const { return unknown; }
  /// How much more it is than that of the step before, which was taken in this way: of a hybrid that has just switched.
  virtual double discrete_energy_jump(const IntegrationState&, const ActiveMethod&) const { return unknown; }
  /// By which method the last step was taken; empty where there is but one.
  virtual std::optional<ActiveMethod> method() const { return std::nullopt; }
  /// Steps that had to be taken in another way than the scheme's.
  virtual std::int64_t fallback_steps() const { return 0; }
  /// What of the energy says that the run has gone wrong, in words; empty: nothing.
  virtual std::string accuracy_warning() const { return {}; }
  /// How much rounding within the formulas of the motion may have made steps be off, where that counts.
  virtual double blur() const { return 0; }
  /// Where the damping is too strong for one of so many first steps.
  virtual std::optional<StrongDamping> strong_damping(std::int64_t) const { return std::nullopt; }
  virtual Work work() const = 0;
  /// What the scheme says of the step that failed, in words; empty: nothing.
  virtual std::string failure() const { return {}; }
};

/// When the step ahead of the state leads out of the domain, by trial steps; before `outside_at`, where one is known to
/// end outside, else NaN.
double exit_time(const ProblemTable& problem, const Integrator& integrator, const IntegrationState& state,
                 double outside_at);

/// Whether what the motion needs of a state are numbers of which an energy can be said. What is carried beside it, an
/// action or the work of forces, has no say.
inline bool is_finite_state(const ProblemTraits& traits, StateView x) {
  bool good = std::isfinite(x.t);
  for (std::size_t i = 0; i < traits.moving; ++i) good = good && std::abs(x[i]) < largest_component;
  return good;
}

}  // namespace least
