// Diagnostics that look at every step: energy, momenta, orbit. Values, so that a block of steps can be taken back.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

#include "core/describe.hpp"
#include "core/problem.hpp"
#include "core/run/outcome.hpp"

namespace least {

inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// Extremes of one quantity along a run; unknown until it starts.
struct Trace {
  double initial = unknown, final = unknown, most = unknown;
  void start(double x) {
    initial = final = x;
    most = 0;
  }
  void see(double x) {
    final = x;
    most = std::max(most, std::abs(x - initial));
  }
};

/// Least-squares slope of a quantity against time: its secular drift, apart from its oscillation.
struct Trend {
  double n = 0, t = 0, tt = 0, y = 0, ty = 0;
  void see(double time, double value) {
    n += 1;
    t += time;
    tt += time * time;
    y += value;
    ty += time * value;
  }
  double slope() const { return (n * ty - t * y) / (n * tt - t * t); }
};

/// Revolutions of a two-body orbit in the plane of its start, counted when the body passes the direction it started
/// from. Angles are measured in the direction of motion; `sense` turns them counter-clockwise in the plane.
template <int N>
struct OrbitTrack {
  Vec<N> e1{}, e2{};
  double mu = 0, radius = 0, before = 0, apsis = 0, rotation = 0, closure = 0, sense = 1;
  std::int64_t revolutions = 0;
  bool defined = false, has_apsis = false;  ///< a straight line has no revolutions, a circle no apsis
};

template <class P>
concept TwoBody = requires(const P& m) {
  { m.gravitational_parameter() } -> std::convertible_to<double>;
};

template <class P>
class Observer {
 public:
  using X = StateOf<P>;
  bool energy = false, momenta = false, orbit = false;

  bool wanted() const { return energy || momenta || orbit; }

  void start(const P& problem, const X& x) {
    if (energy) energy_.start(hamiltonian(problem, x.q, x.p, x.t));
    if (energy) trend_.see(0, 0);
    start_time_ = x.t;
    if constexpr (HasInvariants<P>) {
      if (momenta) {
        const auto values = problem.invariants(x.q, x.p, x.t);
        for (std::size_t i = 0; i < values.size(); ++i) invariants_[i].start(values[i]);
      }
    }
    if constexpr (TwoBody<P>) {
      if (orbit) start_orbit(problem, x);
    }
  }

  void see(const P& problem, const X& x) {
    if (energy) {
      const double h = hamiltonian(problem, x.q, x.p, x.t);
      energy_.see(h);
      trend_.see(x.t - start_time_, h - energy_.initial);
    }
    if constexpr (HasInvariants<P>) {
      if (momenta) {
        const auto values = problem.invariants(x.q, x.p, x.t);
        for (std::size_t i = 0; i < values.size(); ++i) invariants_[i].see(values[i]);
      }
    }
    if constexpr (TwoBody<P>) {
      if (orbit) see_orbit(x);
    }
  }

  Report energy_report() const {
    return {"energy", std::vector<Report>{{"initial", energy_.initial},
                                          {"final", energy_.final},
                                          {"max_abs_error", energy_.most},
                                          {"max_rel_error", energy_.most / std::abs(energy_.initial)},
                                          {"drift_per_time", trend_.slope()}}};
  }
  Report momenta_report(const ProblemCard& card) const {
    std::vector<Report> all;
    std::size_t i = 0;
    for (const Trace& trace : invariants_)
      all.push_back(
          {card.invariants[i++].name,
           std::vector<Report>{{"initial", trace.initial}, {"final", trace.final}, {"max_abs_error", trace.most}}});
    return {"momenta", all};
  }
  /// closure: distance by which the last whole revolution misses the start; apsidal_rotation: of the Laplace–Runge–Lenz
  /// vector, mean per revolution, counter-clockwise positive (about L in space); elements: osculating at the end.
  Report orbit_report(const X& x) const {
    std::vector<Report> all;
    if constexpr (TwoBody<P>) {
      const bool started = track_.mu > 0, closed = track_.revolutions > 0;
      const auto k = static_cast<double>(track_.revolutions);
      const Elements now = elements(x, track_.mu);
      all = {{"revolutions", started ? k : unknown},
             {"closure", closed ? track_.closure : unknown},
             {"apsidal_rotation", closed && track_.has_apsis ? track_.sense * track_.rotation / k : unknown},
             {"semi_major_axis", started ? now.semi_major_axis : unknown},
             {"eccentricity", started ? std::sqrt(dot(now.lenz, now.lenz)) / track_.mu : unknown}};
    }
    return {"orbit", all};
  }

 private:
  struct Elements {
    Vec<P::dof> lenz;  ///< p × L − μ q/r = (p² − μ/r) q − (q·p) p, of length μe
    double semi_major_axis, angular_momentum_squared;
  };
  static Elements elements(const X& x, double mu) {
    const double r = std::sqrt(dot(x.q, x.q)), pp = dot(x.p, x.p), qp = dot(x.q, x.p);
    Elements e;
    for (std::size_t i = 0; i < x.q.size(); ++i) e.lenz[i] = (pp - mu / r) * x.q[i] - qp * x.p[i];
    e.semi_major_axis = 1 / (2 / r - pp / mu);
    e.angular_momentum_squared = r * r * pp - qp * qp;
    return e;
  }

  void start_orbit(const P& problem, const X& x) requires TwoBody<P> {
    track_.mu = problem.gravitational_parameter();
    track_.radius = std::sqrt(dot(x.q, x.q));
    const double along = dot(x.q, x.p) / track_.radius;
    double length = 0;
    for (std::size_t i = 0; i < x.q.size(); ++i) {
      track_.e1[i] = x.q[i] / track_.radius;
      track_.e2[i] = x.p[i] - along * track_.e1[i];
      length += track_.e2[i] * track_.e2[i];
    }
    track_.defined = length > 0;
    for (auto& c : track_.e2) c /= std::sqrt(length);
    if constexpr (P::dof == 2) track_.sense = track_.e1[0] * track_.e2[1] - track_.e1[1] * track_.e2[0] < 0 ? -1 : 1;
    const Elements e = elements(x, track_.mu);
    track_.apsis = apsis(e);
    track_.has_apsis = dot(e.lenz, e.lenz) > 1e-16 * track_.mu * track_.mu;  // e > 1e-8
    track_.before = 0;
  }

  void see_orbit(const X& x) {
    const double across = dot(x.q, track_.e2);
    if (track_.defined && track_.before < 0 && across >= 0 && dot(x.q, track_.e1) > 0) {
      const Elements e = elements(x, track_.mu);
      const double now = apsis(e);
      track_.rotation += std::remainder(now - track_.apsis, 8 * std::atan(1.0));
      track_.apsis = now;
      // Where the osculating ellipse cuts the direction of the start.
      track_.closure = std::abs(e.angular_momentum_squared / (track_.mu + dot(e.lenz, track_.e1)) - track_.radius);
      ++track_.revolutions;
    }
    track_.before = across;
  }
  double apsis(const Elements& e) const { return std::atan2(dot(e.lenz, track_.e2), dot(e.lenz, track_.e1)); }

  static constexpr std::size_t count() {
    if constexpr (HasInvariants<P>) {
      return std::tuple_size_v<decltype(P{}.invariants(Vec<P::dof>{}, Vec<P::dof>{}, 0.0))>;
    } else {
      return 0;
    }
  }

  Trace energy_;
  Trend trend_;
  double start_time_ = 0;
  std::array<Trace, count()> invariants_{};
  OrbitTrack<P::dof> track_{};
};

}  // namespace least
