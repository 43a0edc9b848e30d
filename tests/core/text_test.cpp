// Formulas as text: precedence, and what is refused and where.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>
#include <string>

#include "tests/support/read_text.hpp"

namespace {

using namespace least;
using namespace reading;

TEST(Text, BindsAsTheFieldDoes) {
  constexpr double x = x_here, y = y_here, t = t_here, pi = std::numbers::pi;
  const std::pair<const char*, double> table[] = {
      {"-x^2", -(x * x)},
      {"2^-x^2", std::exp2(-x * x)},
      {"-x^-2", -1 / (x * x)},
      {"x-y-t", x - y - t},
      {"x-(y-t)", x - (y - t)},
      {"x/y/t", x / y / t},
      {"x/y*t", x / y * t},
      {"x^y^t", std::pow(x, std::pow(y, t))},
      {"x^3^2", std::pow(x, 9)},
      {"(x^3)^2", std::pow(x, 6)},
      {"x+y*t", x + y * t},
      {"(x+y)*t", (x + y) * t},
      {"-x*y", -x * y},
      {"x*-y", x * -y},
      {"x--y", x + y},
      {"--x", x},
      {"+x", x},
      {"x^-1*y", y / x},
      {"-x-y", -x - y},
      {"sin(x)^2", std::sin(x) * std::sin(x)},
      {"-sin(x)", -std::sin(x)},
      {"abs(-x)*k", 2 * x},
      {"2*pi", 2 * pi},
      {".5+1e-3+1.5E2", 150.501},
      {" x\t*\ny ", x * y},
      {"sqrt(x^2+y^2)", std::sqrt(x * x + y * y)},
      {"atan(x)+asin(t)+acos(t)", std::atan(x) + pi / 2},
      {"tan(t)*cos(t)-sin(t)", 0},
      {"cosh(x)^2-sinh(x)^2", 1},
      {"tanh(x)-sinh(x)/cosh(x)", 0},
      {"log(exp(x))", x},
  };
  for (const auto& [typed, expected] : table) {
    const ReadText got = read(typed);
    EXPECT_FALSE(got.fault) << typed << ": " << got.fault->detail;
    EXPECT_NEAR(got.value, expected, 4e-15 * std::max(1.0, std::abs(expected))) << typed;
  }
}

TEST(Text, SaysWhatIsWrongAndWhere) {
  struct Case {
    std::string typed;
    std::size_t position;
    const char* detail;
  };
  const Case table[] = {
      {"", 0, "is empty"},
      {"  ", 2, "is empty"},
      {"x+", 2, "is due"},
      {"x+*y", 2, "is due"},
      {"()", 1, "is due"},
      {"x y", 2, "a product needs its sign"},
      {"2x", 1, "a product needs its sign"},
      {"2(x)", 1, "a product needs its sign"},
      {"(x)(y)", 3, "a product needs its sign"},
      {"2 + x (y)", 4, "a product needs its sign"},
      {"x+lg(y)", 2, "lg is no function"},
      {"2*mod(x,1.31)", 2, "mod is of whole numbers alone"},
      {"x***2", 3, "a number, a name or ( is due"},
      {"(x+y", 0, "is never closed"},
      {"x+((y)", 2, "is never closed"},
      {"x)", 1, "was never opened"},
      {"x+z", 2, "nobody knows the name z"},
      {"x+s", 2, "s is no part of this"},
      {"sin x", 0, "its argument stands in brackets"},
      {"x+sin", 2, "its argument stands in brackets"},
      {"x=y", 1, "means nothing here"},
      {"x,y", 1, "a comma stands between the arguments of a function alone"},
      {"(x,y)", 2, "a comma stands between the arguments of a function alone"},
      {"sin(x,y)", 0, "sin is given 2 arguments"},
      {"1+min(x)", 2, "min is given 1 arguments"},
      {"if(x<y,x)", 0, "if is given 2 arguments"},
      {"max(x,)", 6, "is due"},
      {"x<y", 0, "is a condition and no number"},
      {"1+(x<y)", 1, "is given a condition where a number is due"},
      {"if(x,1,2)", 0, "is given a number where a condition is due"},
      {"if(x<y<t,1,2)", 6, "is given a condition where a number is due"},
      {"if(x<y and t,1,2)", 7, "is given a number where a condition is due"},
      {"not", 3, "is due"},
      {"and", 0, "nobody knows the name and"},
      {"x+\"y\"", 2, "means nothing here"},
      {"µ*x", 0, "is no ASCII character"},
      {"x+.", 2, "is no number"},
      {"1e999", 0, "that no double holds"},
      {"x+1/0", 3, "is no finite number"},
      {"sqrt(-1)", 0, "is no finite number"},
      {"log(0)*x", 0, "is no finite number"},
  };
  for (const auto& [typed, position, detail] : table) {
    const ReadText got = read(typed);
    ASSERT_TRUE(got.fault) << typed;
    EXPECT_EQ(got.fault->position, position) << typed << ": " << got.fault->detail;
    EXPECT_NE(got.fault->detail.find(detail), std::string::npos) << typed << ": " << got.fault->detail;
  }
  EXPECT_EQ(read("x+z").fault->unknown, "z");
  EXPECT_EQ(read("x+z").fault->allowed, "x, y, t, k, pi");
}

TEST(Text, ChoosesByConditions) {
  constexpr double x = x_here, y = y_here, pi = std::numbers::pi;
  const std::pair<const char*, double> table[] = {
      {"min(x, y)", x},
      {"max(x, y, 2*y, t)", 2 * y},
      {"min(3*t, x, 2)", x},
      {"sign(t-x)+10*sign(x)+100*sign(x-x)", 9},
      {"sign(y*0*t)", 0},
      {"hypot(x, y)", std::hypot(x, y)},
      {"atan2(y, x)", std::atan2(y, x)},
      {"atan2(-y, x)", std::atan2(-y, x)},
      {"atan2(x, -y)", std::atan2(x, -y)},
      {"atan2(-x, -y)", std::atan2(-x, -y)},
      {"atan2(x, y)", std::atan2(x, y)},
      {"atan2(0*x, -y)", pi},
      {"atan2(-y, 0*x)", -pi / 2},
      {"if(x < y, 1, 2)", 1},
      {"if(y < x, 1, 2)", 2},
      {"if(x < x, 1, 2)", 2},
      {"if(x <= x, 1, 2)", 1},
      {"if(x >= x, 1, 2)", 1},
      {"if(x > x, 1, 2)", 2},
      {"if(not x < y, 1, 2)", 2},
      {"if(x < y and t < x, 1, 2)", 1},
      {"if(x < y and t > x, 1, 2)", 2},
      {"if(x > y or t < x, 1, 2)", 1},
      {"if(x > y or t > x, 1, 2)", 2},
      {"if(x > y and t < x or y > t, 1, 2)", 1},
      {"if(x > y and (t < x or y > t), 1, 2)", 2},
      {"if(not (x > y or t > x) and not t >= y, x, y)^2", x * x},
      {"if(x + t < y - 1, if(t < 1, 5, 6), 7)", 5},
  };
  for (const auto& [typed, expected] : table) {
    const ReadText got = read(typed);
    EXPECT_FALSE(got.fault) << typed << ": " << got.fault->detail;
    EXPECT_NEAR(got.value, expected, 4e-15 * std::max(1.0, std::abs(expected))) << typed;
  }
}

TEST(Text, IsBoundedInDepthAndLength) {
  const auto nested = [](std::size_t depth) { return std::string(depth, '(') + "x" + std::string(depth, ')'); };
  EXPECT_EQ(read(nested(100)).value, x_here);
  ASSERT_TRUE(read(nested(101)).fault);
  EXPECT_EQ(read(nested(101)).fault->position, 100U);
  std::string many = "x";
  for (int i = 0; i < 3000; ++i) many += "+y";
  EXPECT_EQ(read(many).value, x_here + 3000 * y_here) << "no recursion, however long";
  std::string calls;
  for (int i = 0; i < 99; ++i) calls += "sin(";
  EXPECT_FALSE(read(calls + "x" + std::string(99, ')')).fault);
  EXPECT_TRUE(read(std::string(10'001, '1')).fault);
  EXPECT_FALSE(read(std::string(9'999, ' ') + "1").fault);
  EXPECT_FALSE(read(std::string(400, '-') + "x").fault);
  EXPECT_TRUE(read(std::string(9'999, '-') + "x").fault) << "signs and powers that wait are bounded, too";
  std::string tower = "x";
  for (int i = 0; i < 3000; ++i) tower += "^y";
  EXPECT_TRUE(read(tower).fault);
  const auto operations = [](int count) {  // no two operations are alike
    std::string typed = "x";
    for (int i = 2; i < count; ++i) typed += "+" + std::to_string(i) + "*x";
    return typed;
  };
  EXPECT_FALSE(read(operations(1300)).fault) << "a constant, a product and a sum each";
  ASSERT_LT(operations(1400).size(), text::most_characters);
  EXPECT_NE(read(operations(1400)).fault.value().detail.find("too many operations"), std::string::npos);
}

TEST(Text, RefusesWhatIsHugeAtOnce) {
  using Clock = std::chrono::steady_clock;
  for (const std::string& typed :
       {std::string(1'000'000, '('), std::string(10'000'000, 'x'), std::string(9'999, '(') + ")"}) {
    double least = 1;
    for (int attempt = 0; attempt < 3; ++attempt) {
      std::string copy = typed;
      const auto from = Clock::now();
      const auto parsed = text::Expression::parse(std::move(copy));
      least = std::min(least, std::chrono::duration<double>(Clock::now() - from).count());
      EXPECT_TRUE(std::holds_alternative<text::Fault>(parsed));
    }
    EXPECT_LT(least, 0.01) << typed.size();
  }
}

}  // namespace
