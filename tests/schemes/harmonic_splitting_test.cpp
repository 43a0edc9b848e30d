// harmonic_splitting on scenes as text: its orders in the step and in the perturbation, the symplectic form, reversal,
// and fast oscillators that no step resolves.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/schemes/harmonic_stepper.hpp"
#include "tests/support/steps_of_text.hpp"

namespace harmonic_splitting {
namespace {

using namespace texts;
constexpr auto typed_v = Definition::Kind::potential, typed_h = Definition::Kind::hamiltonian,
               typed_l = Definition::Kind::lagrangian;

struct Scene {
  const char* name;
  Definition definition;
  std::vector<double> start;  ///< q, p
};
Scene henon_heiles() {
  return {"henon_heiles",
          of(typed_l, {"x", "y"}, {{"e", 0.3}}, "(vx^2 + vy^2)/2 - (x^2 + y^2)/2 - e*y*(x^2 - y^2/3)"),
          {0.3, 0.2, 0.1, 0.4}};
}
/// A mass matrix that is not diagonal, coupled oscillators, and a drive.
Scene coupled() {
  return {
      "coupled",
      of(typed_h, {"x", "y"}, {{"e", 0.3}}, "px^2/2 + py^2 + px*py/3 + (x^2 + 2*y^2 + x*y)/2 + e*x^4 + e*x*cos(2*t)"),
      {0.3, 0.2, 0.1, 0.4}};
}
/// A direction in which V falls, one that is free, and unequal masses.
Scene saddle() {
  Scene made{"saddle",
             of(typed_v, {"x", "y", "z"}, {{"e", 0.3}}, "-x^2/2 + 2*y^2 + x*y + e*(x^4 + z^4)"),
             {0.3, 0.2, 0.1, 0.4, 0, 0.2}};
  made.definition.masses = {{"y", "2"}, {"z", "0.5"}};
  return made;
}
/// A chain of Fermi, Pasta and Ulam with nine masses: more coordinates than any compiled class has.
Scene chain() {
  Scene made{"chain", of(typed_v, {}, {{"e", 0.3}}, "0"), {}};
  constexpr int n = 9;
  const auto at = [](int i) { return i == 0 || i > n ? std::string("0") : "x" + std::to_string(i); };
  for (int i = 0; i <= n; ++i) {
    if (i > 0) made.definition.variables.push_back(at(i));
    const std::string spring = "(" + at(i + 1) + " - " + at(i) + ")";
    made.definition.formula += " + " + spring + "^2/2 + e*" + spring + "^3/3";
  }
  for (int i = 1; i <= n; ++i) made.start.push_back(0.4 * std::sin(3.14159265358979 * i / (n + 1)));
  made.start.resize(2 * n);
  return made;
}
std::vector<Scene> scenes() { return {henon_heiles(), coupled(), saddle(), chain()}; }

Request request_of(const Scene& scene, double step, double end, std::string_view scheme = "harmonic_splitting") {
  Request request = request_by(scheme, mechanics_of(scene.definition), scene.start, end);
  if (schemes()[request.scheme].find("step")) runs::set(request, "step", step);
  return request;
}
double error_of(Request request, const Scene& scene, double e, std::string_view setting, std::string_view value) {
  Request truth = request_of(scene, 0, request.end, "taylor");
  for (Request* one : {&request, &truth}) runs::set(*one, "e", e);
  runs::set(truth, "tolerance", 1e-16);
  runs::set(request, setting, value);
  return distance(final_of(request), final_of(truth));
}

struct Row {
  const char *setting, *value;
  int order;        ///< where the perturbation is not small
  int small_order;  ///< of the part linear in it; 0: hidden by round-off or by the quadratic part
};
const Row rows[] = {{"composition", "none", 2, 2},       {"composition", "suzuki_4", 4, 4},
                    {"composition", "kahan_li_6", 6, 6}, {"composition", "kahan_li_8", 8, 0},
                    {"splitting", "saba_2", 2, 4},       {"splitting", "saba_4", 2, 0},
                    {"splitting", "aba_864", 4, 8},      {"splitting", "aba_1064", 4, 0}};

class HarmonicSplittingOf : public testing::TestWithParam<Scene> {};

// The order is checked from both sides, at the last of the halved steps whose errors are small and above round-off.
TEST_P(HarmonicSplittingOf, HasItsOrders) {
  for (const Row& row : rows) {
    double seen = unknown, before = 1;
    for (double step = 1; step > 1e-3 && before > 2e-12; step /= 2) {
      const double error = error_of(request_of(GetParam(), step, 3), GetParam(), 0.3, row.setting, row.value);
      if (before < 1e-3 && error > 2e-12) seen = std::log2(before / error);
      before = error;
    }
    if (std::isnan(seen)) {
      EXPECT_EQ(row.order, 8) << "no two steps between 1e-3 and round-off: " << row.value;
      continue;
    }
    // For saba and aba the part quadratic in the perturbation is the last to be seen.
    const bool mixed = row.setting == std::string("splitting");
    EXPECT_NEAR(seen, row.order, mixed ? 0.8 : row.order == 8 ? 1 : 0.3) << row.value;
  }
}

TEST_P(HarmonicSplittingOf, KeepsTheForm) {
  for (const Row& row : rows) {
    Request request = request_of(GetParam(), 0.3, 6);
    runs::set(request, row.setting, row.value);
    runs::ask(request, "structure");
    const auto found = runs::go(request).outcome.diagnostics;
    EXPECT_LT(runs::number(found, "structure/max_defect"), 3e-14) << row.value;
  }
}

TEST_P(HarmonicSplittingOf, ComesBackByTheStepsItCameBy) {
  const Definition& definition = GetParam().definition;
  const auto mechanics = mechanics_of(definition);
  const auto scene = std::make_shared<const text::Harmonic>(
      std::get<text::Harmonic>(text::harmonic(*mechanics->text()->form, parameters_of(definition))));
  for (const HarmonicSplitting& scheme :
       {HarmonicSplitting{0.1, Composition::none}, HarmonicSplitting{0.1, Composition::kahan_li_6},
        HarmonicSplitting{0.1, Composition::none, SplittingTurns::aba_864}}) {
    const auto went = there_and_back(HarmonicStepper<double>(scene, scheme, definition.variables.size()),
                                     GetParam().start, 0.3, 0.1, 40);
    EXPECT_GT(went.away, 1e-2);
    EXPECT_LT(went.missed, 1e-11);
  }
}

TEST_P(HarmonicSplittingOf, IsTheSameHoweverItIsRecorded) {
  expect_the_same_however_recorded(request_of(GetParam(), 0.1, 3.14));
}

INSTANTIATE_TEST_SUITE_P(, HarmonicSplittingOf, testing::ValuesIn(scenes()),
                         [](const auto& tested) { return tested.param.name; });

// Where the perturbation is small the error is linear in it, and for saba and aba of a higher order in the step.
TEST(HarmonicSplitting, HasItsOrdersInWhatDisturbs) {
  constexpr double e = 1e-5, end = 4.8;
  for (const Row& row : rows) {
    if (row.small_order == 0) continue;
    const double step = row.small_order >= 6 ? 1.2 : 0.6;
    const auto at = [&](double small, double h) {
      return error_of(request_of(henon_heiles(), h, end), henon_heiles(), small, row.setting, row.value);
    };
    const double whole = at(e, step), fine = at(e, step / 2);
    EXPECT_NEAR(std::log2(whole / at(e / 2, step)), 1, 0.1) << row.value;
    EXPECT_GT(fine, 3e-15) << row.value << ": round-off";
    EXPECT_NEAR(std::log2(whole / fine), row.small_order, 0.15 * row.small_order) << row.value;
  }
}

// Without a perturbation of the oscillators, steps of any length are exact.
TEST(HarmonicSplitting, OfOscillatorsAloneIsExact) {
  Scene scene = coupled();
  Request request = request_of(scene, 7, 70), truth = request_of(scene, 0, 70, "taylor");
  for (Request* one : {&request, &truth}) runs::set(*one, "e", 0);
  runs::set(truth, "tolerance", 1e-16);
  EXPECT_LT(distance(final_of(request), final_of(truth)), 1e-12);
}

// A stiff spring that oscillates 1000 times in a period of the soft one: leapfrog would have to resolve it.
TEST(HarmonicSplitting, GoesOverFastOscillators) {
  const Scene stiff{
      "stiff", of(typed_v, {"x", "y"}, {{"e", 0.1}}, "x^2/2 + 1e6*y^2/2 + e*x^2*y + e*x^4"), {1, 0, 0, 0.5}};
  Request request = request_of(stiff, 0.049, 200), truth = request_of(stiff, 0, 200, "taylor");
  EXPECT_LT(energy_error(request), 5e-3);
  EXPECT_NEAR(final_of(request)[0], final_of(truth)[0], 0.02);
  EXPECT_NE(runs::go(request_of(stiff, 0.05, 200, "leapfrog")).outcome.stop.reason, ReturnCode::completed);
}

// A long run of a chain: the energy error stays bounded.
TEST(HarmonicSplitting, KeepsTheEnergyOfAChain) {
  const auto error = [&](double end) { return energy_error(request_of(chain(), 0.4, end)); };
  EXPECT_LT(error(100'000), 2 * error(1000));
}

}  // namespace
}  // namespace harmonic_splitting
