// Sparse linear systems whose pattern is known beforehand, and Jacobians of formulas by directions that share no row.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "core/number/asked_by_thread.hpp"
#include "core/number/sparse_system.hpp"
#include "core/tape/sparse_jacobian.hpp"
#include "core/tape/symbol.hpp"

namespace least {
namespace {

/// Entries without order, of any sign.
double entry(std::size_t i, std::size_t j) { return std::sin(1.3 * double(i * i) + 7.1 * double(j) + 2); }

/// |A x − b| of the solution for a right side, over what is there.
double residual(const SparsityPattern& pattern, SparseSystem& system, double diagonal) {
  const std::size_t n = pattern.size();
  system.clear();
  std::vector<double> x(n);
  for (std::size_t i = 0; i < n; ++i) {
    x[i] = std::cos(double(3 * i));
    for (const auto j : pattern[i]) system.add(i, j, entry(i, j));
    system.add(i, i, diagonal);
  }
  const std::vector<double> b = x;
  system.factor();
  system.solve(x.data());
  double worst = 0;
  for (std::size_t i = 0; i < n; ++i) {
    double sum = diagonal * x[i] - b[i], size = std::abs(b[i]);
    for (const auto j : pattern[i]) {
      sum += entry(i, j) * x[j];
      size += std::abs(entry(i, j) * x[j]);
    }
    worst = std::isfinite(sum) ? std::max(worst, std::abs(sum) / size) : std::numeric_limits<double>::infinity();
  }
  return worst;
}

/// Those that differ by at most `reach`, in an order without order; of a ring the ends meet.
SparsityPattern neighbours(std::size_t n, std::size_t reach, bool ring) {
  std::vector<std::uint32_t> name(n);
  for (std::size_t i = 0; i < n; ++i) name[i] = static_cast<std::uint32_t>(i * 7 % n);  // 7 divides none of the sizes
  SparsityPattern pattern(n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      const std::size_t apart = i > j ? i - j : j - i;
      if (apart <= reach || (ring && n - apart <= reach)) pattern[name[i]].push_back(name[j]);
    }
  return pattern;
}

TEST(SparseSystem, FindsTheBandOfChainsAndRings) {
  for (const bool ring : {false, true}) {
    const auto pattern = neighbours(500, 1, ring);
    SparseSystem system(pattern);
    EXPECT_TRUE(system.is_banded());
    EXPECT_EQ(system.bandwidth(), ring ? 2U : 1U);
    EXPECT_LT(residual(pattern, system, 0), 1e-9);
    EXPECT_LT(residual(pattern, system, 3), 1e-13) << "and again";
  }
}

TEST(SparseSystem, SolvesWhatIsDenseAndWhatFallsApart) {
  SparseSystem wide(neighbours(90, 30, false));
  EXPECT_FALSE(wide.is_banded());
  EXPECT_LT(residual(neighbours(90, 30, false), wide, 0), 1e-11);
  SparseSystem large(neighbours(200, 200, false));  // in several blocks
  EXPECT_LT(residual(neighbours(200, 200, false), large, 0), 1e-11);
  SparseSystem full(neighbours(9, 9, false));
  EXPECT_LT(residual(neighbours(9, 9, false), full, 0), 1e-12);

  SparsityPattern star(100);  // no order makes the band of a row that all share narrow
  for (std::uint32_t i = 0; i < 100; ++i) star[i] = {0, i};
  star[0] = neighbours(100, 100, false)[0];
  SparseSystem centre(star);
  EXPECT_FALSE(centre.is_banded());
  EXPECT_LT(residual(star, centre, 0), 1e-11);
  SparsityPattern narrow = neighbours(100, 12, false);  // 25 in a row: a band of 12
  EXPECT_TRUE(SparseSystem(narrow).is_banded());

  SparsityPattern parts(40);  // 20 pairs
  for (std::uint32_t i = 0; i < 40; ++i) parts[i] = {i, (i + 20) % 40};
  SparseSystem pairs(parts);
  EXPECT_EQ(pairs.bandwidth(), 1U);
  EXPECT_LT(residual(parts, pairs, 0), 1e-12);
}

TEST(SparseSystem, AsksWhetherItIsToGoOnWhereItIsLarge) {
  const auto pattern = neighbours(200, 200, false);
  SparseSystem system(pattern);
  EXPECT_TRUE(system.factor()) << "nobody is to be asked";
  int left = 3;
  const AskedByThread asked([&] { return left-- > 0; });
  EXPECT_FALSE(system.factor());
}

TEST(SparseSystem, ChangesRowsWhereAPivotIsZero) {
  constexpr std::uint32_t n = 20;
  SparsityPattern pattern(n);  // neighbours, and nothing on the diagonal
  for (std::uint32_t i = 0; i < n; ++i) {
    if (i > 0) pattern[i].push_back(i - 1);
    if (i + 1 < n) pattern[i].push_back(i + 1);
  }
  SparseSystem system(pattern);
  EXPECT_EQ(system.bandwidth(), 1U);
  EXPECT_LT(residual(pattern, system, 0), 1e-13);
}

TEST(SparseSystem, HasNoFiniteSolutionWhereThereIsNoInverse) {
  for (const std::size_t n : {20, 60}) {
    SparsityPattern pattern = neighbours(n, n > 50 ? n : 1, false);
    SparseSystem system(pattern);
    system.clear();  // all of it is zero
    system.factor();
    std::vector<double> b(n, 1);
    system.solve(b.data());
    EXPECT_FALSE(std::isfinite(b[0])) << n;
  }
}

TEST(SparseJacobian, TakesAsManyDirectionsAsARowHasEntries) {
  constexpr std::size_t n = 100;
  tape::Tape tape;
  std::vector<Symbol> x;
  for (std::size_t i = 0; i < n; ++i) x.push_back(Symbol::variable(tape, i));
  std::vector<tape::Index> outputs;
  for (std::size_t i = 0; i < n; ++i) {  // reads i, i + 1 and, through a sine, i + 2; the last ones less
    Symbol y = x[i] * x[i];
    if (i + 1 < n) y = y + 3.0 * x[i + 1];
    if (i + 2 < n) y = y + sin(x[i] * x[i + 2]);
    outputs.push_back(y.place());
  }
  const tape::SparseJacobian jacobian(tape, outputs, n);
  EXPECT_EQ(jacobian.directions(), 3U);
  EXPECT_EQ(jacobian.pattern()[0], (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(jacobian.pattern()[n - 1], (std::vector<std::uint32_t>{n - 1}));

  std::vector<double> at(n);
  for (std::size_t i = 0; i < n; ++i) at[i] = std::cos(double(i));
  std::size_t entries = 0;
  jacobian.evaluate(tape::Formula(tape, outputs), at.data(), 0, [&](std::size_t i, std::size_t j, double value) {
    const double bend = i + 2 < n ? std::cos(at[i] * at[i + 2]) : 0;
    const double known = j == i ? 2 * at[i] + (i + 2 < n ? at[i + 2] * bend : 0) : j == i + 1 ? 3 : at[i] * bend;
    EXPECT_NEAR(value, known, 1e-14) << i << " by " << j;
    ++entries;
  });
  EXPECT_EQ(entries, 3 * n - 3);
}

}  // namespace
}  // namespace least
