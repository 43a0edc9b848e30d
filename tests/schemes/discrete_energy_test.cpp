// The discrete energy of variational schemes: against its definition, as a column, and its jumps, and those of
// conserved quantities, where a hybrid switches.
#include "core/run/discrete_energy.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/schemes/list.hpp"
#include "least_problems.hpp"
#include "tests/support/runs.hpp"

namespace {

using namespace least;
using namespace least::problems;

template <class Scheme, class P, class X>
X stepped(const Scheme& scheme, const P& problem, X x, double h) {
  auto stepper = scheme.bind(problem, x);
  EXPECT_EQ(stepper.step(x, h), StepStatus::ok);
  return x;
}

/// The action S of a step generates it: dS = p₁·dq₁ − p₀·dq₀ − E_d dh. So the derivatives of E_d by the initial state
/// x₀ are ω(∂x₁/∂x₀, ∂x₁/∂h), whatever S is; and E_d = H at h = 0.
template <class Scheme, class P, class X>
void generates_the_step(const Scheme& scheme, const P& problem, const X& x, double h, double slack = 1e-7) {
  constexpr double d = 1e-5;
  constexpr std::size_t n = P::dof;
  const auto slope = [&](auto&& f) { return (f(d) - f(-d)) / (2 * d); };
  const auto along = [&](std::size_t i, double by) {
    X y = x;
    y[i] += by;
    return y;
  };
  for (std::size_t i = 0; i < 2 * n; ++i) {
    const auto by_start = [&](std::size_t k) {
      return slope([&](double by) { return stepped(scheme, problem, along(i, by), h)[k]; });
    };
    const auto by_length = [&](std::size_t k) {
      return slope([&](double by) { return stepped(scheme, problem, x, h + by)[k]; });
    };
    double form = 0;
    for (std::size_t k = 0; k < n; ++k) form += by_start(n + k) * by_length(k) - by_start(k) * by_length(n + k);
    const double by_energy = slope([&](double by) { return discrete_energy(scheme, problem, along(i, by), h); });
    EXPECT_NEAR(by_energy, form, slack) << scheme.card().id << ' ' << i;
  }
  EXPECT_NEAR(discrete_energy(scheme, problem, x, 1e-7), energy(problem, x), 1e-6) << scheme.card().id;
}
TEST(DiscreteEnergy, IsWhatTheActionOfAStepSays) {
  const State<2> orbit{0, {1, 0.3}, {0.2, 0.9}, {}}, linked{0, {1, 0.5}, {0.3, -0.2}, {}};
  generates_the_step(SymplecticEuler{}, Kepler<>{}, orbit, 0.1);
  for (const auto composition : {Composition::none, Composition::suzuki_4, Composition::kahan_li_6}) {
    generates_the_step(Leapfrog{1, composition}, Kepler<>{}, orbit, 0.1);
    generates_the_step(VariationalMidpoint{1, composition}, Kepler<>{}, orbit, 0.1);
    generates_the_step(VariationalMidpoint{1, composition}, DoublePendulum<>{}, linked, 0.2);
    generates_the_step(Galerkin4{1, composition}, DoublePendulum<>{}, linked, 0.2);
  }
  generates_the_step(Leapfrog{}, HarmonicOscillator<>{2, 3}, State<1>{0, {0.7}, {0.4}, {}}, 0.3);
  EXPECT_TRUE(std::isnan(discrete_energy(RungeKutta4{}, Kepler<>{}, orbit, 0.1)));
}

using Carried = State<1, double, double, Action<double>>;

/// own_energy() returns −∂/∂h of h L(q, way/h, s, t) with q, s and t held fixed; way = q₁ − q₀.
template <class P>
double own_energy(const P& m, double way, double h, double q, double s, double t) {
  using D = Dual<double, 1>;
  const D length = D::variable(h, 0), v = way / length;
  const auto f = phase(m, t);
  return -(length * (0.5 * v * v - D(m.potential(Vec<1>{q}, f) + action_energy(m, s, f)))).slope[0];
}
template <class P>
void check_contact(const P& m) {
  const double h = 0.3, t = 0.4;
  const Carried a{t, {0.7}, {0.6}, {-0.2}};
  const double s0 = a.action.s;
  auto b = stepped(ContactSymplecticEuler{}, m, a, h);
  EXPECT_NEAR(discrete_energy(ContactSymplecticEuler{}, m, a, h), own_energy(m, b.q[0] - a.q[0], h, a.q[0], s0, t),
              1e-14);
  b = stepped(ContactLeapfrog{}, m, a, h);
  EXPECT_NEAR(discrete_energy(ContactLeapfrog{}, m, a, h),
              0.5 * (own_energy(m, b.q[0] - a.q[0], h, a.q[0], s0, t) +
                     own_energy(m, b.q[0] - a.q[0], h, b.q[0], b.action.s, t + h)),
              1e-14);
  b = stepped(ContactVariationalMidpoint{}, m, a, h);
  EXPECT_NEAR(discrete_energy(ContactVariationalMidpoint{}, m, a, h),
              own_energy(m, b.q[0] - a.q[0], h, 0.5 * (a.q[0] + b.q[0]), 0.5 * (s0 + b.action.s), t + h / 2), 1e-14);
  // For a scheme with stages along a path it is the mean of H over the step, to fourth order.
  const auto off = [&](double length) {
    constexpr int parts = 100;
    double mean = 0;
    Carried x = a;
    for (int k = 1; k <= parts; ++k) {
      Carried y = stepped(RungeKutta4{}, m, x, length / parts);
      y.t = a.t + length * k / parts;
      mean += (energy(m, x) + energy(m, y)) / (2 * parts);
      x = y;
    }
    return discrete_energy(ContactGalerkin4{}, m, a, length) - mean;
  };
  EXPECT_NEAR(off(0.1), 0, 1e-6);
}
TEST(DiscreteEnergy, OfContactSchemes) {
  check_contact(DrivenOscillator<>{2, 0.3, 0.5, 1.1, 0.2});
  check_contact(ModulatedOscillator<>{2, 0.5, 1.3});
  check_contact(CosmologicalOscillator<>{0.7, 1.2});
  // Without damping it equals that of the conservative twin.
  const Carried a{0, {0.7}, {0.6}, {0}};
  EXPECT_NEAR(discrete_energy(ContactGalerkin4{}, DampedOscillator<>{2, 0}, a, 0.3),
              discrete_energy(Galerkin4{}, HarmonicOscillator<>{1, 2}, State<1>{0, {0.7}, {0.6}, {}}, 0.3), 1e-14);
}

// ---- as a column

void ask_column(Request& request, std::string_view name) {
  request.columns.push_back(runs::position(runs::card(request).columns, name, &ColumnCard::name));
}

const std::set<std::string> variational{"symplectic_euler",     "leapfrog",
                                        "variational_midpoint", "galerkin_4",
                                        "jacobi_maupertuis",    "energy_momentum",
                                        "contact_leapfrog",     "contact_symplectic_euler",
                                        "contact_galerkin_4",   "contact_variational_midpoint"};

/// The column is null before the first step and for schemes without a discrete energy. Asking for it does not change
/// the run, and the value of a step does not depend on which steps are kept.
TEST(DiscreteEnergy, IsAColumnOfTheLastStep) {
  for (const char* problem : {"kepler", "double_pendulum", "driven_oscillator", "cosmological_oscillator"})
    for (const std::size_t index : runs::problem_card(problem).schemes) {
      const std::string what = std::string(problem) + ' ' + schemes()[index].id;
      const auto run = [&](std::int64_t every, bool asked) {
        Request request = runs::defaults(problem, schemes()[index].id);
        runs::show_all(request);
        request.until_steps = schemes()[index].own_clock;
        request.steps = 21;
        request.end = request.scene->start + 20.4 * (request.until_steps ? 1 : request.settings[0]);
        request.record = {Record::Mode::every, every, {}};
        if (asked) ask_column(request, "discrete_energy");
        return runs::go(request);
      };
      const auto plain = run(1, false), each = run(1, true), some = run(7, true);
      ASSERT_EQ(each.rows.size(), plain.rows.size()) << what;
      EXPECT_EQ(each.outcome.cost.force_evaluations, plain.outcome.cost.force_evaluations) << what;
      ASSERT_GT(each.rows.size(), 20U) << what;
      const bool has = variational.contains(schemes()[index].id);
      for (std::size_t k = 0; k < each.rows.size(); ++k) {
        EXPECT_EQ(std::isfinite(each.rows[k].back()), has && k > 0) << what << ' ' << k;
        for (std::size_t i = 0; i < plain.rows[k].size(); ++i)
          ASSERT_TRUE(each.rows[k][i] == plain.rows[k][i] || std::isnan(plain.rows[k][i])) << what;
      }
      if (!has) continue;
      for (std::size_t k = 1; 7 * k < each.rows.size() && k < some.rows.size(); ++k)
        EXPECT_EQ(some.rows[k].back(), each.rows[7 * k].back()) << what << ' ' << k;
    }
}

/// A sample has the discrete energy of the last step that ends before it or at it, also where that step is a shorter
/// one.
TEST(DiscreteEnergy, OfASampleIsThatOfTheStepBeforeIt) {
  const double h = 0.125;  // exact in binary, so that sample times on the grid are grid times
  Request request = runs::defaults("kepler", "leapfrog");
  runs::set(request, "step", h);
  ask_column(request, "discrete_energy");
  runs::at_times(request, {0.5 * h, h, 2.5 * h, 3 * h, 3.5 * h});
  const auto rows = runs::go(request).rows;
  const Kepler<> kepler;
  const State<2> x{0, {0, -4}, {-0.1, -0.1}, {}};
  EXPECT_TRUE(std::isnan(rows[0].back()));
  EXPECT_EQ(rows[1].back(), discrete_energy(Leapfrog{}, kepler, x, h));
  const auto after = stepped(Leapfrog{}, kepler, stepped(Leapfrog{}, kepler, x, h), h);
  EXPECT_NE(rows[2].back(), rows[1].back());
  EXPECT_EQ(rows[3].back(), discrete_energy(Leapfrog{}, kepler, after, h));
  EXPECT_EQ(rows[4].back(), discrete_energy(Leapfrog{}, kepler, stepped(Leapfrog{}, kepler, after, h), 0.5 * h))
      << "of the shorter step to the end";
}

TEST(DiscreteEnergy, IsKeptByTheSchemeThatSolvesForIt) {
  Request request = runs::defaults("henon_heiles", "energy_momentum");
  ask_column(request, "discrete_energy");
  const auto rows = runs::go(request).rows;
  ASSERT_GT(rows.size(), 1000U);
  for (std::size_t k = 1; k < rows.size(); ++k) EXPECT_NEAR(rows[k].back(), rows[1].back(), 1e-15);
}

// ---- where a hybrid switches

double part(const Report& event, std::string_view path) {
  return runs::number(std::get<std::vector<Report>>(event.value), path);
}

/// As published: it is E₀ along the coordinate, and still after the exit, because the step in time is chosen for that.
TEST(DiscreteEnergy, OfTheHybridAndItsJumps) {
  for (const double midpoint : {0, 1}) {
    Request request = runs::defaults("kepler", "jacobi_maupertuis");
    for (const auto& preset : schemes()[request.scheme].presets)
      if (preset.name == "paper")
        for (const auto& [name, value] : preset.settings) runs::set(request, name, value);
    runs::set(request, "quadrature", midpoint);
    request.end = 16;
    for (const char* name : {"energy", "angular_momentum", "mode", "discrete_energy"}) ask_column(request, name);
    const auto run = runs::go(request);
    ASSERT_EQ(run.outcome.stop.reason, ReturnCode::completed);
    const double level = -0.24;
    std::size_t seen = 0;
    for (std::size_t k = 2; k < run.rows.size(); ++k) {
      const auto &was = run.rows[k - 1], &is = run.rows[k];  // t x y px py energy L mode E_d
      if (is[7] == 1) {
        EXPECT_NEAR(is[8], level, 1e-12);
      }
      if (was[7] == is[7]) continue;
      const auto event =
          std::ranges::find_if(run.outcome.events, [&](const Report& e) { return part(e, "t") == was[0]; });
      ASSERT_NE(event, run.outcome.events.end());
      ++seen;
      EXPECT_EQ(part(*event, "energy_jump"), is[5] - was[5]);
      EXPECT_EQ(part(*event, "momentum_jumps/angular_momentum"), is[6] - was[6]);
      EXPECT_EQ(part(*event, "discrete_energy_jump"), is[8] - was[8]);
      if (is[7] == 1) {
        EXPECT_GT(std::abs(is[8] - was[8]), 1e-8);
      } else {
        EXPECT_LT(std::abs(is[8] - was[8]), 1e-9) << "the exit keeps it";
      }
    }
    EXPECT_EQ(seen, 2U);
  }
}

}  // namespace
