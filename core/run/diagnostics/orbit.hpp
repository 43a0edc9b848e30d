// The orbit of a two-body scene: its revolutions, how its apsis turns, its elements.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/run/diagnostics/diagnostic.hpp"

namespace least {

/// Revolutions in the plane of the start, counted when the body passes the direction it started from. Angles are
/// measured in the direction of motion; `sense_` turns them counter-clockwise in the plane. A straight line has no
/// revolutions, a circle no apsis.
template <TwoBody P, class X>
class OrbitTrack {
 public:
  void start(const P& problem, const X& x) {
    mu_ = problem.gravitational_parameter();
    radius_ = std::sqrt(dot(x.q, x.q));
    const double along = dot(x.q, x.p) / radius_;
    double length = 0;
    for (std::size_t i = 0; i < x.q.size(); ++i) {
      e1_[i] = x.q[i] / radius_;
      e2_[i] = x.p[i] - along * e1_[i];
      length += e2_[i] * e2_[i];
    }
    defined_ = length > 0;
    for (auto& c : e2_) c /= std::sqrt(length);
    if constexpr (P::dof == 2) sense_ = e1_[0] * e2_[1] - e1_[1] * e2_[0] < 0 ? -1 : 1;
    const Elements e = elements(x);
    apsis_ = apsis(e);
    has_apsis_ = dot(e.lenz, e.lenz) > 1e-16 * mu_ * mu_;  // e > 1e-8
    before_ = 0;
  }

  void see(const P&, const X& x) {
    const double across = dot(x.q, e2_);
    if (defined_ && before_ < 0 && across >= 0 && dot(x.q, e1_) > 0) {
      const Elements e = elements(x);
      const double now = apsis(e);
      rotation_ += std::remainder(now - apsis_, 8 * std::atan(1.0));
      apsis_ = now;
      // Where the osculating ellipse cuts the direction of the start.
      closure_ = std::abs(e.angular_momentum_squared / (mu_ + dot(e.lenz, e1_)) - radius_);
      ++revolutions_;
    }
    before_ = across;
  }

  /// closure: distance by which the last whole revolution misses the start; apsidal_rotation: of the Laplace–Runge–Lenz
  /// vector, mean per revolution, counter-clockwise positive (about L in space); elements: osculating at the end.
  Report report(const RunEnd<P, X>& end) const {
    const X& x = end.x;
    const bool started = mu_ > 0, closed = revolutions_ > 0;
    const auto k = static_cast<double>(revolutions_);
    const Elements now = elements(x);
    return numbers("orbit", {{"revolutions", started ? k : unknown},
                             {"closure", closed ? closure_ : unknown},
                             {"apsidal_rotation", closed && has_apsis_ ? sense_ * rotation_ / k : unknown},
                             {"semi_major_axis", started ? now.semi_major_axis : unknown},
                             {"eccentricity", started ? std::sqrt(dot(now.lenz, now.lenz)) / mu_ : unknown}});
  }

 private:
  struct Elements {
    Vec<P::dof> lenz;  ///< p × L − μ q/r = (p² − μ/r) q − (q·p) p, of length μe
    double semi_major_axis, angular_momentum_squared;
  };
  Elements elements(const X& x) const {
    const double r = std::sqrt(dot(x.q, x.q)), pp = dot(x.p, x.p), qp = dot(x.q, x.p);
    Elements e;
    for (std::size_t i = 0; i < x.q.size(); ++i) e.lenz[i] = (pp - mu_ / r) * x.q[i] - qp * x.p[i];
    e.semi_major_axis = 1 / (2 / r - pp / mu_);
    e.angular_momentum_squared = r * r * pp - qp * qp;
    return e;
  }
  double apsis(const Elements& e) const { return std::atan2(dot(e.lenz, e2_), dot(e.lenz, e1_)); }

  Vec<P::dof> e1_{}, e2_{};
  double mu_ = 0, radius_ = 0, before_ = 0, apsis_ = 0, rotation_ = 0, closure_ = 0, sense_ = 1;
  std::int64_t revolutions_ = 0;
  bool defined_ = false, has_apsis_ = false;
};

struct OrbitRow {
  static constexpr DiagnosticCard info{"orbit", "closure, apsidal rotation and elements of a Kepler orbit"};
  static constexpr Sees sees = Sees::every_step;
  template <class P>
  static constexpr bool applies = TwoBody<P>;
  template <class P, class X>
  using Seen = OrbitTrack<P, X>;
};

}  // namespace least
