// Each contact scheme's map against its formula, computed here in another way; against its twin without damping; and
// without the variables that the equations of motion do not depend on.
#include <gtest/gtest.h>

#include <cmath>

#include "core/schemes/list.hpp"
#include "least_problems.hpp"
#include "tests/support/runs.hpp"
#include "tests/support/tangents.hpp"

namespace {

using namespace least;
using namespace least::problems;

template <class Scheme, class P, class X>
X after(const Scheme& scheme, const P& problem, X x, double h, int steps = 1) {
  auto stepper = scheme.bind(problem, x);
  const double start = x.t;
  for (int n = 1; n <= steps; ++n) {
    EXPECT_EQ(stepper.step(x, h), StepStatus::ok);
    x.t = start + n * h;
  }
  return x;
}

using Acting = State<1, double, double, Action<double>>;
constexpr double h = 0.3, t0 = 0.4, q0 = 0.7, p0 = 0.6, s0 = -0.2;
const Acting start{t0, {q0}, {p0}, {s0}};
const DrivenOscillator<> driven{2, 0.3, 0.5, 1.1, 0.2};
const ModulatedOscillator<> modulated{2, 0.5, 1.3};
const ScalarFieldCosmology<> cosmology{1.2, 0.3, 0.7};

template <class P>
double force(const P& m, double q, double t) {
  return -m.potential(seed<1, double>({q}), t).slope[0];
}
template <class P>
double potential(const P& m, double q, double t) {
  return m.potential(Vec<1>{q}, t);
}

// ---- contact_symplectic_euler

/// h L(q₀, (q₁ − q₀)/h, s₀, t₀), in the number type of its arguments q₀, q₁, s₀, for one degree of freedom.
template <class P, class T>
T first_order_action(const P& m, const Vec<3, T>& y) {
  const Vec<1, T> q{y[0]}, v{(y[1] - y[0]) / h};
  return h * (0.5 * dot(v, momentum(m, q, v)) - m.potential(q, phase(m, t0)) - action_energy(m, y[2], phase(m, t0)));
}
template <class P>
void check_symplectic_euler(const P& m) {
  const auto x = after(ContactSymplecticEuler{}, m, start, h);
  const auto z = first_order_action(m, seed<3, double>({q0, x.q[0], s0}));
  EXPECT_NEAR(-z.slope[0] / (1 + z.slope[2]), p0, 1e-14);
  EXPECT_NEAR(x.p[0], z.slope[1], 1e-14);
  EXPECT_NEAR(x.action.s, s0 + z.value, 1e-15);
  const auto tangent = tangent_map(ContactSymplecticEuler{}, m, start, h);
  ASSERT_TRUE(tangent);
  const auto [defect, factor] = contact_defect(start, *tangent);
  EXPECT_LT(defect, 1e-14);
  EXPECT_NEAR(factor, 1 + z.slope[2], 1e-14);
}
/// A mass that grows with q, with friction.
template <class R = double>
struct HeavierAway {
  R alpha{0.3};
  static constexpr int dof = 1;
  template <class T, class S>
  T potential(const Vec<1, T>& q, const S&) const {
    using least::cos;
    return -cos(q[0]);
  }
  template <class T>
  Mat<1, T> metric(const Vec<1, T>& q) const {
    Mat<1, T> g;
    g[0][0] = 1.0 + 0.4 * q[0] * q[0];
    return g;
  }
  R damping() const { return alpha; }
};
TEST(ContactMap, SymplecticEulerIsTheFirstOrderHerglotzScheme) {
  check_symplectic_euler(driven);
  check_symplectic_euler(modulated);
  check_symplectic_euler(cosmology);
  check_symplectic_euler(HeavierAway<>{});
}
/// Where H is quadratic in s the factor λ depends on the state: where it is not positive, there is no contact map.
TEST(ContactMap, SymplecticEulerHasNoStepWhereItsFactorIsNotPositive) {
  const auto status = [](double s) {
    auto x = start;
    x.action.s = s;
    auto stepper = ContactSymplecticEuler{}.bind(cosmology, x);
    return stepper.step(x, h);
  };
  EXPECT_EQ(status(0.99 / (0.7 * h)), StepStatus::ok);
  EXPECT_EQ(status(1.01 / (0.7 * h)), StepStatus::singular);
}

// ---- contact_leapfrog

template <class P, class Damping>
void check_leapfrog(const P& m, Damping&& alpha) {
  const auto x = after(ContactLeapfrog{}, m, start, h);
  const double a0 = h * alpha(t0) / 2, a1 = h * alpha(t0 + h) / 2;
  const double v = (1 - a0) * p0 + h / 2 * force(m, q0, t0), q1 = q0 + h * v;
  EXPECT_NEAR(x.q[0], q1, 1e-15);
  EXPECT_NEAR(x.p[0], (v + h / 2 * force(m, q1, t0 + h)) / (1 + a1), 1e-15);
  const double mean = (potential(m, q0, t0) + potential(m, q1, t0 + h)) / 2;
  EXPECT_NEAR(x.action.s, ((1 - a0) * s0 + h * (v * v / 2 - mean)) / (1 + a1), 1e-15);
}
TEST(ContactMap, LeapfrogIsItsClosedForm) {
  check_leapfrog(driven, [](double) { return 0.3; });
  check_leapfrog(modulated, [](double t) { return 0.5 * std::sin(1.3 * t); });
}
// s₁ solves s₁ = s₀ + (h/2)(L₀ + L₁) with γs²/2 in L, and the momenta are −D₁/(1 + hD₃) and D₂/(1 − hD₄).
TEST(ContactMap, LeapfrogOfAQuadraticAction) {
  const auto x = after(ContactLeapfrog{}, cosmology, start, h);
  const double v = (x.q[0] - q0) / h, s1 = x.action.s, gamma = 0.7;
  EXPECT_NEAR(v, (1 - h / 2 * gamma * s0) * p0 + h / 2 * force(cosmology, q0, 0), 1e-15);
  EXPECT_NEAR((1 + h / 2 * gamma * s1) * x.p[0], v + h / 2 * force(cosmology, x.q[0], 0), 1e-15);
  const auto lagrangian = [&](double q, double s) {
    return v * v / 2 - potential(cosmology, q, 0) - gamma * s * s / 2;
  };
  EXPECT_NEAR(s1, s0 + h / 2 * (lagrangian(q0, s0) + lagrangian(x.q[0], s1)), 1e-15);
}

// ---- contact_variational_midpoint

template <class P>
void check_midpoint(const P& m) {
  const auto x = after(ContactVariationalMidpoint{}, m, start, h);
  const double t = t0 + h / 2, v = (x.q[0] - q0) / h, q = (q0 + x.q[0]) / 2, s = (s0 + x.action.s) / 2;
  const double loss = h / 2 * action_slope(m, s, t), kick = h / 2 * force(m, q, t);
  EXPECT_NEAR(v - kick, (1 - loss) * p0, 1e-14);
  EXPECT_NEAR(v + kick, (1 + loss) * x.p[0], 1e-14);
  EXPECT_NEAR(x.action.s, s0 + h * (v * v / 2 - potential(m, q, t) - action_energy(m, s, t)), 1e-14);
}
TEST(ContactMap, MidpointSolvesTheDiscreteHerglotzEquations) {
  check_midpoint(driven);
  check_midpoint(modulated);
  check_midpoint(cosmology);
}

// ---- contact_galerkin_4

/// The action at the end of the quadratic path q₀, b, q₁, by the classical Runge–Kutta scheme.
template <class P, class T>
T path_action(const P& m, const Vec<4, T>& y) {
  const auto& [a, b, c, s] = y;
  const auto lagrangian = [&](const T& q, const T& v, const T& action, double t) {
    return 0.5 * v * v - m.potential(Vec<1, T>{q}, t) - action_energy(m, action, t);
  };
  const T v0 = (4.0 * b - 3.0 * a - c) / h, vm = (c - a) / h, v1 = (a + 3.0 * c - 4.0 * b) / h;
  const T k1 = lagrangian(a, v0, s, t0), k2 = lagrangian(b, vm, T(s + 0.5 * h * k1), t0 + h / 2);
  const T k3 = lagrangian(b, vm, T(s + 0.5 * h * k2), t0 + h / 2), k4 = lagrangian(c, v1, T(s + h * k3), t0 + h);
  return s + h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
}
template <class P>
void check_galerkin(const P& m) {
  const auto x = after(ContactGalerkin4{}, m, start, h);
  using D = Dual<double, 4>;
  const auto at = [&](double b) { return path_action<P, D>(m, seed<4, double>({q0, b, x.q[0], s0})); };
  double b = (q0 + x.q[0]) / 2;
  for (int k = 0; k < 20; ++k)  // Z_b = 0 by the secant through a point beside
    b -= at(b).slope[1] * 1e-3 / (at(b + 1e-3).slope[1] - at(b).slope[1]);
  const D z = at(b);
  EXPECT_NEAR(z.slope[1], 0, 1e-13);
  EXPECT_NEAR(z.slope[0] + p0 * z.slope[3], 0, 1e-13);
  EXPECT_NEAR(x.p[0], z.slope[2], 1e-13);
  EXPECT_NEAR(x.action.s, z.value, 1e-14);
}
TEST(ContactMap, GalerkinExtremisesTheActionOfAQuadraticPath) {
  check_galerkin(driven);
  check_galerkin(modulated);
  check_galerkin(cosmology);
}

// ---- contact_gauss

// One stage: the midpoint rule for 𝓗 = −P_s H(q, −P_q/P_s, s), with P_s at the end read off the tangent map.
template <class P>
void check_gauss(const P& m) {
  const auto tangent = tangent_map(ContactGauss{h, 1}, m, start, h);
  ASSERT_TRUE(tangent);
  const Acting& x = tangent->image;
  const double end = 1 / contact_defect(start, *tangent).factor, scale = (1 + end) / 2;
  const double q = (q0 + x.q[0]) / 2, s = (s0 + x.action.s) / 2, p = (p0 + end * x.p[0]) / 2 / scale, t = t0 + h / 2;
  EXPECT_NEAR(x.q[0] - q0, h * p, 1e-14);
  EXPECT_NEAR(end * x.p[0] - p0, h * scale * force(m, q, t), 1e-14);
  EXPECT_NEAR(x.action.s - s0, h * (p * p / 2 - potential(m, q, t) - action_energy(m, s, t)), 1e-14);
  EXPECT_NEAR(end - 1, h * scale * action_slope(m, s, t), 1e-14);
}
TEST(ContactMap, GaussIsTheMidpointRuleOfTheLift) {
  check_gauss(driven);
  check_gauss(modulated);
  check_gauss(cosmology);
}

// ---- contact_splitting

template <class P>
void check_splitting(const P& m, double alpha) {
  const double t = t0 + h / 2, q = q0 + h / 2 * p0, e = std::exp(-alpha * h), v = potential(m, q, t);
  const double f = force(m, q, t), phi = (1 - e) / alpha, s = s0 + h / 2 * p0 * p0 / 2;
  const double plain = e * (p0 + h / 2 * f) + h / 2 * f, merged = e * p0 + phi * f;
  const auto x = after(ContactSplitting{h, Composition::none, Splitting::plain}, m, start, h);
  EXPECT_NEAR(x.p[0], plain, 1e-15);
  EXPECT_NEAR(x.q[0], q + h / 2 * plain, 1e-15);
  EXPECT_NEAR(x.action.s, e * (s - h / 2 * v) - h / 2 * v + h / 2 * plain * plain / 2, 1e-15);
  const auto y = after(ContactSplitting{h, Composition::none, Splitting::merged}, m, start, h);
  EXPECT_NEAR(y.p[0], merged, 1e-15);
  EXPECT_NEAR(y.q[0], q + h / 2 * merged, 1e-15);
  EXPECT_NEAR(y.action.s, e * s - phi * v + h / 2 * merged * merged / 2, 1e-15);
}
TEST(ContactMap, SplittingIsAPalindromeOfExactFlows) {
  check_splitting(driven, 0.3);
  check_splitting(modulated, 0.5 * std::sin(1.3 * (t0 + h / 2)));
}
TEST(ContactMap, SplittingIsMergedFromStrongDampingOn) {
  const auto same = [](double alpha, Splitting splitting) {
    const DampedOscillator<> m{1, alpha};
    return after(ContactSplitting{h}, m, start, h) ==
           after(ContactSplitting{h, Composition::none, splitting}, m, start, h);
  };
  EXPECT_TRUE(same(0.49 / h, Splitting::plain));
  EXPECT_TRUE(same(0.51 / h, Splitting::merged));
  EXPECT_FALSE(same(0.51 / h, Splitting::plain));
}
// ṡ = −γs²/2 + R and ṗ = −γsp between the kicks, for both signs of R, far from 0 and near it, by many small steps.
TEST(ContactMap, SplittingOfAQuadraticAction) {
  for (const double source : {12.0, 1.3, 0.0, -0.8, -12.0}) {
    const CosmologicalOscillator<> m{0.7, source};
    for (const Splitting splitting : {Splitting::plain, Splitting::merged}) {
      const bool merged = splitting == Splitting::merged;
      const double kick = h / 2 * (0.5 * (q0 + h / 2 * p0) * (q0 + h / 2 * p0) - (merged ? 0 : source));
      double p = p0 - h / 2 * (q0 + h / 2 * p0), s = s0 + h / 2 * p0 * p0 / 2 - kick;
      const int steps = 20'000;
      for (int n = 0; n < steps; ++n) {  // the midpoint rule, its error 1e-9
        const auto rate = [&](double a) { return (merged ? source : 0) - 0.35 * a * a; };
        const double d = h / steps, middle = s + d / 2 * rate(s + d / 2 * rate(s));
        p *= std::exp(-d * 0.7 * middle);
        s += d * rate(middle);
      }
      p -= h / 2 * (q0 + h / 2 * p0);
      const auto x = after(ContactSplitting{h, Composition::none, splitting}, m, start, h);
      EXPECT_NEAR(x.p[0], p, 1e-9) << source;
      EXPECT_NEAR(x.q[0], q0 + h / 2 * p0 + h / 2 * p, 1e-9) << source;
      EXPECT_NEAR(x.action.s, s - kick + h / 2 * p * p / 2, 1e-9) << source;
    }
  }
}

// ---- without damping

template <class P, class Twin>
void check_twins(const P& damped, const Twin& twin) {
  constexpr int n = P::dof;
  State<n> x;
  State<n, double, double, Action<double>> y;
  for (std::size_t i = 0; i < n; ++i) {
    x.q[i] = y.q[i] = 0.7 + double(i);
    x.p[i] = y.p[i] = 0.2 + 0.3 * double(i);
  }
  const auto most = [](const auto& a, const auto& b) {
    double difference = 0;
    for (std::size_t i = 0; i < 2 * n; ++i) difference = std::max(difference, std::abs(a[i] - b[i]));
    return difference;
  };
  for (const double step : {0.1, 0.037}) {
    const auto leapt = after(Leapfrog{step}, twin, x, step, 100);
    EXPECT_EQ(leapt, after(ContactLeapfrog{step}, damped, x, step, 100));
    EXPECT_EQ(most(leapt, after(ContactLeapfrog{step}, damped, y, step, 100)), 0);
    EXPECT_LT(most(after(Leapfrog{step, Composition::kahan_li_6}, twin, x, step),
                   after(ContactLeapfrog{step, Composition::kahan_li_6}, damped, x, step)),
              1e-14);
    EXPECT_EQ(after(SymplecticEuler{step}, twin, x, step, 100),
              after(ContactSymplecticEuler{step}, damped, x, step, 100));
    EXPECT_LT(most(after(VariationalMidpoint{step}, twin, x, step),  //
                   after(ContactVariationalMidpoint{step}, damped, y, step)),
              1e-14);
    EXPECT_LT(most(after(Galerkin4{step}, twin, x, step), after(ContactGalerkin4{step}, damped, y, step)), 1e-14);
  }
}
TEST(ContactMap, WithoutDampingItIsTheConservativeTwin) {
  check_twins(DampedOscillator<>{2, 0}, HarmonicOscillator<>{1, 2});
  check_twins(ModulatedOscillator<>{2, 0, 3}, HarmonicOscillator<>{1, 2});
  check_twins(DrivenOscillator<>{2, 0, 0, 1, 0}, HarmonicOscillator<>{1, 2});
  check_twins(DampedPendulum<>{1, 1, 0}, Pendulum<>{1, 1});
  check_twins(PerturbedKepler<>{-1, 0, 3}, Kepler<>{1});
}

// ---- what the motion does not read

void check_same_bits(const Request& lean, const Request& full) {
  const auto plain = runs::go(lean), result = runs::go(full);
  const std::string pair = std::string(runs::card(lean).id) + ' ' + std::string(schemes()[lean.scheme].id);
  ASSERT_EQ(plain.rows.size(), 301U) << pair;
  ASSERT_EQ(result.rows.size(), plain.rows.size()) << pair;
  for (std::size_t k = 0; k < plain.rows.size(); ++k)
    for (std::size_t i = 0; i < plain.rows[k].size(); ++i) ASSERT_EQ(result.rows[k][i], plain.rows[k][i]) << pair;
}
// Asking for s, the energy or the slope of the orbit never changes a bit of the motion.
TEST(ContactMap, TheMotionHasTheSameBitsWithAndWithoutTheRest) {
  int pairs = 0;
  for (const auto& card : runs::problem_cards()) {
    if (std::ranges::none_of(card.variables, [](const auto& v) { return v.optional; })) continue;
    for (const std::size_t scheme : card.schemes) {
      const bool composable =
          std::ranges::any_of(schemes()[scheme].parameters, [](const auto& p) { return p.name == "composition"; });
      for (const char* composition : {"none", "yoshida_4", "kahan_li_6"}) {
        Request lean = runs::defaults(card.id, schemes()[scheme].id);
        lean.until_steps = true;
        lean.steps = 300;
        if (card.id == "lane_emden") runs::set(lean, "after_zero", "signed");  // the run goes on however long steps are
        if (composable) runs::set(lean, "composition", composition);
        Request full = lean;
        runs::show_all(full);
        check_same_bits(lean, full);
        const auto energy = std::ranges::find(card.columns, "energy", &ColumnCard::name);
        if (energy != card.columns.end()) {
          full = lean;
          full.columns.push_back(std::size_t(energy - card.columns.begin()));
          check_same_bits(lean, full);
        }
        ++pairs;
        if (!composable) break;
      }
    }
  }
  EXPECT_GT(pairs, 60);
}

}  // namespace
