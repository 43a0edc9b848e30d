// Runs of schemes that choose their own steps, and measures of the orbits they give.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/problems/kepler.hpp"
#include "core/scheme.hpp"

namespace clocks {

using namespace least;
using namespace least::problems;

template <class P, class T>
using Moving = State<P::dof, T, T>;

/// level_of() returns K + V at x, the energy level of a run that begins there.
template <class P, class X>
auto level_of(const P& problem, const X& x) {
  return mechanical_energy(problem, x.q, x.p, phase(problem, x.t));
}
/// bound() returns a stepper of the scheme for the energy level of the state x.
template <class Scheme, class P, class X>
auto bound(const Scheme& scheme, const P& problem, const X& x) {
  return scheme.bind(problem, x, energy_level(scheme, problem, x));
}

/// steps() makes n steps, calls `look(x)` after each and returns how many succeeded: n, or fewer where a step failed.
template <class Stepper, class X, class Look>
int steps(Stepper& stepper, X& x, int n, Look&& look) {
  for (int k = 0; k < n; ++k) {
    if (stepper.step(x) != StepStatus::ok) return k;
    look(x);
  }
  return n;
}
template <class Stepper, class X>
int steps(Stepper& stepper, X& x, int n) {
  return steps(stepper, x, n, [](const X&) {});
}

/// past() makes whole steps while x.t < t and calls `look(x)` after each; it returns false where a step failed.
template <class Stepper, class X, class Look>
bool past(Stepper& stepper, X& x, const typename X::Time& t, Look&& look) {
  while (x.t < t) {
    if (stepper.step(x) != StepStatus::ok) return false;
    look(x);
  }
  return true;
}

/// until() makes whole steps as long as they end before t, and returns `finish(stepper, x)`, called at the last of
/// them.
template <class Stepper, class X, class Finish>
StepStatus until(Stepper& stepper, X& x, const typename X::Time& t, Finish&& finish) {
  for (;;) {
    X next = x;
    Stepper ahead = stepper;
    if (const StepStatus status = ahead.step(next); status != StepStatus::ok) return status;
    if (!(next.t < t)) return finish(stepper, x);
    x = next;
    stepper = ahead;
  }
}
template <class Stepper, class X>
StepStatus until(Stepper& stepper, X& x, const typename X::Time& t) {
  return until(stepper, x, t, [&](Stepper& last, X& y) { return last.reach(y, t); });
}

template <class X>
X reversed(X x) {
  for (auto& c : x.p) c = -c;
  return x;
}

/// larger() returns the larger of both; once one of them is NaN, the result is and stays NaN.
inline double larger(double most, double x) { return most >= x ? most : (std::isnan(most) ? most : x); }
/// distance() returns the largest difference of components, time left out.
template <class X, class Y>
double distance(const X& a, const Y& b) {
  double most = 0;
  for (std::size_t i = 0; i < X::size; ++i) most = larger(most, std::abs(static_cast<double>(a[i] - b[i])));
  return most;
}

/// The initial state of the paper's Kepler orbit; `paper_period` is the period.
inline constexpr State<2> paper{0, {0, -4}, {-0.1, -0.1}, {}};
/// The value of a setting that is switched off.
inline constexpr double off = std::numeric_limits<double>::quiet_NaN();
/// An initial state of the double pendulum.
inline const State<2> swing{0, {1, 0.5}, {0.3, -0.2}, {}};
inline constexpr double paper_period = 18.893743377439769;

/// Loss holds the largest errors of a run on a Kepler orbit, and what the run cost.
struct Loss {
  int steps = 0;
  std::int64_t forces = 0;
  double position = 0;                         ///< max over steps of |q − q(t)|
  double energy = 0, momentum = 0, apsis = 0;  ///< max |ΔH|, max |ΔL|, rotation of the Laplace–Runge–Lenz vector
};
/// orbit_loss() runs the scheme over `span` and measures its errors at every step; the position, against the closed
/// form in long double, only where `compare`.
template <class Scheme>
Loss orbit_loss(const Scheme& scheme, const State<2>& start, double span, bool compare = true) {
  const Kepler<> kepler;
  const auto wide = convert<long double, long double>(start);
  const auto first = kepler.invariants(start.q, start.p, 0.0);
  const double level = energy(kepler, start);
  auto stepper = scheme.bind(kepler, start, level);
  auto x = start;
  Loss loss;
  const bool whole = past(stepper, x, start.t + span, [&](const State<2>& y) {
    ++loss.steps;
    const auto now = kepler.invariants(y.q, y.p, 0.0);
    loss.energy = larger(loss.energy, std::abs(energy(kepler, y) - level));
    loss.momentum = larger(loss.momentum, std::abs(now[0] - first[0]));
    loss.apsis = larger(
        loss.apsis, std::abs(std::atan2(first[1] * now[2] - first[2] * now[1], first[1] * now[1] + first[2] * now[2])));
    if (!compare) return;
    const auto truth = kepler.exact(wide, static_cast<long double>(y.t));
    loss.position = larger(loss.position, double(std::hypot(y.q[0] - truth.q[0], y.q[1] - truth.q[1])));
  });
  EXPECT_TRUE(whole) << "stopped at t = " << x.t;
  loss.forces = stepper.work().forces;
  return loss;
}

/// slope() returns the slope of log error against log setting, by least squares.
inline double slope(const std::vector<std::pair<double, double>>& points) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const auto& [setting, error] : points) {
    const double u = std::log(setting), v = std::log(error);
    n += 1, sx += u, sy += v, sxx += u * u, sxy += u * v;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

/// tangent_at_level() returns the derivatives of (q, p) after a step by (q, p) before it, the energy level held fixed;
/// nothing where the step fails.
template <class Scheme, class P>
std::optional<Mat<2 * P::dof>> tangent_at_level(const Scheme& scheme, const P& problem, const State<P::dof>& x,
                                                double level) {
  using D = Dual<double, 2 * P::dof>;
  auto y = convert<D, D>(x);
  for (std::size_t i = 0; i < y.size; ++i) y[i] = D::variable(x[i], static_cast<int>(i));
  auto stepper = scheme.bind(problem, y, D(level));
  if (stepper.step(y) != StepStatus::ok) return std::nullopt;
  Mat<2 * P::dof> m;
  for (std::size_t i = 0; i < y.size; ++i) m[i] = y[i].slope;
  return m;
}

}  // namespace clocks
