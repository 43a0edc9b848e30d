// HarmonicStepper is the map of harmonic_splitting on a scene whose size is known at run time. It carries the normal
// modes from step to step; the state of the scene is computed from these, and the reverse only at the start.
#pragma once

#include <memory>
#include <vector>

#include "core/problem_traits.hpp"
#include "core/schemes/harmonic_splitting.hpp"
#include "core/text/harmonic.hpp"

namespace least {

/// T is double or a dual number. A step allocates nothing.
template <class T>
class HarmonicStepper {
 public:
  /// `room`: the number of coordinates for which a state has places; its momenta follow behind these.
  HarmonicStepper(std::shared_ptr<const text::Harmonic> scene, const HarmonicSplitting& scheme, std::size_t room);

  /// x: the coordinates of the scene, then their momenta.
  void begin(const T* x, double t);
  /// Moves x from the state at t to that at t + h.
  StepStatus step(T* x, double t, double h) noexcept;
  const Work& work() const { return work_; }

 private:
  /// The motion of an oscillator over a time h: cos ωh − 1, sin(ωh)/ω and −ω sin ωh.
  struct Swing {
    double back, along, pull;
  };

  void prepare(double h) noexcept;
  void drift(std::size_t i) noexcept;
  void kick(double t, double h) noexcept;
  /// Sets y to a x, or to aᵀ x, for all modes or coordinates.
  void times(const std::vector<double>& a, const T* x, T* y) const noexcept;
  void transposed_times(const std::vector<double>& a, const T* x, T* y) const noexcept;

  std::shared_ptr<const text::Harmonic> scene_;
  HarmonicSplitting scheme_;  ///< keeps the turns
  const Alternation<double>* turns_;
  std::size_t modes_, room_;
  std::vector<T> z_, rho_, q_, slopes_, force_;
  double prepared_ = 0;        ///< length of the step for which swings_ are computed
  std::vector<Swing> swings_;  ///< by drift, then by mode
  Work work_;
};

extern template class HarmonicStepper<double>;
extern template class HarmonicStepper<Slope>;

}  // namespace least
