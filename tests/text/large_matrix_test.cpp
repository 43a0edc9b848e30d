// Scenes of dozens of coordinates whose steps have full matrices: forty pendulums in a row, and others with a kinetic
// energy that depends on position, with a general Hamiltonian and with H quadratic in s. Implicit schemes have their
// orders there, keep what they keep for two coordinates, and stop when they are told to.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>

#include "core/catalogue/metric_energy_momentum.hpp"
#include "core/catalogue/sized_herglotz.hpp"
#include "core/catalogue/sized_stages.hpp"
#include "core/number/asked_by_thread.hpp"
#include "core/text/scene.hpp"
#include "tests/support/sized.hpp"

namespace large_matrix {
namespace {

using namespace sized;
using Kind = Definition::Kind;

constexpr std::size_t n = 40;

std::shared_ptr<const Mechanics> typed(Kind kind, const std::string& formula, double count = n) {
  text::TypedScene scene;
  scene.scene = of(kind, {"q[n]"}, {{"n", count}}, formula.c_str());
  return made(scene);
}
/// Rods in a row, each hinged at the end of the one before: the metric is full, and depends on every angle. The total
/// length and mass are 1, so that the row swings about as fast whatever the number of rods.
const std::shared_ptr<const Mechanics>& pendulums() {
  static const auto known = [] {
    text::TypedScene scene;
    scene.scene = of(Kind::lagrangian, {"q[n]"}, {{"n", double(n)}},
                     "sum(i=1..n, j=1..n, below(i,j)*cos(q[i] - q[j])*v[i]*v[j])/(2*n^3)"
                     " + sum(i=1..n, below(i,i)*cos(q[i]))/n^2");
    scene.definitions = {{"below(i,j)", "if(i < j, n + 1 - j, n + 1 - i)"}};
    return made(scene);
  }();
  return known;
}
/// arc() is a smooth arc, released from rest.
std::vector<double> arc() {
  std::vector<double> x(2 * n, 0.0);
  for (std::size_t i = 0; i < n; ++i) x[i] = 0.8 * std::cos(3.0 * double(i) / double(n));
  return x;
}
std::vector<double> crowd(bool with_action) {
  std::vector<double> x;
  for (std::size_t i = 0; i < 2 * n; ++i) x.push_back(0.5 * std::sin(1 + 2.3 * double(i * i)));
  if (with_action) x.push_back(0.3);
  return x;
}
double off(const Request& request, const std::vector<double>& truth) {
  return sized::distance(final_of(request), truth);
}

TEST(LargeMatrix, FortyPendulumsMoveByEveryScheme) {
  constexpr double end = 0.2;
  const auto truth = final_of(request_by("taylor", pendulums(), arc(), end));
  ASSERT_GT(sized::distance(truth, arc()), 0.05);
  for (const auto& [scheme, order] :
       {std::pair{"variational_midpoint", 2}, {"galerkin_4", 4}, {"energy_momentum", 2}}) {
    const double step = 0.01;
    const double coarse = off(stepped(scheme, pendulums(), arc(), end, step), truth),
                 fine = off(stepped(scheme, pendulums(), arc(), end, step / 2), truth);
    EXPECT_NEAR(std::log2(coarse / fine), order, 0.3) << scheme << " " << coarse << " " << fine;
  }
}

TEST(LargeMatrix, SchemesThatChooseTheirStepsGoOnFortyPendulums) {
  std::vector<double> start = final_of(request_by("taylor", pendulums(), arc(), 0.4));
  constexpr double end = 0.02;
  const auto truth = final_of(request_by("taylor", pendulums(), start, end));
  const auto transformed = [&](double sigma) {
    Request request = request_by("time_transformed", pendulums(), start, end);
    runs::set(request, "sigma", sigma);
    runs::set(request, "kappa", 1);
    return off(request, truth);
  };
  EXPECT_NEAR(std::log2(transformed(4e-3) / transformed(2e-3)), 2, 0.3);
  const auto along = [&](double theta) {
    Request request = stepped("jacobi_maupertuis", pendulums(), start, end, 1);
    runs::set(request, "theta", theta);
    runs::set(request, "critical_kinetic_energy", 0);
    runs::set(request, "alpha_max", 1);
    return off(request, truth);
  };
  EXPECT_LT(along(8e-3), 1e-4);
  EXPECT_LT(along(4e-3), 0.3 * along(8e-3));
}

TEST(LargeMatrix, EnergyMomentumKeepsItsEnergyToTheLastDigits) {
  Request request = stepped("energy_momentum", pendulums(), arc(), 0.2, 0.01);
  request.record = {Record::Mode::every, 1, {}};
  request.columns = {
      runs::position(runs::card(request).columns, "discrete_energy", [](const auto& column) { return column.name; })};
  const auto rows = runs::go(request).rows;
  ASSERT_GT(rows.size(), 10U);
  for (std::size_t k = 1; k + 1 < rows.size(); ++k) EXPECT_NEAR(rows[k][0] / rows[1][0], 1, 1e-13) << k;
}

TEST(LargeMatrix, ContactSchemesHaveTheirOrders) {
  const auto general =
      typed(Kind::hamiltonian, "sum(i=1..n, (q[i]^2 + p[i]^2)^2/8) + sum(i=1..n-1, q[i]*p[i+1]*q[i+1]/3) + s*p[1]/9");
  const auto quadratic =
      typed(Kind::lagrangian,
            "sum(i=1..n, v[i]^2/2) - s^2/2 + 1 - sum(i=1..n, q[i]^2/2) - sum(i=1..n-1, (q[i+1] - q[i])^4/4)");
  const auto start = crowd(true);
  for (const auto& [mechanics, scheme, order] : {std::tuple{general, "contact_gauss", 4},
                                                 {quadratic, "contact_gauss", 4},
                                                 {quadratic, "contact_variational_midpoint", 2},
                                                 {quadratic, "contact_galerkin_4", 4}}) {
    const auto truth = final_of(request_by("taylor", mechanics, start, 0.5));
    const double step = order == 4 ? 0.1 : 0.02;
    const double coarse = off(stepped(scheme, mechanics, start, 0.5, step), truth),
                 fine = off(stepped(scheme, mechanics, start, 0.5, step / 2), truth);
    EXPECT_NEAR(std::log2(coarse / fine), order, 0.3) << scheme << " " << coarse << " " << fine;
  }
}

/// beads() has a diagonal metric that depends on position, of `count` coordinates bound to their neighbours.
std::shared_ptr<const Mechanics> beads(double count) {
  return typed(Kind::lagrangian,
               "sum(i=1..n, v[i]^2*(1 + q[i]^2)/2) - sum(i=1..n-1, (q[i+1] - q[i])^2/2) - sum(i=1..n, q[i]^4/4)",
               count);
}

/// asked() returns how often a step asks whether to go on; from the question after the first `most` on the answer is
/// no, and the step has to fail.
template <class Step>
int asked(int most, Step&& step) {
  int count = 0;
  const AskedByThread asking([&] { return ++count <= most; });
  const StepStatus status = step();
  EXPECT_EQ(status == StepStatus::ok, count <= most) << most;
  return count;
}
TEST(LargeMatrix, AStepEndsWhenItIsToldTo) {
  constexpr int forever = 1 << 20;
  const auto check = [](auto&& step, const char* what) {
    const int all = asked(forever, step);
    EXPECT_GT(all, 20) << what << ": it asks again and again";
    for (const int most : {0, 1, all / 3, all / 2, all - 1})
      EXPECT_LT(asked(most, step), most + 5) << what << ": it ends at once";
  };
  constexpr std::size_t count = 100;
  std::vector<double> start(2 * count);
  for (std::size_t i = 0; i < start.size(); ++i) start[i] = 0.5 * std::sin(1 + 2.3 * double(i * i));
  const auto metric = beads(count)->text()->sized(std::vector<double>{double(count)});
  for (const SizedPath path : {SizedPath::straight, SizedPath::parabola})
    check(
        [&] {
          auto x = start;
          return SizedHerglotz<double>(*metric, path, Composition::none).step(x.data(), 0, 0.05);
        },
        "by its Lagrangian");
  check(
      [&] {
        auto x = start;
        double h = 0;
        EnergyMomentum scheme;
        scheme.step = 0.01;
        return MetricEnergyMomentum<double>(*metric, scheme, hamiltonian_at(*metric, x.data())).step(x.data(), h);
      },
      "of its own length");
  const auto general = typed(Kind::hamiltonian, "sum(i=1..n, (q[i]^2 + p[i]^2)^2/8) + q[1]*q[n]*p[2]", count)
                           ->text()
                           ->sized(std::vector<double>{double(count)});
  check(
      [&] {
        auto x = start;
        return SizedStages<double>(*general, StageRule::gauss(3), Composition::none).step(x.data(), 0, 0.05);
      },
      "by its stages");
}

// Tangents in one direction after another use the matrix of a step once, and agree with those of a new stepper.
TEST(LargeMatrix, WhatASolverKeepsChangesNoStep) {
  const auto scene = beads(30)->text()->sized(std::vector<double>{30});
  const auto step = [&](SizedHerglotz<Slope>& stepper, double from, std::size_t along) {
    std::vector<Slope> x;
    for (std::size_t i = 0; i < 60; ++i) x.emplace_back(0.5 * std::sin(from + 2.3 * double(i * i)));
    x[along].slope[0] = 1;
    EXPECT_EQ(stepper.step(x.data(), 0, 0.1), StepStatus::ok);
    std::vector<double> all;
    for (const Slope& c : x) all.insert(all.end(), {c.value, c.slope[0]});
    return all;
  };
  for (const SizedPath path : {SizedPath::straight, SizedPath::parabola}) {
    SizedHerglotz<Slope> kept(*scene, path, Composition::none);
    kept.begin(nullptr, 0);
    std::int64_t first = 0;
    for (const auto& [from, along] : {std::pair{1.0, 0U}, {1.0, 7U}, {2.0, 7U}, {1.0, 40U}}) {
      SizedHerglotz<Slope> anew(*scene, path, Composition::none);
      const std::int64_t before = kept.work().forces;
      EXPECT_EQ(step(kept, from, along), step(anew, from, along)) << from << " " << along;
      if (first == 0) first = kept.work().forces;
      if (from == 1.0 && along == 7U) {
        EXPECT_LT(kept.work().forces - before, first / 2) << "it knows the matrix";
      }
    }
  }
}

// For many rows the determinant is small beside the product of their lengths even where the rows are far from parallel.
TEST(LargeMatrix, AMassWithoutInverseIsToldFromOneOfManyRows) {
  const auto objection = [](const std::shared_ptr<const Mechanics>& mechanics, const std::vector<double>& start) {
    const auto why = mechanics->text()->objection_to_start(std::vector<double>{double(n)}, 0, start);
    return why ? why->detail : "";
  };
  EXPECT_EQ(objection(pendulums(), arc()), "");
  const auto singular =
      typed(Kind::lagrangian, "sum(i=1..n-1, (v[i] + v[i+1])^2*(1 + q[i]^2))/2 - sum(i=1..n, q[i]^2)");
  EXPECT_NE(objection(singular, crowd(false)).find("has no inverse"), std::string::npos);
}

TEST(LargeMatrix, BeyondTheLimitIsSaidByName) {
  text::TypedScene scene;
  scene.scene = of(Kind::lagrangian, {"q[n]"}, {{"n", 257}}, "sum(i=1..n, v[i]^2/2 - q[i]^2/2)");
  scene.scene.forces = {{"q[1]", "-v[1]*abs(v[1])"}};
  const auto forced = made(scene);
  EXPECT_NE(forced->card().offers.find("more coordinates than the 256"), std::string::npos) << forced->card().offers;
  EXPECT_FALSE(runs::fits(forced->card(), find_scheme("galerkin_4").value()));
}

}  // namespace
}  // namespace large_matrix
