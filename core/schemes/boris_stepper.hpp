// The map of boris on a scene whose size is known when it runs, on components that stand where its caller has them.
// Velocities stay what is carried from step to step: momenta are made of them, never the other way but at the start.
#pragma once

#include <memory>
#include <vector>

#include "core/problem_traits.hpp"
#include "core/schemes/boris.hpp"
#include "core/text/magnetic.hpp"

namespace least {

/// Of numbers T, double or dual. Nothing is allocated in a step.
template <class T>
class BorisStepper {
 public:
  /// `room`: coordinates that a state has places for.
  BorisStepper(std::shared_ptr<const text::Magnetic> scene, const Boris& scheme, std::size_t room);

  /// x: the coordinates of the scene, then their momenta, at the time t.
  void begin(const T* x, double t);
  /// From the state at t to that at t + h, which is written to x.
  StepStatus step(T* x, double t, double h) noexcept;
  const Work& work() const { return work_; }
  /// √m v of each coordinate, at the state.
  const std::vector<T>& velocities() const { return w_; }

 private:
  void drift(T* x, double h) noexcept;
  void kick(double h) noexcept;
  void turn(double h) noexcept;

  std::shared_ptr<const text::Magnetic> scene_;
  Composition composition_;  ///< keeps the weights
  const Weights<double>* weights_;
  std::size_t room_;
  std::vector<T> w_;       ///< √m v
  std::vector<T> fields_;  ///< kicks and turns at the last place
  std::vector<T> shift_;
  Work work_;
};

extern template class BorisStepper<double>;
extern template class BorisStepper<Slope>;

}  // namespace least
