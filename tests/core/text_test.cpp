// Formulas as text: what binds how, what is refused and where, and that the tape says what was typed.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <string>

#include "core/tape/formula.hpp"
#include "core/text/expression.hpp"

namespace {

using namespace least;

/// x, y and t are 1.25, 3 and 0.5.
constexpr double x_here = 1.25, y_here = 3, t_here = 0.5;

struct ReadText {
  std::optional<text::Fault> fault;
  double value = 0;
};
ReadText read(const std::string& typed) {
  const auto parsed = text::Expression::parse(typed);
  if (const auto* fault = std::get_if<text::Fault>(&parsed)) return {*fault};
  tape::Tape tape;
  const text::Word words[] = {{"x", Symbol::variable(tape, 0)},
                              {"y", Symbol::variable(tape, 1)},
                              {"t", Symbol::time(tape)},
                              {"k", Symbol(2.0)},
                              {"s", Symbol(), "is no part of this"}};
  const auto recorded = std::get<text::Expression>(parsed).record(tape, words);
  if (const auto* fault = std::get_if<text::Fault>(&recorded)) return {*fault};
  const tape::Index output[] = {std::get<Symbol>(recorded).on(tape)};
  const double variables[] = {x_here, y_here};
  double value = 0;
  tape::Formula(tape, output).evaluate(variables, t_here, &value);
  return {std::nullopt, value};
}

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
  const auto operations = [](int count) {  // no two alike
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

// ---- random formulas, against an evaluator that knows the tree and neither the parser nor the tape

/// A value, and by how much rounding may have moved it.
struct Rounded {
  double value, error;
};
constexpr double epsilon_here = std::numeric_limits<double>::epsilon();

struct Tree {
  enum class Kind { number, name, negative, sum, difference, product, quotient, power, call };
  Kind kind;
  double value = 0;
  int which = 0;
  std::unique_ptr<Tree> a{}, b{};
};
struct Called {
  const char* name;
  double (*f)(double);
  double (*slope)(double);
};
const Called called[] = {
    {"sin", [](double x) { return std::sin(x); }, [](double x) { return std::cos(x); }},
    {"cos", [](double x) { return std::cos(x); }, [](double x) { return -std::sin(x); }},
    {"tan", [](double x) { return std::tan(x); }, [](double x) { return 1 + std::tan(x) * std::tan(x); }},
    {"asin", [](double x) { return std::asin(x); }, [](double x) { return 1 / std::sqrt(1 - x * x); }},
    {"acos", [](double x) { return std::acos(x); }, [](double x) { return -1 / std::sqrt(1 - x * x); }},
    {"atan", [](double x) { return std::atan(x); }, [](double x) { return 1 / (1 + x * x); }},
    {"sinh", [](double x) { return std::sinh(x); }, [](double x) { return std::cosh(x); }},
    {"cosh", [](double x) { return std::cosh(x); }, [](double x) { return std::sinh(x); }},
    {"tanh", [](double x) { return std::tanh(x); }, [](double) { return 1.0; }},
    {"exp", [](double x) { return std::exp(x); }, [](double x) { return std::exp(x); }},
    {"log", [](double x) { return std::log(x); }, [](double x) { return 1 / x; }},
    {"sqrt", [](double x) { return std::sqrt(x); }, [](double x) { return 0.5 / std::sqrt(x); }},
    {"abs", [](double x) { return std::abs(x); }, [](double) { return 1.0; }},
};

class RandomTrees {
 public:
  explicit RandomTrees(std::uint64_t seed) : random_(seed) {}

  std::unique_ptr<Tree> tree(int depth) {
    using Kind = Tree::Kind;
    auto made = std::make_unique<Tree>();
    const int pick = depth == 0 ? below(2) : 2 + below(9);
    if (pick == 0) {
      constexpr double numbers[] = {1, 2, 3, 0.5, 0.1, 7.25, 1e-3, 40};
      made->kind = Kind::number;
      made->value = numbers[below(8)];
    } else if (pick == 1) {
      made->kind = Kind::name;
      made->which = below(5);
    } else if (pick <= 6) {
      constexpr Kind kinds[] = {Kind::sum, Kind::difference, Kind::product, Kind::quotient, Kind::negative};
      made->kind = kinds[pick - 2];
      made->a = tree(below(depth));
      if (made->kind != Kind::negative) made->b = tree(below(depth));
    } else if (pick <= 8) {
      made->kind = Kind::power;
      made->a = tree(below(depth));
      made->b = std::make_unique<Tree>();
      made->b->kind = Kind::number;
      constexpr double exponents[] = {0, 1, 2, 3, 5, 17, 0.5, 1.5, 2.7};
      made->b->value = exponents[below(9)];
      if (below(3) == 0) made->b = negative(std::move(made->b));
    } else {
      made->kind = Kind::call;
      made->which = below(int(std::size(called)));
      made->a = tree(below(depth));
    }
    return made;
  }
  int below(int n) { return n <= 1 ? 0 : int(random_() % unsigned(n)); }

 private:
  static std::unique_ptr<Tree> negative(std::unique_ptr<Tree> a) {
    auto made = std::make_unique<Tree>();
    made->kind = Tree::Kind::negative;
    made->a = std::move(a);
    return made;
  }
  std::mt19937_64 random_;
};

/// With no more brackets than the rules need, and now and then some more.
std::string printed(const Tree& tree, RandomTrees& random) {
  using Kind = Tree::Kind;
  const auto binds = [](const Tree& part) {
    switch (part.kind) {
      case Kind::sum:
      case Kind::difference:
        return 1;
      case Kind::product:
      case Kind::quotient:
        return 2;
      case Kind::negative:
        return 3;
      case Kind::power:
        return 4;
      default:
        return 5;
    }
  };
  const auto part = [&](const Tree& inner, int least) {
    const std::string plain = printed(inner, random);
    return binds(inner) < least || random.below(8) == 0 ? "(" + plain + ")" : plain;
  };
  const std::string space = random.below(4) == 0 ? " " : "";
  switch (tree.kind) {
    case Kind::number: {
      char text[40];
      std::snprintf(text, sizeof text, random.below(2) ? "%.17g" : "%.17e", tree.value);
      return text;
    }
    case Kind::name: {
      const char* names[] = {"x", "y", "t", "k", "pi"};
      return names[tree.which];
    }
    case Kind::negative:
      return "-" + space + part(*tree.a, 3);
    case Kind::sum:
      return part(*tree.a, 1) + space + "+" + part(*tree.b, 2);
    case Kind::difference:
      return part(*tree.a, 1) + "-" + space + part(*tree.b, 2);
    case Kind::product:
      return part(*tree.a, 2) + "*" + part(*tree.b, 3);
    case Kind::quotient:
      return part(*tree.a, 2) + space + "/" + part(*tree.b, 3);
    case Kind::power:
      return part(*tree.a, 5) + "^" + part(*tree.b, 3);
    case Kind::call:
      return called[tree.which].name + space + "(" + printed(*tree.a, random) + ")";
  }
  return {};
}

/// `wild`: something on the way was no finite number.
Rounded evaluated(const Tree& tree, bool& wild) {
  using Kind = Tree::Kind;
  const Rounded a = tree.a ? evaluated(*tree.a, wild) : Rounded{0, 0};
  const Rounded b = tree.b ? evaluated(*tree.b, wild) : Rounded{0, 0};
  const auto [u, du] = a;
  const auto [v, dv] = b;
  Rounded made{0, 0};
  switch (tree.kind) {
    case Kind::number:
      made = {tree.value, 0};
      break;
    case Kind::name: {
      const double values[] = {x_here, y_here, t_here, 2, std::numbers::pi};
      made = {values[tree.which], 0};
      break;
    }
    case Kind::negative:
      made = {-u, du};
      break;
    case Kind::sum:
      made = {u + v, du + dv};
      break;
    case Kind::difference:
      made = {u - v, du + dv};
      break;
    case Kind::product:
      made = {u * v, std::abs(u) * dv + std::abs(v) * du};
      break;
    case Kind::quotient:
      made = {u / v, (du + std::abs(u / v) * dv) / std::abs(v)};
      break;
    case Kind::power:
      made = {std::pow(u, v), std::abs(v * std::pow(u, v - 1)) * du};
      if (v == 0) made.error = 0;
      break;
    case Kind::call:
      made = {called[tree.which].f(u), std::abs(called[tree.which].slope(u)) * du};
      break;
  }
  wild = wild || !std::isfinite(made.value) || !std::isfinite(made.error);
  made.error += 20 * epsilon_here * std::abs(made.value);
  return made;
}

TEST(Text, SaysWhatAnIndependentEvaluatorSays) {
  RandomTrees random(20231122);
  int compared = 0, refused = 0;
  for (int i = 0; i < 20'000; ++i) {
    const auto tree = random.tree(1 + random.below(7));
    const std::string typed = printed(*tree, random);
    bool wild = false;
    const Rounded expected = evaluated(*tree, wild);
    const ReadText got = read(typed);
    if (got.fault) {
      EXPECT_TRUE(wild && got.fault->detail.find("finite") != std::string::npos)
          << typed << ": " << got.fault->detail << " at " << got.fault->position;
      ++refused;
      continue;
    }
    if (wild) continue;
    ASSERT_NEAR(got.value, expected.value, expected.error) << typed;
    ++compared;
  }
  EXPECT_GT(compared, 10'000);
  EXPECT_LT(refused, 5'000);
}

}  // namespace
