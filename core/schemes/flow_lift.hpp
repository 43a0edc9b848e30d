// FlowLift is the map of lifted_splitting on equations ẋ = X(x, t) without momenta: a lift moves x, and its exact
// derivative takes the contact elements along, so the motion of x alone determines it. Where X is linear with constant
// coefficients, the map is exact. Else the variables move part by part, there and back again, with the time at its
// middle: order 2, symmetric. A part whose rates are linear in their own variables is exact,
//   x_i += h φ₁(h ∂X_i/∂x_i) X_i,
// any other one goes by the implicit midpoint rule in each variable for itself. Where the divergence of every part is a
// number, as of Lorenz's equations, volumes contract as the motion's do, to round-off.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/problem_traits.hpp"
#include "core/schemes/lifted_splitting.hpp"
#include "core/text/flow_parts.hpp"

namespace least {

/// T is double or a dual number. A step allocates nothing.
template <class T>
class FlowLift {
 public:
  /// Requires that `objection` has returned an empty text.
  FlowLift(std::shared_ptr<const text::FlowParts> flow, const LiftedSplitting& scheme);
  static std::string objection(const text::FlowParts& flow, const LiftedSplitting& scheme);

  void begin(const T* x, double t);
  /// Moves x from the state at t to that at t + h.
  StepStatus step(T* x, double t, double h) noexcept;
  const Work& work() const { return work_; }

 private:
  StepStatus move(const text::FlowParts::Part& part, T* x, double t, double h) noexcept;
  StepStatus by_midpoint(const text::FlowParts::Part& part, T* x, double t, double h) noexcept;
  void look(const text::FlowParts::Part& part, const T* x, double t) noexcept;

  std::shared_ptr<const text::FlowParts> flow_;
  Composition composition_;  ///< keeps the weights
  const Weights<double>* weights_;
  bool whole_;        ///< all variables move at once
  LiftedMap<T> map_;  ///< that moves them
  std::vector<T> momenta_, slope_;
  std::vector<T> rates_, old_, speed_;
  std::int64_t looks_ = 0;
  Work work_;
};

extern template class FlowLift<double>;
extern template class FlowLift<Slope>;

}  // namespace least
