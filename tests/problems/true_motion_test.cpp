// The series behind reference solutions against extrapolation in quad precision, which does not use tapes.
#include <gtest/gtest.h>

#include "core/reference/reference.hpp"

namespace least {
namespace {

/// Every rule of a tape, with arguments that change.
struct EveryRule {
  static constexpr int dim = 15;
  template <class T, class S>
  Vec<dim, T> field(const Vec<dim, T>& y, const S& t) const {
    using least::acos, least::asin, least::atan, least::cos, least::cosh, least::exp, least::log, least::pow,
        least::sin, least::sinh, least::sqrt, least::tan, least::tanh;
    const T u = 1.0 + y[0] * y[0];
    return {cos(y[1] + t),
            sin(y[0] - 2.0 * t) / 3.0,
            exp(-y[2]) * y[0],
            log(u + 1.0),
            tan(0.4 * y[0]),
            sinh(0.5 * y[1]) + y[5] / 7.0,
            cosh(0.3 * y[0]),
            tanh(y[1]) - y[7],
            atan(2.0 * y[0]),
            asin(0.3 * y[1]),
            acos(0.3 * y[0]),
            sqrt(u) - 1.0,
            pow(u, -1.3),
            y[3] / (u + y[1] * y[1]) + 1.0 / (1.0 + t),
            pow(1.0 + t, -0.5) * y[1] + y[0] * y[1]};
  }
};

TEST(TrueMotion, IsThatOfExtrapolationToTwentyFiveDigits) {
  const EveryRule problem;
  Point<15> start;
  for (std::size_t i = 0; i < 15; ++i) start[i] = 0.1 + 0.05 * static_cast<double>(i);
  tape::Tape tape;
  const auto rates = taylor::write_equations<Point<15>>(problem, tape);
  ASSERT_TRUE(TrueMotion::covers(tape));
  TrueMotion motion(std::move(tape), rates, fine_tolerance);
  motion.start(digits_of(taylor::values_of(convert<Quad, Quad>(start))), start.t);
  Extrapolation<EveryRule> other(problem, convert<Quad, Quad>(start), fine_tolerance);
  int steps = 0;
  for (const double t : {0.0, 1e-9, 0.3, 0.31, 1.0, 2.5}) {
    ASSERT_TRUE(other.advance(Quad(t), [] { return true; }));
    const auto x = motion.at(t, [&] { return ++steps < 100; });
    ASSERT_EQ(x.size(), 15U) << t;
    for (std::size_t i = 0; i < 15; ++i)
      EXPECT_LT(std::abs(static_cast<double>(Quad(x[i].high()) + Quad(x[i].low()) - other.state()[i])), 1e-25)
          << "rate " << i << ", t = " << t;
  }
  EXPECT_GT(steps, 3);
}

/// ẋ = x²: x₀/(1 − x₀t).
struct BlowUp {
  static constexpr int dim = 1;
  template <class T, class S>
  Vec<1, T> field(const Vec<1, T>& y, const S&) const {
    return {y[0] * y[0]};
  }
};
const auto always = [] { return true; };

// The unit of time adapts to the motion, so that neither coefficients of 1e±300 nor a singularity end it early.
TEST(TrueMotion, GoesOnAtEveryScaleAndEndsAtASingularity) {
  for (const double start : {1e-60, 1e-3, 1.0, 1e40}) {
    const Point<1> x0{0, {start}};
    const double end = 1 / start;
    const auto run = quad_precision_run(BlowUp{}, x0, {0.5 * end, 0.999 * end}, always);
    ASSERT_TRUE(run.complete) << start;
    EXPECT_NEAR(run.states[0][0] / start, 2, 1e-15);
    EXPECT_NEAR(run.states[1][0] / start, 1000, 1e-10) << start;
    EXPECT_FALSE(quad_precision_run(BlowUp{}, x0, {2 * end}, always).complete) << start;
  }
}

TEST(TrueMotion, KeepsNothingOfAnEarlierStart) {
  tape::Tape tape;
  const auto rates = taylor::write_equations<Point<1>>(BlowUp{}, tape);
  TrueMotion motion(std::move(tape), rates, fine_tolerance);
  for (const double x : {1.0, 0.5}) {
    motion.start({x}, 0);
    const auto there = motion.at(0.5, always);
    ASSERT_EQ(there.size(), 1U);
    EXPECT_LT(std::abs((there[0] * (DoubleDouble(1) - DoubleDouble(0.5 * x)) - DoubleDouble(x)).high()), 1e-25);
  }
}

/// Lorenz's equations: differences grow by e^0.9t, also that of the two runs that a reference compares.
struct Chaos {
  static constexpr int dim = 3;
  template <class T, class S>
  Vec<dim, T> field(const Vec<dim, T>& y, const S&) const {
    return {10.0 * (y[1] - y[0]), y[0] * (28.0 - y[2]) - y[1], y[0] * y[1] - 8.0 / 3.0 * y[2]};
  }
};

// The two runs advance together: the result is their distance, and the states of the finer one.
TEST(TrueMotion, TellsHowFarTwoRunsAreApart) {
  const Point<3> x0{0, {1, 1, 1}};
  std::vector<double> times;
  for (int i = 1; i <= 45; ++i) times.push_back(i);
  const auto run = quad_precision_run(Chaos{}, x0, times, always);
  ASSERT_TRUE(run.complete);
  ASSERT_EQ(run.states.size(), times.size());
  EXPECT_GT(run.uncertainty, 1e-14);
  EXPECT_LT(run.uncertainty, 1e-9);
  times.resize(20);
  const auto early = quad_precision_run(Chaos{}, x0, times, always);
  EXPECT_LT(early.uncertainty, 1e-15);
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_EQ(state_error(early.states[i], run.states[i]), 0) << times[i];
}

TEST(TrueMotion, GivesUpWhenTold) {
  int left = 3;
  EXPECT_FALSE(quad_precision_run(BlowUp{}, Point<1>{0, {1.0}}, {0.9999}, [&] { return --left > 0; }).complete);
  EXPECT_EQ(left, 0);
}

/// Forces that a series does not show: one that is switched on, and a later pulse, while all digits of the series at
/// the start are zero.
struct Late {
  static constexpr int dim = 1;
  template <class T, class S>
  Vec<1, T> field(const Vec<1, T>&, const S& t) const {
    using least::exp;
    using least::tanh;
    return {T(1.0 + tanh(20.0 * (t - 10.0)) + exp(-(t - 30.0) * (t - 30.0)))};
  }
};
/// A pulse at t = 20 that is over long before a step from rest ends.
struct Pulse {
  static constexpr int dim = 1;
  template <class T, class S>
  Vec<1, T> field(const Vec<1, T>&, const S& t) const {
    using least::exp;
    return {T(exp(-16.0 * ((t - 20.0) * (t - 20.0))))};
  }
};
struct Root {
  static constexpr int dim = 1;
  template <class T, class S>
  Vec<1, T> field(const Vec<1, T>&, const S& t) const {
    using least::sqrt;
    return {T(sqrt(t))};
  }
};
TEST(TrueMotion, IsHeldAgainstItsEquations) {
  const auto late = quad_precision_run(Late{}, Point<1>{0, {0.0}}, {9.0, 20.0, 40.0}, always);
  ASSERT_TRUE(late.complete);
  EXPECT_NEAR(late.states[0][0], 0, 1e-17);
  EXPECT_NEAR(late.states[1][0], 20, 1e-14);
  EXPECT_NEAR(late.states[2][0], 60 + std::sqrt(std::acos(-1.0)), 1e-13);
}
TEST(TrueMotion, IsLookedAtOnItsWay) {
  const auto run = quad_precision_run(Pulse{}, Point<1>{0, {0.0}}, {40.0}, always);
  ASSERT_TRUE(run.complete);
  EXPECT_NEAR(run.states[0][0], std::sqrt(std::acos(-1.0)) / 4, 1e-15);
}
TEST(TrueMotion, LeavesToOthersWhatHasNoSeries) {
  tape::Tape tape;
  const auto rates = taylor::write_equations<Point<1>>(Root{}, tape);
  TrueMotion motion(std::move(tape), rates, fine_tolerance);
  motion.start({0.0}, 0);
  EXPECT_EQ(motion.at(0, always).size(), 1U);
  EXPECT_TRUE(motion.at(1, always).empty());
  EXPECT_TRUE(motion.lost());
  const auto run = quad_precision_run(Root{}, Point<1>{0, {0.0}}, {0.0, 1.0}, always);
  EXPECT_FALSE(run.complete && std::abs(run.states.back()[0] - 2.0 / 3) > 1e-9);
  EXPECT_EQ(run.states.at(0)[0], 0);
}

/// A kink that the motion does not reach.
struct Kink {
  static constexpr int dim = 1;
  template <class T, class S>
  Vec<1, T> field(const Vec<1, T>& y, const S&) const {
    using least::abs;
    return {-abs(y[0])};
  }
};
TEST(TrueMotion, GoesOnBesideAKink) {
  const auto run = quad_precision_run(Kink{}, Point<1>{0, {1.0}}, {1.0}, always);
  ASSERT_TRUE(run.complete);
  EXPECT_NEAR(run.states[0][0], std::exp(-1.0), 1e-16);
  const auto other = extrapolated_run(Kink{}, Point<1>{0, {1.0}}, {1.0}, always);
  ASSERT_TRUE(other.complete);
  EXPECT_EQ(other.states[0][0], run.states[0][0]);
}

// Double-double numbers, with twice the digits of a double, which the tapes of references use.
TEST(DoubleDouble, RoundsAtItsHundredAndSixthBit) {
  const auto wide = [](const DoubleDouble& x) { return Quad(x.high()) + Quad(x.low()); };
  std::uint64_t bits = 1;
  const auto any = [&] {
    bits = bits * 6364136223846793005U + 1442695040888963407U;
    const double high = static_cast<double>(static_cast<std::int64_t>(bits)) * 0x1p-61;
    bits = bits * 6364136223846793005U + 1442695040888963407U;
    return DoubleDouble::ordered_sum(high,
                                     high * 0x1p-53 * static_cast<double>(static_cast<std::int64_t>(bits)) * 0x1p-63);
  };
  for (int i = 0; i < 2000; ++i) {
    const DoubleDouble a = any(), b = any();
    const Quad x = wide(a), y = wide(b);
    const auto off = [](const DoubleDouble& made, const Quad& truth, const Quad& scale) {
      return std::abs(static_cast<double>((Quad(made.high()) + Quad(made.low()) - truth) / scale));
    };
    EXPECT_LT(off(a + b, x + y, x + y), 0x1p-103);
    EXPECT_LT(off(a * b, x * y, x * y), 0x1p-102);
    EXPECT_LT(off(a / b, x / y, x / y), 0x1p-101);
    EXPECT_LE(std::abs((a * b).low()), std::abs((a * b).high()) * 0x1p-53);
  }
}

// Series of any length, as terms are taken in fours and the rest one by one.
TEST(DoubleDouble, ConvolvesToItsLastBits) {
  const auto wide = [](const DoubleDouble& x) { return Quad(x.high()) + Quad(x.low()); };
  std::vector<DoubleDouble> a, b;
  for (int i = 1; i <= 40; ++i) {
    a.push_back(DoubleDouble(i % 3 - 1.5) / DoubleDouble(i));
    b.push_back(DoubleDouble(2 - i % 5) / DoubleDouble(3 * i - 1));
  }
  for (std::size_t k = 0; k < a.size(); ++k)
    for (std::size_t first = 0; first <= std::min<std::size_t>(k, 2); ++first) {
      Quad sum = 0, size = 0;
      for (std::size_t j = first; j <= k; ++j) {
        const Quad term = wide(a[j]) * wide(b[k - j]);
        sum += term;
        size += abs(term);
      }
      const Quad off = wide(convolve(a.data(), b.data(), k, first, k)) - sum;
      EXPECT_LE(std::abs(static_cast<double>(off)), 0x1p-101 * static_cast<double>(size)) << k << " from " << first;
    }
}

}  // namespace
}  // namespace least
