// Derived equations as text: short, and of the same value.
#include "core/text/collected.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/text/print.hpp"
#include "tests/support/texts.hpp"

namespace least::text {
namespace {

constexpr std::string_view names[] = {"x", "y", "k"};

Symbol recorded(tape::Tape& tape, const std::string& text) {
  std::vector<Word> words;
  for (std::size_t i = 0; i < std::size(names); ++i) words.push_back({names[i], Symbol::variable(tape, i), {}});
  const auto parsed = Expression::parse(text);
  return std::get<Symbol>(std::get<Expression>(parsed).record(tape, words));
}

std::string collected(const std::string& text) {
  tape::Tape tape;
  return print_collected(tape, recorded(tape, text),
                         [](int i) { return std::string(names[static_cast<std::size_t>(i)]); });
}

double value(const std::string& text, const std::array<double, 3>& at) {
  tape::Tape tape;
  const Symbol y = recorded(tape, text);
  const std::array outputs{y.on(tape)};
  double result = 0;
  tape::Formula(tape, outputs).evaluate(at.data(), 0.0, &result);
  return result;
}

TEST(Collected, PutsTermsTogether) {
  const std::pair<const char*, const char*> known[] = {
      {"(0.5*x^2 - 0.5)*(2*x)", "x^3 - x"},
      {"x*y - y*x + x", "x"},
      {"x - x*1", "0"},
      {"y + x/10 + x/5 - 3*x/10", "y"},  // 5.6e-17 of x, by round-off
      {"2*x/(4*x^2)", "0.5/x"},
      {"k*x/sqrt(x^2 + y^2)/sqrt(x^2 + y^2)", "k*x/(x^2 + y^2)"},
      {"-(x + y)*1 + 3*y", "-x + 2*y"},
      {"x/3 + x*2/3", "x"},
      {"x/3", "x/3"},
      {"2*x/7*y", "2*y*x/7"},
      {"sin(x + x)*cos(y)^2", "sin(2*x)*cos(y)^2"},
      {"(x + y)^2*k", "k*(x + y)^2"},
      {"sqrt(x^2)", "sqrt(x^2)"},
      {"(x*y)^0.5*(x*y)^0.5", "(y*x)"},
      {"1/(x + y)", "1/(x + y)"},
      {"k/(x*y)", "k/(y*x)"},
      {"(x + 1)^(-1.5)", "1/(x + 1)^1.5"},
      {"if(x < 0, -x, x)^2*y", "y*abs(x)^2"},
      {"x*abs(2*(1/(2*k))*y)", "x*abs(y/k)"},
      {"x^4 + x - 2*x^3 + x^5 + 1", "1 + x - 2*x^3 + x^4 + x^5"},
  };
  for (const auto& [text, wanted] : known) EXPECT_EQ(collected(text), wanted) << text;
}

// The collected text has the value of the original and is no longer than the original printed as it is.
TEST(Collected, HasTheSameValue) {
  std::mt19937 random(7);
  const auto pick = [&](std::size_t n) { return random() % n; };
  const std::function<std::string(int)> made = [&](int depth) -> std::string {
    if (depth == 0 || pick(6) == 0) return pick(4) == 0 ? std::to_string(1 + pick(5)) : std::string(names[pick(3)]);
    const std::string a = made(depth - 1), b = made(depth - 1);
    switch (pick(9)) {
      case 0:
      case 1:
        return "(" + a + " + " + b + ")";
      case 2:
        return "(" + a + " - " + b + ")";
      case 3:
      case 4:
        return a + "*" + b;
      case 5:
        return "(" + a + ")/(1 + (" + b + ")^2)";
      case 6:
        return "sin(" + a + ")*" + b;
      case 7:
        return "sqrt(1 + (" + a + ")^2)";
      default:
        return "(" + a + ")^" + std::to_string(2 + pick(2));
    }
  };
  int shorter = 0, compared = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::string text = made(4);
    if (text.size() > 300) continue;
    tape::Tape tape;
    const std::string was =
        print(tape, recorded(tape, text), [](int k) { return std::string(names[static_cast<std::size_t>(k)]); });
    const std::string is = collected(text);
    EXPECT_LE(is.size(), was.size()) << text;
    shorter += is.size() < was.size();
    const std::array at{0.7, -1.3, 0.4};
    const double wanted = value(text, at), got = value(is, at);
    if (!std::isfinite(wanted)) continue;
    EXPECT_NEAR(got, wanted, 1e-9 * std::max(1.0, std::abs(wanted))) << text << "\n  " << is;
    ++compared;
  }
  EXPECT_GT(compared, 2000);
  EXPECT_GT(shorter, 500);
}

}  // namespace
}  // namespace least::text
