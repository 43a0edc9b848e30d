// Dormand–Prince 5(4) on the motion of any problem: what control runs are made with.
#pragma once

#include <memory>

#include "core/run/backend.hpp"
#include "core/schemes/odeint.hpp"

namespace least {

/// The equations of motion of states that have what it needs and no more. `steep`: what may hide in a step.
odeint::Field field_of(const RunBackend& backend, const tape::SteepForces* steep);

/// Steps of states that have what the motion needs and no more.
class ControlStepper {
 public:
  ControlStepper(const RunBackend& backend, double tolerance);

  /// x.t is the time itself. A state that is not the one the last step ended in costs an evaluation.
  StepStatus step(RunState& x) noexcept;
  /// x set to the state at t, which lies within the last step; false where a step failed since.
  bool interpolate(RunState& x, double t) const noexcept;
  const Work& work() const noexcept { return integrator_->work(); }

 private:
  const RunBackend& backend_;
  std::shared_ptr<const tape::SteepForces> steep_;
  std::unique_ptr<odeint::Integrator> integrator_;
};

}  // namespace least
