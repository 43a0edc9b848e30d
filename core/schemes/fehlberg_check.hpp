// Checks of steps whose own error estimate is blind to a part of the error.
#pragma once

#include <algorithm>
#include <array>
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
  double longest(const Vector&, const Vector&, double, bool) const {
    return std::numeric_limits<double>::infinity();
  }
};

/// SixthDifference examines the steps of Fehlberg's pair again. The pair's own estimate, 41/840 h (k₀ + k₁₀ − k₁₁ −
/// k₁₂), compares slopes at the ends of a step alone: it is zero for an integral over time, and misses a kink or a
/// drive within the step. The solution is made of stages at 0, 1/6, …, 1 with the weights of Newton and Cotes; Weddle's
/// rule, of two orders less, gives a result that differs by h/840 times the sixth difference of these stages. The
/// difference may be as large as tolerance^0.8: it is of lower order, and so larger than the error by more than that,
/// where rates are smooth. Where rates are rough, the error is smaller than the difference only by about the ratio of
/// sixth to fourth differences, which is about 1 beside a pole. A sixth difference may vanish by chance, as it does for
/// some step over any pole: it is taken to be at least the geometric continuation of the fourth and fifth ones.
/// Sources: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, 1993, II.5; Abramowitz & Stegun,
/// 25.4.16 and 25.4.18.
template <class Shape>
class SixthDifference {
 public:
  using Vector = typename Shape::Vector;
  explicit SixthDifference(double tolerance) : tolerance_(tolerance), smooth_tolerance_(std::pow(tolerance, 0.8)) {}

  void begin(const Vector&) { stage_ = 0; }
  void see(const Vector& rate) {
    static constexpr int none = 7, places[] = {none, none, none, none, none, 3, 5, 1, 4, 2, none, 0, 6};
    const int place = ++stage_ < std::size(places) ? places[stage_] : none;
    if (place != none) rates_[static_cast<std::size_t>(place)] = rate;
  }
  /// Returns the length with which a step would have passed; for a step that passes, the longest that the next one
  /// should be. `rough`: rates may have a pole near here.
  double longest(const Vector& y, const Vector& rate, double h, bool rough) const {
    const double allowed = rough ? tolerance_ : smooth_tolerance_;
    Vector parts = y;  // its shape
    for (std::size_t i = 0; i < std::size(y); ++i)
      parts[i] = h / 840 * unseen(i, rough) / (allowed * (1 + std::abs(y[i]) + h * std::abs(rate[i])));
    const double excess = Shape::Algebra::norm_inf(parts);
    if (!(excess > 0)) return std::numeric_limits<double>::infinity();
    const double factor = 0.9 * std::pow(excess, -1.0 / (rough ? 9 : 7));
    return excess > 1 ? h * std::clamp(factor, 0.2, 0.95) : h * std::max(factor, 1.0);
  }

 private:
  /// Estimates the part of a component's rates that a step does not see, as a sixth difference.
  double unseen(std::size_t i, bool rough) const {
    std::array<double, 7> d;
    for (std::size_t k = 0; k < d.size(); ++k) d[k] = rates_[k][i];
    std::array<double, 7> largest{};  // of the k-th differences
    for (std::size_t order = 1; order < d.size(); ++order)
      for (std::size_t k = 0; k + order < d.size(); ++k) {
        d[k] = d[k + 1] - d[k];
        largest[order] = std::max(largest[order], std::abs(d[k]));
      }
    if (!(largest[5] > 0)) return 0;
    const double sixth = std::max(largest[6], largest[5] * largest[5] / largest[4]);
    return rough ? sixth * std::min(1.0, sixth / largest[4]) : sixth;
  }

  double tolerance_, smooth_tolerance_;
  std::size_t stage_ = 0;
  std::array<Vector, 7> rates_{};  ///< at 0, 1/6, …, 1 of a step
};

}  // namespace least::odeint
