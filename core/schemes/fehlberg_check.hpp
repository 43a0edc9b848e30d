// A second look at steps whose own estimate of the error is blind to part of it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>

namespace least::odeint {

/// For a stepper whose own estimate sees everything.
struct NoCheck {
  template <class Vector>
  void begin(const Vector&) {}
  template <class Vector>
  void see(const Vector&) {}
  template <class Vector>
  double longest(const Vector&, const Vector&, double) const {
    return std::numeric_limits<double>::infinity();
  }
};

/// A second look at the steps of Fehlberg's pair. Its estimate, 41/840 h (k₀ + k₁₀ − k₁₁ − k₁₂), compares slopes at the
/// ends of a step alone: it is zero for an integral over time, and a kink or a drive within the step goes unseen. The
/// stages that the solution is made of lie at 0, 1/6, …, 1, weighted as by Newton and Cotes; what Weddle's rule, of two
/// orders less, would make of them differs by h/840 times their sixth difference. That may be tolerance^0.8: being of
/// lower order it is larger than the error by more than that. Sources: Hairer, Nørsett, Wanner, Solving Ordinary
/// Differential Equations I, 1993, II.5; Abramowitz & Stegun, 25.4.16 and 25.4.18.
template <class Shape>
class SixthDifference {
 public:
  using Vector = typename Shape::Vector;
  explicit SixthDifference(double tolerance) : allowed_(std::pow(tolerance, 0.8)) {}

  void begin(const Vector& rate) {
    stage_ = 0;
    sum_ = rate;  // its shape
    for (std::size_t i = 0; i < std::size(sum_); ++i) sum_[i] = 0;
  }
  void see(const Vector& rate) {
    static constexpr double weights[] = {0, 0, 0, 0, 0, -20, -6, -6, 15, 15, 0, 1, 1};
    const double weight = ++stage_ < std::size(weights) ? weights[stage_] : 0;
    if (weight != 0)
      for (std::size_t i = 0; i < std::size(sum_); ++i) sum_[i] += weight * rate[i];
  }
  /// The step that would have passed; of a step that passes, the longest that the next one should be.
  double longest(const Vector& y, const Vector& rate, double h) const {
    Vector parts = sum_;
    for (std::size_t i = 0; i < std::size(y); ++i)
      parts[i] *= h / (840 * allowed_ * (1 + std::abs(y[i]) + h * std::abs(rate[i])));
    const double excess = Shape::Algebra::norm_inf(parts);
    if (!(excess > 0)) return std::numeric_limits<double>::infinity();
    const double factor = 0.9 * std::pow(excess, -1.0 / 7);
    return excess > 1 ? h * std::clamp(factor, 0.2, 0.95) : h * std::max(factor, 1.0);
  }

 private:
  double allowed_;
  std::size_t stage_ = 0;
  Vector sum_{};
};

}  // namespace least::odeint
