// Random formulas as text, against an evaluator that walks the tree and shares neither the parser nor the tape.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <string>

#include "tests/support/read_text.hpp"

namespace {

using namespace least;
using namespace reading;

/// Rounded is a value with a bound on its rounding error.
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

/// printed() writes the tree with the brackets that the rules need, and at random some more.
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

/// evaluated() sets `wild` where an intermediate value is not finite.
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
