// Scenes of more coordinates than any compiled class has, whose kinetic energy depends on position, or whose
// Hamiltonian mixes momenta and positions: variational schemes and Gauss' collocation.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/support/sized.hpp"

namespace sized_metric {
namespace {

using namespace sized;
constexpr auto typed_l = Definition::Kind::lagrangian, typed_h = Definition::Kind::hamiltonian;

/// Eight beads on a bent wire, bound to their neighbours; a ninth is alone.
std::shared_ptr<const Mechanics> beads(int n) {
  text::TypedScene typed;
  typed.scene = of(typed_l, {"q[n]"}, {{"n", double(n)}},
                   "sum(i=1..n, v[i]^2*(1 + q[i]^2)/2) - sum(i=1..7, (q[i+1] - q[i])^2/2) - sum(i=1..n, q[i]^4/4)");
  return made(typed);
}
/// H = Σ (q² + p²)²/8 + `bond`, which couples neighbours: without it each pair rotates with the frequency (q² + p²)/2.
std::shared_ptr<const Mechanics> turning(int n, const char* bond) {
  text::TypedScene typed;
  typed.scene = of(typed_h, {"q[n]"}, {{"n", double(n)}}, std::string("sum(i=1..n, (q[i]^2 + p[i]^2)^2/8)") + bond);
  return made(typed);
}
std::vector<double> start_of(int n) {
  std::vector<double> x;
  for (int i = 0; i < 2 * n; ++i) x.push_back(0.8 * std::sin(1 + 2.3 * i * i));
  return x;
}
/// The same state with one more coordinate, at rest.
std::vector<double> with_one_more(std::vector<double> x) {
  x.insert(x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2), 0);
  x.push_back(0);
  return x;
}

TEST(SizedMetric, MovesAsTheClassThatIsCompiled) {
  const auto start = start_of(8);
  for (const char* scheme : {"variational_midpoint", "galerkin_4", "runge_kutta_4", "explicit_midpoint"}) {
    const auto few = final_of(stepped(scheme, beads(8), start, 3, 0.1)),
               many = final_of(stepped(scheme, beads(9), with_one_more(start), 3, 0.1));
    EXPECT_GT(distance(few, start), 0.1) << scheme;
    EXPECT_LT(distance(many, with_one_more(few)), 1e-12) << scheme;
  }
  for (const double stages : {1, 2, 3}) {
    std::vector<std::vector<double>> ends;
    for (const int n : {8, 9}) {
      const char* const bond = " + sum(i=1..7, q[i]*p[i+1]*q[i+1]/3)";
      Request request = stepped("contact_gauss", turning(n, bond), n > 8 ? with_one_more(start) : start, 2, 0.1);
      runs::set(request, "stages", stages);
      ends.push_back(final_of(request));
    }
    EXPECT_LT(distance(ends[1], with_one_more(ends[0])), 1e-12) << stages;
  }
}

TEST(SizedMetric, SchemesHaveTheirOrders) {
  constexpr int n = 12;
  const auto start = start_of(n);
  const auto bound = beads(n);
  const auto truth = final_of(request_by("taylor", bound, start, 2));
  for (const auto& [scheme, order] : {std::pair{"variational_midpoint", 2}, std::pair{"galerkin_4", 4}}) {
    const double coarse = distance(final_of(stepped(scheme, bound, start, 2, 0.05)), truth),
                 fine = distance(final_of(stepped(scheme, bound, start, 2, 0.025)), truth);
    EXPECT_NEAR(std::log2(coarse / fine), order, 0.2) << scheme;
    EXPECT_GT(fine, 1e-11) << scheme;
  }
  // Gauss' collocation keeps each q² + p², and with it the shape of the orbit: only the angle has an error.
  const auto free = turning(n, "");
  for (const int stages : {1, 2, 3}) {
    const auto error = [&](double step) {
      Request request = stepped("contact_gauss", free, start, 4, step);
      runs::set(request, "stages", stages);
      const auto last = final_of(request);
      double most = 0;
      for (std::size_t i = 0; i < n; ++i) {
        const double square = start[i] * start[i] + start[n + i] * start[n + i], angle = square / 2 * 4;
        EXPECT_NEAR(last[i] * last[i] + last[n + i] * last[n + i], square, 1e-13) << i;
        most = std::max(most, std::abs(last[i] - (start[i] * std::cos(angle) + start[n + i] * std::sin(angle))));
      }
      return most;
    };
    EXPECT_NEAR(std::log2(error(0.5) / error(0.25)), 2 * stages, 0.2) << stages;
  }
}

// Ten rods in a row, each hinged at the end of the one before: the metric is full, and depends on every angle.
TEST(SizedMetric, TenPendulumsInARowKeepTheirEnergy) {
  text::TypedScene typed;
  typed.scene = of(typed_l, {"q[n]"}, {{"n", 10}},
                   "sum(i=1..n, j=1..n, below(i,j)*cos(q[i] - q[j])*v[i]*v[j])/2 + sum(i=1..n, below(i,i)*cos(q[i]))");
  typed.definitions = {{"below(i,j)", "if(i < j, n + 1 - j, n + 1 - i)"}};
  const auto row = made(typed);
  std::vector<double> start;
  for (int i = 0; i < 10; ++i) start.push_back(0.6 + 0.05 * i);
  const auto truth = final_of(request_by("taylor", row, start, 0.5));
  const auto off = [&](double step) {
    return distance(final_of(stepped("variational_midpoint", row, start, 0.5, step)), truth);
  };
  EXPECT_NEAR(std::log2(off(0.05) / off(0.025)), 2, 0.2);
  Request request = stepped("variational_midpoint", row, start, 2, 0.02);
  runs::ask(request, "energy");
  EXPECT_LT(runs::number(runs::go(request).outcome.diagnostics, "energy/max_rel_error"), 1e-2);
}

TEST(SizedMetric, WhatHasAFullMatrixIsOfSomeCoordinatesOnly) {
  const auto offers = [](const std::shared_ptr<const Mechanics>& mechanics, const char* scheme) {
    return runs::fits(mechanics->card(), find_scheme(scheme).value());
  };
  EXPECT_TRUE(offers(beads(256), "galerkin_4"));
  EXPECT_TRUE(offers(beads(257), "taylor"));
  EXPECT_FALSE(offers(beads(257), "galerkin_4"));
  EXPECT_NE(beads(257)->card().offers.find("more coordinates than the 256"), std::string::npos);
  EXPECT_TRUE(offers(turning(256, ""), "contact_gauss"));
  EXPECT_FALSE(offers(turning(257, ""), "contact_gauss"));
  EXPECT_FALSE(offers(turning(257, " + s/9"), "contact_gauss"));
}

TEST(SizedMetric, GaussKeepsTheContactFormOfManyCoordinates) {
  const auto mechanics = turning(9, " + s*p[1]/9");
  Request request = stepped("contact_gauss", mechanics, std::vector<double>(9, 0.7), 1, 0.1);
  runs::ask(request, "structure");
  const auto reports = runs::go(request).outcome.diagnostics;
  EXPECT_LT(runs::number(reports, "structure/max_defect"), 1e-13);
  EXPECT_GT(std::abs(runs::number(reports, "structure/factor") - 1), 1e-5) << "s takes part";
  const auto truth = final_of(request_by("taylor", mechanics, std::vector<double>(9, 0.7), 1));
  const auto off = [&](double step) {
    return distance(final_of(stepped("contact_gauss", mechanics, std::vector<double>(9, 0.7), 1, step)), truth);
  };
  EXPECT_NEAR(std::log2(off(0.2) / off(0.1)), 4, 0.3);
}

}  // namespace
}  // namespace sized_metric
