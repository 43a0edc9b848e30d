// The true motion of equations whose formulas change on the way: |x|, sign(x), if(…).
#include <gtest/gtest.h>

#include <numbers>

#include "core/reference/reference.hpp"

namespace least {
namespace {

const auto to_the_end = [] { return true; };

/// A ball in V = |x| + x²/2: cosines about −1 and about 1, by turns.
struct BetweenSlopes {
  static constexpr int dim = 2;
  template <class T, class S>
  Vec<2, T> field(const Vec<2, T>& y, const S&) const {
    using least::select;
    return {y[1], select(y[0] < T(0), T(1), T(-1)) - y[0]};
  }
};

Quad whole_turn() { return acos(Quad(-1)) * Quad(2); }

/// From x = 1 at rest: x + 1 = 2 cos t until t = π/3, and its mirror image from there until t = π; the period is 4π/3.
Quad between_slopes(double t) {
  const Quad third = whole_turn() / Quad(6), period = Quad(4) * third;
  Quad phase(t);
  while (!(phase < period)) phase = phase - period;
  if (phase < third) return Quad(2) * cos(phase) - Quad(1);
  if (phase < Quad(3) * third) return Quad(1) - Quad(2) * cos(phase - Quad(2) * third);
  return Quad(2) * cos(phase - period) - Quad(1);
}

TEST(SwitchingMotion, IsKnownToTwentyFiveDigitsOverManyKinks) {
  tape::Tape tape;
  const BetweenSlopes problem;
  const Point<2> start{0, {1, 0}};
  const auto rates = taylor::write_equations<Point<2>>(problem, tape);
  ASSERT_TRUE(TrueMotion::covers(tape));
  TrueMotion motion(std::move(tape), rates, fine_tolerance);
  motion.start(digits_of(taylor::values_of(convert<Quad, Quad>(start))), 0);
  int steps = 0;
  for (const double t : {0.5, 1.0471975511965976, 1.5, 3.0, 10.0, 100.0}) {
    const auto x = motion.at(t, [&] { return ++steps < 3000; });
    ASSERT_EQ(x.size(), 2U) << t;
    EXPECT_LT(std::abs(static_cast<double>(Quad(x[0].high()) + Quad(x[0].low()) - between_slopes(t))), 1e-24) << t;
  }
}

TEST(SwitchingMotion, IsTheReference) {
  std::vector<double> times;
  for (int i = 1; i <= 300; ++i) times.push_back(i);
  const auto run = quad_precision_run(BetweenSlopes{}, Point<2>{0, {1, 0}}, times, to_the_end);
  ASSERT_TRUE(run.complete);
  EXPECT_LT(run.uncertainty, 2e-16);
  for (std::size_t i = 0; i < times.size(); ++i)
    EXPECT_NEAR(run.states[i][0], static_cast<double>(between_slopes(times[i])), 4e-16) << times[i];
}

/// ẍ = 1 − x with a wall below 0, which x = 1 + cos t touches again and again without crossing it.
struct Touching {
  static constexpr int dim = 2;
  template <class T, class S>
  Vec<2, T> field(const Vec<2, T>& y, const S&) const {
    using least::select;
    return {y[1], 1.0 - y[0] + select(y[0] < T(0), T(100), T(0))};
  }
};

TEST(SwitchingMotion, StaysOnItsSideWhereItOnlyTouches) {
  const auto run = quad_precision_run(Touching{}, Point<2>{0, {2, 0}}, {3, 4, 50}, to_the_end);
  ASSERT_TRUE(run.complete);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(run.states[i][0], 1 + std::cos(run.states[i].t), 1e-15);
}

// The motion may go to either side from there.
TEST(SwitchingMotion, MayBeginOnABorder) {
  for (const double v : {1.0, -1.0}) {
    const auto run = quad_precision_run(BetweenSlopes{}, Point<2>{0, {0, v}}, {0.25}, to_the_end);
    ASSERT_TRUE(run.complete);
    EXPECT_NEAR(run.states[0][0], v * (std::cos(0.25) + std::sin(0.25) - 1), 4e-16) << v;
  }
}

/// A mass on a spring with dry friction, which takes 0.6 from each half swing: from 1 to −0.4 to 0.2, where it stays.
struct DryFriction {
  static constexpr int dim = 2;
  template <class T, class S>
  Vec<2, T> field(const Vec<2, T>& y, const S&) const {
    using least::select;
    const T sign = select(y[1] < T(0), T(-1), select(T(0) < y[1], T(1), T(0)));
    return {y[1], -1.0 * y[0] - 0.3 * sign};
  }
};

TEST(SwitchingMotion, EndsWhereFrictionHolds) {
  const Point<2> start{0, {1, 0}};
  const auto run = quad_precision_run(DryFriction{}, start, {3, 6}, to_the_end);
  ASSERT_TRUE(run.complete);
  EXPECT_NEAR(run.states[0][0], 0.3 + 0.7 * std::cos(3), 1e-15);
  EXPECT_NEAR(run.states[1][0], -0.3 - 0.1 * std::cos(6 - std::numbers::pi), 1e-15);
  const auto held = quad_precision_run(DryFriction{}, start, {3, 7}, to_the_end);
  EXPECT_FALSE(held.complete);
  EXPECT_EQ(held.states.size(), 1U);
  EXPECT_EQ(held.missing, missing::no_motion);
}

/// A force that ends at q = 0 as q^1.5 does, which has no series there.
struct EndsAsARoot {
  static constexpr int dim = 2;
  template <class T, class S>
  Vec<2, T> field(const Vec<2, T>& y, const S&) const {
    using least::abs, least::pow, least::select;
    return {y[1], select(y[0] < T(0), T(0), -1.0 * pow(abs(y[0]), 1.5))};
  }
};

// From q = 0 on the motion is straight, with the speed that its energy v²/2 + q^2.5/2.5 gives it.
TEST(SwitchingMotion, IsLeftToOthersWhereNoSeriesLeadsOn) {
  const auto run = quad_precision_run(EndsAsARoot{}, Point<2>{0, {1, 0}}, {1, 3, 4}, to_the_end);
  ASSERT_TRUE(run.complete);
  EXPECT_NEAR(run.states[1][1], -std::sqrt(0.8), 1e-12);
  EXPECT_NEAR(run.states[2][0] - run.states[1][0], -std::sqrt(0.8), 1e-12);
}

}  // namespace
}  // namespace least
