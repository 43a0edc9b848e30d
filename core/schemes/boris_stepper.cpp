#include "core/schemes/boris_stepper.hpp"

#include <utility>

#include "core/schemes/magnetic_turn.hpp"

namespace least {
template <class T>
BorisStepper<T>::BorisStepper(std::shared_ptr<const text::Magnetic> scene, const Boris& scheme, std::size_t room)
    : scene_(std::move(scene)),
      composition_(scheme.composition),
      weights_(&Weights<double>::of(composition_)),
      room_(room),
      w_(scene_->root_mass.size()),
      fields_(scene_->fields.outputs()),
      shift_(w_.size()) {}

template <class T>
void BorisStepper<T>::begin(const T* x, double t) {
  work_ = {};
  scene_->shift.evaluate(x, t, shift_.data());
  for (std::size_t i = 0; i < w_.size(); ++i) w_[i] = scene_->inverse_root[i] * x[room_ + i] - shift_[i];
}

template <class T>
StepStatus BorisStepper<T>::step(T* x, double t, double h) noexcept {
  double before = 0;  // length of the stage before, half of whose drift is still to be made
  for (std::size_t i = 0; i < static_cast<std::size_t>(weights_->stages); ++i) {
    const double part = h * weights_->gamma[i];
    drift(x, 0.5 * (before + part));
    scene_->fields.evaluate(x, t + h * weights_->middle[i], fields_.data());
    ++work_.forces;
    kick(0.5 * part);
    turn(part);
    kick(0.5 * part);
    before = part;
  }
  drift(x, 0.5 * before);
  scene_->shift.evaluate(x, t + h, shift_.data());
  for (std::size_t i = 0; i < w_.size(); ++i) x[room_ + i] = scene_->root_mass[i] * (w_[i] + shift_[i]);
  return StepStatus::ok;
}

template <class T>
void BorisStepper<T>::drift(T* x, double h) noexcept {
  for (std::size_t i = 0; i < w_.size(); ++i) x[i] = x[i] + (h * scene_->inverse_root[i]) * w_[i];
}

template <class T>
void BorisStepper<T>::kick(double h) noexcept {
  if (!scene_->kicks) return;
  for (std::size_t i = 0; i < w_.size(); ++i) w_[i] = w_[i] + h * fields_[i];
}

template <class T>
void BorisStepper<T>::turn(double h) noexcept {
  turn_velocities(*scene_, fields_.data() + (fields_.size() - scene_->turns), h, w_.data());
}

template class BorisStepper<double>;
template class BorisStepper<Slope>;

}  // namespace least
