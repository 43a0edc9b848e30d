#include "core/schemes/harmonic_stepper.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace least {

template <class T>
HarmonicStepper<T>::HarmonicStepper(std::shared_ptr<const text::Harmonic> scene, const HarmonicSplitting& scheme,
                                    std::size_t room)
    : scene_(std::move(scene)),
      scheme_(scheme),
      turns_(&scheme_.turns()),
      modes_(scene_->squares.size()),
      room_(room),
      z_(modes_),
      rho_(modes_),
      q_(modes_),
      slopes_(modes_),
      force_(modes_),
      swings_(modes_ * static_cast<std::size_t>(turns_->stages + 1)) {}

template <class T>
void HarmonicStepper<T>::times(const std::vector<double>& a, const T* x, T* y) const noexcept {
  for (std::size_t i = 0; i < modes_; ++i) {
    if (!scene_->mixed) {
      y[i] = a[i] * x[i];
      continue;
    }
    const double* const row = &a[i * modes_];
    T sum = row[0] * x[0];
    for (std::size_t j = 1; j < modes_; ++j) sum = sum + row[j] * x[j];
    y[i] = sum;
  }
}

template <class T>
void HarmonicStepper<T>::transposed_times(const std::vector<double>& a, const T* x, T* y) const noexcept {
  if (!scene_->mixed) return times(a, x, y);
  std::fill_n(y, modes_, T(0));
  for (std::size_t i = 0; i < modes_; ++i)
    for (std::size_t j = 0; j < modes_; ++j) y[j] = y[j] + a[i * modes_ + j] * x[i];
}

template <class T>
void HarmonicStepper<T>::begin(const T* x, double) {
  work_ = {};
  times(scene_->from_places, x, z_.data());
  transposed_times(scene_->to_places, x + room_, rho_.data());
}

/// Computes the swings once for steps of one length; cos ωh − 1 keeps its digits apart from the 1.
template <class T>
void HarmonicStepper<T>::prepare(double h) noexcept {
  if (h == prepared_) return;
  prepared_ = h;
  Swing* swing = swings_.data();
  for (std::size_t i = 0; i <= static_cast<std::size_t>(turns_->stages); ++i)
    for (const double square : scene_->squares) {
      const double length = h * turns_->drift[i], w = std::sqrt(std::abs(square)), half = 0.5 * w * length;
      if (square > 0) {
        const double sine = std::sin(half);
        *swing++ = {-2 * sine * sine, std::sin(w * length) / w, -w * std::sin(w * length)};
      } else if (square < 0) {
        const double sine = std::sinh(half);
        *swing++ = {2 * sine * sine, std::sinh(w * length) / w, w * std::sinh(w * length)};
      } else {
        *swing++ = {0, length, 0};
      }
    }
}

template <class T>
void HarmonicStepper<T>::drift(std::size_t i) noexcept {
  const Swing* swing = &swings_[i * modes_];
  for (std::size_t k = 0; k < modes_; ++k, ++swing) {
    const T z = z_[k], rho = rho_[k];
    z_[k] = z + (swing->back * z + swing->along * rho);
    rho_[k] = rho + (swing->pull * z + swing->back * rho);
  }
}

/// Kicks by −Tᵀ∇V + ω²z, the force of V beyond its quadratic part.
template <class T>
void HarmonicStepper<T>::kick(double t, double h) noexcept {
  times(scene_->to_places, z_.data(), q_.data());
  scene_->gradient.evaluate(q_.data(), t, slopes_.data());
  ++work_.forces;
  transposed_times(scene_->to_places, slopes_.data(), force_.data());
  for (std::size_t k = 0; k < modes_; ++k) rho_[k] = rho_[k] + h * (scene_->squares[k] * z_[k] - force_[k]);
}

template <class T>
StepStatus HarmonicStepper<T>::step(T* x, double t, double h) noexcept {
  prepare(h);
  const auto kicks = static_cast<std::size_t>(turns_->stages);
  for (std::size_t i = 0; i < kicks; ++i) {
    drift(i);
    kick(t + h * turns_->middle[i], h * turns_->kick[i]);
  }
  drift(kicks);
  times(scene_->to_places, z_.data(), x);
  times(scene_->to_momenta, rho_.data(), x + room_);
  return StepStatus::ok;
}

template class HarmonicStepper<double>;
template class HarmonicStepper<Slope>;

}  // namespace least
