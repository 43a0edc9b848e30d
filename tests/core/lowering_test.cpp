// The limits of a tape, and of the program made of it.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "core/tape/series.hpp"
#include "core/tape/symbol.hpp"

namespace {

using least::Symbol;
using least::tape::Program;
using least::tape::Series;
using least::tape::Step;
using least::tape::Tape;

TEST(Lowering, OperationsAreBounded) {
  Tape tape;
  const Symbol x = Symbol::variable(tape, 0);
  tape.bound(tape.size() + 1);
  const Symbol square = x * x;
  EXPECT_EQ((x * x).place(), square.place()) << "what stands there is not written anew";
  EXPECT_THROW(square * x, least::tape::TooManyOperations);
}

/// Look-ups in the table of nodes are fast only if different nodes have different hashes.
TEST(Lowering, NodesThatDifferHaveHashesThatDiffer) {
  constexpr std::size_t n = 4096, mask = 4 * n - 1;
  std::set<std::size_t> places;
  for (std::size_t i = 0; i < n; ++i) places.insert(least::tape::Node{.value = static_cast<double>(i)}.hash() & mask);
  EXPECT_GT(places.size(), n * 3 / 4) << "of constants that are whole numbers";
}

/// Adding to a sum makes a new sum that copies its terms. A long sum is therefore split into partial sums that are
/// kept, so that the work of copying is proportional to what is written.
TEST(Lowering, LongSumsAreSumsOfShortOnes) {
  constexpr std::size_t n = 90, longest = 100;
  Tape tape;
  std::vector<Symbol> x;
  std::vector<least::tape::Index> rates;
  std::vector<double> at;
  for (std::size_t i = 0; i < n; ++i) {
    x.push_back(Symbol::variable(tape, i));
    rates.push_back(x[i].on(tape));
    at.push_back(std::sin(static_cast<double>(i)));
  }
  Symbol sum = 0;
  double truth = 0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      sum += Symbol(static_cast<double>(1 + j)) * (x[i] * x[j]);
      truth += static_cast<double>(1 + j) * at[i] * at[j];
    }
  rates[0] = sum.on(tape);
  const Program program(tape, rates, n);
  for (const Step& step : program.steps) EXPECT_LE(static_cast<std::size_t>(step.values + step.products), longest);
  EXPECT_EQ(program.products.size(), n * (n + 1) / 2);
  EXPECT_EQ(program.lane_a.size(), n * (n + 1) / 2) << "each product once";
  Series series(program, 2);
  ASSERT_TRUE(series.defined(at.data(), 0));
  EXPECT_NEAR(series.rate(0), truth, 1e-11 * std::abs(truth));
}

}  // namespace
