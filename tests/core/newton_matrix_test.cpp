// Matrices of Newton's method whose size is known at run time: few unknowns by the inverse, many by L and U.
#include "core/newton_matrix.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/number/asked_by_thread.hpp"

namespace least {
namespace {

/// entry() has no regularity; the first column has its largest entry in the last row, so that rows are exchanged.
double entry(std::size_t i, std::size_t j, std::size_t n) {
  return std::sin(1.3 * double(i * i) + 7.1 * double(j) + 2) + (i + j == n - 1 ? 3 : 0);
}

TEST(NewtonMatrix, SolvesForNumbersAndWhatTheyCarry) {
  using D = Dual<double, 2>;
  for (const std::size_t n : {std::size_t(1), std::size_t(2), std::size_t(7), NewtonMatrix::most_inverted,
                              NewtonMatrix::most_inverted + 1, std::size_t(130)}) {
    NewtonMatrix matrix(n);
    EXPECT_EQ(matrix.is_large(), n > NewtonMatrix::most_inverted);
    for (int again = 0; again < 2; ++again) {
      std::vector<D> x(n), b(n), found(n);
      for (std::size_t i = 0; i < n; ++i) x[i] = D(std::cos(3.0 * double(i)), {double(i), 1 - double(again)});
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) {
          matrix.entries()[i * n + j] = (1 + again) * entry(i, j, n);
          b[i] = b[i] + (1 + again) * entry(i, j, n) * x[j];
        }
      ASSERT_TRUE(matrix.factor());
      matrix.solve(b.data(), found.data());
      for (std::size_t i = 0; i < n; ++i) {
        EXPECT_NEAR(found[i].value, x[i].value, 1e-12) << n << " " << i;
        EXPECT_NEAR(found[i].slope[0], x[i].slope[0], 1e-10) << n << " " << i;
        EXPECT_NEAR(found[i].slope[1], x[i].slope[1], 1e-12) << n << " " << i;
      }
      std::vector<double> plain(n), right(n);
      for (std::size_t i = 0; i < n; ++i) right[i] = b[i].value;
      matrix.solve(right.data(), plain.data());
      for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(plain[i], x[i].value, 1e-12) << n << " " << i;
    }
  }
}

TEST(NewtonMatrix, WithoutInverseFindsNothingFinite) {
  for (const std::size_t n : {2, 40}) {
    NewtonMatrix matrix(n);
    std::fill_n(matrix.entries(), n * n, 1.0);
    ASSERT_TRUE(matrix.factor());
    std::vector<double> b(n), x(n);
    for (std::size_t i = 0; i < n; ++i) b[i] = double(i);
    matrix.solve(b.data(), x.data());
    bool finite = true;
    for (const double c : x) finite = finite && std::isfinite(c);
    EXPECT_FALSE(finite) << n;
  }
}

// Where only neighbours are coupled, and weakly, L and U decay with the distance from the diagonal. Numbers below
// 1e-308 are subnormal, and a processor takes a hundred times as long for each operation with them.
TEST(NewtonMatrix, HasNoNumbersThatAreSlow) {
  constexpr std::size_t n = 400;
  NewtonMatrix matrix(n);
  double* const a = matrix.entries();
  std::fill_n(a, n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    a[i * n + i] = 1;
    if (i > 0) a[i * n] = a[i] = std::pow(1e-2, double(i));
    if (i + 1 < n) a[i * n + i + 1] = a[(i + 1) * n + i] = 1e-2;
  }
  for (std::size_t i = 0; i < n * n; ++i)
    if (std::fpclassify(a[i]) == FP_SUBNORMAL) a[i] = 0;
  ASSERT_TRUE(matrix.factor());
  for (std::size_t i = 0; i < n * n; ++i) ASSERT_NE(std::fpclassify(a[i]), FP_SUBNORMAL) << i / n << " " << i % n;
  std::vector<double> b(n), x(n);
  b[0] = 1;
  matrix.solve(b.data(), x.data());
  EXPECT_NEAR(x[0] + 2e-2 * x[1], 1, 1e-3);
}

TEST(NewtonMatrix, AsksWhetherToGoOnWhereItIsLarge) {
  const AskedByThread never([] { return false; });
  for (const std::size_t n : {NewtonMatrix::most_inverted, NewtonMatrix::most_inverted + 1}) {
    NewtonMatrix matrix(n);
    for (std::size_t i = 0; i < n * n; ++i) matrix.entries()[i] = i % (n + 1) == 0 ? 1 : 0;
    EXPECT_EQ(matrix.factor(), !matrix.is_large());
  }
}

}  // namespace
}  // namespace least
