// Sine and cosine of lanes against those of the C library in extended precision.
#define LEAST_LANE_BYTES 16
#define least least_of_lanes  // so that the linker shares nothing of this with other files
#include "core/number/lanes.hpp"
#undef least

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace {

using least_of_lanes::Lanes;

constexpr double most = 3e6;

/// ulps() returns the error in units in the last place of the right value; of the difference, `grain` is allowed for
/// free.
double ulps(double found, long double right, long double grain) {
  const long double unit = std::ldexp(1.0L, std::ilogb(right) - 52);
  return static_cast<double>(std::max(std::abs(found - right) - grain, 0.0L) / unit);
}

/// arguments() returns arguments of all sizes; at every third either sine or cosine is almost zero.
std::vector<double> arguments() {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> exponent(-8, std::log10(most)), sign(-1, 1);
  std::vector<double> all;
  for (int i = 0; i < 300'000; ++i) {
    double x = std::copysign(std::pow(10, exponent(random)), sign(random));
    if (i % 3 == 0) x = std::nearbyint(x / (std::numbers::pi / 2)) * (std::numbers::pi / 2);
    if (std::abs(x) < most) all.push_back(x);
  }
  return all;
}

TEST(LaneSine, IsRight) {
  double sine = 0;
  long double cosine = 0;
  for (const double x : arguments()) {
    const long double s = std::sin(static_cast<long double>(x)), c = std::cos(static_cast<long double>(x));
    if (s != 0) sine = std::max(sine, ulps(sin(Lanes(x))[0], s, 2e-20L));
    cosine = std::max(cosine, std::abs(cos(Lanes(x))[0] - c));
    EXPECT_EQ(sincos(Lanes(x)).first[1], sin(Lanes(x))[0]);
    EXPECT_EQ(sincos(Lanes(x)).second[1], cos(Lanes(x))[0]);
  }
  EXPECT_LT(sine, 2.5);
  EXPECT_LT(cosine, 3e-16);
  EXPECT_GT(std::min<long double>(sine, cosine), 1e-17);  // both were measured
}

/// √(1 − s²) has to be real.
TEST(LaneSine, IsNeverMoreThanOne) {
  for (const double quarter : {-0.5, 0.5, 1.5, 20.5}) {
    double x = quarter * std::numbers::pi - 1e-6;
    for (int i = 0; i < 100'000; ++i, x += 2e-11) {
      ASSERT_LE(std::abs(sin(Lanes(x))[0]), 1) << x;
      ASSERT_LE(std::abs(cos(Lanes(x - std::numbers::pi / 2))[0]), 1) << x;
    }
  }
}

TEST(LaneSine, OfAnySizeIsThatOfTheLibrary) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double x : {most, 1e7, -3e12, 1e300})
    EXPECT_LT(ulps(sin(Lanes(x))[0], std::sin(static_cast<long double>(x)), 0), 3.5) << x;
  for (const double x : {infinity, -infinity, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_TRUE(std::isnan(sin(Lanes(x))[1])) << x;
    EXPECT_TRUE(std::isnan(cos(Lanes(x))[1])) << x;
    EXPECT_TRUE(std::isnan(sincos(Lanes(x)).second[1])) << x;
  }
  EXPECT_EQ(sin(Lanes(0))[0], 0);
  EXPECT_EQ(cos(Lanes(0))[0], 1);
}

TEST(LaneSine, DoesNotDependOnOtherLanes) {
  for (const double other : {0.5, 1e10, std::numeric_limits<double>::quiet_NaN()})
    for (double x = 0.7; x < 1e9; x *= 1.1) {
      Lanes pair(x);
      pair[1] = other;
      EXPECT_EQ(sin(pair)[0], sin(Lanes(x))[0]) << x << ' ' << other;
      EXPECT_EQ(cos(pair)[0], cos(Lanes(x))[0]) << x << ' ' << other;
      EXPECT_EQ(sincos(pair).second[0], sincos(Lanes(x)).second[0]) << x << ' ' << other;
    }
}

}  // namespace
