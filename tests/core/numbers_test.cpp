// Dual numbers against difference quotients, the linear solve against its definition.
#include <gtest/gtest.h>

#include <cmath>

#include "core/number/linear.hpp"
#include "core/number/quad.hpp"
#include "core/problem.hpp"

namespace {

using namespace least;

static_assert(sizeof(State<1>) == 24, "a conservative scene carries t, q, p and nothing else");
static_assert(sizeof(State<2>) == 40);
static_assert(sizeof(State<1, double, double, Action<double>>) == 32, "s is there where it is asked for");
template <class X>
concept CarriesAction = requires(X x) {
  x.action.s;
};
static_assert(!CarriesAction<State<1>> && CarriesAction<State<1, double, double, Action<double>>>);

using D = Dual<double, 1>;

template <class F>
void check(F f, double x) {
  const double h = 1e-6;
  const D value = f(D(x, {1.0}));
  EXPECT_DOUBLE_EQ(value.value, f(x));
  EXPECT_NEAR(value.slope[0], (f(x + h) - f(x - h)) / (2 * h), 1e-8 * (1 + std::abs(value.slope[0])));
  const auto nested = f(Dual<D, 1>(D(x, {1.0}), {D(1.0)}));
  EXPECT_NEAR(nested.slope[0].slope[0], (f(x + 1e-4) - 2 * f(x) + f(x - 1e-4)) / 1e-8,
              1e-4 * (1 + std::abs(nested.slope[0].slope[0])));
}

TEST(Dual, ElementaryFunctions) {
  for (const double x : {0.3, 1.7}) {
    check(
        [](const auto& u) {
          using least::sin;
          return sin(u);
        },
        x);
    check(
        [](const auto& u) {
          using least::cos;
          return cos(u);
        },
        x);
    check(
        [](const auto& u) {
          using least::exp;
          return exp(u);
        },
        x);
    check(
        [](const auto& u) {
          using least::log;
          return log(u);
        },
        x);
    check(
        [](const auto& u) {
          using least::sqrt;
          return sqrt(u);
        },
        x);
    check(
        [](const auto& u) {
          using least::pow;
          return pow(u, 2.5);
        },
        x);
    check(
        [](const auto& u) {
          using least::abs;
          return abs(-u);
        },
        x);
    check(
        [](const auto& u) {
          using least::sincos;
          return sincos(u).first * sincos(u).second;
        },
        x);
    check([](const auto& u) { return (1.0 - u) / (2.0 + u * u) - 3 * u + u / 4 - (u - 1) * (2 / u); }, x);
    check(
        [](auto u) {
          u += 2.0;
          u *= u;
          u -= 1.0;
          u /= 3.0;
          return -u;
        },
        x);
  }
}

TEST(Dual, ConstantsKeepTheDigitsOfTheNumber) {  // a long double beside a dual is not narrowed to double
  const long double third = 1.0L / 3;
  const Dual<long double, 1> x(1.0L, {1.0L});
  EXPECT_EQ((third * x).value, third);
  EXPECT_EQ((x + third).value, 1.0L + third);
  EXPECT_EQ((third * Dual<Dual<long double, 1>, 1>(x)).value.value, third);
}

TEST(LinearSolver, SolvesAndDifferentiates) {
  const Mat<3> a{{{2, 1, -1}, {0, 0, 3}, {1, 4, 1}}};  // needs a pivot
  const Vec<3> b{1, 2, 3};
  const auto x = LinearSolver<double>::solve(a, b);
  const auto back = a * x;
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(back[i], b[i], 1e-14);

  Mat<3, D> da;
  Vec<3, D> db;
  for (std::size_t i = 0; i < 3; ++i) {
    db[i] = D(b[i], {double(i)});
    for (std::size_t j = 0; j < 3; ++j) da[i][j] = D(a[i][j], {double(i) - double(j)});
  }
  const auto dx = LinearSolver<D>::solve(da, db);
  const auto dback = da * dx;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(dback[i].value, b[i], 1e-14);
    EXPECT_NEAR(dback[i].slope[0], double(i), 1e-14);
  }
  const auto none = LinearSolver<double>::solve(Mat<2>{}, Vec<2>{1, 1});
  EXPECT_FALSE(std::isfinite(none[0]) && std::isfinite(none[1]));
}

/// A matrix without symmetry that needs pivots, with a known solution.
template <class T, int N>
void solves() {
  Mat<N, T> a;
  Vec<N, T> expected;
  for (std::size_t i = 0; i < N; ++i) {
    expected[i] = T(std::sin(3.0 + double(i)));
    for (std::size_t j = 0; j < N; ++j) a[i][j] = T(std::sin(1.7 * double((i + 2) * (i + 2) + 5 * j * i)));
  }
  const auto x = LinearSolver<T>::solve(a, Vec<N, T>(a * expected));
  for (std::size_t i = 0; i < N; ++i) {
    const T error = x[i] - expected[i];
    EXPECT_LT(std::abs(double(error)), 1e4 * N * Precision<T>::epsilon) << N;
  }
}
template <class T>
void solves_any_size() {
  solves<T, 2>();
  solves<T, 3>();
  solves<T, 4>();
  solves<T, 5>();
  solves<T, 16>();  // the last one without blocks
  solves<T, 17>();
  solves<T, 30>();
  solves<T, largest_system>();
}
TEST(LinearSolver, IsOfAnySize) {
  solves_any_size<double>();
  solves_any_size<long double>();
  solves_any_size<Quad>();
}

/// A permutation of a triangular matrix.
template <int N>
void determinant_is_the_product() {
  Mat<N> a{};
  double product = 1;
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = i; j < N; ++j) a[i][j] = std::cos(double(i * j));
    a[i][i] = i % 3 == 0 ? -1.5 : 1.25;
    product *= a[i][i];
  }
  std::swap(a[0], a[N - 1]);
  EXPECT_NEAR(determinant(a), -product, 1e-10 * std::abs(product)) << N;
}
TEST(Determinant, IsOfAnySize) {
  determinant_is_the_product<3>();
  determinant_is_the_product<7>();
  determinant_is_the_product<17>();
  determinant_is_the_product<33>();
}

TEST(SolveDefinite, AgreesWithTheGeneralSolver) {
  const Mat<3> g{{{4, 1, 0.5}, {1, 3, -1}, {0.5, -1, 2}}};
  const Vec<3> b{1, -2, 3};
  const auto x = solve_definite(g, b), y = LinearSolver<double>::solve(g, b);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(x[i], y[i], 1e-14);
}

}  // namespace
