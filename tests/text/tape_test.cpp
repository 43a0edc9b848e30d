// Operations on the tape of a text: derivatives against dual numbers, and texts that are printed and read back.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <ctime>
#include <limits>

#include "core/number/dual.hpp"
#include "core/tape/derivative.hpp"
#include "core/tape/formula.hpp"
#include "core/text/expression.hpp"
#include "core/text/print.hpp"

namespace {

using namespace least;
using text::Expression;

/// At least one of every operation; x and y are 0.7 and 1.3, t is 0.4.
constexpr const char* texts_of_all_kinds[] = {
    "x*y - x/y + 3*x - y/4 + 2/x",
    "x^2 + y^3 - x^(-2) + x^0.5 + y^1.25 + (x*y)^(-1.5)",
    "x^y + (x + y)^(x - 2*y) + 2^x",
    "sqrt(x + y)*exp(-x*t) + log(x*y)",
    "sin(x*y) + cos(x - y)*tan(x/3)",
    "sinh(x) - cosh(y) + tanh(x*y)",
    "asin(x/2) + acos(y/3) + atan(x*y*t)",
    "abs(x - y)*abs(x + y)",
    "min(x, y)*max(x*y, 1) + sign(x - y)*hypot(x, y)",
    "if(x < y and not y < t, x^2, y^2)*atan2(y - 1, x - 2) + if(x > y or t >= x, x*y, x/y)",
    "-1/sqrt((x - 1)^2 + y^2) - (1 - t)/sqrt((x + t)^2 + y^2)",
    "cos(t)*sin(x) + sin(t)*cos(x) + cos(2*t)*cos(3*t) - sin(2*t)*sin(3*t)",
    "x - x + 0*y",
    "7",
};

struct Recorded {
  tape::Tape tape;
  Symbol symbol;
};
void record(const std::string& text, Recorded& recorded) {
  auto parsed = Expression::parse(text);
  ASSERT_TRUE(std::holds_alternative<Expression>(parsed)) << text;
  const text::Word words[] = {{"x", Symbol::variable(recorded.tape, 0)},
                              {"y", Symbol::variable(recorded.tape, 1)},
                              {"t", Symbol::time(recorded.tape)}};
  const auto made = std::get<Expression>(parsed).record(recorded.tape, words);
  ASSERT_TRUE(std::holds_alternative<Symbol>(made)) << text;
  recorded.symbol = std::get<Symbol>(made);
}
template <class T>
T value(Recorded& recorded, const Symbol& of, const std::array<T, 2>& x) {
  const tape::Index place = of.on(recorded.tape);
  T result;
  tape::Formula(recorded.tape, std::span(&place, 1)).evaluate(x.data(), 0.4, &result);
  return result;
}

TEST(TapeOfText, DerivativesAreThoseOfDualNumbers) {
  using D = Dual<double, 2>;
  const std::array<double, 2> at{0.7, 1.3};
  const std::array<D, 2> seeds{D::variable(at[0], 0), D::variable(at[1], 1)};
  for (const char* text : texts_of_all_kinds) {
    Recorded recorded;
    record(text, recorded);
    const auto gradient = tape::gradient(recorded.tape, recorded.symbol, std::array{0, 1});
    const D truth = value(recorded, recorded.symbol, seeds);
    EXPECT_EQ(truth.value, value(recorded, recorded.symbol, at)) << text;
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_NEAR(value(recorded, gradient[i], at), truth.slope[i], 1e-14 * (1 + std::abs(truth.slope[i]))) << text;
    // Second derivatives, from the gradient of the gradient.
    for (std::size_t i = 0; i < 2; ++i) {
      const auto second = tape::gradient(recorded.tape, gradient[i], std::array{0, 1});
      const D along = value(recorded, gradient[i], seeds);
      for (std::size_t j = 0; j < 2; ++j)
        EXPECT_NEAR(value(recorded, second[j], at), along.slope[j], 1e-13 * (1 + std::abs(along.slope[j]))) << text;
    }
  }
}

TEST(TapeOfText, WhatIsPrintedIsReadBack) {
  const std::array<double, 2> at{0.7, 1.3};
  for (const char* text : texts_of_all_kinds) {
    Recorded first, again;
    record(text, first);
    const std::string printed =
        text::print(first.tape, first.symbol, [](int i) { return std::string(i == 0 ? "x" : "y"); });
    record(printed, again);
    const double was = value(first, first.symbol, at), is = value(again, again.symbol, at);
    EXPECT_NEAR(is, was, 1e-15 * (1 + std::abs(was))) << text << " → " << printed;
  }
}

TEST(TapeOfText, KnowsOnWhatItDepends) {
  const auto depends = [](const char* text) {
    Recorded recorded;
    record(text, recorded);
    tape::Dependences of(recorded.tape, [](int i) { return tape::Dependence(1) << i; });
    return of(recorded.symbol);
  };
  EXPECT_EQ(depends("x*t"), 1U | tape::on_time);
  EXPECT_EQ(depends("exp(y)"), 2U);
  EXPECT_EQ(depends("x - x + 0*y + 3"), 0U);
}

TEST(TapeOfText, OtherSymbolsTakeThePlaceOfVariables) {
  Recorded recorded;
  record("x^2*sin(y) + x*t", recorded);
  tape::Tape other;
  tape::Substitution fold(recorded.tape, other, [](int i) { return Symbol(i == 0 ? 3.0 : 0.5); });
  const tape::Index place = fold(recorded.symbol).on(other);
  double result = 0;
  const double* const none = nullptr;
  tape::Formula(other, std::span(&place, 1)).evaluate(none, 0.25, &result);
  EXPECT_DOUBLE_EQ(result, 9 * std::sin(0.5) + 0.75);
}

// Each of many values contains the one before. Substituting all of them one after the other costs about as much as
// substituting the last one alone, not that times their number.
TEST(TapeOfText, SharedPartsAreSubstitutedOnce) {
  constexpr std::size_t count = 4000;
  Recorded recorded;
  std::vector<Symbol> chain{Symbol::variable(recorded.tape, 0)};
  for (std::size_t i = 1; i < count; ++i) chain.push_back(sin(chain.back()) + Symbol::variable(recorded.tape, i % 7));
  const auto seconds = [&](std::span<const Symbol> values, double& last) {
    const std::clock_t from = std::clock();
    tape::Tape other;
    tape::Substitution move(recorded.tape, other,
                            [&](int i) { return Symbol::variable(other, static_cast<std::size_t>(i + 1)); });
    std::vector<tape::Index> places;
    for (const Symbol& y : values) places.push_back(move(y).on(other));
    const double passed = static_cast<double>(std::clock() - from) / CLOCKS_PER_SEC;
    const std::vector<double> x{9, .1, .2, .3, .4, .5, .6, .7};
    tape::Formula(other, std::span(&places.back(), 1)).evaluate(x.data(), 0.0, &last);
    return passed;
  };
  double expected = .1, of_all = 0, alone = 0;
  for (std::size_t i = 1; i < count; ++i) expected = std::sin(expected) + .1 * static_cast<double>(i % 7 + 1);
  double least_ratio = std::numeric_limits<double>::infinity();  // of a few, as others may compute meanwhile
  for (int i = 0; i < 5; ++i) {
    const double together = seconds(chain, of_all);
    least_ratio = std::min(least_ratio, together / seconds(std::span(chain).last(1), alone));
  }
  EXPECT_DOUBLE_EQ(of_all, expected);
  EXPECT_DOUBLE_EQ(alone, expected);
  EXPECT_LT(least_ratio, 20) << "of " << count << " values";
}

// Many operations alike are evaluated in batches, with the bits of each evaluated alone.
TEST(TapeOfText, BatchesAreTheirParts) {
  constexpr std::size_t copies = 300;  // more than a block of a batch
  tape::Tape tape;
  tape.bound(1 << 20);
  std::vector<double> at;
  std::vector<tape::Index> all;
  for (std::size_t k = 0; k < copies; ++k) {
    at.push_back(0.7 + 0.9 * std::sin(static_cast<double>(k)));
    // With a neighbour, with one that all share, and with itself.
    const std::size_t other = k % 3 == 0 ? (k + 1) % copies : k % 3 == 1 ? 5 : k;
    const text::Word words[] = {
        {"x", Symbol::variable(tape, k)}, {"y", Symbol::variable(tape, other)}, {"t", Symbol::time(tape)}};
    for (const char* text : texts_of_all_kinds) {
      const auto parsed = Expression::parse(text);
      const auto made = std::get<Expression>(parsed).record(tape, words, 1 << 20);
      ASSERT_TRUE(std::holds_alternative<Symbol>(made)) << text << ": " << std::get<text::Fault>(made).detail;
      all.push_back(std::get<Symbol>(made).on(tape));
    }
  }
  std::vector<double> together(all.size());
  const tape::Formula formula(tape, all);
  ASSERT_TRUE(formula.in_batches());
  for (const double t : {0.4, -1.3}) {
    formula.evaluate(at.data(), t, together.data());
    int numbers = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const tape::Formula part(tape, std::span(&all[i], 1));
      ASSERT_FALSE(part.in_batches());
      double alone = 0;
      part.evaluate(at.data(), t, &alone);
      if (std::isnan(alone) && std::isnan(together[i])) continue;
      ++numbers;
      EXPECT_EQ(std::bit_cast<std::uint64_t>(together[i]), std::bit_cast<std::uint64_t>(alone)) << i << " at " << t;
    }
    EXPECT_GT(numbers, 3000);
  }
}

// Long sums are evaluated beside each other, and their products tile by tile. They have the bits of one operation after
// the other, whatever their lengths and signs, also where a sum is continued after it was used.
TEST(TapeOfText, LongSumsAreTheirTermsOneAfterTheOther) {
  constexpr std::size_t n = 45;
  tape::Tape tape;
  tape.bound(1 << 20);
  std::vector<double> at;
  std::vector<Symbol> x, sum(n, Symbol(0));
  std::vector<tape::Index> all;
  for (std::size_t i = 0; i < n; ++i) {
    at.push_back(std::sin(static_cast<double>(7 * i)));
    x.push_back(Symbol::variable(tape, i));
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n - i % 5; ++j) {
      const Symbol apart = x[i] - x[j], weighed = apart / (apart * apart + 0.3);
      sum[i] = (i + j) % 3 == 0 ? weighed + sum[i] : sum[i] - weighed;
      sum[j] = sum[j] + weighed;
      if (i == 4 && j % 10 == 0) all.push_back(sum[j].on(tape));
    }
  for (const Symbol& whole : sum) all.push_back(whole.on(tape));
  const tape::Formula formula(tape, all);
  ASSERT_TRUE(formula.in_batches());
  std::vector<double> together(all.size());
  formula.evaluate(at.data(), 0.0, together.data());
  using Slope = Dual<double, 1>;  // in which nothing is batched
  const std::vector<Slope> same(at.begin(), at.end());
  std::vector<Slope> alone(all.size());
  formula.evaluate(same.data(), Slope(0), alone.data());
  for (std::size_t i = 0; i < all.size(); ++i)
    EXPECT_EQ(std::bit_cast<std::uint64_t>(together[i]), std::bit_cast<std::uint64_t>(alone[i].value)) << i;
}

}  // namespace
