#include "core/run/control_stepper.hpp"

namespace least {

odeint::Field field_of(const RunBackend& backend, const tape::SteepForces* steep) {
  odeint::Field field{[](const void* of, double t, const double* y, double* rate) {
                        static_cast<const RunBackend*>(of)->motion().rates({t, y}, rate);
                      },
                      &backend, steep};
  if (backend.found() > 0)
    field.complete = [](const void* of, double t, double* variables) {
      static_cast<const RunBackend*>(of)->values_of({t, variables}, variables);
    };
  return field;
}

ControlStepper::ControlStepper(const RunBackend& backend, double tolerance, odeint::Method method, bool all)
    : backend_(&backend), all_(all), steep_(backend.steep_forces()) {
  const std::size_t moving = backend.motion().traits.components;
  const std::size_t count = all ? backend.table().traits.numbers : moving;
  integrator_ = odeint::make_integrator(method, {count, moving, backend.motion().traits.dof}, tolerance);
}
ControlStepper::ControlStepper(const ControlStepper& other)
    : backend_(other.backend_), all_(other.all_), steep_(other.steep_), integrator_(other.integrator_->clone()) {}
ControlStepper& ControlStepper::operator=(ControlStepper other) noexcept {
  backend_ = other.backend_;
  all_ = other.all_;
  steep_ = std::move(other.steep_);
  integrator_ = std::move(other.integrator_);
  return *this;
}

odeint::Field ControlStepper::field() const {
  odeint::Field field = field_of(*backend_, steep_.get());
  if (all_)
    field.rate = [](const void* of, double t, const double* y, double* rate) {
      static_cast<const RunBackend*>(of)->table().rates({t, y}, rate);
    };
  return field;
}

StepStatus ControlStepper::step(RunState& x) noexcept { return integrator_->step(field(), x.numbers.data(), x.t); }

StepStatus ControlStepper::reach(RunState& x, double t) noexcept {
  return integrator_->reach(field(), x.numbers.data(), x.t, t);
}

bool ControlStepper::interpolate(RunState& x, double t) const noexcept {
  if (!integrator_->between(t, x.numbers.data())) return false;
  x.t = t;
  return true;
}

}  // namespace least
