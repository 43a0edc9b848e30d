// energy_momentum against its equations, what it keeps, and where no length of a step keeps the energy.
#include "core/schemes/energy_momentum.hpp"

#include "core/problems/double_pendulum.hpp"
#include "core/problems/henon_heiles.hpp"
#include "core/problems/pendulum.hpp"
#include "tests/support/clocks.hpp"
#include "tests/support/runs.hpp"
#include "tests/support/tangents.hpp"

namespace {

using namespace least;
using namespace least::problems;

static_assert(SelfTimedSchemeFor<EnergyMomentum, DoublePendulum<>>);
static_assert(!FixedStepSchemeFor<EnergyMomentum, DoublePendulum<>>);

const State<2> ellipse{0, {1, 0}, {0, 0.8}, {}}, linked{0, {1, 0.5}, {0, 0}, {}};

/// h L((q₀+q₁)/2, (q₁−q₀)/h), in the number type of its arguments q₀, q₁, h, for two degrees of freedom.
template <class P>
Dual<double, 5> action(const P& m, const Vec<5, Dual<double, 5>>& y) {
  using D = Dual<double, 5>;
  const Vec<2, D> q{0.5 * (y[0] + y[2]), 0.5 * (y[1] + y[3])}, v{(y[2] - y[0]) / y[4], (y[3] - y[1]) / y[4]};
  return y[4] * (0.5 * dot(v, momentum(m, q, v)) - m.potential(q, 0.0));
}
template <class P>
void solves_its_equations(const P& m, State<2> x) {
  const EnergyMomentum scheme{0.05};
  auto stepper = clocks::bound(scheme, m, x);
  double level = 0, shortest = 1, longest = 0;
  for (int k = 0; k < 100; ++k) {
    const auto before = x;
    ASSERT_EQ(stepper.step(x), StepStatus::ok);
    const double h = x.t - before.t;
    const auto s = action(m, seed<5, double>({before.q[0], before.q[1], x.q[0], x.q[1], h}));
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(-s.slope[i], before.p[i], 1e-13);
      EXPECT_NEAR(s.slope[2 + i], x.p[i], 1e-13);
    }
    if (k == 0) {
      EXPECT_NEAR(h, scheme.step, 1e-12) << "the first step has the nominal length";
      level = -s.slope[4];
    }
    EXPECT_NEAR(-s.slope[4], level, 1e-13);
    shortest = std::min(shortest, h);
    longest = std::max(longest, h);
  }
  EXPECT_EQ(stepper.fallback_steps(), 0);
  EXPECT_GT(longest, 1.2 * shortest);
}
TEST(EnergyMomentum, SolvesForMomentumAndEnergy) {
  solves_its_equations(Kepler<>{}, ellipse);
  solves_its_equations(DoublePendulum<>{}, linked);
}

TEST(EnergyMomentum, KeepsDiscreteEnergyAndAngularMomentum) {
  const Kepler<> kepler;
  auto x = ellipse;
  auto stepper = clocks::bound(EnergyMomentum{0.02}, kepler, x);
  const double level = energy_level(EnergyMomentum{0.02}, kepler, x), start = energy(kepler, x);
  const double spin = kepler.invariants(x.q, x.p, 0)[0];
  double off = 0, discrete = 0, turned = 0;
  for (int k = 0; k < 20'000; ++k) {
    const auto before = x;
    ASSERT_EQ(stepper.step(x), StepStatus::ok);
    discrete = std::max(discrete, std::abs(midpoint_energy(kepler, before, x, x.t - before.t) - level));
    turned = std::max(turned, std::abs(kepler.invariants(x.q, x.p, 0)[0] - spin));
    off = std::max(off, std::abs(energy(kepler, x) - start));
  }
  EXPECT_EQ(stepper.fallback_steps(), 0);
  EXPECT_LT(discrete, 1e-14);
  EXPECT_LT(turned, 1e-12);
  EXPECT_LT(off, 2e-4);  // the energy H itself has an error O(h²) that does not grow
  EXPECT_GT(off, 1e-5);
}

/// For short steps round-off of E_d hides most of its dependence on h: what is left suffices.
TEST(EnergyMomentum, GoesOnWhereRoundOffBlursTheLength) {
  for (const double h : {1e-3, 1e-4, 1e-5}) {
    auto x = ellipse;
    auto stepper = clocks::bound(EnergyMomentum{h}, Kepler<>{}, x);
    ASSERT_EQ(clocks::steps(stepper, x, 1000), 1000);
    EXPECT_EQ(stepper.fallback_steps(), 0) << h;
    EXPECT_LT(stepper.work().iterations, 6 * 1000) << h;
  }
}

/// Symplectic at fixed E₀, to round-off: the derivatives grow as 1/h, and the defect as their square.
TEST(EnergyMomentum, IsSymplecticAtFixedEnergy) {
  const auto check = [](const auto& problem, State<2> x, double h) {
    const EnergyMomentum scheme{h};
    const auto start = x;
    auto stepper = clocks::bound(scheme, problem, x);
    for (int k = 0; k < 200; ++k) {
      const auto tangent = step_tangent(scheme, problem, start, x, [] { return true; });
      ASSERT_TRUE(tangent);
      double most = 0;
      for (const auto& row : tangent->m)
        for (const double c : row) most = std::max(most, std::abs(c));
      EXPECT_LT(symplectic_defect(tangent->m), 2e-15 * most * most) << most;
      EXPECT_GT(most, 0.1 / h);
      ASSERT_EQ(stepper.step(x), StepStatus::ok);
    }
  };
  check(HenonHeiles<>{}, {0, {0, 0.1}, {0.49, 0}, {}}, 0.04);
  check(DoublePendulum<>{}, linked, 0.04);
  check(Kepler<>{}, ellipse, 0.04);
}

/// A rotating pendulum: E_d − H changes its sign on the way, and there no length keeps E_d.
TEST(EnergyMomentum, GoesAtTheNominalLengthWhereThereIsNoOther) {
  const Pendulum<> pendulum;
  const EnergyMomentum scheme{0.05};
  State<1> x{0, {0}, {2.5}, {}};
  auto stepper = clocks::bound(scheme, pendulum, x);
  const double level = energy_level(scheme, pendulum, x);
  std::int64_t counted = 0, solved = 0;
  for (int k = 0; k < 500; ++k) {
    const auto before = x;
    ASSERT_EQ(stepper.step(x), StepStatus::ok);
    const double h = x.t - before.t;
    EXPECT_GE(h, scheme.step / 4);
    EXPECT_LE(h, scheme.step * 4);
    const double off = std::abs(midpoint_energy(pendulum, before, x, h) - level);
    if (stepper.fallback_steps() > counted) {
      EXPECT_NEAR(h, scheme.step, 1e-13);
      EXPECT_GT(off, 1e-12);
      counted = stepper.fallback_steps();
    } else {
      EXPECT_LT(off, 1e-13);
      ++solved;
    }
  }
  EXPECT_GT(counted, 20);
  EXPECT_GT(solved, 100);
}

TEST(EnergyMomentum, SaysHowManyStepsItFoundNoLengthFor) {
  Request request = runs::defaults("kepler", "energy_momentum");
  request.end = 40;
  runs::only_final(request);
  const auto outcome = runs::go(request).outcome;
  ASSERT_EQ(outcome.stop.reason, ReturnCode::completed) << outcome.stop.detail;
  const auto found = std::ranges::find(outcome.warnings, "steps_in_time", &Warning::code);
  ASSERT_NE(found, outcome.warnings.end());
  EXPECT_GT(std::stoi(found->detail.text()), 100);
  EXPECT_NE(found->detail.text().find("keeps the discrete energy"), std::string::npos) << found->detail;
  request.scene = runs::defaults("henon_heiles", "energy_momentum").scene;
  for (const Warning& warning : runs::go(request).outcome.warnings) EXPECT_NE(warning.code, "steps_in_time");
}

/// At rest every length keeps E_d; the nominal one is taken, and the state stays.
TEST(EnergyMomentum, RestsAtAnEquilibrium) {
  State<1> x{0, {0}, {0}, {}};
  auto stepper = clocks::bound(EnergyMomentum{0.1}, Pendulum<>{}, x);
  ASSERT_EQ(clocks::steps(stepper, x, 10), 10);
  EXPECT_EQ(stepper.fallback_steps(), 10);
  EXPECT_EQ(x.q[0], 0);
  EXPECT_NEAR(x.t, 1, 1e-15);
}

}  // namespace
