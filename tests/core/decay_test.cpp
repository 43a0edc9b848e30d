// The law of decay along a run: the residual is that of the scheme, and nothing else.
#include <cmath>
#include <numbers>

#include "tests/core/asking.hpp"

namespace {

using namespace least;
using namespace asks;

Request driven(std::string_view scheme, double frequency, double h) {
  Request request = asking("driven_oscillator", scheme, "decay");
  runs::set(request, "frequency", frequency);
  runs::set(request, "step", h);
  return request;
}

// A fast drive with long steps of order 10: the states are right to 2e-13.
TEST(Decay, HasNoErrorOfItsOwn) {
  Request request = driven("contact_splitting", 5, 0.2);
  runs::set(request, "composition", "sofroniou_spaletta_10");
  const double coarse = ask(request, "decay/max_residual");
  EXPECT_LT(coarse, 1e-9) << "what is left is amplified by e^αt = 150";
  runs::set(request, "step", 0.15);
  EXPECT_GT(std::log(coarse / ask(request, "decay/max_residual")) / std::log(0.2 / 0.15), 9) << "and is the scheme's";
  EXPECT_LT(ask(request, "decay/floor"), 1e-11);
  EXPECT_GT(ask(request, "decay/floor"), 1e-16);
  for (const char* autonomous : {"damped_oscillator", "scalar_field_cosmology"}) {
    Request free = asking(autonomous, "contact_splitting", "decay");
    runs::set(free, "composition", "sofroniou_spaletta_10");
    EXPECT_LT(ask(free, "decay/max_residual"), 1e-12) << autonomous;
  }
  Request varying = asking("perturbed_kepler", "contact_splitting", "decay");
  runs::set(varying, "composition", "sofroniou_spaletta_10");
  EXPECT_LT(ask(varying, "decay/max_residual"), 1e-11);
}

// With many short steps of order 10 the only residual is that of rounding.
TEST(Decay, SaysWhatRoundingMakesOfIt) {
  for (const char* problem : {"damped_oscillator", "driven_oscillator"})
    for (const double h : {0.05, 0.01, 0.002}) {
      Request request = asking(problem, "contact_leapfrog", "decay");
      runs::set(request, "composition", "sofroniou_spaletta_10");
      runs::set(request, "step", h);
      request.end = 20;
      const double floor = ask(request, "decay/floor"), residual = ask(request, "decay/max_residual");
      EXPECT_LT(residual, 4 * floor) << problem << ", h = " << h;
      EXPECT_GT(residual, floor / 100) << problem << ", h = " << h;
    }
}

/// The reported residual is the largest change of H eᴬ − G along a trajectory, here with G by Simpson's rule over pairs
/// of steps.
TEST(Decay, IsWhatTheSchemeDoesToTheLaw) {
  for (const char* scheme : {"contact_leapfrog", "contact_variational_midpoint"}) {
    Request request = driven(scheme, 2, 0.002);
    request.end = 20;
    const double reported = ask(request, "decay/max_residual");
    EXPECT_GT(reported, 100 * ask(request, "decay/floor")) << scheme;
    request.record.count = 1;
    runs::show_all(request);
    const auto rows = runs::go(request).rows;
    const double alpha = 0.1, amplitude = 0.3, phase = -std::numbers::pi / 2;
    const auto gain = [&](const std::vector<double>& row) {  // H_t eᴬ, H = p²/2 + q²/2 − q f(t) + αs
      return row[1] * amplitude * 2 * std::sin(2 * row[0] + phase) * std::exp(alpha * row[0]);
    };
    double most = 0, gained = 0, first = 0;
    for (std::size_t n = 0; n < rows.size(); n += 2) {
      const double t = rows[n][0], q = rows[n][1], p = rows[n][2], s = rows[n][3];
      const double h = p * p / 2 + q * q / 2 - q * amplitude * std::cos(2 * t + phase) + alpha * s;
      if (n == 0) first = h;
      if (n > 0) gained += 0.004 / 6 * (gain(rows[n - 2]) + 4 * gain(rows[n - 1]) + gain(rows[n]));
      most = std::max(most, std::abs(h * std::exp(alpha * t) - gained - first));
    }
    EXPECT_NEAR(reported, most / first, 0.02 * reported) << scheme;
  }
}

}  // namespace
