// Watches whether steps are too long for the motion: ωh against the stability bound of the scheme, where the problem
// estimates ω.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/run/stability.hpp"

namespace least {

class StepGuard {
 public:
  /// `damping_step`: a constant damping times the step. Where the scheme grows at every step even without damping it is
  /// not unstable, it is what it is: nothing is too fast for it.
  StepGuard(std::size_t scheme, std::span<const double> settings, double damping_step, bool watches)
      : scheme_(scheme), settings_(settings), damping_step_(damping_step) {
    if (watches && stability_bound(scheme, settings, 0, 0) > 0) cleared_ = 0;
  }

  void see(double turn_squared) { largest_ = std::max(largest_, turn_squared); }
  /// Whether what was seen is beyond the bound, which is measured as far as it is asked for.
  bool exceeded() { return exceeded(largest_); }
  bool exceeded(double turn_squared) {
    if (!(turn_squared > cleared_)) return false;
    const double needed = 4 * std::sqrt(turn_squared), limit = std::min(bound(needed), needed);
    cleared_ = limit * limit * (1 + 1e-6);
    return turn_squared > cleared_;
  }
  /// The largest ωh seen.
  double largest() const { return std::sqrt(largest_); }
  /// The bound; infinite where it lies beyond `needed`.
  double bound(double needed = std::numeric_limits<double>::infinity()) const {
    return stability_bound(scheme_, settings_, damping_step_, needed);
  }

 private:
  std::size_t scheme_;
  std::span<const double> settings_;
  double damping_step_;
  double largest_ = 0;                                        ///< (ωh)²
  double cleared_ = std::numeric_limits<double>::infinity();  ///< up to here steps are stable
};

}  // namespace least
