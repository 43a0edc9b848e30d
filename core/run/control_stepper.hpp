// Schemes with error control on the motion of any problem: what control runs are made with, and runs of scenes whose
// size is known when they run.
#pragma once

#include <memory>

#include "core/run/backend.hpp"
#include "core/schemes/odeint.hpp"

namespace least {

/// The equations of motion of states that have what it needs and no more. `steep`: what may hide in a step.
odeint::Field field_of(const RunBackend& backend, const tape::SteepForces* steep);

/// Steps of states that have what the motion needs and no more, or `all` that a run carries: Dormand–Prince 5(4) unless
/// it is told otherwise.
class ControlStepper {
 public:
  /// As in TaylorStepper: steps of high order are so long that a quantity may change its sign more than once in one.
  static constexpr int parts = 16;

  ControlStepper(const RunBackend& backend, double tolerance, odeint::Method method = odeint::Method::dormand_prince_5,
                 bool all = false);
  ControlStepper(const ControlStepper& other);
  ControlStepper(ControlStepper&&) noexcept = default;
  ControlStepper& operator=(ControlStepper other) noexcept;
  ~ControlStepper() = default;

  /// x.t is the time itself. A state that is not the one the last step ended in costs an evaluation.
  StepStatus step(RunState& x) noexcept;
  /// x moved to the time t, which lies within one step from x, by a step that ends there: as accurate as steps are.
  StepStatus reach(RunState& x, double t) noexcept;
  /// x set to the state at t, which lies within the last step; false where a step failed since.
  bool interpolate(RunState& x, double t) const noexcept;
  const Work& work() const noexcept { return integrator_->work(); }

 private:
  odeint::Field field() const;

  const RunBackend* backend_;
  bool all_;
  std::shared_ptr<const tape::SteepForces> steep_;
  std::unique_ptr<odeint::Integrator> integrator_;
};

}  // namespace least
