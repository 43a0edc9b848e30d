// Matrices of second derivatives that store only the entries that are not zero.
#include "core/text/symbol_matrix.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/memory_budget.hpp"
#include "core/tape/formula.hpp"

namespace {

using namespace least;
using text::BlockMatrix;
using text::SymbolMatrix;

using Square = std::vector<std::vector<double>>;

SymbolMatrix symbols_of(const Square& numbers) {
  SymbolMatrix made(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i)
    for (std::size_t j = 0; j < numbers.size(); ++j)
      if (numbers[i][j] != 0) made.row(i).push_back({j, Symbol(numbers[i][j])});
  return made;
}
std::vector<double> entries_of(const SymbolMatrix& matrix) {
  std::vector<double> all;
  for (std::size_t i = 0; i < matrix.size(); ++i)
    for (const auto& entry : matrix.row(i)) all.push_back(entry.value.constant());
  return all;
}
/// two_blocks() returns a symmetric, positive definite matrix of two blocks whose rows are interleaved.
Square two_blocks(std::size_t n) {
  std::minstd_rand random(3);
  Square made(n, std::vector<double>(n, 0));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j <= i; ++j)
      if (i == j || i == j + 2 || (i % 2 == j % 2 && random() % 2 == 0))
        made[i][j] = made[j][i] = i == j ? double(n) : 0.5;
  return made;
}

void expect_unit(const Square& a, const Square& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < a.size(); ++j) {
      double sum = 0;
      for (std::size_t k = 0; k < a.size(); ++k) sum += a[i][k] * b[k][j];
      EXPECT_NEAR(sum, i == j ? 1 : 0, 1e-12) << i << ' ' << j;
    }
}

TEST(SymbolMatrix, HasItsInverse) {
  const Square a = two_blocks(9);
  const SymbolMatrix given = symbols_of(a);
  EXPECT_FALSE(given.is_diagonal());
  const auto inverse = text::inverse_of(given);
  ASSERT_TRUE(inverse);
  Square b(9, std::vector<double>(9));
  for (std::size_t i = 0; i < 9; ++i)
    for (std::size_t j = 0; j < 9; ++j) b[i][j] = inverse->at(i, j).constant();
  expect_unit(a, b);

  BlockMatrix blocks(given, entries_of(given));
  EXPECT_EQ(blocks.blocks().size(), 2u);
  blocks.invert();
  Square c(9, std::vector<double>(9, 0));
  for (const auto& [of, numbers] : blocks.blocks())
    for (std::size_t i = 0; i < of.size(); ++i)
      for (std::size_t j = 0; j < of.size(); ++j) c[of[i]][of[j]] = numbers[i * of.size() + j];
  expect_unit(a, c);
}

// Where a pivot is zero rows are exchanged; where all are zero there is no inverse.
TEST(SymbolMatrix, ExchangesRows) {
  const Square swapped{{0, 2, 0}, {1, 0, 0}, {0, 3, 4}};
  const auto inverse = text::inverse_of(symbols_of(swapped));
  ASSERT_TRUE(inverse);
  Square b(3, std::vector<double>(3));
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) b[i][j] = inverse->at(i, j).constant();
  expect_unit(swapped, b);
  EXPECT_FALSE(text::inverse_of(symbols_of({{1, 0}, {1, 0}})));
}

TEST(SymbolMatrix, IsInvertedOnATape) {
  tape::Tape tape;
  const Symbol x = Symbol::variable(tape, 0);
  SymbolMatrix given(2);
  given.row(0) = {{0, Symbol(1) + x * x}, {1, x}};
  given.row(1) = {{0, x}, {1, Symbol(2)}};
  const auto inverse = text::inverse_of(given);
  ASSERT_TRUE(inverse);
  const std::vector<tape::Index> places{inverse->at(0, 0).on(tape), inverse->at(0, 1).on(tape),
                                        inverse->at(1, 1).on(tape)};
  double values[3];
  const double at = 0.5;
  tape::Formula(tape, places).evaluate(&at, 0.0, values);
  const double determinant = 1.25 * 2 - 0.25;
  EXPECT_NEAR(values[0], 2 / determinant, 1e-15);
  EXPECT_NEAR(values[1], -0.5 / determinant, 1e-15);
  EXPECT_NEAR(values[2], 1.25 / determinant, 1e-15);
}

TEST(SymbolMatrix, TellsSignsOfPivots) {
  const auto definite = [](const Square& a) {
    const SymbolMatrix given = symbols_of(a);
    return text::is_positive_definite(given, entries_of(given));
  };
  EXPECT_TRUE(definite(two_blocks(9)));
  EXPECT_TRUE(definite({{2, 0, 1}, {0, 1, 0}, {1, 0, 2}}));
  EXPECT_FALSE(definite({{1, 0, 2}, {0, 1, 0}, {2, 0, 1}}));
  EXPECT_FALSE(definite({{-1, 0}, {0, -1}}));
  EXPECT_FALSE(definite({{1, 0}, {0, NAN}}));
  EXPECT_FALSE(text::is_indefinite(symbols_of({{-1, 0}, {0, -2}})));
  EXPECT_TRUE(text::is_indefinite(symbols_of({{1, 0}, {0, -2}})));
  EXPECT_TRUE(text::is_indefinite(symbols_of({{1, 2}, {2, 1}})));
}

/// min(i, j), as masses of a chain of pendulums: the condition grows as 4 n² / π², and the determinant is 1, ever
/// smaller beside the product of the rows.
TEST(SymbolMatrix, IsRegularOrNotAtAnySize) {
  const auto regularity = [](const Square& a) {
    const SymbolMatrix matrix = symbols_of(a);
    return BlockMatrix(matrix, entries_of(matrix)).regularity();
  };
  for (const std::size_t n : {2U, 12U, 100U, 300U}) {
    Square a(n, std::vector<double>(n));
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) a[i][j] = double(std::min(i, j) + 1);
    const auto regular = regularity(a);
    EXPECT_GT(regular.reciprocal_condition, 1e-7) << n;
    EXPECT_NEAR(regular.log_determinant, 0, 1e-9) << n;
    // Units far apart do not change the result.
    Square in_units = a;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) in_units[i][j] *= (i % 2 ? 1e9 : 1) * (j % 2 ? 1e9 : 1);
    EXPECT_GT(regularity(in_units).reciprocal_condition, 1e-7) << n;
    // The last coordinate as the sum of the first two.
    for (std::size_t j = 0; j < n; ++j) a[n - 1][j] = a[0][j] + (n > 2 ? a[1][j] : 0);
    for (std::size_t i = 0; i < n; ++i) a[i][n - 1] = a[i][0] + (n > 2 ? a[i][1] : 0);
    EXPECT_FALSE(regularity(a).reciprocal_condition > 1e-14) << n;
  }
  EXPECT_EQ(regularity({{2, 0}, {0, 0}}).reciprocal_condition, 0);
  EXPECT_FALSE(regularity({{2, NAN}, {NAN, 1}}).reciprocal_condition > 0);
}

// A chain of a thousand coordinates takes hardly any memory; a full matrix is refused before it takes time or memory.
TEST(SymbolMatrix, TakesWhatItsEntriesTake) {
  constexpr std::size_t n = 1024;
  SymbolMatrix chain(n), full(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (i > 0) chain.row(i).push_back({i - 1, Symbol(0.1)});
    chain.row(i).push_back({i, Symbol(1)});
    if (i + 1 < n) chain.row(i).push_back({i + 1, Symbol(0.1)});
    for (std::size_t j = 0; j < n; ++j) full.row(i).push_back({j, Symbol(i == j ? 2.0 : 1.0)});
  }
  MemoryBudget budget(std::size_t(1) << 20);
  const HeldByThread held(&budget);
  EXPECT_TRUE(text::is_positive_definite(chain, entries_of(chain)));
  EXPECT_FALSE(text::is_indefinite(chain));
  EXPECT_THROW(text::inverse_of(chain), std::exception) << "its inverse is full";
  EXPECT_THROW(BlockMatrix(chain, entries_of(chain)), tape::TooManyOperations);
  EXPECT_THROW(text::is_positive_definite(full, entries_of(full)), MemoryShortage);
  EXPECT_EQ(budget.held(), 0u);
  MemoryBudget more(std::size_t(1) << 26);
  const HeldByThread of_more(&more);
  EXPECT_THROW(text::is_positive_definite(full, entries_of(full)), tape::TooManyOperations);
  EXPECT_THROW(text::inverse_of(chain), tape::TooManyOperations);
}

}  // namespace
