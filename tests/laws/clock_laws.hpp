// Laws of the schemes that choose their own steps, on a problem: order and reversal.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/laws/scheme_laws.hpp"
#include "tests/support/clocks.hpp"
#include "tests/support/hermite.hpp"

namespace laws {

constexpr double never = std::numeric_limits<double>::quiet_NaN();

/// Transforms: TimeTransformed takes this problem. It takes conservative ones, and damped ones with a constant metric.
template <class P>
concept Transforms = SelfTimedSchemeFor<TimeTransformed, P>;

template <template <class> class P, class F>
void for_each_clock(F&& f) {
  if constexpr (Transforms<P<double>>) {
    TimeTransformed soft;
    for (const auto composition : {Composition::none, Composition::suzuki_4, Composition::kahan_li_6}) {
      soft.composition = composition;
      f(soft, order(soft));
    }
  }
  if constexpr (Conservative<P<double>>) {
    f(EnergyMomentum{}, 2);
    if constexpr (Separable<P<double>>)
      for (const Monitor monitor : {Monitor::arclength, Monitor::frequency}) f(AdaptiveVerlet{0.01, monitor}, 2);
    JacobiMaupertuis hybrid;
    hybrid.alpha_max = never;  // with step control the error does not follow a step length
    for (const double critical : {never, 0.0})
      for (const Quadrature quadrature : {Quadrature::trapezoid, Quadrature::midpoint})
        for (hybrid.order = 2; hybrid.order <= 4; hybrid.order += 2) {
          hybrid.critical_kinetic_energy = critical;
          hybrid.quadrature = quadrature;
          const bool by_quadrature = P<double>::dof == 1 && critical == 0;
          f(hybrid, by_quadrature ? 6 : hybrid.order);
        }
  }
}

/// fast_state() returns the state with the largest kinetic energy, where the schemes that step in a coordinate can move
/// it.
template <template <class> class P>
auto fast_state() {
  const P<double> problem;
  auto fastest = states<P>()[0];
  const auto kinetic = [&](const auto& x) { return dot(x.p, velocity(problem, x.q, x.p)); };
  for (const auto& x : states<P>())
    if (kinetic(x) > kinetic(fastest)) fastest = x;
  if (Autonomous<P<double>>) fastest.t = 0;
  return fastest;
}

/// resized() returns the scheme with its setting changed so that a step from x takes about the time h.
template <class Scheme, class P, class X>
Scheme resized(Scheme scheme, const P& problem, const X& x, double h) {
  const auto v = velocity(problem, x.q, x.p);
  if constexpr (requires { scheme.sigma; })
    scheme.sigma =
        h * std::pow(0.5 * dot(x.p, v) + scheme.kappa, Conservative<P> ? 1 : 1 - scheme.exponent);  // of dt/dτ
  if constexpr (requires { scheme.step; }) scheme.step = h;
  if constexpr (requires { scheme.theta; }) {
    double most = 0;
    for (const double c : v) most = std::max(most, std::abs(c));
    scheme.theta = h * most;
  }
  return scheme;
}

/// arrive() advances x to the time t: whole steps, and then the stepper's own reach, or else interpolation, in the last
/// one.
template <class Scheme, class P, class X>
StepStatus arrive(const Scheme& scheme, const P& problem, X& x, const typename X::Time& t) {
  auto stepper = clocks::bound(scheme, problem, x);
  const auto level = energy_level(scheme, problem, x);
  for (X before = x;; before = x) {
    const auto last = stepper;
    if (const StepStatus status = stepper.step(x); status != StepStatus::ok) return status;
    if (x.t < t) continue;
    if constexpr (requires { stepper.reach(before, t); }) {
      auto again = scheme.bind(problem, before, level);
      if constexpr (requires { last.memory(); }) again.resume(before, last.memory());
      const StepStatus status = again.reach(before, t);
      x = before;
      return status;
    } else {
      x = hermite(problem, before, x, t);
      return StepStatus::ok;
    }
  }
}

template <template <class> class P>
void clocks_have_their_order() {
  const P<double> problem;
  if constexpr (Transforms<P<double>>) {
    const auto start = fast_state<P>();
    const double span = 0.35 * rhythm(problem, start);
    Orbit<P> truth(problem, convert<Quad, Quad>(start), 1e-28);
    ASSERT_TRUE(truth.advance(Quad(start.t + span), [] { return true; }));
    using T = long double;
    const auto end = convert<T, T>(truth.state());
    for_each_clock<P>([&](const auto& scheme, int order) {
      std::vector<Measured> points;
      for (double ladder = 3; ladder < 400; ladder *= 1.35) {
        auto x = convert<T, T>(start);
        if (arrive(resized(scheme, problem, start, span / ladder), problem, x, T(start.t + span)) != StepStatus::ok)
          continue;
        const double error = distance(x, end) / size(end);
        if (error < 1e-17) break;
        points.push_back({span / ladder, error});
      }
      ASSERT_GE(points.size(), 5U) << label(scheme) << order;
      // The error depends on where in the last step the end lies, which differs from step length to step length: many
      // points average that out.
      const std::size_t first = points.size() > 10 ? points.size() - 10 : 0;
      double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
      for (std::size_t i = first; i < points.size(); ++i) {
        const double u = std::log(points[i].step), v = std::log(points[i].error);
        n += 1, sx += u, sy += v, sxx += u * u, sxy += u * v;
      }
      EXPECT_NEAR((n * sxy - sx * sy) / (n * sxx - sx * sx), order, 0.2)
          << label(scheme) << " order " << order << ", from " << points[first].error << " to " << points.back().error;
    });
  }
}

/// goes_and_returns() makes three steps of a kernel along the parameter and three back. Unlike turning the momentum
/// over, that returns damped motion, too.
template <class Kernel, class X>
void goes_and_returns(Kernel kernel, const X& start, double sigma, const std::string& what) {
  auto x = start;
  Work work;
  for (const double part : {sigma, sigma, sigma, -sigma, -sigma, -sigma}) {
    double elapsed = 0;
    ASSERT_EQ(kernel.move(x, part, elapsed, work), StepStatus::ok) << what;
    x.t += elapsed;
  }
  EXPECT_LT(distance(x, start) / size(start), 1e-13) << what;
  EXPECT_NEAR(x.t, start.t, 1e-13 * (1 + start.t)) << what;
}

/// Some steps, the momentum turned over, as many steps: schemes that say they are symmetric come back to the start.
/// Other schemes are not examined, because they may return at times: the hybrid does until it switches.
template <template <class> class P>
void symmetric_clocks_return() {
  if constexpr (Transforms<P<double>>) {
    const P<double> problem;
    const auto start = fast_state<P>();
    for_each_clock<P>([&](const auto& chosen, int) {
      const auto scheme = resized(chosen, problem, start, 0.1 * rhythm(problem, start));
      if (!scheme.card().symmetric) return;
      auto x = start;
      auto stepper = clocks::bound(scheme, problem, x);
      if constexpr (LinearContact<P<double>>) return goes_and_returns(stepper.kernel(), x, scheme.sigma, label(scheme));
      ASSERT_EQ(clocks::steps(stepper, x, 4), 4) << label(scheme);
      x = clocks::reversed(x);
      ASSERT_EQ(clocks::steps(stepper, x, 4), 4) << label(scheme);
      EXPECT_LT(distance(clocks::reversed(x), start) / size(start), 1e-13) << label(scheme);
    });
  }
}

}  // namespace laws
