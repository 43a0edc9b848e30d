// Physical results of whole scenes under the contact schemes: the period of a limit cycle, fixed points and blow-up of
// a universe, capture of a moon, a thermal ensemble. The numbers come from an independent implementation.
#include <gtest/gtest.h>

#include <cmath>

#include "core/schemes/list.hpp"
#include "least_problems.hpp"
#include "tests/support/contact_data.hpp"

namespace {

using namespace least;
using namespace least::problems;
using contact::data, contact::pi, contact::orbits, contact::request_for;
using nlohmann::json;

double read(const json& text) { return std::stod(text.get<std::string>()); }

// ---- van_der_pol

/// cycle() returns period and amplitude of the last cycle. The orbit starts where it creeps towards its jump, so that
/// it is on the scheme's own cycle at once where ε is large.
std::pair<double, double> cycle(double epsilon, double h, double end) {
  Request request = request_for("van_der_pol", "contact_splitting", "none", h);
  runs::set(request, "epsilon", epsilon);
  runs::begin(request, "x", -1.3);
  runs::begin(request, "v", 1.3 / (0.69 * epsilon));
  request.end = end;
  runs::ask(request, "cycle");
  runs::only_final(request);
  const auto result = runs::go(request);
  EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed);
  EXPECT_GE(runs::number(result.outcome.diagnostics, "cycle/cycles"), 1);
  return {runs::number(result.outcome.diagnostics, "cycle/period"),
          runs::number(result.outcome.diagnostics, "cycle/amplitude")};
}
TEST(ContactScene, VanDerPolPeriods) {
  const auto check = [](const char* epsilon, double h, double end, double tolerance) {
    for (const auto& truth : data().at("van_der_pol_cycle"))
      if (truth.at("epsilon") == epsilon) {
        const auto [period, amplitude] = cycle(read(truth.at("epsilon")), h, end);
        EXPECT_LT(std::abs(period / read(truth.at("period")) - 1), tolerance) << epsilon << ' ' << h;
        EXPECT_LT(std::abs(amplitude / read(truth.at("amplitude")) - 1), 10 * tolerance) << epsilon << ' ' << h;
      }
  };
  check("10", 0.01, 100, 1e-5);
  check("100", 1e-3, 400, 2e-7);
  check("1000", 2e-4, 1750, 1e-8);
  for (const char* gentle : {"0.1", "1", "2", "5"}) check(gentle, 1e-3, 250, 1e-6);
}
// From the default start, through the transient, with a composition.
TEST(ContactScene, VanDerPolEndsOnItsCycle) {
  Request request = request_for("van_der_pol", "contact_splitting", "kahan_li_8", 0.01);
  runs::ask(request, "cycle");
  request.end = 100;
  const auto result = runs::go(request);
  EXPECT_NEAR(runs::number(result.outcome.diagnostics, "cycle/period"), 6.66328685932313, 1e-11);
  EXPECT_NEAR(runs::number(result.outcome.diagnostics, "cycle/amplitude"), 2.00861986087484, 1e-11);
  EXPECT_EQ(runs::number(result.outcome.diagnostics, "cycle/cycles"), 14);
}

// ---- cosmological_oscillator

// For q = p = 0 the merged splitting is exact in s; the plain one shifts the fixed point.
TEST(ContactScene, CosmologicalFixedPoint) {
  const auto distance = [](std::string_view splitting, std::string_view composition, double s, double gamma,
                           double source) {
    Request request = request_for("cosmological_oscillator", "contact_splitting", composition, 0.1);
    runs::set(request, "splitting", splitting);
    runs::set(request, "gamma", gamma);
    runs::set(request, "R", source);
    runs::scene(request).initial = {0, 0, s};
    request.end = 200;
    double last = 0;
    const auto result = runs::go(request);
    EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed);
    for (const auto& row : result.rows)
      if (row[0] > 100) last = std::max(last, std::abs(row[3] - std::sqrt(2 * source / gamma)));
    return last;
  };
  for (const auto& [gamma, source] : {std::pair{1.0, 1.0}, {0.5, 2.0}, {3.0, 0.25}})
    for (const double s : {std::sqrt(2 * source / gamma), 0.0, 3.0})
      for (const char* composition : {"none", "kahan_li_6"}) {
        EXPECT_LT(distance("merged", composition, s, gamma, source), 1e-13) << gamma << ' ' << source << ' ' << s;
        EXPECT_EQ(distance("automatic", composition, s, gamma, source),
                  distance("merged", composition, s, gamma, source));
      }
  EXPECT_NEAR(distance("plain", "none", 0, 1, 1), 8.8e-4, 0.1e-4);
}
TEST(ContactScene, CosmologicalEllipsoid) {
  for (const json* entry : orbits("cosmological_oscillator"))
    if (read(entry->at("start").at(2)) < -1.1)
      for (const char* scheme : {"contact_leapfrog", "contact_splitting"}) {
        Request request = request_for("cosmological_oscillator", scheme, "none", 0.1);
        for (std::size_t i = 0; i < 3; ++i) runs::scene(request).initial[i] = read(entry->at("start").at(i));
        request.end = 50;
        runs::ask(request, "energy");
        const auto result = runs::go(request);
        EXPECT_LT(std::abs(runs::number(result.outcome.diagnostics, "energy/initial")), 1e-15);
        EXPECT_LE(runs::number(result.outcome.diagnostics, "energy/max_abs_error"), 4.9e-3) << scheme;
      }
}
// For q = p = 0 the merged splitting is exact, and so is the time of the blow-up. Others report the time that their own
// steps lead to.
TEST(ContactScene, CosmologicalBlowUp) {
  const double truth = read(data().at("cosmological_blow_up").at("t"));
  const auto error = [&](std::string_view scheme, std::string_view composition, double h) {
    Request request = request_for("cosmological_oscillator", scheme, composition, h);
    runs::scene(request).initial = {0, 0, -2};
    const auto result = runs::go(request);
    EXPECT_EQ(result.outcome.stop.reason, ReturnCode::singular) << scheme << ' ' << h;
    EXPECT_TRUE(result.outcome.stop.singular_at) << scheme << ' ' << h;
    EXPECT_LT(result.outcome.t, truth);
    return std::abs(result.outcome.stop.singular_at.value_or(0) - truth);
  };
  for (const double h : {0.1, 0.05, 0.013}) {
    EXPECT_LT(error("contact_splitting", "none", h), 1e-10) << h;
    EXPECT_LT(error("contact_splitting", "kahan_li_6", h), 1e-10) << h;
    EXPECT_LT(error("contact_leapfrog", "none", h), 0.5 * h) << h;
  }
}

// ---- spin_orbit: e = 0.01, ε = 0.0075, o = 1, h = π/10

TEST(ContactScene, SpinOrbit) {
  const auto error = [](std::string_view composition) {
    Request request = request_for("spin_orbit", "contact_splitting", composition, pi / 10);
    request.end = 20 * pi;
    const auto x = runs::go(request).outcome.final;
    const json& truth = orbits("spin_orbit").at(0)->at("states").at(1).at("state");  // λ = 0.001
    return std::abs(x[0] - read(truth.at(0))) + std::abs(x[1] - read(truth.at(1)));
  };
  EXPECT_NEAR(error("none") / 5.0e-5, 1, 0.05);
  EXPECT_LT(error("kahan_li_6"), 1.05e-11);
}
// Steps of another length, or at other times, do not use the table of phases: they have the same bits as without one.
template <class Scheme>
void expect_own_steps_only() {
  const SpinOrbit<> problem;
  const double h = pi / 10, shorter = 0.1;
  State<1> x{0, {0.3}, {1.1}, {}}, y = x;
  auto tabulated = Scheme{h}.bind(problem, x);
  auto computed = Scheme{shorter}.bind(problem, y);
  const auto step = [&](double length) {
    EXPECT_EQ(tabulated.step(x, length), StepStatus::ok);
    EXPECT_EQ(computed.step(y, length), StepStatus::ok);
    EXPECT_EQ(x, y) << "a step of " << length << " from " << x.t;
    x.t = y.t = x.t + length;
  };
  step(shorter);
  step(h);
}
TEST(ContactScene, SpinOrbitTableIsForItsOwnSteps) {
  expect_own_steps_only<ContactSplitting>();
  expect_own_steps_only<ContactLeapfrog>();
}
// Friction slows the spin until it is captured: from then on |p − 1| stays small.
TEST(ContactScene, SpinOrbitCapture) {
  Request request = request_for("spin_orbit", "contact_splitting", "kahan_li_6", pi / 10);
  for (const auto& [name, value] : {std::pair{"lambda", 1e-4}, {"damping", 1e-3}, {"torque", 1e-3}})
    runs::set(request, name, value);
  runs::scene(request).initial = {2.7, 3, 0};
  request.end = 5000;
  double last = 0;
  for (const auto& row : runs::go(request).rows)
    if (std::abs(row[2] - 1) > 0.16) last = row[0];
  EXPECT_NEAR(last, 2668.5, 2);
}
// One start librates about the resonance, the other rotates (the separatrix is known to about 2e-5).
TEST(ContactScene, SpinOrbitIsland) {
  const json& edge = data().at("spin_orbit_separatrix");
  const auto librates = [&](double p) {
    Request request = request_for("spin_orbit", "contact_splitting", "kahan_li_6", pi / 10);
    runs::scene(request).initial = {0, p, 0};
    request.end = 1200 * pi;
    double most = 0;
    for (const auto& row : runs::go(request).rows) most = std::max(most, std::abs(row[1] - row[0]));
    return most < pi;
  };
  const double upper = edge.at("upper_p0"), lower = edge.at("lower_p0");
  EXPECT_TRUE(librates(upper - 1e-3));
  EXPECT_FALSE(librates(upper + 1e-3));
  EXPECT_TRUE(librates(lower + 1e-3));
  EXPECT_FALSE(librates(lower - 1e-3));
}

// ---- thermostat

// Starts distributed with the target density keep this distribution: averages over the starts and the second half of
// 200 steps. The points are Kronecker's sequence for the plastic number of dimension 3, mapped by the inverse
// distributions.
TEST(ContactScene, ThermostatKeepsTheEnsemble) {
  const Thermostat<> problem{1, 1, 1};
  constexpr double plastic = 1.2207440846057596, h = 0.05;
  constexpr int starts = 25'000, steps = 200;
  Vec<4, double> mean{};  // q², p², p⁴, s²
  for (int k = 0; k < starts; ++k) {
    double u[3], power = 1;
    for (double& c : u) c = std::fmod(0.5 + k * (power /= plastic), 1.0);
    const double r = std::sqrt(-2 * std::log(1 - u[0]));
    Point<3> x{0, {r * std::cos(2 * pi * u[1]), r * std::sin(2 * pi * u[1]), std::log(u[2] / (1 - u[2]))}};
    auto stepper = ContactSplitting{h}.bind(problem, x);
    for (int n = 0; n < steps; ++n) {
      ASSERT_EQ(stepper.step(x, h), StepStatus::ok);
      if (n < steps / 2) continue;
      const auto m = problem.moments(x.y);
      for (std::size_t i = 0; i < 4; ++i) mean[i] += m[i] / (starts * (steps / 2));
    }
  }
  EXPECT_NEAR(mean[0], 1, 0.02);
  EXPECT_NEAR(mean[1], 1, 0.02);
  EXPECT_NEAR(mean[2], 3, 0.1);
  EXPECT_NEAR(mean[3], 3.29, 0.05);
}
// For a narrow density of s one long orbit is ergodic enough; with long steps or a wide density it is not.
TEST(ContactScene, ThermostatMoments) {
  const auto moments = [](double scale, double h, double end) {
    Request request = request_for("thermostat", "contact_splitting", "none", h);
    runs::set(request, "scale", scale);
    runs::ask(request, "moments");
    runs::only_final(request);
    request.end = end;
    const auto result = runs::go(request);
    return std::pair{runs::number(result.outcome.diagnostics, "moments/q2"),
                     runs::number(result.outcome.diagnostics, "moments/p4")};
  };
  const auto [q2, p4] = moments(0.1, 0.02, 1e5);
  EXPECT_NEAR(q2, 1, 0.05);
  EXPECT_NEAR(p4, 3, 0.15);
  const auto [long_q2, long_p4] = moments(0.1, 0.1, 1e5);
  EXPECT_NEAR(long_q2, 0.79, 0.08);
  EXPECT_NEAR(long_p4, 5.1, 0.5);
  const auto [wide_q2, wide_p4] = moments(1, 0.02, 2e4);
  EXPECT_GT(std::abs(wide_q2 - 1) + std::abs(wide_p4 - 3), 0.3);
}

}  // namespace
