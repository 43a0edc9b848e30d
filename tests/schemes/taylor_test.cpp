// Taylor steps: as accurate as their tolerance, with dense output as accurate as steps, and the same whatever is
// carried along.
#include "core/schemes/taylor.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/problems/damped_kepler.hpp"
#include "core/problems/driven_oscillator.hpp"
#include "core/problems/henon_heiles.hpp"
#include "core/problems/kepler.hpp"
#include "core/problems/lane_emden.hpp"
#include "core/problems/pendulum.hpp"
#include "core/problems/perturbed_kepler.hpp"
#include "core/problems/scalar_field_cosmology.hpp"
#include "core/problems/spin_orbit.hpp"
#include "core/problems/van_der_pol.hpp"
#include "core/state_error.hpp"
#include "core/tape/unrolled.hpp"
#include "tests/support/typed_taylor.hpp"

namespace {

using namespace least;
using namespace least::problems;

/// taylor_at() returns the state at t by whole steps and the polynomial of the last one.
template <class P, class X>
X taylor_at(const P& problem, X x, double t, double tolerance, int order = 0) {
  auto stepper = TypedTaylor{tolerance, order}.bind(problem, x);
  while (x.t < t)
    if (stepper.step(x) != StepStatus::ok) {
      ADD_FAILURE() << "at t = " << x.t;
      return x;
    }
  if (x.t > t) {
    EXPECT_TRUE(stepper.interpolate(x, t));
  }
  return x;
}

TEST(Taylor, ErrorsAreThoseOfTheTolerance) {
  const Kepler<> kepler;
  const State<2> ellipse{0, {0.4, 0}, {0, 2}, {}};
  const DrivenOscillator<> driven;
  const State<1> start{5, {1}, {0}, {}};
  double last = 1, before = 1;  // a single one may be small by chance
  for (const double tolerance : {1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13}) {
    const double orbit = state_error(taylor_at(kepler, ellipse, 20, tolerance), kepler.exact(ellipse, 20.0));
    EXPECT_LT(orbit, 500 * tolerance);  // three periods: differences of the start grow by as much
    EXPECT_LT(orbit, 0.01 * std::exchange(before, std::exchange(last, orbit)));
    EXPECT_LT(state_error(taylor_at(driven, start, 25, tolerance), driven.exact(start, 25.0)), 10 * tolerance);
  }
}

/// Other parameters: the program still has a structure that the compiler has unrolled, but its own constants.
TEST(Taylor, IsUnrolledForOtherParametersToo) {
  const auto known = [](const auto& problem) {
    using X = StateOf<std::remove_cvref_t<decltype(problem)>>;
    const auto program = taylor::record<X>(problem);
    std::array<double, X::size> x;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = 0.7 + 0.2 * static_cast<double>(i);
    bool unrolled = true;
    for (const int order : {1, 2, 3, 4, 5, 6, 9, 20, 31}) {
      tape::Series series(program, order), read(program, order, false);
      for (tape::Series* one : {&series, &read}) one->expand(x.data(), 1.5);
      for (int k = 0; k <= order; ++k)
        EXPECT_TRUE(std::equal(series.coefficients(k), series.coefficients(k) + x.size(), read.coefficients(k)))
            << program.rows << " values, order " << k << " of " << order;
      unrolled = unrolled && series.unrolled();
    }
    return unrolled || tape::unrolled_series().empty();
  };
  EXPECT_TRUE(known(Kepler<>{.mu = 2}));
  EXPECT_TRUE(known(VanDerPol<>{.epsilon = 10}));
  EXPECT_TRUE(known(VanDerPol<>{.epsilon = 10, .amplitude = 0.5, .frequency = 2}));
  EXPECT_TRUE(known(LaneEmden<>{.n = 1.5}));
  EXPECT_TRUE(known(PerturbedKepler<>{.gamma = -1, .alpha = -0.07, .frequency = 6}));
  EXPECT_TRUE(known(ScalarFieldCosmology<>{.lambda = 0.2}));
  EXPECT_TRUE(known(Pendulum<>{}));
  EXPECT_TRUE(known(DampedKepler<>{}));
  EXPECT_TRUE(known(HenonHeiles<>{}));
  EXPECT_TRUE(known(SpinOrbit<>{}));
}

// The step of a state at rest is as long as the time suggests: powers of it overflow.
TEST(Taylor, RestsHoweverLateItIs) {
  for (const double start : {1e16, 1e60, 1e150})
    for (const int order : {0, 40}) {
      State<1> x{start, {0}, {0}, {}};
      auto stepper = TypedTaylor{1e-12, order}.bind(Pendulum<>{}, x);
      for (int i = 0; i < 5; ++i) ASSERT_EQ(stepper.step(x), StepStatus::ok) << start;
      EXPECT_EQ(x.q[0], 0) << start;
      EXPECT_EQ(x.p[0], 0) << start;
    }
}

TEST(Taylor, OfAnyOrderIsAsAccurate) {
  const Kepler<> kepler;
  const State<2> ellipse{0, {0.4, 0}, {0, 2}, {}};
  for (const int order : {4, 8, 16, 20, 24, 40})
    EXPECT_LT(state_error(taylor_at(kepler, ellipse, 5, 1e-8, order), kepler.exact(ellipse, 5.0)), 1e-6) << order;
  auto x = ellipse;
  auto stepper = TypedTaylor{1e-8, 13}.bind(kepler, x);
  ASSERT_EQ(stepper.step(x), StepStatus::ok);
  EXPECT_EQ(stepper.work().forces, 13);
}

// A hundred periods at the tolerance 1e-15: without compensated sums rounding would cost a digit and a half more.
TEST(Taylor, RoundingStaysSmall) {
  const Kepler<> kepler;
  const State<2> ellipse{0, {0.4, 0}, {0, 2}, {}};
  const double end = 200 * std::acos(-1.0);
  EXPECT_LT(state_error(taylor_at(kepler, ellipse, end, 1e-15), kepler.exact(ellipse, end)), 2e-11);
}

template <class P, class X>
void dense_output_is_a_run_that_ends_there(const P& problem, const X& start, double span) {
  X x = start;
  const auto scheme = TypedTaylor{1e-15};
  auto stepper = scheme.bind(problem, x);
  double most = 0;
  int steps = 0;
  while (x.t < start.t + span) {
    const X before = x;
    ASSERT_EQ(stepper.step(x), StepStatus::ok);
    ++steps;
    for (const double part : {0.1, 0.5, 0.9, 1.0}) {
      X between, reached = before;
      const double t = before.t + part * (x.t - before.t);
      ASSERT_TRUE(stepper.interpolate(between, t));
      ASSERT_EQ(scheme.bind(problem, before).reach(reached, t), StepStatus::ok);
      most = std::max(most, state_error(between, reached));
    }
  }
  EXPECT_GT(steps, 3);
  EXPECT_LT(most, 1e-13);
}
TEST(Taylor, DenseOutputIsARunThatEndsThere) {
  dense_output_is_a_run_that_ends_there(Kepler<>{}, State<2>{0, {0.4, 0}, {0, 2}, {}}, 10);
  dense_output_is_a_run_that_ends_there(VanDerPol<>{10}, Point<2>{0, {2, 0}}, 20);
  dense_output_is_a_run_that_ends_there(SpinOrbit<>{}, State<1>{0, {0.3}, {1}, {}}, 20);
}

/// (q, p) has the same bits with and without what can be carried along.
template <class P, class More, class X>
void carrying_changes_nothing(const P& problem, const More& more) {
  X plain;
  More full = more;
  plain.t = full.t;
  for (std::size_t i = 0; i < X::size; ++i) plain[i] = taylor::component(full, i);
  auto alone = TypedTaylor{}.bind(problem, plain);
  auto carrying = TypedTaylor{}.bind(problem, full);
  for (int k = 0; k < 50; ++k) {
    ASSERT_EQ(alone.step(plain), StepStatus::ok);
    ASSERT_EQ(carrying.step(full), StepStatus::ok);
    ASSERT_EQ(plain.t, full.t);
    for (std::size_t i = 0; i < X::size; ++i) ASSERT_EQ(plain[i], taylor::component(full, i)) << k;
  }
}
TEST(Taylor, WhatIsCarriedChangesNoBit) {
  carrying_changes_nothing<PerturbedKepler<>, FullStateOf<PerturbedKepler<>>, StateOf<PerturbedKepler<>>>(
      {}, {0, {0.5, 0}, {0, 1.7}, {0}});
  carrying_changes_nothing<SpinOrbit<>, FullStateOf<SpinOrbit<>>, StateOf<SpinOrbit<>>>({}, {0, {0.3}, {1}, {0}});
  FullRunState<VanDerPol<>> x;
  x[0] = {2, {1}};
  x[1] = {0.5, {-0.3}};
  carrying_changes_nothing<VanDerPol<>, FullRunState<VanDerPol<>>, Point<2>>({}, x);
}

// A tangent vector that begins as the flow's own field stays the field.
TEST(Taylor, ATangentDirectionMovesWithTheFlow) {
  const VanDerPol<> problem{3};
  FullRunState<VanDerPol<>> x;
  Point<2> from{0, {2, 0.5}};
  for (std::size_t i = 0; i < 2; ++i) x[i] = {from[i], {derivative(problem, from)[i]}};
  x = taylor_at(problem, x, 7.0, 1e-13);
  const auto rate = derivative(problem, plain(x));
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(x[i].slope[0], rate[i], 1e-9 * std::abs(rate[i]) + 1e-10);
}

// x = t − λt⁵/20 + …: at order 19 the last two coefficients vanish, although the series does not end.
TEST(Taylor, VanishingCoefficientsDoNotMakeALongStep) {
  const ScalarFieldCosmology<> quartic{0, 1, 0};
  const StateOf<ScalarFieldCosmology<>> start{0, {0}, {1}, {0}};
  auto x = start;
  auto stepper = TypedTaylor{1e-10, 19}.bind(quartic, x);
  ASSERT_EQ(stepper.step(x), StepStatus::ok);
  EXPECT_LT(x.t, 2.5);  // the nearest singularity lies at |t| = 2.6
  EXPECT_GT(x.t, 0.3);
  EXPECT_NEAR(energy(quartic, x), 0.5, 1e-9);
}

/// ẋ = 1 − x¹²: from x = 0 the coefficients of t² … t¹² vanish, and from near 0 they are tiny and say nothing of the
/// radius.
struct Saturation {
  static constexpr int dim = 1;
  template <class T, class S>
  constexpr Vec<1, T> field(const Vec<1, T>& y, const S&) const {
    using least::pow;
    return {T(1) - pow(y[0], 12.0)};
  }
};
TEST(Taylor, ARowOfVanishingCoefficientsDoesNotMakeALongStep) {
  const double x = 0.95;
  double time = 0;  // ∫ dx/(1 − x¹²)
  for (int k = 0; k < 60; ++k) time += std::pow(x, 12 * k + 1) / (12 * k + 1);
  for (const int order : {0, 4, 8, 9, 12, 20, 40})
    for (const double start : {0.0, 1e-9}) {
      const Point<1> from{0, {start}};
      EXPECT_NEAR(taylor_at(Saturation{}, from, time, 1e-3, order).y[0], x, 1e-2) << order << ' ' << start;
      EXPECT_NEAR(taylor_at(Saturation{}, from, 3, 1e-3, order).y[0], 1, 1e-2) << order << ' ' << start;
    }
}

// What a thread keeps of a run serves the next one only for the same equations; two runs at once may share it.
TEST(Taylor, WhatOtherRunsLeaveBehindChangesNoBit) {
  const auto orbit = [](double mu, double tolerance, int steps, auto&& meanwhile) {
    const Kepler<> kepler{.mu = mu};
    State<2> x{0, {0.4, 0}, {0, 2}, {}};
    auto stepper = TypedTaylor{tolerance}.bind(kepler, x);
    for (int k = 0; k < steps; ++k) {
      EXPECT_EQ(stepper.step(x), StepStatus::ok);
      meanwhile();
    }
    return x;
  };
  const auto nothing = [] {};
  const auto alone = orbit(1, 1e-12, 20, nothing);
  EXPECT_FALSE(orbit(2, 1e-12, 20, nothing) == alone);
  EXPECT_FALSE(orbit(1, 1e-6, 20, nothing) == alone);
  for (const auto& [mu, tolerance] : {std::pair{1.0, 1e-12}, {1.0, 1e-6}, {2.0, 1e-12}}) {
    EXPECT_TRUE(orbit(1, 1e-12, 20, [&, mu = mu, tolerance = tolerance] { orbit(mu, tolerance, 3, nothing); }) ==
                alone);
    orbit(mu, tolerance, 3, nothing);
    EXPECT_TRUE(orbit(1, 1e-12, 20, nothing) == alone) << mu << ' ' << tolerance;
  }
}

// A force that ends at q = 0: a step ends there, too, and the next begins behind it.
TEST(Taylor, StepsEndWhereAFormulaChanges) {
  const LaneEmden<> star{1, AfterZero::clamp};
  const double pi = std::acos(-1.0);
  const State<1> start{1, {std::sin(1.0)}, {std::cos(1.0) - std::sin(1.0)}, {}};
  const auto x = taylor_at(star, start, 10, 1e-12);
  EXPECT_NEAR(x.p[0], -pi / 100, 1e-12);  // p t² stays what it is at π
  EXPECT_NEAR(x.q[0], pi / 10 - 1, 1e-12);
}

// 2/t is singular, the motion is not: no step crosses the singularity, and none has to be short because of it.
TEST(Taylor, StepsAreNotLongerThanTheTimeToASingularDamping) {
  const LaneEmden<> star{1, AfterZero::continue_};
  State<1> x{0.1, {std::sin(0.1) / 0.1}, {(std::cos(0.1) - std::sin(0.1) / 0.1) / 0.1}, {}};
  auto stepper = TypedTaylor{1e-12}.bind(star, x);
  int steps = 0;
  for (; x.t < 30; ++steps) ASSERT_EQ(stepper.step(x), StepStatus::ok);
  EXPECT_LT(steps, 60);
  EXPECT_NEAR(x.q[0], std::sin(x.t) / x.t, 1e-10);
  State<1> before{-1, {std::sin(1.0)}, {std::sin(1.0) - std::cos(1.0)}, {}};
  auto towards = TypedTaylor{1e-12}.bind(star, before);
  for (int k = 0; k < 200 && towards.step(before) == StepStatus::ok; ++k) ASSERT_LT(before.t, 0);
}

TEST(Taylor, CopiesGoOnWithTheSameBits) {
  const Kepler<> kepler;
  State<2> x{0, {0.4, 0}, {0, 2}, {}};
  auto stepper = TypedTaylor{}.bind(kepler, x);
  for (int k = 0; k < 5; ++k) ASSERT_EQ(stepper.step(x), StepStatus::ok);
  auto copy = stepper;
  auto y = x, between = x, again = x;
  const double t = x.t - 0.01;
  ASSERT_TRUE(copy.interpolate(between, t));
  for (int k = 0; k < 20; ++k) ASSERT_EQ(stepper.step(x), StepStatus::ok);
  ASSERT_TRUE(copy.interpolate(again, t));  // whatever other copies have done meanwhile
  EXPECT_TRUE(between == again);
  EXPECT_FALSE(copy.interpolate(again, x.t));
  for (int k = 0; k < 20; ++k) ASSERT_EQ(copy.step(y), StepStatus::ok);
  EXPECT_TRUE(x == y);
  EXPECT_EQ(stepper.work().forces, copy.work().forces);
}

TEST(Taylor, WhatIsNoNumberIsSingular) {
  const Kepler<> kepler;
  for (const double bad : {0.0, std::nan(""), 1e300}) {
    State<2> x{0, {bad, 0}, {0, bad == 1e300 ? 1e300 : 0.0}, {}};
    const auto before = x;
    auto stepper = TypedTaylor{}.bind(kepler, x);
    const StepStatus status = stepper.step(x);
    if (bad == 1e300) continue;  // this one may pass for free motion
    EXPECT_EQ(status, StepStatus::singular) << bad;
    EXPECT_EQ(std::isnan(x.q[0]), std::isnan(before.q[0]));
    EXPECT_EQ(x.t, 0);
  }
}

}  // namespace
