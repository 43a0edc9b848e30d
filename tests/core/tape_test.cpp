// Tapes and their Taylor series: every rule against Cauchy's integral of the same formula in complex numbers, which
// shares no code with the rules.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include "core/tape/series.hpp"
#include "core/tape/symbol.hpp"
#include "core/tape/unrolled.hpp"

namespace {

using least::Symbol;
using least::tape::Program;
using least::tape::Series;
using least::tape::Tape;

using Complex = std::complex<double>;
constexpr int highest = 20;

/// by_cauchy() returns the Taylor coefficients of f at 0 from its values on a circle of this radius.
template <class F>
std::vector<double> by_cauchy(F&& f, double radius) {
  constexpr int points = 128;
  std::vector<Complex> values;
  const double turn = 2 * std::acos(-1.0);
  for (int j = 0; j < points; ++j) values.push_back(f(std::polar(radius, turn * j / points)));
  std::vector<double> found;
  for (int k = 0; k < highest; ++k) {
    Complex sum = 0;
    for (int j = 0; j < points; ++j) sum += values[std::size_t(j)] * std::polar(1.0, -turn * (j * k % points) / points);
    found.push_back(sum.real() / points / std::pow(radius, k));
  }
  return found;
}

/// by_rules() returns the Taylor coefficients of f(x), with ẋ = x from x₀, or x = x₀ + slope t where `linear`.
template <class F>
std::vector<double> by_rules(F&& f, double start, double slope, bool linear) {
  Tape tape;
  const Symbol x = Symbol::variable(tape, 0), y = Symbol::variable(tape, 1);
  const Symbol u = linear ? start + slope * Symbol::time(tape) : x;
  const std::vector<least::tape::Index> rates{x.on(tape), (f(u) + 0.0 * y).on(tape)};
  Series series(Program(tape, rates, 2), highest);
  const double at[] = {start, 0};
  series.expand(at, 0);
  std::vector<double> found;
  for (int k = 0; k < highest; ++k) found.push_back(series.coefficients(k + 1)[1] * (k + 1));
  return found;
}

/// holds() compares both at points between `low` and `high`, where f and its argument have no singularity nearer than
/// twice `radius`.
template <class F>
void holds(const char* what, F&& f, double low, double high, double radius) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(low, high), speed(0.5, 1);
  for (int trial = 0; trial < 20; ++trial) {
    const double start = place(random), slope = speed(random);
    for (const bool linear : {false, true}) {
      const auto found = by_rules(f, start, slope, linear);
      const auto truth =
          by_cauchy([&](const Complex& t) { return f(linear ? start + slope * t : start * std::exp(t)); }, radius);
      double scale = 0;
      for (int k = 0; k < highest; ++k) scale = std::max(scale, std::abs(truth[std::size_t(k)]) * std::pow(radius, k));
      for (int k = 0; k < highest; ++k)
        EXPECT_LT(std::abs(found[std::size_t(k)] - truth[std::size_t(k)]) * std::pow(radius, k), 2e-14 * scale)
            << what << (linear ? " of t" : "") << " at " << start << ", order " << k;
    }
  }
}

TEST(Tape, SumsAndProductsHaveTheirSeries) {
  holds(
      "(1 - 2x) x + 3", [](const auto& x) { return (1.0 - 2.0 * x) * x + 3.0; }, 0.5, 1.5, 0.3);
  holds(
      "x/(1 + x^2)", [](const auto& x) { return x / (1.0 + x * x); }, 0.5, 1.5, 0.2);
  holds(
      "2/x", [](const auto& x) { return 2.0 / x; }, 0.8, 1.5, 0.2);
  holds(
      "(x/x^2) (x - 3)/x", [](const auto& x) { return x / (x * x) * ((x - 3.0) / x); }, 0.8, 1.5, 0.2);
}

TEST(Tape, PowersHaveTheirSeries) {
  holds(
      "sqrt", [](const auto& x) { return sqrt(x); }, 0.8, 2, 0.2);
  holds(
      "sqrt of a sum", [](const auto& x) { return sqrt(1.0 + 4.0 * x); }, 0.8, 2, 0.2);
  for (const double p : {-1.5, -0.5, 0.3, 1.5, 2.5, -2.0, 3.0, 7.0})
    holds(
        "power", [p](const auto& x) { return pow(x, p); }, 0.8, 1.5, 0.2);
  holds(
      "scaled power", [](const auto& x) { return pow(3.0 * x, -1.5); }, 0.8, 1.5, 0.2);
  holds(
      "u sqrt u", [](const auto& x) { return 2.0 / ((x + 1.0) * sqrt(x + 1.0)) * x; }, 0.8, 1.5, 0.2);
}

TEST(Tape, FunctionsHaveTheirSeries) {
  holds(
      "exp", [](const auto& x) { return exp(-0.5 * x); }, -1, 1, 1.2);
  holds(
      "log", [](const auto& x) { return log(2.0 * x); }, 0.8, 2, 0.2);
  holds(
      "sin", [](const auto& x) { return sin(2.0 * x); }, -2, 2, 1.2);
  holds(
      "cos", [](const auto& x) { return cos(x - 0.3) * x; }, -2, 2, 1.2);
  holds(
      "tan", [](const auto& x) { return tan(0.5 * x); }, -1, 1, 0.3);
  holds(
      "sinh", [](const auto& x) { return sinh(x); }, -1, 1, 1.2);
  holds(
      "cosh", [](const auto& x) { return cosh(1.5 * x); }, -1, 1, 1.2);
  holds(
      "tanh", [](const auto& x) { return tanh(x); }, -1, 1, 0.3);
  holds(
      "atan", [](const auto& x) { return atan(x); }, -0.8, 0.8, 0.2);
  holds(
      "asin", [](const auto& x) { return asin(0.5 * x); }, -0.8, 0.8, 0.2);
  holds(
      "acos", [](const auto& x) { return acos(0.5 * x); }, -0.8, 0.8, 0.2);
  holds(
      "x^x", [](const auto& x) { return pow(x, x); }, 0.8, 1.5, 0.2);
}

/// The series is that of the branch that applies on either side of a change of sign.
TEST(Tape, ChoicesAreMadeByTheSign) {
  const auto f = [](const auto& x) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(x)>, Symbol>) {
      return x * abs(x - 1.0);
    } else {
      return x.real() < 1 ? x * (1.0 - x) : x * (x - 1.0);
    }
  };
  holds("x |x - 1|, above", f, 1.6, 2, 0.2);
  holds("x |x - 1|, below", f, -0.6, 0.6, 0.2);
}

std::size_t size_of(const Tape& tape) { return std::size_t(tape.size()); }

TEST(Tape, NothingIsWrittenTwiceAndConstantsAreNot) {
  Tape tape;
  const Symbol x = Symbol::variable(tape, 0), t = Symbol::time(tape);
  const std::size_t before = size_of(tape);
  EXPECT_EQ((0.0 * x).constant(), 0);
  EXPECT_EQ((1.0 * x + 0.0).on(tape), x.on(tape));
  EXPECT_EQ((Symbol(2) * Symbol(3)).constant(), 6);
  EXPECT_EQ(size_of(tape), before);
  EXPECT_EQ((x + -x).constant(), 0);
  EXPECT_EQ((t + -2.0 * x).on(tape), (t - 2.0 * x).on(tape));
  EXPECT_EQ((t - -2.0 * x).on(tape), (t + 2.0 * x).on(tape));
  const std::size_t then = size_of(tape);
  EXPECT_EQ((x * t).on(tape), (x * t).on(tape));
  EXPECT_EQ(size_of(tape), then + 1);
}

/// u √u is one power, and so is its inverse: Kepler's force needs two lanes for it and four products.
TEST(Tape, KeplersForceIsShort) {
  Tape tape;
  const Symbol x = Symbol::variable(tape, 0), y = Symbol::variable(tape, 1), u = Symbol::variable(tape, 2),
               v = Symbol::variable(tape, 3), r2 = x * x + y * y, w = 1.0 / (r2 * sqrt(r2));
  const std::vector<least::tape::Index> rates{u.on(tape), v.on(tape), (-(w * x)).on(tape), (-(w * y)).on(tape)};
  const Program program(tape, rates, 4);
  EXPECT_EQ(program.lane_a.size(), 6U);
  EXPECT_EQ(program.steps.size(), 4U);
}

/// Sums of harmonics need no products: the addition theorem applies.
TEST(Tape, HarmonicsOfTimeHaveNoLanes) {
  Tape tape;
  const Symbol t = Symbol::time(tape);
  const auto [s1, c1] = sincos(2.0 * t);
  Symbol s = s1, c = c1, sum = s;
  for (int k = 1; k < 5; ++k) {
    const Symbol next = s * c1 + c * s1;
    c = c * c1 - s * s1;
    s = next;
    sum = sum + s + 0.5 * c;
  }
  const std::vector<least::tape::Index> rates{sum.on(tape)};
  Program program(tape, rates, 1);
  EXPECT_EQ(program.lane_a.size(), 0U);
  EXPECT_TRUE(program.whole);
  Series series(program, 12);
  const double zero = 0;
  series.expand(&zero, 0.3);
  double truth = 0;
  for (int k = 1; k <= 5; ++k) truth += std::sin(2 * k * 0.3) + (k > 1 ? 0.5 * std::cos(2 * k * 0.3) : 0);
  EXPECT_NEAR(series.coefficients(1)[0], truth, 1e-14);
}

/// A compiler may evaluate the operands of a sum in either order.
TEST(Tape, ProgramsDoNotDependOnWhatWasWrittenFirst) {
  const auto structure = [](bool backwards) {
    Tape tape;
    const Symbol x = Symbol::variable(tape, 0), y = Symbol::variable(tape, 1);
    if (backwards) sin(y) * exp(x * y) + y / x;
    const Symbol f = x * x + y / x, g = f * exp(x * y) + sin(y);
    const std::vector<least::tape::Index> rates{f.on(tape), g.on(tape)};
    std::vector<least::tape::Index> all;
    least::tape::read_structure(Program(tape, rates, 2), [&](least::tape::Index n) {
      all.push_back(n);
      return true;
    });
    return all;
  };
  EXPECT_EQ(structure(false), structure(true));
}

/// Quantities that are computed beside a motion do not change a bit of it.
TEST(Tape, WhatIsCarriedChangesNothing) {
  const auto coefficients = [](bool more) {
    Tape tape;
    const Symbol x = Symbol::variable(tape, 0), v = Symbol::variable(tape, 1), w = (1.0 - x * x) * v + sin(x) * x;
    std::vector<least::tape::Index> rates{v.on(tape), (w - x).on(tape)};
    if (more) rates.push_back((exp(w) * (1.0 - x * x) + cos(x) / v + x * x + w * w).on(tape));
    Series series(Program(tape, rates, 2), highest);
    const double at[] = {0.3, 0.7, 0.1};
    series.expand(at, 0);
    std::vector<double> all;
    for (int k = 0; k <= highest; ++k)
      for (int i = 0; i < 2; ++i) all.push_back(series.coefficients(k)[i]);
    return all;
  };
  EXPECT_EQ(coefficients(false), coefficients(true));
}

}  // namespace
