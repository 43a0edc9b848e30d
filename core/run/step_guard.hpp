// Watches whether steps are too long for the motion: ωh against the stability bound of the scheme, where the problem
// estimates ω.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/run/problem_table.hpp"
#include "core/run/stability.hpp"

namespace least {

/// The damping that stability is a matter of.
inline double guarded_damping(const ProblemTable& problem) {
  const bool guarded = problem.traits.has_frequency && problem.traits.constant_damping;
  return guarded ? std::max(problem.damping(0), 0.0) : 0;
}

class StepGuard {
 public:
  /// `damping_step`: a constant damping times the step. `constant`: ω is the same everywhere, so that a step is stable
  /// or not; else every ω up to the largest has to be. Where the scheme grows at every step even without damping it is
  /// not unstable, it is what it is: nothing is too fast for it.
  /// `roughly`: only the largest ω is held against the scheme, which may be unstable at smaller ones.
  StepGuard(std::size_t scheme, std::span<const double> settings, double damping_step, bool watches, bool constant,
            bool roughly)
      : scheme_(scheme), settings_(settings), damping_step_(damping_step), constant_(constant), roughly_(roughly) {
    grows_ = stability_bound(scheme, settings, 0, 0) == 0;
    if (watches && !grows_) cleared_ = 0;
  }

  void see(double turn_squared) { largest_ = std::max(largest_, turn_squared); }
  /// Whether what was seen is beyond the bound, which is measured as far as it is asked for.
  bool exceeded() {
    if (!(largest_ > cleared_)) return false;
    if (constant_ || roughly_) {
      const double z = largest();
      if ((!roughly_ && z < bound(2 * z)) || is_stable(scheme_, settings_, z, damping_step_)) cleared_ = largest_;
    } else {
      const double needed = 4 * largest(),
                   limit = std::min(stability_bound(scheme_, settings_, damping_step_, needed), needed);
      cleared_ = limit * limit * (1 + 1e-6);
    }
    return largest_ > cleared_;
  }
  /// Whether the scheme grows at every step where nothing is damped.
  bool grows_undamped() const { return grows_; }
  bool damped() const { return damping_step_ > 0; }
  /// Of such a scheme, by what a step at the ω seen multiplies an oscillation, if that is the same everywhere; else 1.
  double growth() const {
    return grows_ && constant_ ? growth_per_step(scheme_, settings_, largest(), damping_step_) : 1;
  }
  /// The largest ωh seen.
  double largest() const { return std::sqrt(largest_); }
  /// The first ωh at which a step grows, that at the largest ω seen; infinite where it lies beyond `needed`, and 0
  /// where the scheme grows at every step.
  double bound(double needed = far_turn) const {
    if (!constant_) return stability_bound(scheme_, settings_, damping_step_, needed);
    const double z = largest();
    return z > 0 ? z * stable_steps(scheme_, settings_, z, damping_step_, needed / z).limit : infinite;
  }

 private:
  static constexpr double infinite = std::numeric_limits<double>::infinity();

  std::size_t scheme_;
  std::span<const double> settings_;
  double damping_step_;
  bool constant_, roughly_, grows_ = false;
  double largest_ = 0;         ///< (ωh)²
  double cleared_ = infinite;  ///< up to here steps are stable
};

}  // namespace least
