// orbit: the revolutions of a two-body scene, the rotation of its apsis, its elements.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/exact/elements.hpp"
#include "core/run/diagnostics/rows.hpp"

namespace least {
namespace {

/// Orbit counts revolutions in the plane of the start, when the body passes its initial direction. Angles are measured
/// in the direction of motion, and the body turns by less than a revolution between two looks; `sense_` makes angles
/// counter-clockwise in the plane. A straight line has no revolutions, a circle no apsis.
template <int N>
class Orbit final : public Diagnostic {
 public:
  void start(const ProblemTable& problem, StateView view) override {
    const Motion x(view);
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
    if constexpr (N == 2) sense_ = e1_[0] * e2_[1] - e1_[1] * e2_[0] < 0 ? -1 : 1;
    const Elements e = elements(x);
    apsis_ = apsis(e);
    has_apsis_ = e.eccentricity > two_body::least_eccentricity;
    before_ = at_step_ = {radius_, 0};
  }

  /// Looks at states within a step, which may be as long as several revolutions.
  bool looks() const override { return true; }
  void look(const ProblemTable&, StateView view) override {
    const Motion x(view);
    const Place here{dot(x.q, e1_), dot(x.q, e2_)};
    if (defined_ && passed(before_, here, dot(x.p, e1_), dot(x.p, e2_))) ++passages_;
    before_ = here;
  }
  void look_again() override {
    before_ = at_step_;
    passages_ = 0;
  }
  void see(const ProblemTable& problem, StateView view) override {
    look(problem, view);
    const Motion x(view);
    at_step_ = before_;
    if (passages_ > 0) {
      const Elements e = elements(x);
      const double now = apsis(e);
      rotation_ += std::remainder(now - apsis_, 8 * std::atan(1.0));
      apsis_ = now;
      // The distance at which the osculating ellipse meets the initial direction, minus that of the start.
      closure_ = std::abs(e.angular_momentum * e.angular_momentum / (mu_ + dot(e.lenz, e1_)) - radius_);
      revolutions_ += std::exchange(passages_, 0);
    }
  }

  /// closure: distance by which the last whole revolution misses the start; apsidal_rotation: of the Laplace–Runge–Lenz
  /// vector, mean per revolution, counter-clockwise positive (about L in space); elements: osculating at the end. All
  /// are null if the centre does not attract.
  Report report(const RunEnd& end) override {
    const Motion x(end.x);
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
  /// Position and velocity.
  struct Motion {
    Vec<N> q, p;
    explicit Motion(StateView x) {
      std::copy_n(x.numbers, N, q.begin());
      std::copy_n(x.numbers + N, N, p.begin());
    }
  };
  /// Place is a position in the plane of the start: along the initial direction, and across it in the direction of
  /// motion.
  struct Place {
    double along, across;
  };
  /// passed returns whether a step passed the initial direction. A step of less than a revolution that passed it ends
  /// at a smaller angle, and only then: at a close passage a step may be more than half a revolution.
  static bool passed(const Place& before, const Place& now, double p_along, double p_across) {
    constexpr double rounding = 1e-9;
    const bool was_above = before.across >= 0, is_above = now.across >= 0;
    if (was_above && !is_above) return false;
    if (was_above == is_above) {
      const double turned = before.along * now.across - before.across * now.along;
      const double size = std::abs(before.along * now.across) + std::abs(before.across * now.along);
      if (!(turned < -rounding * size)) return false;
    }
    return now.along * p_across > now.across * p_along;  // it moves in the direction that it began with
  }

  using Elements = two_body::Elements<N>;
  Elements elements(const Motion& x) const { return two_body::elements(x.q, x.p, mu_); }
  double apsis(const Elements& e) const { return std::atan2(dot(e.lenz, e2_), dot(e.lenz, e1_)); }

  Vec<N> e1_{}, e2_{};
  Place before_{}, at_step_{};  ///< at the last look, and at the end of the last step
  double mu_ = 0, radius_ = 0, apsis_ = 0, rotation_ = 0, closure_ = 0, sense_ = 1;
  std::int64_t revolutions_ = 0, passages_ = 0;  ///< passages_: within the current step
  bool defined_ = false, has_apsis_ = false;
};

}  // namespace

std::unique_ptr<Diagnostic> orbit_diagnostic(const RunBackend& backend, const Request&, const KeepGoing&) {
  if (backend.motion().traits.dof == 2) return std::make_unique<Orbit<2>>();
  return std::make_unique<Orbit<3>>();
}

}  // namespace least
