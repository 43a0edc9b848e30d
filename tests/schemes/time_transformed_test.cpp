// Time-transformed steps against their formulas: the maps, symplectic at a fixed level, symmetric, order by
// composition.

#include "core/schemes/time_transformed.hpp"

#include "core/problems/double_pendulum.hpp"
#include "core/problems/harmonic_oscillator.hpp"
#include "core/problems/henon_heiles.hpp"
#include "core/reference/reference.hpp"
#include "tests/support/clocks.hpp"
#include "tests/support/lanes.hpp"
#include "tests/support/tangents.hpp"

namespace {

using namespace least;
using namespace least::problems;
using namespace clocks;

static_assert(SelfTimedSchemeFor<TimeTransformed, Kepler<>> && SelfTimedSchemeFor<TimeTransformed, DoublePendulum<>>);
static_assert(!FixedStepSchemeFor<TimeTransformed, Kepler<>>);

// ---- the maps

// Masses that are not 1: m = 2, k = 3.
TEST(TimeTransformed, ConstantMetricIsLeapfrogForTheLogarithms) {
  const HarmonicOscillator<> m{2, 3};
  const double sigma = 0.3, kappa = 0.7;
  double q = 0.8, p = 0.5, t = 0;
  const double level = p * p / 4 + 1.5 * q * q;
  State<1> x{0, {q}, {p}, {}};
  auto stepper = TimeTransformed{sigma, kappa}.bind(m, x, level);
  for (int k = 0; k < 3; ++k) {
    const auto drift = [&] {
      const double h = sigma / 2 / (p * p / 4 + kappa);
      q += h * p / 2;
      t += h;
    };
    drift();
    p -= sigma * 3 * q / (level - 1.5 * q * q + kappa);
    drift();
    ASSERT_EQ(stepper.step(x), StepStatus::ok);
    EXPECT_NEAR(x.q[0], q, 1e-15);
    EXPECT_NEAR(x.p[0], p, 1e-15);
    EXPECT_NEAR(x.t, t, 1e-15);
  }
}

// p₀ = −∂S/∂q₀ and p₁ = ∂S/∂q₁ for S = L_d(q₀, q₁; h) + E₀h, h = σ/(E₀ − V(m) + κ), with the derivatives by dual
// numbers.
TEST(TimeTransformed, MetricIsTheMidpointRuleWithAStepOfThePosition) {
  const DoublePendulum<> m{1.3, 0.7, 0.9, 1.2, 1.1};
  const double sigma = 0.4, kappa = 0.6, level = energy(m, swing);
  auto x = swing;
  ASSERT_EQ((TimeTransformed{sigma, kappa}.bind(m, x, level).step(x)), StepStatus::ok);
  using D = Dual<double, 4>;
  const Vec<4> ends{swing.q[0], swing.q[1], x.q[0], x.q[1]};
  const auto s = seed<4, double>(ends);
  Vec<2, D> middle, way;
  for (std::size_t i = 0; i < 2; ++i) {
    middle[i] = (s[i] + s[i + 2]) / 2.0;
    way[i] = s[i + 2] - s[i];
  }
  const D potential = m.potential(middle, 0.0), h = sigma / (level - potential + kappa);
  const D action = dot(way, m.metric(middle) * way) / (2.0 * h) + (level - potential) * h;
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(-action.slope[i], swing.p[i], 1e-14);
    EXPECT_NEAR(action.slope[i + 2], x.p[i], 1e-14);
  }
  EXPECT_NEAR(x.t, h.value, 1e-15);
}

template <class P>
void composition_is_the_base_by_weights(const P& problem, const State<P::dof>& start) {
  const double level = energy(problem, start), sigma = 0.1;
  for (const auto composition : {Composition::suzuki_4, Composition::kahan_li_8}) {
    auto x = start, y = start;
    ASSERT_EQ((TimeTransformed{sigma, 0.8, composition}.bind(problem, x, level).step(x)), StepStatus::ok);
    const auto& weights = Weights<double>::of(composition);
    for (std::size_t i = 0; i < std::size_t(weights.stages); ++i) {
      const double gamma = weights.gamma[i];
      if (gamma > 0) {
        ASSERT_EQ((TimeTransformed{gamma * sigma, 0.8}.bind(problem, y, level).step(y)), StepStatus::ok);
      } else {  // back: the step is symmetric and reversible
        const double t = y.t;
        y = reversed(y);
        ASSERT_EQ((TimeTransformed{-gamma * sigma, 0.8}.bind(problem, y, level).step(y)), StepStatus::ok);
        y = reversed(y);
        y.t = 2 * t - y.t;
      }
    }
    EXPECT_LT(distance(x, y), 1e-14);
    EXPECT_NEAR(x.t, y.t, 1e-14);
  }
}
TEST(TimeTransformed, CompositionIsTheBaseTakenByItsWeights) {
  composition_is_the_base_by_weights(Kepler<>{}, {0, {1, 0.2}, {0.1, 0.9}, {}});
  composition_is_the_base_by_weights(DoublePendulum<>{}, swing);
}

TEST(TimeTransformed, CountsItsForces) {
  const Kepler<> kepler;
  auto x = paper;
  auto stepper = bound(TimeTransformed{0.1, 0.75, Composition::kahan_li_6}, kepler, x);
  EXPECT_EQ(stepper.work().forces, 0);
  steps(stepper, x, 10);
  EXPECT_EQ(stepper.work().forces, 90);
  EXPECT_EQ(stepper.work().iterations, 0);

  auto y = swing;
  auto implicit = bound(TimeTransformed{0.1, 0.75, Composition::kahan_li_6}, DoublePendulum<>{}, y);
  steps(implicit, y, 10);
  EXPECT_GT(implicit.work().iterations, 90);
  EXPECT_LT(implicit.work().iterations, 3.2 * 90);
  EXPECT_EQ(implicit.work().forces, 2 * 90 + implicit.work().iterations);  // one for the guess, one for the end
}

// A stepper's memory follows from the state: a copy, or a stepper bound anew at the same level, goes on with the same
// bits.
template <class P>
void goes_on_from_the_state(const P& problem, const State<P::dof>& start) {
  const TimeTransformed scheme{0.1, 0.8, Composition::kahan_li_6};
  auto x = start;
  const double level = energy(problem, x);
  auto stepper = scheme.bind(problem, x, level);
  steps(stepper, x, 7);
  auto y = x, z = x;
  auto copy = stepper;
  auto fresh = scheme.bind(problem, z, level);
  steps(stepper, x, 7);
  steps(copy, y, 7);
  steps(fresh, z, 7);
  EXPECT_EQ(x, y);
  EXPECT_EQ(x, z);
}
TEST(TimeTransformed, GoesOnFromTheStateAlone) {
  goes_on_from_the_state(Kepler<>{}, paper);
  goes_on_from_the_state(DoublePendulum<>{}, swing);
}

template <class P>
void lanes_move_as_doubles(const P& problem, const State<P::dof>& start) {
  const TimeTransformed scheme{0.1, 0.8, Composition::suzuki_4};
  auto wide = convert<toy::Lanes, toy::Lanes>(start);
  std::array<State<P::dof>, toy::width> narrow;
  toy::Lanes level;
  for (std::size_t lane = 0; lane < toy::width; ++lane) {
    narrow[lane] = start;
    narrow[lane].q[0] += 0.05 * double(lane);
    for (std::size_t i = 0; i < wide.size; ++i) wide[i].v[lane] = narrow[lane][i];
    level.v[lane] = energy(problem, narrow[lane]);
  }
  auto together = scheme.bind(problem, wide, level);
  ASSERT_EQ(steps(together, wide, 5), 5);
  for (std::size_t lane = 0; lane < toy::width; ++lane) {
    auto x = narrow[lane];
    auto alone = scheme.bind(problem, x, level.v[lane]);
    ASSERT_EQ(steps(alone, x, 5), 5);
    for (std::size_t i = 0; i < wide.size; ++i) EXPECT_EQ(wide[i].v[lane], x[i]);
    EXPECT_EQ(wide.t.v[lane], x.t);
  }
  wide.p[0].v[2] = std::numeric_limits<double>::quiet_NaN();  // one lane that fails is a step that fails
  auto spoilt = scheme.bind(problem, wide, level);
  EXPECT_NE(spoilt.step(wide), StepStatus::ok);
}
TEST(TimeTransformed, LanesMoveAsDoubles) {
  lanes_move_as_doubles(Kepler<>{}, paper);
  lanes_move_as_doubles(DoublePendulum<>{}, swing);
}

// ---- structure

template <class P>
double defect(const P& problem, const TimeTransformed& scheme, const State<P::dof>& start) {
  const double level = energy(problem, start);
  auto x = start;
  auto stepper = scheme.bind(problem, x, level);
  double most = 0;
  EXPECT_EQ(steps(stepper, x, 20,
                  [&](const State<P::dof>& y) {
                    const auto m = tangent_at_level(scheme, problem, y, level);
                    ASSERT_TRUE(m);
                    most = larger(most, symplectic_defect(*m));
                  }),
            20);
  return most;
}
TEST(TimeTransformed, IsSymplecticAtAFixedLevel) {
  for (const auto composition : {Composition::none, Composition::kahan_li_6}) {
    EXPECT_LT(defect(Kepler<>{}, {0.2, 0.75, composition}, {0, {1, 0.2}, {0.1, 0.9}, {}}), 1e-12);
    EXPECT_LT(defect(HenonHeiles<>{}, {0.1, 0.3, composition}, {0, {0.1, 0.1}, {0.4, 0.1}, {}}), 1e-12);
    EXPECT_LT(defect(DoublePendulum<>{}, {0.3, 0.5, composition}, swing), 1e-12);
  }
}
TEST(TimeTransformed, IsNotSymplecticWhereTheLevelFollowsTheState) {
  using D = Dual<double, 4>;
  const DoublePendulum<> m;
  auto y = convert<D, D>(swing);
  for (std::size_t i = 0; i < 4; ++i) y[i] = D::variable(swing[i], int(i));
  auto stepper = bound(TimeTransformed{0.3, 0.5}, m, y);
  ASSERT_EQ(stepper.step(y), StepStatus::ok);
  Mat<4> tangent;
  for (std::size_t i = 0; i < 4; ++i) tangent[i] = y[i].slope;
  EXPECT_GT(symplectic_defect(tangent), 1e-3);
}

template <class P>
void turns_round(const P& problem, const State<P::dof>& start, const TimeTransformed& scheme, double tolerance) {
  const int n = 400;
  const double level = energy(problem, start);
  auto x = start;
  auto there = scheme.bind(problem, x, level);
  ASSERT_EQ(steps(there, x, n), n);
  const double half = x.t;
  x = reversed(x);
  auto back = scheme.bind(problem, x, level);
  ASSERT_EQ(steps(back, x, n), n);
  EXPECT_LT(distance(reversed(x), start), tolerance);
  EXPECT_NEAR(x.t, 2 * half, tolerance);
}
TEST(TimeTransformed, TurnsRound) {
  for (const auto composition : {Composition::none, Composition::kahan_li_6}) {
    turns_round(Kepler<>{}, paper, {0.1, 0.75, composition}, 1e-10);
    turns_round(DoublePendulum<>{}, {0, {0.6, 0.3}, {0, 0.1}, {}}, {0.05, 0.5, composition}, 1e-10);
  }
}

// ---- order, at a fixed time

template <class T, class P>
void has_order(const P& problem, const State<P::dof>& start, double span, const TimeTransformed& coarse, double floor) {
  const auto from = convert<Quad, Quad>(start);
  Extrapolation<P, Moving<P, Quad>> truth(problem, from, 1e-28);
  ASSERT_TRUE(truth.advance(Quad(span), [] { return true; }));
  const int order = compositions::orders[std::size_t(coarse.composition)];
  std::vector<std::pair<double, double>> points;
  auto scheme = coarse;
  for (int k = 0; k < 40 && points.size() < 7; ++k, scheme.sigma /= 1.25) {
    auto x = convert<T, T>(start);
    auto stepper = bound(scheme, problem, x);
    ASSERT_EQ(until(stepper, x, T(span)), StepStatus::ok);
    const double error = distance(x, convert<T, T>(truth.state()));
    if (error < floor) break;
    if (error < 1e-5 * std::pow(10, -0.5 * order)) points.emplace_back(scheme.sigma, error);
  }
  ASSERT_GE(points.size(), 5U) << compositions::names[std::size_t(coarse.composition)];
  EXPECT_NEAR(slope(points), order, 0.1) << compositions::names[std::size_t(coarse.composition)];
}
TEST(TimeTransformed, OrdersAreTheCompositions) {
  const State<2> orbit{0, {1, 0}, {0, 1.1}, {}};
  using C = Composition;
  for (const auto c : {C::none, C::yoshida_4, C::suzuki_4}) {
    has_order<long double>(Kepler<>{}, orbit, 3, {0.1, 0.4, c}, 1e-15);
    has_order<long double>(DoublePendulum<>{}, swing, 2, {0.1, 0.5, c}, 1e-15);
  }
  for (const auto c : {C::yoshida_6, C::kahan_li_6}) {
    has_order<Quad>(Kepler<>{}, orbit, 3, {0.2, 0.4, c}, 1e-22);
    has_order<long double>(DoublePendulum<>{}, swing, 2, {0.3, 0.5, c}, 1e-16);
  }
  for (const auto c : {C::suzuki_umeno_8, C::kahan_li_8}) has_order<Quad>(Kepler<>{}, orbit, 3, {0.4, 0.4, c}, 1e-22);
}

}  // namespace
