// kepler_splitting on scenes as text: its laws, with few coordinates and many, about a body and about a fixed centre.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/support/steps_of_text.hpp"

namespace kepler_splitting {
namespace {

using namespace texts;
constexpr auto typed_v = Definition::Kind::potential, typed_h = Definition::Kind::hamiltonian;

/// A star of mass 1 and two planets of masses 3ε/2 and ε in a plane; ε need not be small.
std::shared_ptr<const Mechanics> planets() {
  return mechanics_of(of(typed_h, {"x", "a", "b", "y", "c", "d"}, {{"e", 1e-3}, {"m", 1}},
                         "(px^2 + py^2)/(2*m) + (pa^2 + pc^2)/(3*e) + (pb^2 + pd^2)/(2*e)"
                         " - 1.5*m*e/sqrt((x-a)^2+(y-c)^2) - m*e*((x-b)^2+(y-d)^2)^(-1/2)"
                         " - 1.5*e^2/sqrt((a-b)^2+(c-d)^2)"));
}
/// The start of the planets, with the total momentum 0.
std::vector<double> start_of_planets(double e) {
  const double a = 1.5 * e * 1.05, b = -e * 0.68;
  return {0, 1, -2.1, 0, 0, 0.3, 0, 0, e * 0.09, -a - b, a, b};
}
/// One body about a fixed centre, with a tide as perturbation.
std::shared_ptr<const Mechanics> tide() {
  return mechanics_of(of(typed_v, {"x", "y"}, {{"e", 1e-2}}, "-1/sqrt((x-1)^2 + (y+2)^2) + e*x^2*(1+cos(t)/2)"));
}
/// Nine coordinates: more than any compiled class has.
std::shared_ptr<const Mechanics> in_space() {
  Definition scene = of(typed_v, {"x1", "x2", "x3", "y1", "y2", "y3", "z1", "z2", "z3"}, {{"e", 1e-3}},
                        "-(1/sqrt((x1-x2)^2+(y1-y2)^2+(z1-z2)^2) + 2/sqrt((x1-x3)^2+(y1-y3)^2+(z1-z3)^2))*e"
                        " - 2*e^2/sqrt((x2-x3)^2+(y2-y3)^2+(z2-z3)^2)");
  for (const std::string axis : {"x", "y", "z"}) {
    scene.masses.emplace_back(axis + "2", "e");
    scene.masses.emplace_back(axis + "3", "2*e");
  }
  scene.invariants = {{"turn", "x1*py1 - y1*px1 + x2*py2 - y2*px2 + x3*py3 - y3*px3"}, {"drive", "pz1 + pz2 + pz3"}};
  return mechanics_of(scene);
}
const std::vector<double> in_space_start{0,    1, -3.9, 0,     0.1,    0.2,   0,      0, 0.3,
                                         1e-4, 0, 0,    -2e-4, 1.1e-3, -1e-3, 0.3e-4, 0, 0.1e-3};

Request request_of(std::shared_ptr<const Mechanics> mechanics, const std::vector<double>& start, double step,
                   double end, std::string_view scheme = "kepler_splitting") {
  Request request = request_by(scheme, std::move(mechanics), start, end);
  if (scheme == "kepler_splitting") runs::set(request, "step", step);
  return request;
}
/// distance() compares positions only, because momenta of light bodies would not be seen.
double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size() / 2; ++i) {
    if (std::isnan(a[i])) return a[i];
    most = std::max(most, std::abs(a[i] - b[i]));
  }
  return most;
}

struct Row {
  const char *setting, *value;
  int order;        ///< where the perturbation is not small
  double step;      ///< a step for measuring that order
  int small_order;  ///< of the part linear in it; 0: hidden by the quadratic part or by round-off
};
const Row rows[] = {{"composition", "none", 2, 0.02, 2},       {"composition", "suzuki_4", 4, 0.1, 4},
                    {"composition", "kahan_li_6", 6, 0.25, 6}, {"splitting", "saba_2", 2, 0.02, 4},
                    {"splitting", "saba_4", 2, 0.05, 0},       {"splitting", "aba_864", 4, 0.15, 8},
                    {"splitting", "aba_1064", 4, 0.2, 10}};

// The order is checked from both sides: errors against the true motion at two steps, all of them above round-off. With
// e = 0.3 the error that is quadratic in the perturbation is seen.
TEST(KeplerSplitting, HasItsOrders) {
  for (const char* coordinates : {"jacobi", "heliocentric"})
    for (const Row& row : rows) {
      const auto at = [&](double step) {
        Request request = request_of(planets(), start_of_planets(0.3), step, 4);
        runs::set(request, "e", 0.3);
        Request truth = request_of(planets(), start_of_planets(0.3), 0, 4, "taylor");
        runs::set(truth, "e", 0.3);
        runs::set(truth, "tolerance", 1e-15);
        runs::set(request, row.setting, row.value);
        runs::set(request, "coordinates", coordinates);
        return distance(final_of(request), final_of(truth));
      };
      const double coarse = at(row.step), fine = at(row.step / 2);
      EXPECT_GT(fine, 1e-12) << row.value << ": round-off";
      EXPECT_NEAR(std::log2(coarse / fine), row.order, 0.35) << row.value << " " << coordinates;
    }
}

TEST(KeplerSplitting, OfATideThatChangesInTimeHasItsOrders) {
  const std::vector<double> start{2, -2, 0.1, 1.05};
  for (const Row& row : rows) {
    const auto at = [&](double step) {
      Request request = request_of(tide(), start, step, 4), truth = request_of(tide(), start, 0, 4, "taylor");
      for (Request* one : {&request, &truth}) runs::set(*one, "e", 0.5);
      runs::set(truth, "tolerance", 1e-15);
      runs::set(request, row.setting, row.value);
      return distance(final_of(request), final_of(truth));
    };
    constexpr double step = 0.1;
    const double coarse = at(step), fine = at(step / 2);
    EXPECT_GT(fine, 1e-13) << row.value << ": round-off";
    EXPECT_NEAR(std::log2(coarse / fine), row.order, 0.15) << row.value;
  }
}

// Where the perturbation is small the error is linear in it, and for saba and aba of a higher order in the step; over
// less than a revolution, so that errors of a revolution do not cancel.
TEST(KeplerSplitting, HasItsOrdersInWhatDisturbs) {
  constexpr double end = 4.8, e = 1e-4;
  for (const Row& row : rows) {
    const auto at = [&](double small, double step) {
      Request request = request_of(planets(), start_of_planets(small), step, end),
              truth = request_of(planets(), start_of_planets(small), 0, end, "taylor");
      for (Request* one : {&request, &truth}) runs::set(*one, "e", small);
      runs::set(truth, "tolerance", 1e-16);
      runs::set(request, row.setting, row.value);
      return distance(final_of(request), final_of(truth));
    };
    const double step = row.small_order >= 8 ? 2.4 : 0.6, whole = at(e, step);
    EXPECT_NEAR(std::log2(whole / at(e / 2, step)), row.small_order == 0 ? 2 : 1, 0.1) << row.value;
    if (row.small_order == 0) continue;
    const double fine = at(e, step / 2);
    EXPECT_GT(fine, 3e-14) << row.value << ": round-off";
    EXPECT_NEAR(std::log2(whole / fine), row.small_order, 0.1 * row.small_order) << row.value;
  }
}

TEST(KeplerSplitting, IsSymplectic) {
  for (const char* coordinates : {"jacobi", "heliocentric"})
    for (const Row& row : rows) {
      const auto defect = [&](Request request) {
        runs::set(request, row.setting, row.value);
        runs::set(request, "coordinates", coordinates);
        runs::ask(request, "structure");
        const auto found = runs::go(request).outcome.diagnostics;
        return runs::number(found, "structure/max_defect");
      };
      Request heavy = request_of(planets(), start_of_planets(0.2), 0.3, 6);
      runs::set(heavy, "e", 0.2);
      EXPECT_LT(defect(heavy), 3e-13) << row.value << " " << coordinates;
      EXPECT_LT(defect(request_of(in_space(), in_space_start, 0.3, 6)), 1e-11) << row.value << " of nine coordinates";
      EXPECT_LT(defect(request_of(tide(), {2, -2, 0.1, 1.05}, 0.3, 6)), 1e-13) << row.value;
    }
}

TEST(KeplerSplitting, ComesBackAndKeepsEnergyAndMomenta) {
  for (const char* coordinates : {"jacobi", "heliocentric"})
    for (const Row& row : rows) {
      Request there = request_of(in_space(), in_space_start, 0.25, 2000);
      runs::set(there, row.setting, row.value);
      runs::set(there, "coordinates", coordinates);
      runs::ask(there, "energy");
      runs::ask(there, "momenta");
      const auto outcome = runs::go(there).outcome;
      const auto& found = outcome.diagnostics;
      EXPECT_LT(runs::number(found, "energy/max_rel_error"), 2e-4) << row.value;
      EXPECT_LT(std::abs(runs::number(found, "energy/drift_per_time")) * 2000,
                0.5 * runs::number(found, "energy/max_abs_error") + 1e-17)
          << row.value;
      EXPECT_LT(runs::number(found, "momenta/turn/max_abs_error"), 1e-16) << row.value << ", of 4e-3";
      EXPECT_LT(runs::number(found, "momenta/drive/max_abs_error"), 1e-18) << row.value << ", of 2e-4";

      std::vector<double> x = outcome.final;
      for (std::size_t i = 9; i < 18; ++i) x[i] = -x[i];
      Request back = there;
      back.diagnostics.clear();
      begin_at(back, x);
      EXPECT_LT(distance(final_of(back), in_space_start), 1e-9) << row.value << " " << coordinates;
    }
}

// Two bodies have no perturbation, whatever their masses: a step of several revolutions is exact.
TEST(KeplerSplitting, OfTwoBodiesIsExact) {
  Definition two = of(typed_v, {"x1", "y1", "x2", "y2"}, {}, "-6/sqrt((x1-x2)^2 + (y1-y2)^2)");
  two.masses = {{"x1", "2"}, {"y1", "2"}, {"x2", "3"}, {"y2", "3"}};
  const std::vector<double> start{0.5, 0, -0.5, 0.1, 0.4, 2.1, 0.2, -1.9};
  Request truth = request_of(mechanics_of(two), start, 0, 40, "taylor");
  runs::set(truth, "tolerance", 1e-16);
  EXPECT_LT(distance(final_of(request_of(mechanics_of(two), start, 13, 40)), final_of(truth)), 1e-11);
}

TEST(KeplerSplitting, IsTheSameHoweverItIsRecorded) {
  expect_the_same_however_recorded(request_of(in_space(), in_space_start, 0.3, 31));
}

// A comet that is scattered by the star, and one that falls into it.
TEST(KeplerSplitting, OfOrbitsOfEveryKind) {
  Request thrown = request_of(tide(), {-4, 3, 2, -1.5}, 0.5, 60), truth = thrown;
  for (Request* one : {&thrown, &truth}) runs::set(*one, "e", 0);
  const auto end = final_of(thrown);
  truth = request_of(tide(), {-4, 3, 2, -1.5}, 0, 60, "taylor");
  runs::set(truth, "e", 0);
  EXPECT_LT(distance(end, final_of(truth)), 1e-9);
  EXPECT_EQ(runs::go(request_of(tide(), {2, -2, 0, 0}, 0.3, 60)).outcome.stop.reason, ReturnCode::completed);
  EXPECT_NE(runs::go(request_of(tide(), {1, -2, 1, 0}, 0.3, 60)).outcome.stop.reason, ReturnCode::completed)
      << "at the centre";
}

}  // namespace
}  // namespace kepler_splitting
