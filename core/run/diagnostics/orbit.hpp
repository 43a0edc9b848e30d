// The orbit of a two-body scene: its revolutions, how its apsis turns, its elements.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/exact/elements.hpp"
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
    has_apsis_ = e.eccentricity > two_body::least_eccentricity;
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
      closure_ = std::abs(e.angular_momentum * e.angular_momentum / (mu_ + dot(e.lenz, e1_)) - radius_);
      ++revolutions_;
    }
    before_ = across;
  }

  /// closure: distance by which the last whole revolution misses the start; apsidal_rotation: of the Laplace–Runge–Lenz
  /// vector, mean per revolution, counter-clockwise positive (about L in space); elements: osculating at the end. All
  /// null where the centre does not attract.
  Report report(const RunEnd<P, X>& end) const {
    const X& x = end.x;
    const bool started = mu_ > 0, closed = started && revolutions_ > 0;
    const auto k = static_cast<double>(revolutions_);
    const Elements now = elements(x);
    return numbers("orbit", {{"revolutions", started ? k : unknown},
                             {"closure", closed ? closure_ : unknown},
                             {"apsidal_rotation", closed && has_apsis_ ? sense_ * rotation_ / k : unknown},
                             {"semi_major_axis", started ? now.semi_major_axis : unknown},
                             {"eccentricity", started ? now.eccentricity : unknown},
                             {"angular_momentum", started ? now.angular_momentum : unknown}});
  }

 private:
  using Elements = two_body::Elements<P::dof>;
  Elements elements(const X& x) const { return two_body::elements(x.q, x.p, mu_); }
  double apsis(const Elements& e) const { return std::atan2(dot(e.lenz, e2_), dot(e.lenz, e1_)); }

  Vec<P::dof> e1_{}, e2_{};
  double mu_ = 0, radius_ = 0, before_ = 0, apsis_ = 0, rotation_ = 0, closure_ = 0, sense_ = 1;
  std::int64_t revolutions_ = 0;
  bool defined_ = false, has_apsis_ = false;
};

struct OrbitRow {
  static constexpr DiagnosticCard info{"orbit", "closure, apsidal rotation and osculating elements of an orbit"};
  static constexpr Sees sees = Sees::every_step;
  template <class P>
  static constexpr bool applies = TwoBody<P>;
  template <class P, class X>
  using Seen = OrbitTrack<P, X>;
};

}  // namespace least
