// Interval arithmetic: an enclosure contains the values of plain numbers and its derivatives their difference
// quotients, and it says where there are none.
#include "core/number/enclosure.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

namespace {

namespace interval = least::interval;
using interval::Enclosure;
using interval::RateEnclosure;

struct Function {
  std::string name;
  std::function<double(double)> plain;
  std::function<RateEnclosure(const RateEnclosure&)> enclosed;
};
/// `f` is the function that the expression calls.
#define LEAST_BOTH(f, expression) \
  [](const auto& x) {             \
    using std::f;                 \
    return expression;            \
  }
const std::vector<Function>& functions() {
  static const std::vector<Function> all = [] {
    std::vector<Function> made;
    const auto add = [&](const char* name, auto f) { made.push_back({name, f, f}); };
    add("sin", LEAST_BOTH(sin, sin(x)));
    add("cos", LEAST_BOTH(cos, cos(x)));
    add("tan", LEAST_BOTH(tan, tan(x)));
    add("exp", LEAST_BOTH(exp, exp(x)));
    add("log", LEAST_BOTH(log, log(x)));
    add("sqrt", LEAST_BOTH(sqrt, sqrt(x)));
    add("sinh", LEAST_BOTH(sinh, sinh(x)));
    add("cosh", LEAST_BOTH(cosh, cosh(x)));
    add("tanh", LEAST_BOTH(tanh, tanh(x)));
    add("atan", LEAST_BOTH(atan, atan(x)));
    add("asin", LEAST_BOTH(asin, asin(x)));
    add("acos", LEAST_BOTH(acos, acos(x)));
    for (const double exponent : {1.7, -2.5, 21.0, -20.0, -3.0})
      add("power", [exponent](const auto& x) {
        using std::pow;
        return pow(x, exponent);
      });
    add("square", [](const auto& x) { return x * x; });
    add("quotient", [](const auto& x) { return (x + 1.0) / (2.0 - x); });
    add("product", [](const auto& x) { return x * (x + -0.5); });
    made.push_back({"abs", [](double x) { return std::abs(x); },
                    [](const RateEnclosure& x) { return select(x < RateEnclosure(0.0), x * -1.0, x); }});
    return made;
  }();
  return all;
}
#undef LEAST_BOTH

TEST(Enclosures, HoldEveryValueAndSlope) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> middle(-4, 4), digits(-9, 1.5), part(0, 1);
  for (const auto& [name, plain, enclosed] : functions())
    for (int k = 0; k < 4000; ++k) {
      const double low = middle(random), high = low + std::pow(10, digits(random));
      const RateEnclosure f = enclosed({{low, high}, 1.0});
      for (int j = 0; j < 10; ++j) {
        const double x = j == 0 ? low : j == 1 ? high : low + part(random) * (high - low), y = plain(x);
        if (std::isnan(y)) {
          EXPECT_FALSE(f.value.everywhere()) << name << " of " << x << " in " << low << " … " << high;
          continue;
        }
        EXPECT_NE(f.value.defined, interval::Defined::nowhere) << name << " of " << x;
        EXPECT_TRUE(f.value.contains(y)) << name << " of " << x << " in " << low << " … " << high;
        const double h = 1e-6, ahead = plain(x + h), behind = plain(x - h), slope = (ahead - behind) / (2 * h);
        const double off = 1e-3 * (1 + std::abs(slope));  // the error of the difference quotient
        if (std::isnan(slope) || std::abs(ahead - 2 * y + behind) / h > off) continue;
        EXPECT_TRUE(f.rate.low - off <= slope && slope <= f.rate.high + off)
            << name << "' at " << x << " in " << low << " … " << high << ": " << slope;
      }
    }
}

TEST(Enclosures, AreAsNarrowAsRoundOffAtAPoint) {
  for (const auto& [name, plain, enclosed] : functions())
    for (const double x : {0.2, 0.6, 0.9}) {
      const Enclosure f = enclosed({Enclosure(x), 1.0}).value;
      EXPECT_LE(f.width(), 1e-14 * (1 + std::abs(plain(x)))) << name;
      EXPECT_TRUE(f.width() > 0 || name == "abs") << name;
    }
}

TEST(Enclosures, SayWhereNothingIsDefined) {
  using namespace interval;
  EXPECT_EQ(sqrt(Enclosure(-2, -1)).defined, Defined::nowhere);
  EXPECT_EQ(sqrt(Enclosure(-2, 1)).defined, Defined::partly);
  EXPECT_EQ(sqrt(Enclosure(0, 1)).defined, Defined::everywhere);
  EXPECT_EQ(log(Enclosure(-2, -1)).defined, Defined::nowhere);
  EXPECT_EQ(acos(Enclosure(1.5, 2)).defined, Defined::nowhere);
  EXPECT_EQ(tan(Enclosure(1, 2)).defined, Defined::partly);
  EXPECT_EQ(inverse(Enclosure(-1, 1)).defined, Defined::partly);
  EXPECT_EQ((sqrt(Enclosure(-2, -1)) + Enclosure(0, 1)).defined, Defined::nowhere);
  // A pole at an end of the interval, and zero times an unbounded interval.
  EXPECT_EQ(inverse(Enclosure(0, 2)).low, 0.5);
  EXPECT_TRUE((Enclosure(0, 1) * inverse(Enclosure(0, 2))).contains(3));
  EXPECT_TRUE((inverse(Enclosure(0, 2)) * Enclosure(0, 1)).contains(3));
  EXPECT_FALSE((Enclosure(0, 1) * inverse(Enclosure(0, 2))).contains(-1e-3));
  // A value that overflows still has a lower bound.
  EXPECT_TRUE(exp(Enclosure(800, 900)).low > 1e300);
  const Enclosure square_of = Enclosure(-1e-3, 1e-3);
  EXPECT_EQ((square_of * square_of).low, 0) << "the factors are one number";
}

}  // namespace
