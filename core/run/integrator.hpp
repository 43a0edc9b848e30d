// A scheme bound to a problem behind an interface that is called once per block of steps, so that the code of a run
// around its steps is compiled once. Two implementations differ in who sets the clock: steps of equal length
// (fixed_step.hpp) and schemes that set their own clock (self_timed.hpp).
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

/// The largest component of a state that counts as finite: fourth powers up to it do not overflow, so energies can be
/// computed.
inline constexpr double largest_component = 1e75;

/// IntegrationState is the state that a run has reached, and the number of steps up to it.
struct IntegrationState {
  RunState x;
  std::int64_t n = 0;
};

/// StepTarget says how far a block of steps goes: to the step n, or as far as is needed for the state at the time t,
/// whichever comes first.
struct StepTarget {
  std::int64_t n;
  double t;
};

/// BlockEnd says what ended a block of steps.
enum class BlockEnd : std::uint8_t { target, step_failed, not_finite, left_domain, too_fast, stands_still };
struct BlockResult {
  BlockEnd end = BlockEnd::target;
  StepStatus status = StepStatus::ok;  ///< of the step that failed

  static BlockResult failed(StepStatus why) { return {BlockEnd::step_failed, why}; }
  explicit operator bool() const { return end == BlockEnd::target; }
};

/// StrongDamping is a step that reverses the momentum where the motion only damps it, or that does not resolve the
/// damping.
struct StrongDamping {
  double t, damping_step;  ///< αh
  double limit;            ///< the αh from which on a step of the scheme does so
  bool flips;
};

class Integrator {
 public:
  virtual ~Integrator() = default;

  /// advance takes steps towards the target and shows them to the diagnostics, if there are any. It returns early after
  /// a step in which a section changed its sign, or that was taken by another method than the one before, and before a
  /// step that would go wrong. The state is always the last good one.
  virtual BlockResult advance(IntegrationState& state, StepTarget target, StepGuard& guard,
                              DiagnosticSet* diagnostics) = 0;
  /// finish brings the state to the time `end`, which lies within the last step or one step ahead.
  virtual BlockResult finish(IntegrationState& state, double end, StepGuard& guard) = 0;

  /// left returns the state before the last step. For steps of equal length it is known only after `keep_last_step`, or
  /// after a step that ended a block early, or the run.
  virtual RunState left() const = 0;
  /// The number of parts of a step that a search for changes of sign looks at one by one, so that none has two of them.
  virtual int parts() const { return 1; }
  /// state_at sets x to the state at the time t within the last step, or ahead by a trial step. It never changes the
  /// run.
  virtual StepStatus state_at(const IntegrationState& state, double t, RunState& x) const = 0;
  /// step_back returns to the last state that is known to lie before what went wrong within the last step.
  virtual void step_back(IntegrationState&) {}

  /// Whether the motion from x is regular although the equations of motion may not be; decides how the first steps are
  /// taken.
  virtual bool starts_regularly(StateView x) = 0;
  /// check_start returns what would go wrong in the first step from x.
  virtual BlockResult check_start(StateView, StepGuard&) const { return {}; }
  /// Why the scheme does not take this scene, in words; empty where it does.
  virtual std::string unsupported_reason() const = 0;

  /// How the last step, which ended in `state`, was taken.
  virtual StepInfo step_info(const IntegrationState& state) const = 0;
  /// To be called before the first step if `discrete_energy`, or `left` after any block, is needed.
  virtual void keep_last_step() {}
  /// The discrete energy E_d of the last step, which ended in `state`; unknown before the first step, and where the
  /// scheme has none.
  virtual double discrete_energy(const IntegrationState&) const { return unknown; }
  /// By how much E_d of the last step exceeds that of the step before, which was taken by the method given; for a
  /// hybrid that has just switched.
  virtual double discrete_energy_jump(const IntegrationState&, const ActiveMethod&) const { return unknown; }
  /// The method of the last step; empty where the scheme has only one.
  virtual std::optional<ActiveMethod> method() const { return std::nullopt; }
  /// The number of steps that could not be taken in the scheme's own way and were taken in another.
  virtual std::int64_t fallback_steps() const { return 0; }
  /// In words, why the energy shows that the run has gone wrong; empty where it does not.
  virtual std::string accuracy_warning() const { return {}; }
  /// An estimate of the error of all steps by rounding within the formulas of the motion, 0 where that does not matter.
  virtual double blur() const { return 0; }
  /// The first step of so many for which the damping is too strong, if there is one.
  virtual std::optional<StrongDamping> strong_damping(std::int64_t) const { return std::nullopt; }
  virtual Work work() const = 0;
  /// What the scheme says about the step that failed, in words; may be empty.
  virtual std::string failure() const { return {}; }
};

/// exit_time returns the time at which the step ahead of the state leaves the domain, found by trial steps. If a state
/// ahead is known to lie outside, `outside_at` is its time, else NaN.
double exit_time(const ProblemTable& problem, const Integrator& integrator, const IntegrationState& state,
                 double outside_at);

/// is_finite_state returns whether the components that the motion needs are below largest_component. Components that
/// are only carried along, an action or the work of forces, are not checked.
inline bool is_finite_state(const ProblemTraits& traits, StateView x) {
  bool good = std::isfinite(x.t);
  for (std::size_t i = 0; i < traits.moving; ++i) good = good && std::abs(x[i]) < largest_component;
  return good;
}

}  // namespace least
