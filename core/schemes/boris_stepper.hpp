// BorisStepper is the map of boris on a scene whose size is known at run time, in place on its caller's components. It
// carries velocities from step to step; momenta are computed from these, and the reverse only at the start.
#pragma once

#include <memory>
#include <vector>

#include "core/problem_traits.hpp"
#include "core/schemes/boris.hpp"
#include "core/text/magnetic.hpp"

namespace least {

/// T is double or a dual number. A step allocates nothing.
template <class T>
class BorisStepper {
 public:
  /// `room`: the number of coordinates for which a state has places; its momenta follow behind these.
  BorisStepper(std::shared_ptr<const text::Magnetic> scene, const Boris& scheme, std::size_t room);

  /// x: the coordinates of the scene, then their momenta, at the time t.
  void begin(const T* x, double t);
  /// Moves x from the state at t to that at t + h.
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
