// A scheme bound to a problem, erased: called once per block of steps, so that what a run does around its steps is
// compiled once per problem and not once per pair. Two policies of the clock stand behind it: steps of equal length
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

/// Fourth powers of what is smaller do not overflow: an energy can be said.
inline constexpr double largest_component = 1e75;

/// Of the domain of the motion.
template <class P, class X>
bool outside([[maybe_unused]] const P& problem, [[maybe_unused]] const X& x) {
  if constexpr (HasDomain<P>) return problem.bounded() && !(problem.inside(position(x)) >= 0);
  return false;
}

/// Where a run is: a state, and how many steps it has behind it.
template <class X>
struct IntegrationState {
  X x;
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

template <class P, class X>
class Integrator {
 public:
  virtual ~Integrator() = default;

  /// Takes steps towards the target and shows them to the diagnostics, where there are any. Returns early after a step
  /// in which a section changed its sign, or that was taken by another method than the one before it, and where the
  /// next step goes wrong. In every case the state is the last good one.
  virtual BlockResult advance(IntegrationState<X>& state, StepTarget target, StepGuard& guard,
                              DiagnosticSet<P, X>* diagnostics) = 0;
  /// Brings the state to the time `end`, which lies within the last step or one step ahead.
  virtual BlockResult finish(IntegrationState<X>& state, double end, StepGuard& guard) = 0;

  /// The state before the last step: where steps are of equal length, only after `keep_last_step`, and after a step
  /// that ended a block early, or the run.
  virtual const X& left() const = 0;
  /// In how many parts a step is to be looked at, so that nothing changes its sign twice in one.
  virtual int parts() const { return 1; }
  /// Whether the state at t can be told from here: it lies no further than steps have come, or will come by the next.
  virtual bool reaches(const IntegrationState<X>& state, double t) const = 0;
  /// x becomes the state at the time t: within the last step, or ahead by a trial step. Never part of the run.
  virtual StepStatus state_at(const IntegrationState<X>& state, double t, X& x) const = 0;
  /// To the last state that is known to lie before what went wrong within the last step.
  virtual void step_back(IntegrationState<X>&) {}

  /// Whether the motion from x is regular although its equations may not be; decides how the first steps are taken.
  virtual bool starts_regularly(const X& x) = 0;
  /// What already speaks against a first step from x.
  virtual BlockResult check_start(const X&, StepGuard&) const { return {}; }
  /// What the scheme has against this scene, in words; empty: nothing.
  virtual std::string unsupported_reason() const = 0;

  /// How the last step, which ended in x, was taken.
  virtual StepInfo step_info(const IntegrationState<X>& state) const = 0;
  /// To be called before the first step where `discrete_energy`, or `left` after any block, is going to be asked for.
  virtual void keep_last_step() {}
  /// E_d of the last step, which ended in the state; unknown before the first one, and where the scheme has none.
  virtual double discrete_energy(const IntegrationState<X>&) const { return unknown; }
  /// How much more it is than that of the step before, which was taken in this way: of a hybrid that has just switched.
  virtual double discrete_energy_jump(const IntegrationState<X>&, const ActiveMethod&) const { return unknown; }
  /// By which method the last step was taken; empty where there is but one.
  virtual std::optional<ActiveMethod> method() const { return std::nullopt; }
  /// Steps that had to be taken in another way than the scheme's.
  virtual std::int64_t fallback_steps() const { return 0; }
  /// What of the energy says that the run has gone wrong, in words; empty: nothing.
  virtual std::string accuracy_warning() const { return {}; }
  /// Where the damping is too strong for one of so many first steps.
  virtual std::optional<StrongDamping> strong_damping(std::int64_t) const { return std::nullopt; }
  virtual Work work() const = 0;
  /// What the scheme says of the step that failed, in words; empty: nothing.
  virtual std::string failure() const { return {}; }
};

/// The scheme of a request bound to a problem at x: steps of the grid, or by the scheme's own clock up to `end`.
/// Defined in core/catalogue/pairs.hpp and compiled in a unit of its own: steps deserve optimisation that what
/// surrounds them does not, and that costs half of the compilation.
template <class P, class X>
std::unique_ptr<Integrator<P, X>> bind_scheme(const P& problem, const Request& request, const X& x, const Grid& grid,
                                              double end);

/// When the step ahead of the state leads out of the domain, by trial steps; before `outside_at`, where one is known to
/// end outside, else NaN.
template <class P, class X>
double exit_time([[maybe_unused]] const P& problem, [[maybe_unused]] const Integrator<P, X>& integrator,
                 const IntegrationState<X>& state, [[maybe_unused]] double outside_at) {
  if constexpr (HasDomain<P>) {
    const auto inside = [&](double ahead) {
      X x = state.x;
      if (ahead > 0 && integrator.state_at(state, state.x.t + ahead, x) != StepStatus::ok) return -1.0;
      return problem.inside(position(x));
    };
    const double step = integrator.step_info(state).step_size;
    const double known = outside_at > state.x.t ? outside_at - state.x.t : std::numeric_limits<double>::infinity();
    double reach = std::min(step > 0 ? step : 1e-3, known);
    for (int k = 0; k < 60 && reach < known && inside(reach) > 0; ++k) reach = std::min(2 * reach, known);
    if (reach == known && inside(known) > 0) return outside_at;  // trial steps are others than the one that found it
    return state.x.t + root(inside, 0, reach);
  }
  return state.x.t;
}

/// What both policies share.
template <class P, class X>
class BoundIntegrator : public Integrator<P, X> {
 public:
  explicit BoundIntegrator(const P& problem) : problem_(problem) {}

 protected:
  static bool is_finite_state(const X& x) {
    bool good = std::isfinite(x.t);
    for (std::size_t i = 0; i < X::size; ++i) good = good && std::abs(value_of(x[i])) < largest_component;
    return good;
  }
  bool left_domain(const X& x) const { return outside(problem_, x); }

  P problem_;
};

}  // namespace least
