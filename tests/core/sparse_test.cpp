// Sparse linear systems whose pattern is known beforehand, and Jacobians of formulas by groups of columns that share no
// row.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "core/number/asked_by_thread.hpp"
#include "core/number/sparse_system.hpp"
#include "core/tape/derivative.hpp"
#include "core/tape/sparse_jacobian.hpp"
#include "core/tape/symbol.hpp"

namespace least {
namespace {

/// entry() has no regularity, and either sign.
double entry(std::size_t i, std::size_t j) { return std::sin(1.3 * double(i * i) + 7.1 * double(j) + 2); }

/// residual() returns the largest |A x − b| of the computed solution for one right side, relative to the sum of the
/// absolute values of its terms.
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

/// neighbours() couples unknowns that differ by at most `reach`, under shuffled numbers; in a ring the ends are
/// neighbours.
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

  SparsityPattern star(100);  // all unknowns share the first row: no order makes the band narrow
  for (std::uint32_t i = 0; i < 100; ++i) star[i] = {0, i};
  star[0] = neighbours(100, 100, false)[0];
  SparseSystem centre(star);
  EXPECT_FALSE(centre.is_banded());
  EXPECT_LT(residual(star, centre, 0), 1e-11);
  SparsityPattern narrow = neighbours(100, 12, false);  // 25 entries in a row: a band of 12
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
  SparsityPattern pattern(n);  // couples neighbours, and has nothing on the diagonal
  for (std::uint32_t i = 0; i < n; ++i) {
    if (i > 0) pattern[i].push_back(i - 1);
    if (i + 1 < n) pattern[i].push_back(i + 1);
  }
  SparseSystem system(pattern);
  EXPECT_EQ(system.bandwidth(), 1U);
  EXPECT_LT(residual(pattern, system, 0), 1e-13);
}

TEST(SparseSystem, SmallOnesAreSolvedAsTheyAreWithinLargerOnes) {
  const auto number = [](std::size_t i, std::size_t j) { return std::sin(2.7 * double((i + 1) * (j * j + 2))); };
  for (std::uint32_t n = 1; n <= 16; ++n)
    for (const bool pivots : {false, true}) {  // with nothing on the diagonal
      SparsityPattern pattern(n), larger(60);
      for (std::uint32_t i = 0; i < 60; ++i) larger[i] = {i};
      for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j)
          if (!pivots || n == 1 || i != j) pattern[i].push_back(j);
      for (std::uint32_t i = 0; i < n; ++i) larger[i] = pattern[i];
      SparseSystem small(pattern), other(larger);
      EXPECT_TRUE(small.is_small());
      EXPECT_FALSE(other.is_small());
      EXPECT_LT(residual(pattern, small, 0), 1e-13) << n;
      small.clear();
      other.clear();
      std::vector<double> x(n, 1), y(60, 1);
      for (std::uint32_t i = 0; i < 60; ++i)
        for (const auto j : larger[i]) {
          if (i < n) small.add(i, j, number(i, j));
          other.add(i, j, number(i, j));
        }
      small.factor();
      other.factor();
      small.solve(x.data());
      other.solve(y.data());
      for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(x[i], y[i], 1e-11 * (1 + std::abs(y[i]))) << n << " " << i;
    }
  EXPECT_FALSE(SparseSystem(neighbours(16, 3, false)).is_small()) << "a band costs less";
}

TEST(SparseSystem, SmallOnesHaveNoFiniteSolutionWhereThereIsNoInverse) {
  for (std::uint32_t n = 1; n <= 6; ++n)
    for (const double size : {0.0, 1.0}) {  // the zero matrix; all rows alike
      SparsityPattern pattern = neighbours(n, n, false);
      SparseSystem system(pattern);
      system.clear();
      for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j) system.add(i, j, n == 1 ? 0 : size * (j + 1));
      std::vector<double> b(n);
      for (std::uint32_t i = 0; i < n; ++i) b[i] = i + 1;
      EXPECT_TRUE(system.factor());
      system.solve(b.data());
      EXPECT_FALSE(std::isfinite(b[0])) << n;
    }
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
  for (std::size_t i = 0; i < n; ++i) {  // depends on i, i + 1 and, through a sine, i + 2; the last ones on fewer
    Symbol y = x[i] * x[i];
    if (i + 1 < n) y = y + 3.0 * x[i + 1];
    if (i + 2 < n) y = y + sin(x[i] * x[i + 2]);
    outputs.push_back(y.place());
  }
  const tape::SparseJacobian jacobian(tape, outputs, n);
  EXPECT_EQ(jacobian.evaluations(), 3U);
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

/// Written records the gradient of Σ (x_i x_{i+1}² + sin(x_i x_{i+1})) + 3 x₀ over three variables, on a tape with
/// `variables` variables.
struct Written {
  tape::Tape tape;
  std::vector<tape::Index> outputs;

  explicit Written(std::size_t variables) {
    std::vector<Symbol> x;
    for (std::size_t i = 0; i < variables; ++i) x.push_back(Symbol::variable(tape, i));
    Symbol v = 3.0 * x[0];
    for (std::size_t i = 0; i < 2; ++i) v = v + x[i] * x[i + 1] * x[i + 1] + sin(x[i] * x[i + 1]);
    std::vector<int> all(variables);
    std::iota(all.begin(), all.end(), 0);
    for (const Symbol& slope : tape::gradient(tape, v, all)) outputs.push_back(slope.on(tape));
  }
};

TEST(SparseJacobian, OfFewVariablesIsWrittenOut) {
  using Kind = tape::SparseJacobian::Kind;
  for (const Kind kind : {Kind::general, Kind::hessian}) {
    Written few(3), many(9);
    const tape::SparseJacobian written(few.tape, few.outputs, 3, kind), dual(many.tape, many.outputs, 9, kind);
    EXPECT_TRUE(written.is_written_out());
    EXPECT_FALSE(dual.is_written_out());
    EXPECT_EQ(written.evaluations(), 1U);
    const double at[9] = {0.3, -0.8, 1.1};
    double expected[9][9] = {}, values[9], slopes[9], alone[3];
    const tape::Formula of_few(few.tape, few.outputs), of_many(many.tape, many.outputs);
    dual.evaluate(
        of_many, at, 0, [&](std::size_t i, std::size_t j, double entry) { expected[i][j] = entry; }, slopes);
    of_few.evaluate(at, 0.0, alone);
    for (double* const to : {static_cast<double*>(nullptr), values}) {
      std::size_t entries = 0;
      written.evaluate(
          of_few, at, 0,
          [&](std::size_t i, std::size_t j, double entry) {
            EXPECT_NEAR(entry, expected[i][j], 1e-14) << i << j;
            ++entries;
          },
          to);
      EXPECT_EQ(entries, 7U) << "the first and the last share none";
    }
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_DOUBLE_EQ(values[i], alone[i]);
      EXPECT_DOUBLE_EQ(slopes[i], alone[i]);
    }
  }
}

// Functions of time alone have values, but no entries in the Jacobian.
TEST(SparseJacobian, TellsTheValuesOfWhatDoesNotChange) {
  for (const std::size_t n : {2, 9}) {
    tape::Tape tape;
    const std::vector<tape::Index> outputs(n, (sin(Symbol::time(tape)) + 2.0).place());
    const tape::SparseJacobian jacobian(tape, outputs, n);
    EXPECT_EQ(jacobian.evaluations(), 0U);
    std::vector<double> x(n), values(n);
    jacobian.evaluate(
        tape::Formula(tape, outputs), x.data(), 0.5, [](std::size_t, std::size_t, double) { ADD_FAILURE(); },
        values.data());
    for (const double value : values) EXPECT_DOUBLE_EQ(value, std::sin(0.5) + 2);
  }
}

// Outputs that share a long part each repeat its derivatives, which together take longer than dual numbers.
TEST(SparseJacobian, IsNotWrittenOutWhereThatIsLong) {
  constexpr std::size_t n = 4;
  tape::Tape tape;
  std::vector<Symbol> x;
  for (std::size_t i = 0; i < n; ++i) x.push_back(Symbol::variable(tape, i));
  Symbol shared = x[0];
  for (int k = 0; k < 20; ++k) shared = sin(shared * x[k % n]) / (shared + 2.0);
  std::vector<tape::Index> outputs;
  for (std::size_t i = 0; i < n; ++i) outputs.push_back((shared * x[i]).place());
  const tape::SparseJacobian jacobian(tape, outputs, n);
  EXPECT_FALSE(jacobian.is_written_out());
  EXPECT_EQ(jacobian.evaluations(), n);
}

}  // namespace
}  // namespace least
