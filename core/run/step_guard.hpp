// Checks whether steps are too long for the motion: ωh against the stability bound of the scheme, where the problem
// estimates ω.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/run/problem_table.hpp"
#include "core/run/stability.hpp"

namespace least {

/// guarded_damping returns the damping α that the stability bound depends on: a constant one, else 0.
inline double guarded_damping(const ProblemTable& problem) {
  const bool guarded = problem.traits.has_frequency && problem.traits.constant_damping;
  return guarded ? std::max(problem.damping(0), 0.0) : 0;
}

class StepGuard {
 public:
  /// `damping_step`: αh with the constant damping. `watches`: the problem estimates ω. `constant`: ω is the same
  /// everywhere, so that only its own ωh has to be stable; otherwise every one up to the largest. A scheme that grows
  /// at every step even without damping is never reported. `roughly`: only the largest ωh is checked, although the
  /// scheme may be unstable at smaller ones.
  StepGuard(std::size_t scheme, std::span<const double> settings, double damping_step, bool watches, bool constant,
            bool roughly)
      : scheme_(scheme), settings_(settings), damping_step_(damping_step), constant_(constant), roughly_(roughly) {
    grows_ = stability_bound(scheme, settings, 0, 0) == 0;
    if (watches && !grows_) cleared_ = 0;
  }

  void see(double turn_squared) { largest_ = std::max(largest_, turn_squared); }
  /// exceeded returns whether what was seen is beyond the bound. The bound is computed only as far as it is needed.
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
  /// Whether the scheme grows at every step of an undamped oscillation.
  bool grows_undamped() const { return grows_; }
  bool damped() const { return damping_step_ > 0; }
  /// For such a scheme, the factor by which a step at the ω seen multiplies an oscillation, if ω is the same
  /// everywhere; else 1.
  double growth() const {
    return grows_ && constant_ ? growth_per_step(scheme_, settings_, largest(), damping_step_) : 1;
  }
  /// The largest ωh seen.
  double largest() const { return std::sqrt(largest_); }
  /// The first ωh at which a step grows, at the damping ratio of the largest ω seen; infinite if it lies beyond
  /// `needed`, 0 if the scheme grows at every step.
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
  double largest_ = 0;         ///< the largest (ωh)² seen
  double cleared_ = infinite;  ///< steps up to this (ωh)² are known to be stable
};

}  // namespace least
