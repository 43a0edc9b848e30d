#include "core/schemes/adaptive_boris_stepper.hpp"

#include <utility>

namespace least {

AdaptiveBorisStepper::AdaptiveBorisStepper(std::shared_ptr<const text::Magnetic> scene, const AdaptiveBoris& scheme,
                                           std::size_t room, const double* x)
    : scene_(std::move(scene)),
      boris_(scene_, {scheme.step, scheme.composition}, room),
      looked_(scene_->paced.outputs()) {
  boris_.begin(x, 0);
  memory_.density = look(x, memory_.change);
  memory_.whole = scheme.step * memory_.density;
}

double AdaptiveBorisStepper::look(const double* x, double& change) noexcept {
  scene_->paced.evaluate(x, 0.0, looked_.data());
  ++forces_;
  const std::vector<double>& w = boris_.velocities();
  change = 0;
  for (std::size_t i = 0; i < w.size(); ++i) change += looked_[1 + i] * w[i];
  return looked_[0];
}

StepStatus AdaptiveBorisStepper::step(double* x, double h) noexcept {
  forces_ += boris_.work().forces;
  boris_.begin(x, 0);
  return boris_.step(x, 0, h);
}

StepStatus AdaptiveBorisStepper::advance(double* x, double& elapsed, bool back) noexcept {
  const double whole = back ? -memory_.whole : memory_.whole;
  const double density = memory_.density + 0.5 * whole * memory_.change;
  if (!(density > 0)) return StepStatus::singular;
  elapsed = whole / density;
  if (const StepStatus status = step(x, elapsed); status != StepStatus::ok) return status;
  look(x, memory_.change);
  memory_.density = density + 0.5 * whole * memory_.change;
  return memory_.density > 0 ? StepStatus::ok : StepStatus::singular;
}

StepStatus AdaptiveBorisStepper::reach(double* x, double time) noexcept { return step(x, time); }

}  // namespace least
