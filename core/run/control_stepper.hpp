// Schemes with error control for the motion of any problem: control runs use them, and runs of scenes whose size is
// known only at run time.
#pragma once

#include <memory>

#include "core/run/backend.hpp"
#include "core/schemes/odeint.hpp"

namespace least {

/// field_of returns the equations of motion of states with only those components that the motion needs; `steep` are the
/// steep functions that a step has to resolve, may be null.
odeint::Field field_of(const RunBackend& backend, const tape::SteepForces* steep);

/// ControlStepper takes steps of states with the components that the motion needs, or of `all` numbers that a run
/// carries, by Dormand–Prince 5(4) or another method.
class ControlStepper {
 public:
  /// As in TaylorStepper: steps of high order are so long that a quantity may change sign more than once within one;
  /// they are searched in so many parts.
  static constexpr int parts = 16;

  ControlStepper(const RunBackend& backend, double tolerance, odeint::Method method = odeint::Method::dormand_prince_5,
                 bool all = false);
  ControlStepper(const ControlStepper& other);
  ControlStepper(ControlStepper&&) noexcept = default;
  ControlStepper& operator=(ControlStepper other) noexcept;
  ~ControlStepper() = default;

  /// Takes one step of x, x.t included. Costs one evaluation more if x is not the state in which the last step ended.
  StepStatus step(RunState& x) noexcept;
  /// Moves x to the time t, which lies within one step from x, by a step that ends there, with the accuracy of a step.
  StepStatus reach(RunState& x, double t) noexcept;
  /// Sets x to the state at t within the last step; false if a step has failed since.
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
