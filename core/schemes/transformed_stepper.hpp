// TransformedStepper takes steps of constant length σ in a parameter τ that runs with the motion, by a kernel:
//   kernel.move(x, σ, elapsed, work) → StepStatus   moves q, p and s by σ and sets `elapsed` to the time taken. The
//                                                   step begins at the time x.t, which is read where `reads_time`. A
//                                                   failure, also where the time does not advance, leaves x and the
//                                                   kernel as they were
//   kernel.memory(), kernel.settle(x, memory)       what it keeps beside the state, and to go on from x with it
//   kernel.pace(x)                                  dt/dτ at x
//   kernel.strain(), kernel.stages()
#pragma once

#include <limits>
#include <string>

#include "core/scheme.hpp"

namespace least {

/// V and ∇V at a place.
template <class V>
struct PotentialAt {
  typename V::value_type potential;
  V slope;
};
/// At q and the phase f. Where vectors are views, the problem says what it holds the slope in.
template <class P, class V, class F>
PotentialAt<V> potential_at(const P& problem, const V& q, const F& f) {
  if constexpr (HasGradient<P>) {
    return {problem.potential(q, f), problem.gradient(q, f)};
  } else {
    const auto at = problem.potential(seed<P::dof, typename V::value_type>(q), f);
    return {at.value, at.slope};
  }
}

/// The memory of kernels that keep nothing beside the state.
struct NoMemory {};

/// Whether a square is within a factor of 4 of `level`, its value on the energy level of the motion.
template <class T>
auto near_level(const T& square, const T& level) {
  return (square >= 0.25 * level) & (square <= 4.0 * level);
}

template <class Kernel, class X>
class TransformedStepper {
 public:
  using T = typename X::Number;
  using Memory = typename Kernel::Memory;
  static constexpr bool reads_time = Kernel::reads_time;

  TransformedStepper(const Kernel& kernel, double sigma) : kernel_(kernel), sigma_(sigma) {}

  StepStatus step(X& x) noexcept {
    // Works on x itself: a copy would be read in wider pieces than it was just written in, which waits for the memory.
    T elapsed;
    const StepStatus status = kernel_.move(x, sigma_, elapsed, work_);
    if (status != StepStatus::ok) return status;
    x.t = x.t + elapsed;
    elapsed_ = elapsed;
    return StepStatus::ok;
  }

  /// Moves x to the time t, to round-off of t, by a step of a shorter σ. Newton's method within a bracket finds σ: the
  /// derivative of the time by σ is the pace at the end, as far as the step is exact. Returns solver_failed where t is
  /// beyond the end of a whole step.
  StepStatus reach(X& x, const T& t) noexcept requires std::numeric_limits<T>::is_specialized {
    using least::abs;
    constexpr int most_iterations = 100;
    const T wait = t - x.t, tolerance = 4 * Precision<T>::epsilon * (abs(x.t) + abs(t)) * kernel_.stages();
    if (!(wait > T(0))) return StepStatus::ok;
    T low(0), high = sigma_, sigma = wait / kernel_.pace(x);
    const Memory memory = kernel_.memory();
    StepStatus status = StepStatus::solver_failed;
    for (int k = 0; k < most_iterations; ++k) {
      if (sigma > sigma_) sigma = sigma_;
      if (!(low < sigma && sigma <= high)) sigma = 0.5 * (low + high);
      X y = x;
      T elapsed;
      kernel_.settle(x, memory);
      status = kernel_.move(y, sigma, elapsed, work_);
      if (status != StepStatus::ok) break;
      const T excess = elapsed - wait;
      if (abs(excess) <= tolerance) {
        y.t = t;
        x = y;
        return StepStatus::ok;
      }
      status = StepStatus::solver_failed;
      (excess < T(0) ? low : high) = sigma;
      sigma = sigma - excess / kernel_.pace(y);
    }
    kernel_.settle(x, memory);
    return status;
  }
  const Work& work() const { return work_; }
  /// The time that the last step took.
  const T& elapsed() const { return elapsed_; }
  /// What steps remember beside the state; with it another stepper goes on from the state x.
  Memory memory() const { return kernel_.memory(); }
  void resume(const X& x, const Memory& memory) { kernel_.settle(x, memory); }
  const Kernel& kernel() const { return kernel_; }
  /// The largest |(D/(K + κ))² − 1| of a kick.
  T strain() const { return kernel_.strain(); }
  /// Why the last step failed, in words of the kernel; may be empty.
  std::string failure() const {
    if constexpr (requires { kernel_.failure(); }) return kernel_.failure();
    return {};
  }

 private:
  Kernel kernel_;
  T sigma_, elapsed_{};
  Work work_;
};

}  // namespace least
