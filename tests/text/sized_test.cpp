// Scenes as text whose size is known when they run: the same motion as by the classes that are compiled for few
// coordinates, and motions of many that are known.
#include "tests/support/sized.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <variant>

#include "core/catalogue/sized_mechanics.hpp"
#include "core/text/sized_scene.hpp"

namespace sized {
namespace {

using namespace texts;
using std::numbers::pi;

/// The definition as a scene of any size, however few coordinates it has.
std::shared_ptr<const Mechanics> sized_of(const Definition& definition) {
  auto scene = std::get<text::TextScene>(text::TextScene::read(definition));
  scene.capacity = static_cast<int>(scene.form->coordinates);
  return sized_mechanics(std::move(scene));
}

std::vector<double> shown(const Request& request, const std::vector<double>& state) {
  std::vector<double> all;
  const auto& variables = runs::card(request).variables;
  for (std::size_t i = 0; i < variables.size(); ++i)
    if (!variables[i].hidden && std::isfinite(state[i])) all.push_back(state[i]);
  return all;
}

class AsOfFew : public testing::TestWithParam<Typed> {};

// Explicit steps of equal length to the last bit; implicit ones to round-off, as these solve other equations for the
// same step; those of a clock of their own to what they ask of themselves.
TEST_P(AsOfFew, MovesAsTheClassThatIsCompiled) {
  const auto compiled = mechanics_of(GetParam().definition), any = sized_of(GetParam().definition);
  ASSERT_GE(any->card().schemes.size(), 7U);
  for (const auto index : any->card().schemes) {
    const std::string& id = schemes()[index].id;
    ASSERT_TRUE(runs::fits(compiled->card(), index)) << id;
    Request catalogued = runs::defaults(GetParam().id, id);
    catalogued.end = catalogued.scene->start + std::min(5.0, catalogued.end - catalogued.scene->start);
    runs::only_final(catalogued);
    for (const bool composed : {false, true}) {
      if (composed && !schemes()[index].find("composition")) continue;
      if (composed) runs::set(catalogued, "composition", "suzuki_4");
      const Request few = typed_as(catalogued, compiled), many = typed_as(catalogued, any);
      const auto a = runs::go(few).outcome, b = runs::go(many).outcome;
      ASSERT_EQ(a.stop.reason, b.stop.reason) << id << " " << b.stop.detail;
      const auto x = shown(few, a.final), y = shown(many, b.final);
      ASSERT_GE(y.size(), x.size()) << id;
      const bool solves = schemes()[index].implicit;
      const double close = schemes()[index].own_clock ? 1e-8 : solves ? 1e-11 : 0;
      for (std::size_t i = 0; i < x.size(); ++i)
        EXPECT_NEAR(x[i], y[i], close * std::max(1.0, std::abs(x[i]))) << id << " variable " << i;
      if (!schemes()[index].own_clock && !solves) {
        EXPECT_EQ(a.cost.force_evaluations, b.cost.force_evaluations) << id;
      }
    }
  }
}

/// What diagnostics say that are made of the tangents of steps, of those that the scene has.
std::vector<double> tangents_in(Request request) {
  std::vector<std::string> asked;
  for (const char* path : {"structure/max_defect", "structure/factor", "lyapunov/exponent", "lyapunov/megno"}) {
    const std::string name(path, std::string_view(path).find('/'));
    if (std::ranges::count(runs::card(request).diagnostics, name, &DiagnosticCard::name) == 0) continue;
    if (asked.empty() || !asked.back().starts_with(name)) runs::ask(request, name);
    asked.emplace_back(path);
  }
  const auto reports = runs::go(request).outcome.diagnostics;
  std::vector<double> all;
  for (const std::string& path : asked) all.push_back(runs::number(reports, path));
  return all;
}
TEST_P(AsOfFew, TangentsOfStepsAreThoseOfTheClass) {
  const auto compiled = mechanics_of(GetParam().definition), any = sized_of(GetParam().definition);
  for (const auto index : any->card().schemes) {
    const std::string& id = schemes()[index].id;
    Request catalogued = runs::defaults(GetParam().id, id);
    if (schemes()[index].own_clock) continue;
    catalogued.end = catalogued.scene->start + std::min(2.0, catalogued.end - catalogued.scene->start);
    const auto few = tangents_in(typed_as(catalogued, compiled)), many = tangents_in(typed_as(catalogued, any));
    ASSERT_EQ(few.size(), many.size());
    const bool keeps = schemes()[index].structure != "none" && many.size() == 4;
    if (keeps) {
      EXPECT_LT(many[0], 1e-12) << id;
    }
    for (std::size_t i = keeps ? 1 : 0; i < few.size(); ++i) {
      ASSERT_EQ(std::isnan(few[i]), std::isnan(many[i])) << id << " " << i;
      if (!std::isnan(few[i])) {
        EXPECT_NEAR(few[i], many[i], 1e-6 * std::abs(few[i]) + 1e-12) << id << " " << i;
      }
    }
  }
}

std::vector<Typed> of_any_size() {
  std::vector<Typed> some = all();
  std::erase_if(some, [](const Typed& typed) {
    return !text::SizedScene::has(*std::get<text::TextScene>(text::TextScene::read(typed.definition)).form);
  });
  return some;
}
INSTANTIATE_TEST_SUITE_P(, AsOfFew, testing::ValuesIn(of_any_size()),
                         [](const auto& tested) { return name_of(tested.param) + "_" + std::to_string(tested.index); });

TEST(Sized, FormsOfManyCoordinatesAreMost) { EXPECT_GE(of_any_size().size(), 15U); }

Definition full_mass() {
  return of(Definition::Kind::lagrangian, {"x", "y"}, {{"m", 2}},
            "m*vx^2/2 + vy^2/2 + vx*vy/3 - x^2/2 - y^2/2 - x*y^2");
}
TEST(Sized, KnowsConstantMetricsThatAreNotDiagonal) {
  Request few = typed_as(runs::defaults("henon_heiles", "leapfrog"), mechanics_of(full_mass()));
  Request many = typed_as(runs::defaults("henon_heiles", "leapfrog"), sized_of(full_mass()));
  for (Request* request : {&few, &many}) {
    begin_at(*request, std::array{0.1, 0.2, 0.3, -0.1});
    runs::only_final(*request);
    request->end = 10;
  }
  EXPECT_EQ(shown(few, runs::go(few).outcome.final), shown(many, runs::go(many).outcome.final));
}

/// n masses between springs and two walls: q_j = sin(jkπ/(n + 1)) cos ωt, ω = 2 sin(kπ/2(n + 1)); damped by αs with
/// ω² − α²/4 and e^{−αt/2}.
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
  EXPECT_EQ(fault_of(typed), "/variables/0 must name at least one variable and not too many");
  typed.scene.variables = {"x[1024]"};
  typed.scene.formula = "sum(i=1..1024, x[i]^2)";
  EXPECT_EQ(fault_of(typed), "none");
  typed.scene.variables = {"x[9]"};
  typed.scene.formula = "sum(i=1..9, vx[i]^2*(1 + x[i]^2))";
  typed.scene.kind = Definition::Kind::lagrangian;
  EXPECT_EQ(fault_of(typed), "none");
  typed.scene.formula = "sum(i=1..9, vx[i]^2 + vx[i]^4)";
  EXPECT_EQ(fault_of(typed).substr(0, 69), "/variables are more than a Lagrangian not quadratic in the velocities");
}

}  // namespace
}  // namespace sized
