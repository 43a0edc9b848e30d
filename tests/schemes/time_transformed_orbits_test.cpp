// Time-transformed steps on orbits: the step law and exact shape at κ = −E₀, published errors, states at any time
// within a step, and where the transformation ends.
#include <cstring>

#include "core/problems/double_pendulum.hpp"
#include "core/problems/harmonic_oscillator.hpp"
#include "core/problems/henon_heiles.hpp"
#include "core/problems/kepler_3d.hpp"
#include "core/schemes/time_transformed.hpp"
#include "tests/support/clocks.hpp"

namespace {

using namespace least;
using namespace least::problems;
using namespace clocks;

const double minus_energy = std::numeric_limits<double>::quiet_NaN();
const State<2> hyperbola{0, {0, -4}, {-0.1, 1.2}, {}};

// ---- Kepler orbits at κ = −E₀

/// The eccentric anomaly of a bound state.
double eccentric_anomaly(const State<2>& x, double mu) {
  const double r = std::hypot(x.q[0], x.q[1]), a = 1 / (2 / r - dot(x.p, x.p) / mu);
  return std::atan2(dot(x.q, x.p) / std::sqrt(mu * a), 1 - r / a);
}

TEST(TimeTransformed, EllipseTakesEqualStepsOfEccentricAnomaly) {
  for (const double mu : {1.0, 3.0})
    for (const double sigma : {0.05, 0.5, 2.0}) {
      const Kepler<> kepler{mu};
      const State<2> start{0, {1.5, 0.2}, {-0.2, 0.5}, {}};
      const double level = energy(kepler, start), law = 2 * std::atan(sigma * std::sqrt(-2 * level) / (2 * mu));
      const auto first = kepler.invariants(start.q, start.p, 0.0);
      auto x = start;
      auto stepper = bound(TimeTransformed{sigma, minus_energy}, kepler, x);
      double before = eccentric_anomaly(x, mu);
      const int taken = steps(stepper, x, 500, [&](const State<2>& y) {
        const double now = eccentric_anomaly(y, mu);
        EXPECT_NEAR(std::remainder(now - before - law, 2 * M_PI), 0, 1e-12) << sigma;
        before = now;
        const auto kept = kepler.invariants(y.q, y.p, 0.0);
        for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(kept[i], first[i], 2e-13 * mu);
        EXPECT_NEAR(energy(kepler, y), level, 1e-13 * mu);
      });
      EXPECT_EQ(taken, 500);
    }
}

TEST(TimeTransformed, HyperbolaTakesEqualStepsOfItsAnomaly) {
  const double mu = 2, sigma = 0.7;
  const Kepler<> kepler{mu};
  const State<2> start{0, {0, -1}, {-0.3, 2.4}, {}};
  const double level = energy(kepler, start);
  ASSERT_GT(level, 0);
  const double law = 2 * std::atanh(sigma * std::sqrt(2 * level) / (2 * mu));
  const auto anomaly = [&](const State<2>& x) {
    const double r = std::hypot(x.q[0], x.q[1]), a = mu / (2 * level);
    return std::atanh(dot(x.q, x.p) / std::sqrt(mu * a) / (1 + r / a));
  };
  auto x = start;
  auto stepper = bound(TimeTransformed{sigma, minus_energy}, kepler, x);
  double before = anomaly(x);
  EXPECT_EQ(steps(stepper, x, 6,
                  [&](const State<2>& y) {
                    EXPECT_NEAR(anomaly(y) - before, law, 1e-9);
                    before = anomaly(y);
                  }),
            6);
}

// METHODS, section 3b: errors over 10 periods at a number of forces.
TEST(TimeTransformed, PaperOrbitHasThePublishedErrors) {
  struct Row {
    double kappa, sigma;
    Composition composition;
    std::int64_t forces;
    double low, high;
  };
  for (const auto& row : {Row{minus_energy, 0.0048, Composition::none, 18'900, 7e-4, 9e-4},
                          Row{minus_energy, 0.024, Composition::suzuki_4, 18'900, 5e-8, 7e-8},
                          Row{minus_energy, 0.0432, Composition::kahan_li_6, 18'900, 0, 6e-11},
                          Row{0.75, 0.0099, Composition::none, 18'900, 1e-3, 1.2e-3},
                          Row{0.75, 0.08, Composition::suzuki_4, 11'700, 1.3e-5, 1.5e-5},
                          Row{0.75, 0.2, Composition::kahan_li_6, 8'400, 1.5e-5, 2.2e-5}}) {
    const auto loss = orbit_loss(TimeTransformed{row.sigma, row.kappa, row.composition}, paper, 10 * paper_period);
    EXPECT_NEAR(double(loss.forces), double(row.forces), 0.01 * double(row.forces));
    EXPECT_GT(loss.position, row.low) << row.sigma;
    EXPECT_LT(loss.position, row.high) << row.sigma;
    EXPECT_LT(loss.momentum, 1e-12);
  }
}

TEST(TimeTransformed, LongStepsOnThePaperOrbit) {
  const auto loss = orbit_loss(TimeTransformed{0.4, minus_energy, Composition::kahan_li_6}, paper, 10 * paper_period);
  EXPECT_EQ(loss.forces, 2043);
  EXPECT_LT(loss.position, 5e-5);
}

TEST(TimeTransformed, OrbitKeepsItsShapeForAHundredPeriods) {
  for (const auto& [sigma, composition] :
       {std::pair{0.02, Composition::none}, std::pair{0.18, Composition::kahan_li_6}}) {
    const auto loss = orbit_loss(TimeTransformed{sigma, minus_energy, composition}, paper, 100 * paper_period, false);
    EXPECT_LT(loss.apsis, 1e-12);
    EXPECT_LT(loss.energy, 1e-11);
    EXPECT_LT(loss.momentum, 1e-12);
  }
}

TEST(TimeTransformed, AngularMomentumIsKeptAtAnyThreshold) {
  EXPECT_LT(orbit_loss(TimeTransformed{0.05, 0.75}, paper, 100 * paper_period, false).momentum, 1e-12);
  const Kepler3d<> kepler;
  State<3> x{0, {1, 0, 0}, {0, 1.1, 0.3}, {}};
  const auto first = kepler.invariants(x.q, x.p, 0.0);
  auto stepper = bound(TimeTransformed{0.1, 0.75, Composition::suzuki_4}, kepler, x);
  EXPECT_EQ(steps(stepper, x, 1000), 1000);
  const auto last = kepler.invariants(x.q, x.p, 0.0);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(last[i], first[i], 1e-12);
}

// ---- reach

template <class P>
void reaches(const P& problem, const State<P::dof>& start, const TimeTransformed& scheme, double tolerance) {
  auto x = start;
  auto stepper = bound(scheme, problem, x);
  for (int k = 0; k < 60; ++k) {
    auto end = x;
    auto ahead = stepper;
    ASSERT_EQ(ahead.step(end), StepStatus::ok);
    for (const double part : {1e-6, 0.01, 0.3, 0.7, 0.99, 0.999999, 1.0}) {
      const double t = x.t + part * (end.t - x.t);
      auto y = x, back = x;
      auto there = stepper;
      ASSERT_EQ(there.reach(y, t), StepStatus::ok) << part;
      EXPECT_EQ(y.t, t);
      EXPECT_GT(there.work().forces, stepper.work().forces);
      EXPECT_LE(there.work().forces, stepper.work().forces + 12 * (ahead.work().forces - stepper.work().forces));
      if (part == 1) {
        EXPECT_LT(distance(y, end), tolerance);
      }
      // The way to t is a step of some σ: it is reversible, and the stepper goes on from the state it leads to.
      auto z = y;
      auto fresh = scheme.bind(problem, z, energy(problem, start));
      ASSERT_EQ(there.step(y), StepStatus::ok);
      ASSERT_EQ(fresh.step(z), StepStatus::ok);
      EXPECT_EQ(y, z);
      // Reaching the present time does nothing; a time beyond the step is refused, and x stays.
      EXPECT_EQ(stepper.reach(back, x.t), StepStatus::ok);
      EXPECT_EQ(back, x);
    }
    auto y = x;
    auto beyond = stepper;
    EXPECT_EQ(beyond.reach(y, end.t + (end.t - x.t) * 1e-3), StepStatus::solver_failed);
    EXPECT_EQ(y, x);
    ASSERT_EQ(beyond.step(y), StepStatus::ok);
    EXPECT_EQ(y, end);
    x = end;
    stepper = ahead;
  }
}
TEST(TimeTransformed, ReachesAnyTimeWithinAStep) {
  reaches(Kepler<>{}, paper, {0.4, minus_energy, Composition::kahan_li_6}, 1e-12);
  reaches(Kepler<>{}, paper, {0.05, 0.75}, 1e-12);
  reaches(DoublePendulum<>{}, swing, {0.1, 0.5, Composition::suzuki_4}, 1e-12);
}
TEST(TimeTransformed, ReachedStatesAreAsAccurateAsSteps) {
  const Kepler<> kepler;
  for (const double t : {5.0, 10.3, 11.155, 17.77}) {  // the periapsis is at 11.157
    auto x = paper;
    auto stepper = bound(TimeTransformed{0.04, minus_energy, Composition::kahan_li_6}, kepler, x);
    ASSERT_EQ(until(stepper, x, t), StepStatus::ok);
    EXPECT_LT(distance(x, kepler.exact(paper, t)), 1e-9) << t;
    EXPECT_NEAR(energy(kepler, x), energy(kepler, paper), 1e-12);
  }
}

// ---- guards

TEST(TimeTransformed, StopsWhereTheTransformationEnds) {
  const HarmonicOscillator<> m;
  const auto status = [&](double kappa, double sigma = 0.01, State<1> x = State<1>{0, {0.5}, {1}, {}}) {
    const auto before = x;
    auto stepper = bound(TimeTransformed{sigma, kappa}, m, x);
    const StepStatus result = stepper.step(x);
    if (result != StepStatus::ok) {
      EXPECT_EQ(std::memcmp(&x, &before, sizeof x), 0);
    }
    return result;
  };
  EXPECT_EQ(status(0.5), StepStatus::ok);
  EXPECT_EQ(status(-0.4), StepStatus::ok);                // K = .5, E₀ − V = .5
  EXPECT_EQ(status(-0.5), StepStatus::singular);          // K + κ = 0
  EXPECT_EQ(status(-0.6), StepStatus::singular);          // K + κ < 0
  EXPECT_EQ(status(minus_energy), StepStatus::singular);  // −V < 0
  EXPECT_EQ(status(0.5, 0.01, {0, {0.5}, {minus_energy}, {}}), StepStatus::singular);
  EXPECT_EQ(status(0.5, 10), StepStatus::singular);  // far away from the level
  EXPECT_EQ(status(0.5, 1e300), StepStatus::singular);
  EXPECT_EQ(status(1e30, 1e-300), StepStatus::singular);  // time stands still
}
// A step that failed does not change what the stepper remembers.
TEST(TimeTransformed, GoesOnAfterAStepThatFailed) {
  const HarmonicOscillator<> m;
  int failures = 0;
  for (double q = 0.05; q < 1; q += 0.05)
    for (double sigma = 0.5; sigma < 20; sigma *= 1.1) {
      State<1> x{0, {q}, {1}, {}}, y = x;
      auto stepper = bound(TimeTransformed{sigma, 0.5}, m, x), fresh = stepper;
      if (stepper.step(x) == StepStatus::ok) continue;
      ++failures;
      EXPECT_EQ(stepper.step(x), StepStatus::singular);
      EXPECT_EQ(x, y);
      ASSERT_EQ(stepper.reach(x, 0.01), StepStatus::ok);
      ASSERT_EQ(fresh.reach(y, 0.01), StepStatus::ok);
      EXPECT_EQ(x, y);
    }
  EXPECT_GT(failures, 100);
}
// K > |κ| at the start; on the way to the turning point it falls below.
TEST(TimeTransformed, StopsBeforeKineticEnergyFallsToMinusKappa) {
  const HarmonicOscillator<> m;
  State<1> x{0, {0}, {1}, {}};
  auto stepper = bound(TimeTransformed{0.01, -0.3}, m, x);
  const int taken = steps(stepper, x, 10'000);
  EXPECT_LT(taken, 10'000);
  EXPECT_LT(x.t, 1);  // K = 0.3 at t = 0.685
  const auto last = x;
  EXPECT_EQ(stepper.step(x), StepStatus::singular);
  EXPECT_EQ(x, last);
}
TEST(TimeTransformed, MetricStopsWhereTheTransformationEnds) {
  const DoublePendulum<> m;
  auto x = swing;
  const double kinetic = 0.5 * dot(x.p, velocity(m, x.q, x.p));
  for (const auto& scheme : {TimeTransformed{0.01, -1.5 * kinetic}, TimeTransformed{1000, 0.5}}) {
    auto stepper = bound(scheme, m, x);
    EXPECT_NE(stepper.step(x), StepStatus::ok);
    EXPECT_EQ(x, swing);
  }
}
// The level is not that of the state: D and K + κ differ by a factor outside [½, 2].
template <class P>
void stops_off_the_level(const P& problem, const State<P::dof>& x) {
  const double level = energy(problem, x), kinetic = 0.5 * dot(x.p, velocity(problem, x.q, x.p));
  for (const double slow : {kinetic + 1, -0.5 * kinetic})  // K + κ
    for (const double ratio : {-1.0, 0.45, 0.55, 1.9, 2.1}) {
      const double kappa = slow - kinetic, gap = ratio * slow;
      auto y = x;
      const TimeTransformed scheme{1e-4, kappa};
      const bool near = slow > 0 && ratio > 0.5 && ratio < 2;
      EXPECT_EQ(scheme.bind(problem, y, level + gap - slow).step(y), near ? StepStatus::ok : StepStatus::singular)
          << slow << ' ' << ratio;
    }
}
TEST(TimeTransformed, StopsOffTheEnergyLevel) {
  stops_off_the_level(Kepler<>{}, hyperbola);
  stops_off_the_level(DoublePendulum<>{}, swing);
}

TEST(TimeTransformed, HyperbolaIsFollowedOrRefused) {
  const Kepler<> kepler;
  const double level = energy(kepler, hyperbola);
  const auto loss = orbit_loss(TimeTransformed{0.05, minus_energy, Composition::kahan_li_6}, hyperbola, 20);
  EXPECT_LT(loss.position, 1e-9);
  EXPECT_LT(loss.energy, 1e-13);
  // Beyond σ√(2E₀) = 2 every step, from anywhere on the orbit, is refused.
  for (double t = 0; t < 20; t += 0.5)
    for (double sigma = 2.0 / std::sqrt(2 * level) + 1e-9; sigma < 1000; sigma *= 1.1) {
      auto x = kepler.exact(hyperbola, t);
      EXPECT_EQ((TimeTransformed{sigma, minus_energy}.bind(kepler, x, level).step(x)), StepStatus::singular) << sigma;
    }
}

// unsupported_reason() objects exactly where the guard would stop the first step.
TEST(TimeTransformed, ObjectsToWhatTheGuardWouldStop) {
  for (const double mu : {1.0, 0.3})
    for (const auto& start : {paper, hyperbola})
      for (const auto composition : {Composition::none, Composition::suzuki_4, Composition::kahan_li_6}) {
        const Kepler<> kepler{mu};
        const double level = energy(kepler, start);
        int objections = 0;
        for (double sigma = 0.05; sigma < 20; sigma *= 1.07) {
          const TimeTransformed scheme{sigma, minus_energy, composition};
          auto x = start;
          const bool refused = !scheme.unsupported_reason(kepler, level).empty();
          const bool named = !TimeTransformed{sigma, -level, composition}.unsupported_reason(kepler, level).empty();
          const bool stops = scheme.bind(kepler, x, level).step(x) != StepStatus::ok;
          EXPECT_EQ(refused, named);
          EXPECT_EQ(refused, stops) << sigma;
          objections += refused;
        }
        EXPECT_GT(objections, 5);
      }
  EXPECT_EQ((TimeTransformed{3, minus_energy}.unsupported_reason(Kepler<>{}, energy(Kepler<>{}, hyperbola))),
            "σ = 3: with κ = −E₀ on this hyperbola and this composition σ has to be less than 1.777");
  EXPECT_EQ((TimeTransformed{3, 0.75}.unsupported_reason(Kepler<>{}, 0.475)), "");
  EXPECT_EQ((TimeTransformed{3, minus_energy}.unsupported_reason(HenonHeiles<>{}, 0.475)), "");
  EXPECT_EQ((TimeTransformed{3, minus_energy}.unsupported_reason(Kepler<>{}, 0.0)), "");
}

}  // namespace
