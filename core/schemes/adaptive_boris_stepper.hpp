// The map of adaptive_boris on a scene whose size is known when it runs.
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "core/schemes/adaptive_boris.hpp"
#include "core/schemes/boris_stepper.hpp"

namespace least {

class AdaptiveBorisStepper {
 public:
  /// `room`: coordinates that a state has places for. At x: the coordinates of the scene, then their momenta, at the
  /// start of a run.
  AdaptiveBorisStepper(std::shared_ptr<const text::Magnetic> scene, const AdaptiveBoris& scheme, std::size_t room,
                       const double* x);

  /// A step, or one back, which undoes it. `elapsed`: what it took.
  StepStatus advance(double* x, double& elapsed, bool back = false) noexcept;
  /// x moved by a time, which lies within one step.
  StepStatus reach(double* x, double time) noexcept;
  Work work() const { return {forces_ + boris_.work().forces, 0}; }

  /// What steps remember beside the state.
  struct Memory {
    double density = 0, whole = 0, change = 0;
  };
  const Memory& memory() const { return memory_; }
  void resume(const Memory& memory) { memory_ = memory; }
  /// U at the start of the run was a number that steps can be made of.
  bool has_pace() const { return memory_.whole > 0 && memory_.whole < std::numeric_limits<double>::infinity(); }

 private:
  /// U, and d(ln U)/dt with the velocities that boris has at x.
  double look(const double* x, double& change) noexcept;
  StepStatus step(double* x, double h) noexcept;

  std::shared_ptr<const text::Magnetic> scene_;
  BorisStepper<double> boris_;
  Memory memory_;
  std::vector<double> looked_;
  std::int64_t forces_ = 0;  ///< but for those of the last step
};

}  // namespace least
