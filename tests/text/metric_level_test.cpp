// Schemes that need the energy level, for kinetic energies that depend on position and scenes of many coordinates:
// energy_momentum, jacobi_maupertuis and time_transformed.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/sized.hpp"

namespace metric_level {
namespace {

using namespace sized;

constexpr std::size_t n = 12;
double frequency(std::size_t i) { return 1 + 0.2 * double(i); }

/// Oscillators y_i″ = −w_i² y_i, written in coordinates with y_i = q_i + q_i³/3 + q_{i−1}/5: the metric couples
/// neighbours and depends on position, and the motion is known.
std::shared_ptr<const Mechanics> bent_oscillators() {
  text::TypedScene typed;
  typed.scene = of(Definition::Kind::lagrangian, {"q[n]"}, {{"n", double(n)}},
                   "sum(i=1..n, ((1 + q[i]^2)*v[i] + if(i > 1, v[i-1]/5, 0))^2)/2"
                   " - sum(i=1..n, (1 + 0.2*(i - 1))^2*(q[i] + q[i]^3/3 + if(i > 1, q[i-1]/5, 0))^2)/2");
  return made(typed);
}
std::vector<double> straight(const std::vector<double>& q) {
  std::vector<double> y;
  for (std::size_t i = 0; i < n; ++i) y.push_back(q[i] + q[i] * q[i] * q[i] / 3 + (i > 0 ? q[i - 1] / 5 : 0));
  return y;
}
/// pace() is the velocity of y_i at the start.
double pace(std::size_t i) { return 0.7 * std::cos(3.0 * double(i)); }
std::vector<double> start() {
  std::vector<double> x(2 * n, 0.0);
  for (std::size_t i = 0; i < n; ++i) x[i] = 0.3 + 0.2 * std::sin(1 + 2.3 * double(i * i));
  for (std::size_t i = 0; i < n; ++i) x[n + i] = (1 + x[i] * x[i]) * pace(i) + (i + 1 < n ? pace(i + 1) / 5 : 0);
  return x;
}
/// error() returns the distance of the end of a run from the known motion.
double error(const Request& request) {
  const auto from = straight(request.scene->initial), to = straight(final_of(request));
  double most = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double w = frequency(i), angle = w * request.end;
    most = std::max(most, std::abs(to[i] - (from[i] * std::cos(angle) + pace(i) / w * std::sin(angle))));
  }
  return most;
}
/// The end of runs: past the first quarter of each oscillation.
constexpr double end = 2;

TEST(MetricLevel, EnergyMomentumHasOrderTwoAndKeepsTheDiscreteEnergy) {
  const auto mechanics = bent_oscillators();
  const auto request = [&](double step) { return stepped("energy_momentum", mechanics, start(), end, step); };
  EXPECT_NEAR(std::log2(error(request(0.04)) / error(request(0.02))), 2, 0.2);
  EXPECT_LT(error(request(0.02)), 1e-2);
  Request seen = request(0.04);
  seen.record = {Record::Mode::every, 1, {}};
  seen.columns.clear();
  for (const char* name : {"discrete_energy", "step_size"})
    seen.columns.push_back(
        runs::position(runs::card(seen).columns, name, [](const auto& column) { return column.name; }));
  auto rows = runs::go(seen).rows;
  ASSERT_GT(rows.size(), 20U);
  double shortest = 1, longest = 0;
  for (std::size_t k = 1; k + 1 < rows.size(); ++k) {
    EXPECT_NEAR(rows[k][0] / rows[1][0], 1, 1e-12) << k;
    shortest = std::min(shortest, rows[k][1]);
    longest = std::max(longest, rows[k][1]);
  }
  EXPECT_GT(longest, 1.01 * shortest) << "steps are of lengths of their own";
}

TEST(MetricLevel, TimeTransformedHasItsOrders) {
  const auto mechanics = bent_oscillators();
  const auto request = [&](double sigma, const char* composition) {
    Request made = request_by("time_transformed", mechanics, start(), end);
    runs::set(made, "sigma", sigma);
    runs::set(made, "composition", composition);
    return made;
  };
  EXPECT_NEAR(std::log2(error(request(0.1, "none")) / error(request(0.05, "none"))), 2, 0.2);
  EXPECT_NEAR(std::log2(error(request(0.2, "suzuki_4")) / error(request(0.1, "suzuki_4"))), 4, 0.4);
  Request kept = request(0.1, "none");
  kept.end = 0.5;
  runs::ask(kept, "structure");
  EXPECT_LT(runs::number(runs::go(kept).outcome.diagnostics, "structure/max_defect"), 1e-10);
}

TEST(MetricLevel, JacobiMaupertuisHasItsOrders) {
  const auto mechanics = bent_oscillators();
  for (const char* quadrature : {"trapezoid", "midpoint"})
    for (const int order : {2, 4}) {
      const auto request = [&](double theta) {
        Request made = stepped("jacobi_maupertuis", mechanics, start(), 0.4, 1);  // in time it would be far off
        runs::set(made, "theta", theta);
        runs::set(made, "critical_kinetic_energy", 0);
        runs::set(made, "alpha_max", 1);
        runs::set(made, "quadrature", quadrature);
        runs::set(made, "order", order);
        return made;
      };
      const double coarse = order == 2 ? 0.02 : 0.04;
      EXPECT_NEAR(std::log2(error(request(coarse)) / error(request(coarse / 2))), order, 0.5) << quadrature << order;
      EXPECT_LT(error(request(coarse / 2)), order == 2 ? 1e-3 : 1e-5) << quadrature << order;
    }
}

TEST(MetricLevel, IsOfSomeCoordinatesOnly) {
  const auto offers = [](int count, const char* scheme) {
    text::TypedScene typed;
    typed.scene = of(Definition::Kind::lagrangian, {"q[n]"}, {{"n", double(count)}},
                     "sum(i=1..n, v[i]^2*(1 + q[i]^2)/2 - q[i]^4/4)");
    return runs::fits(made(typed)->card(), find_scheme(scheme).value());
  };
  for (const char* scheme : {"energy_momentum", "jacobi_maupertuis", "time_transformed"}) {
    EXPECT_TRUE(offers(256, scheme)) << scheme;
    EXPECT_FALSE(offers(257, scheme)) << scheme;
  }
  EXPECT_TRUE(offers(300, "runge_kutta_4"));
}

}  // namespace
}  // namespace metric_level
