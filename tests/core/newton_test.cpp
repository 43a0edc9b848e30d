// Newton's method where the class of a problem has room for more unknowns than a scene has.
#include "core/newton.hpp"

#include <gtest/gtest.h>

#include <array>

namespace least {
namespace {

/// Two unknowns in eight places: x₀² + x₄ = a and x₄ − x₀ = 1 have the solution x₀ = 1, x₄ = 2 for a = 3.
constexpr SomeUnknowns<8> two{{0, 4}, 2};

template <class A>
auto equations(const A& a, int& calls) {
  return [a, &calls](const auto& x) {
    ++calls;
    auto wrong = x;
    for (auto& w : wrong) w = w - 7.0;  // places without an unknown have no equation
    wrong[0] = x[0] * x[0] + x[4] - a;
    wrong[4] = x[4] - x[0] - 1.0;
    return wrong;
  };
}

TEST(Newton, AsksForTheUnknownsThatThereAre) {
  Vec<8> x;
  x.fill(5);
  int calls = 0;
  Work work;
  ASSERT_EQ(newton<8>(x, two, 1.0, 0.0, equations(3.0, calls), 1, work), StepStatus::ok);
  EXPECT_NEAR(x[0], 1, 1e-14);
  EXPECT_NEAR(x[4], 2, 1e-14);
  for (const std::size_t i : {1, 2, 3, 5, 6, 7}) EXPECT_EQ(x[i], 5);
  EXPECT_EQ(calls, work.iterations) << "a Jacobian of two columns takes one look";
}

// With a coarse tolerance the iteration of the values ends before their derivatives have converged: one more iteration
// brings them along.
TEST(Newton, FollowsTheDerivativeOfASolution) {
  using D = Dual<double, 1>;
  for (const auto& [grain, near] : {std::array{0.0, 1e-13}, std::array{1e-3, 1e-6}}) {
    Vec<8, D> x;
    x.fill(D(5));
    int calls = 0;
    Work work;
    ASSERT_EQ(newton<8>(x, two, D(1), D(grain), equations(D(3, {1.0}), calls), 1, work), StepStatus::ok);
    EXPECT_NEAR(x[0].value, 1, near);
    EXPECT_NEAR(x[0].slope[0], 1 / 3.0, near);  // (2 x₀ + 1) dx₀ = da
    EXPECT_NEAR(x[4].slope[0], 1 / 3.0, near);
  }
}

TEST(Newton, FindsTheSameWithColumnsAFewAtATime) {
  const auto chain = [](const auto& x) {
    auto wrong = x;
    for (std::size_t i = 0; i < x.size(); ++i)
      wrong[i] = x[i] * x[i] * x[i] + 2.0 * x[i] - 0.5 * x[(i + 1) % x.size()] - double(i + 1);
    return wrong;
  };
  Vec<7> at_once, some;
  at_once.fill(1);
  some.fill(1);
  Work work;
  ASSERT_EQ(newton<7>(at_once, AllUnknowns{}, 1.0, 0.0, chain, 1, work), StepStatus::ok);
  ASSERT_EQ(newton<7>(some, SomeUnknowns<7>::all(), 1.0, 0.0, chain, 1, work), StepStatus::ok);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(some[i], at_once[i], 1e-15 * at_once[i]);
}

/// Room for three coordinates, of which two exist.
struct Roomy {
  static constexpr int dof = 3;
  std::size_t coordinates() const { return 2; }
};

TEST(Newton, CountsUnknownsInBlocksOfCoordinates) {
  const auto blocks = unknowns_of<6, 3>(Roomy());
  EXPECT_EQ(blocks.count, 4u);
  EXPECT_EQ((std::array<int, 4>{blocks.place[0], blocks.place[1], blocks.place[2], blocks.place[3]}),
            (std::array<int, 4>{0, 1, 3, 4}));
  const auto with_more = unknowns_of<8, 4>(Roomy());  // each block has one unknown more than coordinates
  EXPECT_EQ(with_more.count, 6u);
  EXPECT_EQ(with_more.place[2], 3);
  EXPECT_EQ(with_more.place[5], 7);
}

}  // namespace
}  // namespace least
