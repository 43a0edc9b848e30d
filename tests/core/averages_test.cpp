// Averages over time, and limit cycles: what they are, and whether they have converged.
#include <cmath>

#include "tests/core/asking.hpp"

namespace {

using namespace least;
using namespace asks;

const char* const moments[] = {"q2", "p2", "p4", "s2"};

/// averages() returns averages over a trajectory in steps so short that the trapezoidal rule is as good as exact: of ρ,
/// over τ with weight ρ^{1−κ}, and over the physical time, dt = ρ^κ dτ.
std::array<std::array<double, 4>, 2> averages(double kappa, double end) {
  Request request = runs::defaults("thermostat", "runge_kutta_4");
  runs::set(request, "scale", 1);
  runs::set(request, "kappa", kappa);
  runs::set(request, "step", 1e-3);
  request.end = end;
  const auto rows = runs::go(request).rows;
  std::array<std::array<double, 4>, 2> sums{};
  std::array<double, 2> weights{};
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const double q = rows[n][1], p = rows[n][2], s = rows[n][3];
    const double density = std::exp(-(q * q + p * p) / 2 - s) / std::pow(1 + std::exp(-s), 2);
    const double part = n == 0 || n + 1 == rows.size() ? 0.5 : 1;
    const double powers[] = {1 - kappa, kappa}, values[] = {q * q, p * p, p * p * p * p, s * s};
    for (std::size_t k = 0; k < 2; ++k) {
      const double w = part * std::pow(density, powers[k]);
      weights[k] += w;
      for (std::size_t i = 0; i < 4; ++i) sums[k][i] += w * values[i];
    }
  }
  for (std::size_t k = 0; k < 2; ++k)
    for (double& sum : sums[k]) sum /= weights[k];
  return sums;
}

TEST(Moments, AreAveragesOverTimeWhateverTheSteps) {
  struct Case {
    const char *scheme, *setting;
    double value, accuracy;
  };
  for (const double kappa : {1.0, 0.5}) {
    const auto expected = averages(kappa, 20);
    for (const auto& [scheme, setting, value, accuracy] :
         {Case{"dormand_prince_5", "tolerance", 1e-10, 1e-5}, Case{"fehlberg_78", "tolerance", 1e-12, 1e-4},
          Case{"bulirsch_stoer", "tolerance", 1e-11, 3e-3}, Case{"runge_kutta_4", "step", 0.03, 1e-5}}) {
      Request request = asking("thermostat", scheme, "moments");  // 20 is no multiple of 0.03
      runs::set(request, "scale", 1);
      runs::set(request, "kappa", kappa);
      runs::set(request, setting, value);
      request.end = 20;
      for (std::size_t i = 0; i < 4; ++i) {
        const std::string name = moments[i];
        EXPECT_NEAR(ask(request, "moments/" + name) / expected[0][i], 1, accuracy) << scheme << kappa << name;
        EXPECT_NEAR(ask(request, "moments/physical_time/" + name) / expected[1][i], 1, accuracy)
            << scheme << kappa << name;
      }
    }
  }
}

/// Most of the run lies in its last step, which is shorter than the others.
TEST(Moments, SeeTheStepToTheEnd) {
  Request request = asking("thermostat", "runge_kutta_4", "moments");
  runs::set(request, "scale", 1);
  runs::set(request, "step", 0.1);
  request.end = 0.19;
  const auto expected = averages(1, 0.19);
  EXPECT_NEAR(ask(request, "moments/p4") / expected[0][2], 1, 1e-4);
  request.end = 0.05;
  EXPECT_NEAR(ask(request, "moments/p4") / averages(1, 0.05)[0][2], 1, 1e-4) << "and where it is the only one";
}

bool converged(const Request& request) {
  const auto reports = runs::go(request).outcome.diagnostics;
  for (const auto& part : std::get<std::vector<Report>>(reports.at(0).value))
    if (part.key == "converged") return std::get<bool>(part.value);
  throw std::out_of_range("converged");
}
Request cycles(double epsilon, double x, double end) {
  Request request = asking("van_der_pol", "contact_splitting", "cycle");
  runs::set(request, "epsilon", epsilon);
  runs::begin(request, "x", x);
  runs::set(request, "step", 0.02);
  request.end = end;
  return request;
}

TEST(Cycle, SaysWhetherItHasConverged) {
  EXPECT_TRUE(converged(cycles(1, 2, 60)));
  EXPECT_TRUE(converged(cycles(5, 0.1, 200)));
  EXPECT_FALSE(converged(cycles(0.01, 0.1, 30))) << "of amplitude 0.115, on its way to 2";
  EXPECT_FALSE(converged(cycles(0.01, 0.1, 700))) << "still on its way";
  EXPECT_TRUE(converged(cycles(0.01, 0.1, 4000)));
  EXPECT_NEAR(ask(cycles(0.01, 0.1, 4000), "cycle/amplitude"), 2, 1e-3);
  EXPECT_FALSE(converged(cycles(1e-5, 0.1, 60))) << "hardly changes from cycle to cycle, and has far to go";
  EXPECT_TRUE(converged(cycles(0, 0.1, 60))) << "every orbit is a cycle";
  Request chaos = cycles(5, 2, 500);
  runs::set(chaos, "amplitude", 5);
  runs::set(chaos, "frequency", 2.463);
  runs::begin(chaos, "v", 2);
  EXPECT_GT(ask(chaos, "cycle/cycles"), 10);
  EXPECT_FALSE(converged(chaos)) << "driven into chaos it has none";
  EXPECT_THROW(converged(cycles(1, 2, 15)), std::bad_variant_access) << "two cycles cannot tell";
}

}  // namespace
