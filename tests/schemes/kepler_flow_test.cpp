// The Kepler flow that kepler_splitting uses for its drifts: against the closed form of conic sections, and against the
// same algorithm in more digits.
#include "core/exact/kepler_flow.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/exact/two_body.hpp"

namespace {

using namespace least;
using Long = long double;

struct Motion {
  std::array<double, 2> q, v;
};

Motion moved(const Motion& from, double mu, double dt) {
  const auto& [q, v] = from;
  const auto c = two_body::kepler_change(dot(q, q), dot(q, v), dot(v, v), mu, dt);
  Motion to = from;
  for (std::size_t i = 0; i < 2; ++i) {
    to.q[i] += c.f * q[i] + c.g * v[i];
    to.v[i] += c.df * q[i] + c.dg * v[i];
  }
  return to;
}

/// Conic gives position and velocity on a conic section with periapsis 1 about μ = 1, at a time after the periapsis.
struct Conic {
  Long e;

  std::array<Long, 4> at(Long t) const {
    const Long a = 1 / std::abs(1 - e), mean = t / (a * std::sqrt(a)), b = std::sqrt(std::abs(1 - e * e)) * a;
    const bool bound = e < 1;
    const auto late = [&](Long x) { return bound ? x - e * std::sin(x) - mean : e * std::sinh(x) - x - mean; };
    Long low = bound ? mean - 1.1L : -1, high = bound ? mean + 1.1L : 1;
    while (late(low) > 0) low *= 2;
    while (late(high) < 0) high *= 2;
    for (int k = 0; k < 200; ++k) (late((low + high) / 2) < 0 ? low : high) = (low + high) / 2;
    const Long x = low, c = bound ? std::cos(x) : std::cosh(x), s = bound ? std::sin(x) : std::sinh(x);
    const Long rate = 1 / (a * std::sqrt(a) * (bound ? 1 - e * c : e * c - 1));
    return bound ? std::array{a * (c - e), b * s, -a * s * rate, b * c * rate}
                 : std::array{a * (e - c), b * s, -a * s * rate, b * c * rate};
  }
};

double off(const Motion& found, const std::array<Long, 4>& true_one) {
  const Long place = std::hypot(true_one[0], true_one[1]), speed = std::hypot(true_one[2], true_one[3]);
  return double(std::max(std::hypot(found.q[0] - true_one[0], found.q[1] - true_one[1]) / std::max(place, 1.0L),
                         std::hypot(found.v[0] - true_one[2], found.v[1] - true_one[3]) / std::max(speed, 1.0L)));
}

// A rounding error of the start changes the mean motion by a relative (1 + e)/|1 − e|, which grows with time; for a
// start far away it changes the position at the passage in proportion to the distance.
TEST(KeplerFlow, IsTheClosedForm) {
  for (const double e : {0.0, 0.01, 0.3, 0.6, 0.9, 0.99, 0.999, 1.001, 1.1, 2.0, 30.0})
    for (const double from : {-2.0, 0.0, 0.5, 30.0})
      for (const double dt : {1e-9, 0.01, 0.3, 1.0, 5.0, 100.0, 1e4}) {
        const Conic conic{e};
        const auto start = conic.at(from);
        const double sensitive = (1 + e) / std::abs(1 - e),
                     mean = (std::abs(from) + dt) * std::pow(std::abs(1 - e), 1.5);
        const double most = 1e-15 * (4 + sensitive * (1 + (e < 1 ? mean : 0.0)) + (e > 1 ? e * std::abs(from) : 0.0));
        for (const double time : {dt, -dt}) {
          const Motion found =
              moved({{double(start[0]), double(start[1])}, {double(start[2]), double(start[3])}}, 1, time);
          const double wrong = off(found, conic.at(from + time));
          EXPECT_LT(wrong, 4 * most) << "e " << e << ", from " << from << " by " << time;
        }
      }
}

TEST(KeplerFlow, OfNearlyParabolicOrbitsIsTheSameInMoreDigits) {
  for (const double more : {-1e-3, -1e-6, -1e-9, -1e-12, -1e-16, 0.0, 1e-12, 1e-9, 1e-6, 1e-3})
    for (const double dt : {1e-3, 0.5, 3.0, 40.0, 2000.0, -0.5, -40.0}) {
      const Motion start{{0.8, 0.6}, {-0.6 * std::sqrt(2 + more), 0.8 * std::sqrt(2 + more)}};
      State<2, Long, Long> x;
      x.t = 0;
      const Long sign = dt < 0 ? -1 : 1;  // the reference goes forward, so that periods do not matter
      for (std::size_t i = 0; i < 2; ++i) x.q[i] = start.q[i], x.p[i] = sign * start.v[i];
      const auto end = two_body::propagate(x, 1.0L, sign * dt);
      EXPECT_LT(off(moved(start, 1, dt), {end.q[0], end.q[1], sign * end.p[0], sign * end.p[1]}), 1e-14)
          << more << " by " << dt;
    }
}

TEST(KeplerFlow, ComesBackAndKeepsAreas) {
  for (const double e : {0.0, 0.5, 0.95, 1.0, 1.5})
    for (const double dt : {1e-5, 0.2, 2.0, 20.0}) {
      const Motion start{{1, 0}, {0, std::sqrt(1 + e)}}, there = moved(start, 1, dt), back = moved(there, 1, -dt);
      const auto& [q, v] = start;
      const auto c = two_body::kepler_change(dot(q, q), dot(q, v), dot(v, v), 1, dt);
      EXPECT_NEAR((1 + c.f) * (1 + c.dg) - c.g * c.df, 1, 1e-13 * (1 + dt)) << e << " by " << dt;
      for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_NEAR(back.q[i], q[i], 1e-13 * (1 + dt)) << e << " by " << dt;
        EXPECT_NEAR(back.v[i], v[i], 1e-13 * (1 + dt)) << e << " by " << dt;
      }
    }
}

// A change of 1e-9 of the state has all its digits; the new state less the old one would have seven.
TEST(KeplerFlow, OfShortTimesIsAChange) {
  const Motion start{{1, 0}, {0, 1.1}};
  const auto c = two_body::kepler_change(dot(start.q, start.q), 0, dot(start.v, start.v), 1, 1e-9);
  EXPECT_NEAR(c.f, -0.5e-18, 1e-32);
  EXPECT_NEAR(c.df, -1e-9, 1e-23);
  EXPECT_NEAR(c.dg, -0.5e-18, 1e-32);
  EXPECT_EQ(c.g, 1e-9);
}

TEST(KeplerFlow, OfAThousandTurnsOneByOneKeepsTheOrbit) {
  for (const double e : {0.05, 0.6, 0.95})
    for (const double dt : {0.1, 0.7, 1.9}) {
      Motion x{{1 - e, 0}, {0, std::sqrt((1 + e) / (1 - e))}};
      const auto turns = int(1000 * 2 * std::numbers::pi / dt);
      for (int k = 0; k < turns; ++k) x = moved(x, 1, dt);
      const double energy = dot(x.v, x.v) / 2 - 1 / std::sqrt(dot(x.q, x.q));
      EXPECT_NEAR(energy, -0.5, 2e-13 / (1 - e)) << e << " by " << dt;
    }
}

TEST(KeplerFlow, GoesOnWhereverItStarts) {
  const double great = 1e12, small = 1e-12;
  for (const double dt : {small, 1.0, great, -great})
    for (const Motion& start :
         {Motion{{1, 0}, {0, 0}}, Motion{{1, 0}, {-1, 0}}, Motion{{1, 0}, {-1, 1e-9}}, Motion{{great, 0}, {0, small}},
          Motion{{small, 0}, {0, great}}, Motion{{1, 1}, {great, -great}}, Motion{{1, 0}, {0, 1e-200}}})
      for (const double mu : {1.0, -1.0, small, great}) {
        const Motion end = moved(start, mu, dt);
        EXPECT_TRUE(std::isfinite(end.q[0] + end.q[1] + end.v[0] + end.v[1]))
            << start.q[0] << " " << start.v[0] << " " << start.v[1] << ", mu " << mu << " by " << dt;
      }
  const auto at_the_centre = two_body::kepler_change(0, 0, 1, 1, 1);
  EXPECT_FALSE(std::isfinite(at_the_centre.f + at_the_centre.df));
}

TEST(KeplerFlow, ADualNumberHasItsDerivatives) {
  using D = Dual<double, 1>;
  for (const double e : {0.2, 0.9, 1.0, 1.4})
    for (const double dt : {0.1, 1.3, 30.0, -30.0})
      for (int which = 0; which < 3; ++which) {
        const std::array<double, 3> at{1.1, 0.2, 1 + e};
        const auto with = [&](double more) {
          auto x = at;
          x[std::size_t(which)] += more;
          return two_body::kepler_change(x[0], x[1], x[2], 1, dt);
        };
        std::array<D, 3> x{at[0], at[1], at[2]};
        x[std::size_t(which)].slope[0] = 1;
        const auto found = two_body::kepler_change(x[0], x[1], x[2], 1, dt);
        const double d = 1e-5;
        const auto near = with(d), before = with(-d), here = with(0);
        const auto agree = [&](const D& made, double value, double high, double low) {
          EXPECT_NEAR(made.value, value, 1e-11 * (1 + std::abs(value)));
          const double slope = (high - low) / (2 * d);
          EXPECT_NEAR(made.slope[0], slope, 1e-5 * (1 + std::abs(slope)) * (1 + dt * dt)) << e << " by " << dt;
        };
        agree(found.f, here.f, near.f, before.f);
        agree(found.g, here.g, near.g, before.g);
        agree(found.df, here.df, near.df, before.df);
        agree(found.dg, here.dg, near.dg, before.dg);
      }
}

}  // namespace
