// The map of harmonic_splitting on a scene whose size is known when it runs.
// Modes are what is carried from step to step: the state of the scene is made
// of them, never the other way but at the start.
#pragma once

#include <memory>
#include <vector>

#include "core/problem_traits.hpp"
#include "core/schemes/harmonic_splitting.hpp"
#include "core/text/harmonic.hpp"

namespace least {

/// Of numbers T, double or dual. Nothing is allocated in a step.
template <class T>
class HarmonicStepper {
 public:
  /// `room`: coordinates that a state has places for.
  HarmonicStepper(std::shared_ptr<const text::Harmonic> scene, const HarmonicSplitting& scheme, std::size_t room);

  /// x: the coordinates of the scene, then their momenta.
  void begin(const T* x, double t);
  /// From the state at t to that at t + h, which is written to x.
  StepStatus step(T* x, double t, double h) noexcept;
  const Work& work() const { return work_; }

 private:
  /// Of an oscillator over a time: cos ωh − 1, sin(ωh)/ω and −ω sin ωh.
  struct Swing {
    double back, along, pull;
  };

  void prepare(double h) noexcept;
  void drift(std::size_t i) noexcept;
  void kick(double t, double h) noexcept;
  /// y = a x, or aᵀ x, of all modes or coordinates.
  void times(const std::vector<double>& a, const T* x, T* y) const noexcept;
  void transposed_times(const std::vector<double>& a, const T* x, T* y) const noexcept;

  std::shared_ptr<const text::Harmonic> scene_;
  HarmonicSplitting scheme_;  ///< keeps the turns
  const Alternation<double>* turns_;
  std::size_t modes_, room_;
  std::vector<T> z_, rho_, q_, slopes_, force_;
  double prepared_ = 0;        ///< the step that the swings are of
  std::vector<Swing> swings_;  ///< of each drift those of all modes
  Work work_;
};

extern template class HarmonicStepper<double>;
extern template class HarmonicStepper<Slope>;

}  // namespace least
