// Each scheme's map against its formula, computed here in another way.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "core/catalogue/catalogue.hpp"
#include "core/number/quad.hpp"
#include "core/run/stability.hpp"
#include "core/schemes/list.hpp"
#include "least_problems.hpp"

namespace {

using namespace least;
using namespace least::problems;

template <class Scheme, class P>
StateOf<P> after_one(const Scheme& scheme, const P& problem, StateOf<P> x, double h) {
  auto stepper = scheme.bind(problem, x);
  EXPECT_EQ(stepper.step(x, h), StepStatus::ok);
  return x;
}

// The pendulum with g/l = 2 from (0.7, 0.4), h = 0.3.
constexpr double h = 0.3, q0 = 0.7, p0 = 0.4;
const Pendulum<> pendulum{2, 1};
const State<1> start{0, {q0}, {p0}, {}};
double force(double q) { return -2 * std::sin(q); }

TEST(Map, SymplecticEulerKicksThenDrifts) {
  const auto x = after_one(SymplecticEuler{}, pendulum, start, h);
  const double p = p0 + h * force(q0);
  EXPECT_DOUBLE_EQ(x.p[0], p);
  EXPECT_DOUBLE_EQ(x.q[0], q0 + h * p);
}

TEST(Map, LeapfrogIsStoermersTwoStepScheme) {
  auto x = start;
  auto stepper = Leapfrog{}.bind(pendulum, x);
  double q[3] = {q0, 0, 0};
  for (int k = 1; k < 3; ++k) {
    ASSERT_EQ(stepper.step(x, h), StepStatus::ok);
    q[k] = x.q[0];
  }
  EXPECT_NEAR(q[2] - 2 * q[1] + q[0], h * h * force(q[1]), 1e-15);
  EXPECT_DOUBLE_EQ(q[1], q0 + h * p0 + h * h / 2 * force(q0));
}

TEST(Map, Ruth3IsDriftsAndKicksInOrder) {
  const double c[] = {7.0 / 24, 3.0 / 4, -1.0 / 24}, d[] = {2.0 / 3, -2.0 / 3, 1};
  double q = q0, p = p0;
  for (int i = 0; i < 3; ++i) {
    q += c[i] * h * p;
    p += d[i] * h * force(q);
  }
  const auto x = after_one(Ruth3{}, pendulum, start, h);
  EXPECT_NEAR(x.q[0], q, 1e-15);
  EXPECT_NEAR(x.p[0], p, 1e-15);
}

TEST(Map, CompositionIsTheBaseTakenByItsWeights) {
  for (std::size_t c = 0; c < compositions::names.size(); ++c) {
    Leapfrog composed;
    composed.composition = static_cast<Composition>(c);
    const auto& weights = Weights<double>::of(composed.composition);
    auto x = start;
    for (int i = 0; i < weights.stages; ++i) x = after_one(Leapfrog{}, pendulum, x, weights.gamma[std::size_t(i)] * h);
    const auto y = after_one(composed, pendulum, start, h);
    EXPECT_NEAR(x.q[0], y.q[0], 1e-14) << compositions::names[c];
    EXPECT_NEAR(x.p[0], y.p[0], 1e-14) << compositions::names[c];
  }
}

TEST(Map, VariationalMidpointSolvesTheImplicitMidpointRule) {
  const auto x = after_one(VariationalMidpoint{}, pendulum, start, h);
  EXPECT_NEAR(x.q[0], q0 + h * (p0 + x.p[0]) / 2, 1e-15);
  EXPECT_NEAR(x.p[0], p0 + h * force((q0 + x.q[0]) / 2), 1e-15);
}

// On H = p²/2m + kq²/2 the action of the quadratic path is a quadratic form; its extremum can be written down.
TEST(Map, Galerkin4ExtremisesTheActionOfAQuadraticPath) {
  const HarmonicOscillator<> m{2, 3};
  const auto x = after_one(Galerkin4{}, m, State<1>{0, {q0}, {p0}, {}}, h);
  const auto action = [&](double a, double b, double c) {  // from a over b to c, Simpson's rule
    const auto lagrangian = [&](double q, double v) { return v * v - 1.5 * q * q; };
    return h / 6 *
           (lagrangian(a, (4 * b - 3 * a - c) / h) + 4 * lagrangian(b, (c - a) / h) +
            lagrangian(c, (a + 3 * c - 4 * b) / h));
  };
  const auto extremum = [&](double a, double c) {  // of a parabola in b, through three of its points
    const double f0 = action(a, -1, c), f1 = action(a, 0, c), f2 = action(a, 1, c);
    return (f0 - f2) / (2 * (f0 - 2 * f1 + f2));
  };
  const auto discrete = [&](double a, double c) { return action(a, extremum(a, c), c); };
  const double d = 1e-4;
  EXPECT_NEAR(-(discrete(q0 + d, x.q[0]) - discrete(q0 - d, x.q[0])) / (2 * d), p0, 1e-9);
  EXPECT_NEAR((discrete(q0, x.q[0] + d) - discrete(q0, x.q[0] - d)) / (2 * d), x.p[0], 1e-9);
}

TEST(Map, RungeKutta4OnALinearSystemIsTheTaylorPolynomial) {
  const HarmonicOscillator<> unit;
  const auto x = after_one(RungeKutta4{}, unit, State<1>{0, {1}, {0}, {}}, h);
  std::complex<double> z(0, -h), sum(0), term(1);  // q + ip turns by e^{−ih}
  for (int k = 0; k < 5; ++k) {
    sum += term;
    term *= z / double(k + 1);
  }
  EXPECT_NEAR(x.q[0], sum.real(), 1e-16);
  EXPECT_NEAR(x.p[0], sum.imag(), 1e-16);
}

// ---- compositions

template <class S>
void check_weights(double tolerance) {
  for (std::size_t c = 0; c < compositions::names.size(); ++c) {
    const auto& w = Weights<S>::of(static_cast<Composition>(c));
    S sum(0), cubes(0), fifth(0);
    for (int i = 0; i < w.stages; ++i) {
      const S g = w.gamma[std::size_t(i)];
      EXPECT_EQ(g, w.gamma[std::size_t(w.stages - 1 - i)]);
      sum += g;
      cubes += g * g * g;
      fifth += g * g * g * g * g;
    }
    EXPECT_LT(std::abs(double(sum - 1)), tolerance) << compositions::names[c];
    EXPECT_TRUE(compositions::orders[c] < 4 || std::abs(double(cubes)) < tolerance) << compositions::names[c];
    EXPECT_TRUE(compositions::orders[c] < 6 || std::abs(double(fifth)) < tolerance) << compositions::names[c];
  }
}
TEST(Composition, WeightsMeetTheirOrderConditions) {
  check_weights<double>(1e-14);
  check_weights<Quad>(1e-25);  // Sofroniou–Spaletta: 26 digits are published
}
TEST(Composition, WeightsAreTheNearestDoubles) {
  for (std::size_t c = 0; c < compositions::names.size(); ++c) {
    const auto& narrow = Weights<double>::of(static_cast<Composition>(c));
    const auto& wide = Weights<Quad>::of(static_cast<Composition>(c));
    for (std::size_t i = 0; i < compositions::most_stages; ++i)
      EXPECT_EQ(narrow.gamma[i], static_cast<double>(wide.gamma[i])) << compositions::names[c];
  }
}

// ---- work

TEST(Work, ForcesAreReUsedFromStepToStep) {
  const Kepler<> kepler;
  const auto forces = [&](const auto& scheme) {
    State<2> x{0, {1, 0}, {0, 1}, {}};
    auto stepper = scheme.bind(kepler, x);
    for (int k = 0; k < 10; ++k) stepper.step(x, 0.1);
    return stepper.work().forces;
  };
  EXPECT_EQ(forces(SymplecticEuler{}), 11);
  EXPECT_EQ(forces(Leapfrog{}), 11);
  EXPECT_EQ(forces(Leapfrog{0.1, Composition::kahan_li_6}), 91);
  EXPECT_EQ(forces(Leapfrog{0.1, Composition::sofroniou_spaletta_10}), 351);
  EXPECT_EQ(forces(Ruth3{}), 31);
  EXPECT_EQ(forces(ExplicitEuler{}), 10);
  EXPECT_EQ(forces(ExplicitMidpoint{}), 20);
  EXPECT_EQ(forces(RungeKutta4{}), 40);
}

// ---- linear stability

TEST(Stability, BoundsAreTheTheorys) {
  const auto bound = [](std::string_view id, std::vector<double> settings = {1, 0}) {
    return stability_bound(find_scheme(id).value(), settings, 0);
  };
  EXPECT_NEAR(bound("leapfrog"), 2, 1e-6);
  EXPECT_NEAR(bound("symplectic_euler"), 2, 1e-6);
  EXPECT_NEAR(bound("runge_kutta_4"), 2 * std::sqrt(2.0), 1e-6);
  EXPECT_EQ(bound("explicit_euler"), 0);
  EXPECT_EQ(bound("explicit_midpoint"), 0);
  EXPECT_TRUE(std::isinf(bound("variational_midpoint")));
  // Yoshida's triple jump: its middle weight is 1.70 and its bound lies well below that of leapfrog (1.5734).
  EXPECT_NEAR(bound("leapfrog", {1, double(Composition::yoshida_4)}), 1.5734, 1e-3);
}

}  // namespace
