// Laws of a scheme on a problem: order, reversal, identity.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/laws/scene.hpp"

namespace laws {

struct Measured {
  double step, error;
};

/// convergence() returns the errors at the end of the span on a ladder of steps, down to the round-off floor of the
/// number T or the end of the work allowed (in force evaluations).
template <class T, class P, class Scheme, class X, class Y>
std::vector<Measured> convergence(const P& problem, const Scheme& scheme, const X& start, const Y& end, double floor,
                                  double work_allowed) {
  const auto truth = convert<T, T>(end);
  std::vector<Measured> points;
  double work = 0;
  for (double ladder = 6; work < work_allowed; ladder *= 1.35) {
    const int n = static_cast<int>(ladder);
    auto x = convert<T, T>(start);
    const T h = (truth.t - x.t) / n;
    auto stepper = scheme.bind(problem, x);
    StepStatus status = StepStatus::ok;
    for (int k = 0; k < n && status == StepStatus::ok; ++k) {
      status = stepper.step(x, h);
      x.t = T(start.t) + T(k + 1) * h;
    }
    work += static_cast<double>(stepper.work().forces);
    if (status != StepStatus::ok) continue;  // the step is too long for the implicit solver
    const double error = distance(x, truth) / size(truth);
    if (error < floor) break;
    if (error < 3e-2) points.push_back({static_cast<double>(h), error});
  }
  return points;
}

/// The order is as declared, ±0.1: the slope of log error against log step over at least three points between the
/// asymptotic range of truncation and round-off. From order 8 on long double leaves too little room for that; these
/// orders are measured in quad.
template <template <class> class P>
void order_is_as_declared() {
  const P<double> problem;
  auto start = default_start<P>();
  if (HasSeries<P<double>>) start = states<P>()[0];  // at a singular time orders fall
  // The span is short against the default one, and not much longer than the time in which the motion changes by its own
  // size.
  const auto rate = derivative(problem, start);
  const double span = std::min(
      {About<P>::card().span / 8, 1.5 * size(start) / distance(rate, decltype(start){}), 6 * rhythm(problem, start)});
  Orbit<P> truth(problem, convert<Quad, Quad>(start), 1e-28);
  ASSERT_TRUE(truth.advance(Quad(start.t + span), [] { return true; }));

  for_each_scheme<P>([&](const auto& scheme) {
    // A damping factor that is rounded once is wrong by the same amount in every step: many steps raise the floor.
    const double floor = order(scheme) < 6 ? 2e-14 : 3e-16;
    const auto points = [&] {
      if constexpr (requires { scheme.composition; })
        if (order(scheme) >= 8) {
          // A slope is its order within a tenth only below such errors.
          const double asymptotic = order(scheme) == 8 ? 1e-18 : 1e-21;
          return convergence<Quad>(problem, scheme, start, truth.state(), asymptotic, 60'000);
        }
      return convergence<long double>(problem, scheme, start, truth.state(), floor, 12'000);
    }();
    ASSERT_GE(points.size(), 3U) << label(scheme) << ": the order could not be measured";
    // The finest points: three, or more where more lie within a factor 2.5 in step.
    std::size_t first = points.size() - 3;
    while (first > 0 && points[first - 1].step < 2.5 * points.back().step) --first;
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (std::size_t i = first; i < points.size(); ++i) {
      const double u = std::log(points[i].step), v = std::log(points[i].error);
      n += 1, sx += u, sy += v, sxx += u * u, sxy += u * v;
    }
    const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
    EXPECT_NEAR(slope, order(scheme), 0.1) << label(scheme) << ", finest error " << points.back().error;
  });
}

/// step(h) then step(−h) comes back for the schemes that say they are symmetric, and for no other.
template <template <class> class P>
void symmetric_schemes_return() {
  const P<double> problem;
  const double h = coarse_step<P>();
  for_each_scheme<P>([&](const auto& scheme) {
    double most = 0;
    const bool symmetric = scheme.card().symmetric;
    // Where the damping is weak, only longer steps show that a scheme is not symmetric.
    for (const double step : symmetric ? std::vector{h} : std::vector{h, 4 * h, 16 * h})
      for (const auto& start : states<P>()) {
        auto x = start;
        auto there = scheme.bind(problem, x);
        const bool went = there.step(x, step) == StepStatus::ok;
        x.t += step;
        auto back = scheme.bind(problem, x);
        const bool returned = went && back.step(x, -step) == StepStatus::ok;
        ASSERT_TRUE(returned || step > h) << label(scheme);
        if (returned) most = std::max(most, distance(x, start) / size(start));
      }
    if (symmetric) {
      EXPECT_LT(most, 1e-13) << label(scheme);
    } else {
      EXPECT_GT(most, 1e-12) << label(scheme) << " returns but does not say that it is symmetric";
    }
  });
}

template <template <class> class P>
void no_step_is_the_identity() {
  const P<double> problem;
  for_each_scheme<P>([&](const auto& scheme) {
    for (const auto& start : states<P>()) {
      auto x = start;
      auto stepper = scheme.bind(problem, x);
      ASSERT_EQ(stepper.step(x, 0.0), StepStatus::ok) << label(scheme);
      EXPECT_EQ(x, start) << label(scheme);
    }
  });
}

}  // namespace laws
