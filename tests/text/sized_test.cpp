// Scenes as text of many coordinates with known motions.
#include "tests/support/sized.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <variant>

namespace sized {
namespace {

using namespace texts;
using std::numbers::pi;

/// n masses between springs and two walls: q_j = sin(jkπ/(n + 1)) cos ωt, ω = 2 sin(kπ/2(n + 1)); with damping αs, ω² −
/// α²/4 in place of ω² and a factor e^{−αt/2}.
struct Chain {
  int n;
  double alpha = 0;
  int k = 3;

  double omega() const { return 2 * std::sin(k * pi / (2 * (n + 1))); }
  std::shared_ptr<const Mechanics> mechanics() const {
    text::TypedScene typed;
    typed.scene = of(Definition::Kind::potential, {"q[n]"}, {{"n", double(n)}, {"alpha", alpha}},
                     "sum(i=0..n, (at(i+1) - at(i))^2/2)");
    typed.definitions = {{"at(i)", "if(i < 1 or i > n, 0, q[i])"}};
    if (alpha > 0) typed.scene.damping = "alpha";
    return made(typed);
  }
  Request request(const char* scheme, double end) const {
    Request request = typed_as(runs::defaults("harmonic_oscillator", scheme), mechanics());
    std::vector<double> start;
    for (int j = 1; j <= n; ++j) start.push_back(std::sin(j * k * pi / (n + 1)));
    begin_at(request, start);
    runs::only_final(request);
    request.end = end;
    return request;
  }
  double error(const Request& request) const {
    const auto last = runs::go(request).outcome.final;
    const double w = std::sqrt(omega() * omega() - alpha * alpha / 4), t = request.end;
    const double amplitude = std::exp(-alpha * t / 2) * (std::cos(w * t) + alpha / (2 * w) * std::sin(w * t));
    double most = 0;
    for (int j = 1; j <= n; ++j)
      most = std::max(most, std::abs(last[std::size_t(j - 1)] - amplitude * std::sin(j * k * pi / (n + 1))));
    return most;
  }
};

TEST(Sized, AChainMovesAsItsNormalModes) {
  const Chain chain{64};  // 128 components are more than a stepper of Odeint holds in place
  for (const char* scheme : {"taylor", "dormand_prince_5", "fehlberg_78", "bulirsch_stoer"}) {
    Request request = chain.request(scheme, 30);
    runs::set(request, "tolerance", 1e-11);
    EXPECT_LT(chain.error(request), 1e-8) << scheme;
  }
}

TEST(Sized, SchemesOfEqualStepsHaveTheirOrders) {
  const Chain chain{100};
  const auto order = [&](const char* scheme, const char* composition, double step) {
    double before = 0, after = 0;
    for (double* error : {&before, &after}) {
      Request request = chain.request(scheme, 20);
      runs::set(request, "step", step);
      if (*composition) runs::set(request, "composition", composition);
      *error = chain.error(request);
      step /= 2;
    }
    EXPECT_GT(after, 1e-14) << scheme << " is not at round-off";
    return std::log2(before / after);
  };
  EXPECT_NEAR(order("symplectic_euler", "", 0.1), 1, 0.1);
  EXPECT_NEAR(order("leapfrog", "", 0.1), 2, 0.1);
  EXPECT_NEAR(order("leapfrog", "suzuki_4", 1), 4, 0.3);
  EXPECT_NEAR(order("leapfrog", "kahan_li_6", 1), 6, 0.5);
  EXPECT_NEAR(order("ruth_3", "", 0.5), 3, 0.3);
  EXPECT_NEAR(order("runge_kutta_4", "", 0.5), 4, 0.3);
  EXPECT_NEAR(order("explicit_midpoint", "", 0.1), 2, 0.1);
}

TEST(Sized, DampedChainsKeepTheirLawOfDecay) {
  const Chain chain{32, 0.1};
  Request request = chain.request("contact_leapfrog", 20);
  runs::set(request, "step", 0.05);
  const double coarse = chain.error(request);
  runs::set(request, "step", 0.025);
  EXPECT_NEAR(std::log2(coarse / chain.error(request)), 2, 0.1);
  runs::ask(request, "energy");
  runs::ask(request, "decay");
  const auto reports = runs::go(request).outcome.diagnostics;
  EXPECT_LT(runs::number(reports, "decay/max_residual"), 1e-4);
  EXPECT_LT(chain.error(chain.request("taylor", 20)), 1e-11);
}

TEST(Sized, TheirStructureIsMeasuredUpToSoManyCoordinates) {
  const auto defect = [](int n) {
    Request request = Chain{n}.request("leapfrog", 0.02);
    runs::set(request, "step", 0.01);
    runs::ask(request, "structure");
    return runs::number(runs::go(request).outcome.diagnostics, "structure/max_defect");
  };
  EXPECT_LT(defect(128), 1e-14);
  EXPECT_TRUE(std::isnan(defect(129))) << "whose matrix takes its cube";
}

/// Seven stars in the plane: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, 1993, II.10.
TEST(Sized, PleiadesComeWhereTheyAreKnownToBe) {
  text::TypedScene typed;
  typed.scene = of(Definition::Kind::potential, {"x[7]", "y[7]"}, {},
                   "-sum(i=1..7, j=i+1..7, i*j/sqrt((x[i]-x[j])^2 + (y[i]-y[j])^2))");
  typed.scene.masses = {{"x[i]", "i"}, {"y[i]", "i"}};
  Request request = typed_as(runs::defaults("kepler", "taylor"), made(typed));
  std::vector<double> start{3, 3, -1, -3, 2, -2, 2, 3, -3, 2, 0, 0, -4, 4};
  start.resize(28, 0);
  start[14 + 5] = 1.75 * 6;
  start[14 + 6] = -1.5 * 7;
  start[21 + 3] = -1.25 * 4;
  start[21 + 4] = 1 * 5;
  begin_at(request, start);
  runs::only_final(request);
  request.end = 3;
  runs::set(request, "tolerance", 1e-15);
  const double known[] = {0.3706139143970502, 3.237284092057233, -3.222559032418324, 0.6597091455775310,
                          0.3425581707156584, 1.562172101400631, -0.7003092922212495};
  runs::ask(request, "error");
  const auto outcome = runs::go(request).outcome;
  for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(outcome.final[i], known[i], 1e-10) << i;
  EXPECT_LT(runs::number(outcome.diagnostics, "error/final"), 1e-10);
  EXPECT_LT(runs::number(outcome.diagnostics, "error/uncertainty"), 1e-14);
}

TEST(Sized, FlowsAndHamiltoniansHaveManyVariables) {
  text::TypedScene typed;  // 40 oscillators, as a flow of 80 variables
  typed.scene = flow({"x[40]", "v[40]"}, {}, {{"x[i]", "v[i]"}, {"v[i]", "-i*x[i]/10"}});
  Request request = typed_as(runs::defaults("van_der_pol", "taylor"), made(typed));
  std::vector<double> start(40, 1);
  begin_at(request, start);
  runs::only_final(request);
  request.end = 2;
  auto last = runs::go(request).outcome.final;
  for (int i = 1; i <= 40; ++i) EXPECT_NEAR(last[std::size_t(i - 1)], std::cos(2 * std::sqrt(i / 10.0)), 1e-11) << i;

  text::TypedScene turning;  // of each pair H = (x² + p²)²/8: turns with the frequency (x² + p²)/2
  turning.scene = of(Definition::Kind::hamiltonian, {"x[20]"}, {}, "sum(i=1..20, (x[i]^2 + px[i]^2)^2/8)");
  Request other = typed_as(runs::defaults("kepler", "taylor"), made(turning));
  start.clear();
  for (int i = 1; i <= 20; ++i) start.push_back(0.1 * i);
  begin_at(other, start);
  runs::only_final(other);
  other.end = 3;
  last = runs::go(other).outcome.final;
  for (int i = 1; i <= 20; ++i) {
    const double r = 0.1 * i;
    EXPECT_NEAR(last[std::size_t(i - 1)], r * std::cos(r * r / 2 * 3), 1e-11) << i;
  }
}

TEST(Sized, WhatIsRefusedSaysWhy) {
  const auto fault_of = [](text::TypedScene typed) {
    const auto found = custom_mechanics(std::move(typed));
    const auto* faults = std::get_if<std::vector<text::DefinitionFault>>(&found);
    return faults && !faults->empty() ? faults->front().pointer + " " + faults->front().fault.detail : "none";
  };
  text::TypedScene typed;
  typed.scene = of(Definition::Kind::potential, {"x[1025]"}, {}, "sum(i=1..1025, x[i]^2)");
  EXPECT_EQ(fault_of(typed), "/variables/0 has too many elements");
  typed.scene.variables = {"x[1024]"};
  typed.scene.formula = "sum(i=1..1024, x[i]^2)";
  EXPECT_EQ(fault_of(typed), "none");
  typed.scene.variables = {"x[9]"};
  typed.scene.formula = "sum(i=1..9, vx[i]^2*(1 + x[i]^2))";
  typed.scene.kind = Definition::Kind::lagrangian;
  EXPECT_EQ(fault_of(typed), "none");
  typed.scene.formula = "sum(i=1..9, vx[i]^2 + vx[i]^4)";
  EXPECT_EQ(fault_of(typed), "none");
  typed.scene.variables = {"x[25]"};
  typed.scene.formula = "sum(i=1..25, vx[i]^2 + vx[i]^4) + sum(i=1..24, vx[i]*vx[i+1])/9";
  EXPECT_EQ(fault_of(typed), "/lagrangian couples the velocities of too many coordinates");
}

}  // namespace
}  // namespace sized
