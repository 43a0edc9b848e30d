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

ControlStepper::ControlStepper(const RunBackend& backend, double tolerance)
    : backend_(backend),
      steep_(backend.steep_forces()),
      integrator_(odeint::make_integrator(odeint::Method::dormand_prince_5, backend.motion().traits.components,
                                          backend.motion().traits.components, tolerance)) {}

StepStatus ControlStepper::step(RunState& x) noexcept {
  return integrator_->step(field_of(backend_, steep_.get()), x.numbers.data(), x.t);
}

bool ControlStepper::interpolate(RunState& x, double t) const noexcept {
  if (!integrator_->between(t, x.numbers.data())) return false;
  x.t = t;
  return true;
}

}  // namespace least
