// Adaptive Verlet against its formulas: the recursion, order, reversal together with the density, energy over long
// runs, and what it saves against leapfrog.
#include "core/schemes/adaptive_verlet.hpp"

#include <cstring>

#include "core/problems/double_pendulum.hpp"
#include "core/problems/harmonic_oscillator.hpp"
#include "core/problems/henon_heiles.hpp"
#include "core/reference/reference.hpp"
#include "core/schemes/splitting.hpp"
#include "tests/support/clocks.hpp"
#include "tests/support/lanes.hpp"
#include "tests/support/tangents.hpp"

namespace {

using namespace least;
using namespace least::problems;
using namespace clocks;

static_assert(SelfTimedSchemeFor<AdaptiveVerlet, Kepler<>> && !FixedStepSchemeFor<AdaptiveVerlet, Kepler<>>);
static_assert(!SelfTimedSchemeFor<AdaptiveVerlet, DoublePendulum<>>);

constexpr std::array both{Monitor::arclength, Monitor::frequency};

/// Two masses of 2 and ½ between three springs; V is a function of position alone, without an estimate of the
/// frequency.
struct Springs {
  static constexpr int dof = 2;
  Vec<2> inverse_mass() const { return {0.5, 2}; }
  template <class T, class S>
  constexpr T potential(const Vec<2, T>& q, const S&) const {
    const T d = q[1] - q[0];
    return 0.5 * (q[0] * q[0] + q[1] * q[1]) + d * d * d * d;
  }
};

TEST(AdaptiveVerlet, IsItsRecursion) {
  const Kepler<> kepler{2};
  const double h = 0.1, mu = 2;
  const State<2> start{0, {1, 0.3}, {0.2, 1.1}, {}};
  const double level = energy(kepler, start);
  for (const auto monitor : both) {
    auto x = start, y = start;
    auto stepper = AdaptiveVerlet{h, monitor}.bind(kepler, x, level);
    const auto size = [&](const Vec<2>& q) {
      const double r = std::hypot(q[0], q[1]);
      return monitor == Monitor::frequency ? std::pow(r, -1.5) : std::sqrt(1 + 2 * (level + mu / r));
    };
    double rho = 1;
    for (int k = 0; k < 3; ++k) {
      const auto kick = [&](double dt) {
        const double r = std::hypot(y.q[0], y.q[1]);
        for (std::size_t i = 0; i < 2; ++i) y.p[i] -= dt * mu * y.q[i] / (r * r * r);
      };
      const auto drift = [&](double dt) {
        for (std::size_t i = 0; i < 2; ++i) y.q[i] += dt * y.p[i];
      };
      const double before = h / 2 / rho;
      kick(before);
      drift(before);
      rho = 2 * size(y.q) / size(start.q) - rho;
      const double after = h / 2 / rho;
      drift(after);
      kick(after);
      y.t += before + after;
      ASSERT_EQ(stepper.step(x), StepStatus::ok);
      EXPECT_LT(distance(x, y), 1e-14);
      EXPECT_NEAR(x.t, y.t, 1e-14);
      EXPECT_NEAR(stepper.density(), rho, 1e-14);
    }
    EXPECT_EQ(stepper.work().forces, 7);  // two points a step, and the start
  }
}

// Where the density is constant, it is leapfrog; `step` is the length in time.
TEST(AdaptiveVerlet, IsLeapfrogAtAConstantFrequency) {
  const HarmonicOscillator<> m{2, 3};
  State<1> x{0, {1}, {0.5}, {}}, y = x;
  auto adaptive = bound(AdaptiveVerlet{0.1, Monitor::frequency}, m, x);
  auto leapfrog = Leapfrog{0.1}.bind(m, y);
  for (int k = 0; k < 20; ++k) {
    ASSERT_EQ(adaptive.step(x), StepStatus::ok);
    ASSERT_EQ(leapfrog.step(y, 0.1), StepStatus::ok);
  }
  EXPECT_LT(distance(x, y), 1e-14);
  EXPECT_NEAR(x.t, 2, 1e-14);
}

/// A uniform field.
struct Weight {
  static constexpr int dof = 1;
  Vec<1> inverse_mass() const { return {1}; }
  template <class T, class S>
  constexpr T potential(const Vec<1, T>& q, const S&) const {
    return 9.81 * q[0];
  }
};

TEST(AdaptiveVerlet, IsLeapfrogWhereThereIsNoFrequency) {
  State<1> x{0, {1}, {0.5}, {}};
  auto adaptive = bound(AdaptiveVerlet{0.1, Monitor::frequency}, Weight{}, x);
  for (int k = 0; k < 20; ++k) ASSERT_EQ(adaptive.step(x), StepStatus::ok);
  EXPECT_NEAR(x.t, 2, 1e-14);
  EXPECT_NEAR(x.q[0], 1 + 0.5 * 2 - 9.81 * 2, 1e-13);
  EXPECT_NEAR(x.p[0], 0.5 - 9.81 * 2, 1e-13);
}

TEST(AdaptiveVerlet, FrequencyIsThatOfTheHessianWhereNoneIsGiven) {
  const Vec<2> q{0.3, -0.4};
  const double c = 12 * 0.7 * 0.7;  // of (q₂ − q₁)⁴
  const double m[2][2] = {{0.5 * (1 + c), -0.5 * c}, {-2 * c, 2 * (1 + c)}};
  double sum = 0;
  for (const auto& row : m) sum += row[0] * row[0] + row[1] * row[1];
  EXPECT_NEAR(local_frequency_squared(Springs{}, q), std::sqrt(sum), 1e-13);
  EXPECT_EQ(local_frequency_squared(Kepler<>{4}, q), 4 / 0.125);
}

TEST(AdaptiveVerlet, LanesMoveAsDoubles) {
  for (const auto monitor : both) {
    const AdaptiveVerlet scheme{0.05, monitor};
    const Springs springs;
    State<2, toy::Lanes, toy::Lanes> wide;
    toy::Lanes level;
    std::array<State<2>, toy::width> narrow;
    for (std::size_t lane = 0; lane < toy::width; ++lane) {
      narrow[lane] = {0, {0.3, 0.1 * double(lane)}, {0.5, -0.2}, {}};
      for (std::size_t i = 0; i < 4; ++i) wide[i].v[lane] = narrow[lane][i];
      level.v[lane] = energy(springs, narrow[lane]);
    }
    auto together = scheme.bind(springs, wide, level);
    ASSERT_EQ(steps(together, wide, 5), 5);
    for (std::size_t lane = 0; lane < toy::width; ++lane) {
      auto alone = scheme.bind(springs, narrow[lane], level.v[lane]);
      ASSERT_EQ(steps(alone, narrow[lane], 5), 5);
      for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(wide[i].v[lane], narrow[lane][i]);
      EXPECT_EQ(wide.t.v[lane], narrow[lane].t);
    }
  }
}

// ---- order, by the error against the true state at the time of each run's last step

template <class P>
void is_of_order_2(const P& problem, const State<P::dof>& start, double span, Monitor monitor) {
  std::vector<std::pair<double, double>> points;
  for (double h = 0.01; points.size() < 6; h /= 1.3) {
    auto x = convert<long double, long double>(start);
    auto stepper = bound(AdaptiveVerlet{h, monitor}, problem, x);
    ASSERT_TRUE(past(stepper, x, static_cast<long double>(span), [](const auto&) {}));
    Extrapolation<P, Moving<P, Quad>> truth(problem, convert<Quad, Quad>(start), 1e-20);
    ASSERT_TRUE(truth.advance(Quad(x.t), [] { return true; }));
    points.emplace_back(h, distance(x, convert<long double, long double>(truth.state())));
  }
  EXPECT_LT(points.back().second, 1e-4);
  EXPECT_GT(points.back().second, 1e-12);
  EXPECT_NEAR(slope(points), 2, 0.1);
}
TEST(AdaptiveVerlet, IsOfOrder2) {
  for (const auto monitor : both) {
    is_of_order_2(Kepler<>{}, {0, {1, 0}, {0, 1.1}, {}}, 3, monitor);
    is_of_order_2(HenonHeiles<>{}, {0, {0, 0.1}, {0.49, 0}, {}}, 5, monitor);
    is_of_order_2(Springs{}, {0, {0.8, 0.2}, {0.5, -0.2}, {}}, 3, monitor);
  }
}

// ---- structure

TEST(AdaptiveVerlet, TurnsRoundWithItsDensity) {
  const int n = 2000;
  for (const auto monitor : both) {
    const double h = monitor == Monitor::frequency ? 0.05 : 0.005;
    auto x = paper;
    auto stepper = bound(AdaptiveVerlet{h, monitor}, Kepler<>{}, x);
    ASSERT_EQ(steps(stepper, x, n), n);
    const double half = x.t;
    ASSERT_GT(half, 9);
    x = reversed(x);
    auto forgetful = bound(AdaptiveVerlet{h, monitor}, Kepler<>{}, x);
    auto y = x;
    ASSERT_EQ(steps(stepper, x, n), n);
    EXPECT_LT(distance(reversed(x), paper), 1e-10);
    EXPECT_NEAR(x.t, 2 * half, 1e-10);
    EXPECT_NEAR(stepper.density(), 1, 1e-9);
    steps(forgetful, y, n);
    EXPECT_GT(distance(reversed(y), paper), 1e-4);  // ρ is part of the state and must not be forgotten
  }
}

TEST(AdaptiveVerlet, EnergyStaysBoundedAndAngularMomentumIsKept) {
  const AdaptiveVerlet scheme{0.1, Monitor::frequency};
  const auto one = orbit_loss(scheme, paper, paper_period), many = orbit_loss(scheme, paper, 100 * paper_period, false);
  EXPECT_LT(one.energy, 2e-3);
  EXPECT_LT(many.energy, 1.2 * one.energy);
  EXPECT_LT(many.momentum, 1e-12);
}

TEST(AdaptiveVerlet, IsNotSymplectic) {
  const State<2> start{0, {1, 0.3}, {0.2, 1.1}, {}};
  for (const auto monitor : both) {
    const auto m = tangent_at_level(AdaptiveVerlet{0.1, monitor}, Kepler<>{}, start, energy(Kepler<>{}, start));
    ASSERT_TRUE(m);
    EXPECT_GT(symplectic_defect(*m), 1e-5);
  }
}

// ---- what it is good for

TEST(AdaptiveVerlet, BeatsLeapfrogAtEqualForcesOnThePaperOrbit) {
  const double span = 10 * paper_period;
  const auto frequency = orbit_loss(AdaptiveVerlet{0.04, Monitor::frequency}, paper, span);
  const auto arclength = orbit_loss(AdaptiveVerlet{0.0114, Monitor::arclength}, paper, span);
  EXPECT_NEAR(double(arclength.forces), double(frequency.forces), 0.01 * double(frequency.forces));
  const Kepler<> kepler;
  auto x = paper;
  const double h = span / double(frequency.forces);
  auto leapfrog = Leapfrog{h}.bind(kepler, x);
  double most = 0;
  for (std::int64_t k = 1; k <= frequency.forces; ++k) {
    leapfrog.step(x, h);
    x.t = double(k) * h;
    const auto truth = kepler.exact(paper, x.t);
    most = larger(most, std::hypot(x.q[0] - truth.q[0], x.q[1] - truth.q[1]));
  }
  EXPECT_GT(frequency.position, 1e-3);
  EXPECT_LT(frequency.position, 1.5e-3);  // 19,000 steps
  EXPECT_LT(arclength.position, 0.15);
  EXPECT_GT(arclength.position, 50 * frequency.position);
  EXPECT_GT(most, arclength.position);
}

TEST(AdaptiveVerlet, PassesAnEccentricPeriapsis) {
  const State<2> start{0, {0, -1.99}, {-0.070888120500833590077, 0}, {}};  // e = .99, a = 1
  const auto loss = orbit_loss(AdaptiveVerlet{0.05, Monitor::frequency}, start, 6 * M_PI);
  EXPECT_LT(loss.position, 0.05);
  EXPECT_LT(loss.energy, 0.02);
}

// ---- guards

TEST(AdaptiveVerlet, StopsWhereTheDensityIsLost) {
  const auto fails = [](const auto& problem, auto x, const AdaptiveVerlet& scheme) {
    auto stepper = bound(scheme, problem, x);
    for (int k = 0; k < 1000; ++k) {
      const auto before = x;
      if (stepper.step(x) == StepStatus::ok) {
        EXPECT_TRUE(std::isfinite(distance(x, before) + x.t));
        continue;
      }
      EXPECT_EQ(std::memcmp(&x, &before, sizeof x), 0);
      const double density = stepper.density();
      EXPECT_EQ(stepper.step(x), StepStatus::singular);
      EXPECT_EQ(std::memcmp(&x, &before, sizeof x), 0);
      EXPECT_EQ(std::memcmp(&density, &stepper.density(), sizeof density), 0);
      return true;
    }
    return false;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto monitor : both) {
    EXPECT_FALSE(fails(Kepler<>{}, State<2>{0, {1, 0}, {0, 1}, {}}, {0.01, monitor}));
    EXPECT_TRUE(fails(Kepler<>{}, State<2>{0, {1, 0}, {nan, 1}, {}}, {0.01, monitor}));
    EXPECT_TRUE(fails(Kepler<>{}, State<2>{0, {0, 0}, {0, 1}, {}}, {0.01, monitor}));
  }
  // Outward from the periapsis, with a step half as long as the distance: 2U(q½) < ρ.
  EXPECT_TRUE(fails(Kepler<>{}, State<2>{0, {0.1, 0}, {4, 0}, {}}, {0.05, Monitor::frequency}));
  // ρ₁ exactly 0, and infinite: q½ is the centre.
  EXPECT_TRUE(fails(HarmonicOscillator<>{3, 3}, State<1>{0, {0}, {3}, {}}, {2, Monitor::arclength}));
  for (const auto monitor : both) EXPECT_TRUE(fails(Kepler<>{}, State<2>{0, {1, 0}, {-1.5, 0}, {}}, {1, monitor}));
  // Where the frequency vanishes everywhere, there is no density to be lost.
  EXPECT_FALSE(fails(HarmonicOscillator<>{1, 0}, State<1>{0, {1}, {1}, {}}, {0.01, Monitor::frequency}));
}

}  // namespace
