// AdaptiveBorisStepper is the map of adaptive_boris on a scene whose size is known at run time.
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "core/schemes/adaptive_boris.hpp"
#include "core/schemes/boris_stepper.hpp"

namespace least {

class AdaptiveBorisStepper {
 public:
  /// `room`: the number of coordinates for which a state has places; its momenta follow behind these. x: coordinates
  /// and momenta at the start of a run.
  AdaptiveBorisStepper(std::shared_ptr<const text::Magnetic> scene, const AdaptiveBoris& scheme, std::size_t room,
                       const double* x);

  /// Moves x by a step, or by one back, which undoes a step, and sets `elapsed` to the time it took.
  StepStatus advance(double* x, double& elapsed, bool back = false) noexcept;
  /// Moves x by a time that lies within one step.
  StepStatus reach(double* x, double time) noexcept;
  Work work() const { return {forces_ + boris_.work().forces, 0}; }

  /// What steps remember beside the state: ρ, σ and d(ln U)/dt.
  struct Memory {
    double density = 0, whole = 0, change = 0;
  };
  const Memory& memory() const { return memory_; }
  void resume(const Memory& memory) { memory_ = memory; }
  /// Whether U at the start of the run was positive and finite, so that steps can be taken.
  bool has_pace() const { return memory_.whole > 0 && memory_.whole < std::numeric_limits<double>::infinity(); }

 private:
  /// Returns U at x and sets `change` to d(ln U)/dt there, with the velocities of boris_.
  double look(const double* x, double& change) noexcept;
  StepStatus step(double* x, double h) noexcept;

  std::shared_ptr<const text::Magnetic> scene_;
  BorisStepper<double> boris_;
  Memory memory_;
  std::vector<double> looked_;
  std::int64_t forces_ = 0;  ///< without those of the last step of boris_
};

}  // namespace least
