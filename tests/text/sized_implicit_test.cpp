// Variational schemes for scenes of many coordinates, by Newton's method with a matrix as sparse as the potential:
// Toda's lattice, which is integrable, chains whose steps are known in closed form, stars that all attract each other.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "tests/support/sized.hpp"

namespace sized_implicit {
namespace {

using namespace sized;
using std::numbers::pi;
constexpr auto typed_v = Definition::Kind::potential, typed_l = Definition::Kind::lagrangian;

/// Toda's lattice closed to a ring; with `unequal`, of unequal masses.
std::shared_ptr<const Mechanics> toda(int n, double alpha = 0, bool unequal = false) {
  text::TypedScene typed;
  typed.scene = of(typed_v, {"q[n]"}, {{"n", double(n)}, {"alpha", alpha}}, "sum(i=1..n, exp(q[i] - q[mod(i,n)+1]))");
  if (alpha > 0) typed.scene.damping = "alpha*(1 + sin(t)/2)";
  if (unequal) typed.scene.masses = {{"q[i]", "1 + i/n"}};
  return made(typed);
}
std::vector<double> toda_start(int n) {
  std::vector<double> x;
  for (int i = 0; i < n; ++i) x.push_back(0.5 * std::sin(1 + 2.3 * i * i));
  for (int i = 0; i < n; ++i) x.push_back(0.4 * std::cos(3 * i));
  return x;
}
TEST(SizedImplicit, SchemesHaveTheirOrders) {
  struct Row {
    const char *scheme, *composition;
    int order;
    double alpha, step;
  };
  constexpr int n = 24;
  for (const Row& row :
       {Row{"variational_midpoint", "", 2, 0, 0.1}, Row{"variational_midpoint", "suzuki_4", 4, 0, 0.4},
        Row{"variational_midpoint", "kahan_li_6", 6, 0, 0.4}, Row{"galerkin_4", "", 4, 0, 0.2},
        Row{"contact_variational_midpoint", "", 2, 0.3, 0.1},
        Row{"contact_variational_midpoint", "suzuki_4", 4, 0.3, 0.4}, Row{"contact_galerkin_4", "", 4, 0.3, 0.2}}) {
    const auto mechanics = toda(n, row.alpha, true);
    auto start = toda_start(n);
    if (row.alpha > 0) start.push_back(0.3);  // s
    const auto with_action = [](Request request) {
      runs::show_all(request);
      return final_of(request);
    };
    const auto truth = with_action(request_by("taylor", mechanics, start, 4));
    const auto error = [&](double step) {
      return distance(with_action(stepped(row.scheme, mechanics, start, 4, step, row.composition)), truth);
    };
    const double coarse = error(row.step), middle = error(row.step / 2), fine = error(row.step / 4);
    EXPECT_NEAR(std::log2(coarse / middle), row.order, 0.35) << row.scheme << row.composition;
    EXPECT_NEAR(std::log2(middle / fine), row.order, 0.15) << row.scheme << row.composition;
    EXPECT_GT(fine, 1e-12) << row.scheme << " is at round-off";
  }
}

// A step of the midpoint rule rotates each mode of a harmonic chain by 2 atan(ωh/2), however long it is.
TEST(SizedImplicit, StepsBeyondTheBoundOfLeapfrogAreThoseOfTheMidpointRule) {
  constexpr int n = 200, k = 190;  // a fast mode
  const double omega = 2 * std::sin(k * pi / (2 * (n + 1))), h = 3, steps = 7;
  text::TypedScene typed;
  typed.scene = of(typed_v, {"q[n]"}, {{"n", n}}, "sum(i=0..n, (at(i+1) - at(i))^2/2)");
  typed.definitions = {{"at(i)", "if(i < 1 or i > n, 0, q[i])"}};
  std::vector<double> start;
  for (int j = 1; j <= n; ++j) start.push_back(std::sin(j * k * pi / (n + 1)));
  ASSERT_GT(omega * h, 5);
  const auto last = final_of(stepped("variational_midpoint", made(typed), start, steps * h, h));
  const double angle = 2 * std::atan(omega * h / 2) * steps;
  for (std::size_t j = 0; j < n; ++j) {
    EXPECT_NEAR(last[j], std::cos(angle) * start[j], 1e-12) << j;
    EXPECT_NEAR(last[n + j], -omega * std::sin(angle) * start[j], 1e-12) << j;
  }
}

TEST(SizedImplicit, ThereAndBackIsWhereItBegan) {
  constexpr int n = 40;
  const auto mechanics = toda(n, 0, true);
  const auto start = toda_start(n);
  for (const char* scheme : {"variational_midpoint", "galerkin_4"}) {
    auto x = final_of(stepped(scheme, mechanics, start, 20, 0.25));
    EXPECT_GT(distance(x, start), 0.1);
    for (int way = 0; way < 2; ++way) {
      for (std::size_t i = n; i < 2 * n; ++i) x[i] = -x[i];
      if (way == 0) x = final_of(stepped(scheme, mechanics, x, 20, 0.25));
    }
    EXPECT_LT(distance(x, start), 1e-12) << scheme;
  }
}

/// defect() returns the largest entry of MᵀJM − λJ, relative to those of M, for the map of q and p over some steps by
/// central differences; λ is fitted to the first entry.
double defect(const char* scheme, const std::shared_ptr<const Mechanics>& mechanics, const std::vector<double>& start) {
  const std::size_t n = start.size() / 2;
  std::vector<std::vector<double>> columns;
  constexpr double aside = 1e-4;
  for (std::size_t j = 0; j < 2 * n; ++j) {
    std::vector<double> column(2 * n, 0);
    for (const auto& [far, weight] : {std::pair{1, 8.0}, std::pair{2, -1.0}})
      for (const int side : {-1, 1}) {
        auto x = start;
        x[j] += side * far * aside;
        const auto end = final_of(stepped(scheme, mechanics, x, 1.5, 0.5));
        for (std::size_t i = 0; i < 2 * n; ++i) column[i] += side * weight * end[i] / (12 * aside);
      }
    columns.push_back(column);
  }
  const auto form = [&](std::size_t a, std::size_t b) {
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += columns[a][i] * columns[b][n + i] - columns[a][n + i] * columns[b][i];
    return sum;
  };
  double most = 0;
  for (std::size_t a = 0; a < 2 * n; ++a)
    for (std::size_t b = 0; b < a; ++b) most = std::max(most, std::abs(form(b, a) - (a == b + n ? form(0, n) : 0)));
  return most;
}
TEST(SizedImplicit, MapsAreSymplecticOrScaleTheForm) {
  constexpr int n = 10;
  const auto free = toda(n), damped = toda(n, 0.3);
  const auto start = toda_start(n);
  EXPECT_LT(defect("variational_midpoint", free, start), 1e-9);
  EXPECT_LT(defect("galerkin_4", free, start), 1e-9);
  EXPECT_LT(defect("contact_variational_midpoint", damped, start), 1e-9);
  EXPECT_LT(defect("contact_galerkin_4", damped, start), 1e-9);
  EXPECT_GT(defect("runge_kutta_4", free, start), 1e-5) << "it sees no form at all";
}

// Each step keeps Σp to round-off; the error of H stays within bounds that shrink with the order.
TEST(SizedImplicit, TodasLatticeKeepsItsEnergyOverLongRuns) {
  constexpr int n = 64;
  const auto energy = [&](const char* scheme, double step) {
    Request request = stepped(scheme, toda(n), toda_start(n), 400, step);
    runs::ask(request, "energy");
    const auto outcome = runs::go(request).outcome;
    double before = 0, after = 0;
    for (std::size_t i = 0; i < n; ++i) {
      before += toda_start(n)[n + i];
      after += outcome.final[n + i];
    }
    EXPECT_NEAR(before, after, 1e-11) << scheme;
    EXPECT_LT(std::abs(runs::number(outcome.diagnostics, "energy/drift_per_time")), 1e-7) << scheme;
    return runs::number(outcome.diagnostics, "energy/max_rel_error");
  };
  EXPECT_NEAR(std::log2(energy("variational_midpoint", 0.1) / energy("variational_midpoint", 0.05)), 2, 0.2);
  EXPECT_NEAR(std::log2(energy("galerkin_4", 0.2) / energy("galerkin_4", 0.1)), 4, 0.4);
}

// The cost of a step is in evaluations: for a chain their number does not depend on the length of the chain, for bodies
// that all attract each other there is one for every direction.
TEST(SizedImplicit, StepsOfChainsTakeAsManyEvaluationsWhateverTheirLength) {
  const auto evaluations = [](int n) {
    return double(
        runs::go(stepped("variational_midpoint", toda(n), toda_start(n), 5, 0.1)).outcome.cost.force_evaluations);
  };
  const double few = evaluations(32), many = evaluations(512);
  EXPECT_LT(many, 1.2 * few);
  EXPECT_LT(few, 50 * 12);
}

TEST(SizedImplicit, BodiesThatAllAttractEachOtherMoveAsTheyShould) {
  constexpr int n = 20;
  text::TypedScene typed;
  typed.scene = of(typed_v, {"x[n]", "y[n]"}, {{"n", n}},
                   "-sum(i=1..n, j=i+1..n, 1/sqrt((x[i]-x[j])^2 + (y[i]-y[j])^2 + 0.5))/n");
  const auto mechanics = made(typed);
  std::vector<double> start;
  for (int i = 0; i < 2 * n; ++i) start.push_back(2 * std::sin(7.3 * i));
  const auto truth = final_of(request_by("taylor", mechanics, start, 2));
  const auto error = [&](const char* scheme, double step) {
    return distance(final_of(stepped(scheme, mechanics, start, 2, step)), truth);
  };
  EXPECT_NEAR(std::log2(error("variational_midpoint", 0.1) / error("variational_midpoint", 0.05)), 2, 0.1);
  EXPECT_NEAR(std::log2(error("galerkin_4", 0.4) / error("galerkin_4", 0.2)), 4, 0.4);
}

// A kinetic matrix that is constant but not diagonal; it is full.
TEST(SizedImplicit, TakesConstantMetricsThatAreNotDiagonal) {
  text::TypedScene typed;
  typed.scene =
      of(typed_l, {"q[12]"}, {}, "sum(i=1..12, v[i]^2/2 - q[i]^2/2 - q[i]^4/8) + sum(i=1..11, v[i]*v[i+1]/3)");
  const auto mechanics = made(typed);
  std::vector<double> start;
  for (int i = 0; i < 12; ++i) start.push_back(std::cos(2.0 * i));
  const auto truth = final_of(request_by("taylor", mechanics, start, 3));
  for (const auto& [scheme, order] : {std::pair{"variational_midpoint", 2}, std::pair{"galerkin_4", 4}}) {
    const double coarse = distance(final_of(stepped(scheme, mechanics, start, 3, 0.1)), truth),
                 fine = distance(final_of(stepped(scheme, mechanics, start, 3, 0.05)), truth);
    EXPECT_NEAR(std::log2(coarse / fine), order, 0.2) << scheme;
  }
}

TEST(SizedImplicit, DiscreteEnergiesAreThoseOfTheClassThatIsCompiled) {
  // Nine coordinates, one of which stays at rest, and the eight others alone.
  const auto ring = [](int n) {
    text::TypedScene typed;
    typed.scene = of(typed_v, {"q[n]"}, {{"n", double(n)}}, "sum(i=1..8, exp(q[i] - q[mod(i,8)+1]))");
    if (n > 8) typed.scene.formula += " + q[9]^2/2";
    return made(typed);
  };
  for (const char* scheme : {"variational_midpoint", "galerkin_4"})
    for (const char* composition : {"none", "suzuki_4"}) {
      std::vector<double> energies;
      for (const int n : {8, 9}) {
        auto start = toda_start(8);
        if (n > 8) start.insert(start.begin() + 8, 0);
        Request request = stepped(scheme, ring(n), start, 2, 0.2, composition);
        request.record = {Record::Mode::every, 10, {}};
        const auto name_of = [](const auto& column) { return column.name; };
        request.columns = {runs::position(runs::card(request).columns, "discrete_energy", name_of)};
        energies.push_back(runs::go(request).rows.back()[0]);
      }
      EXPECT_TRUE(std::isfinite(energies[0]));
      EXPECT_NEAR(energies[0], energies[1], 1e-12) << scheme << composition;
    }
}

}  // namespace
}  // namespace sized_implicit
