// lyapunov: exponents that are known, MEGNO of regular and of chaotic motion, whatever scheme carries the run.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/core/asking.hpp"

namespace {

using namespace least;
using namespace asks;

struct Found {
  double exponent, megno;
};
Found lyapunov(Request request, double end) {
  request.end = runs::scene(request).start + end;
  return {ask(request, "lyapunov/exponent"), ask(request, "lyapunov/megno")};
}

TEST(Lyapunov, OnASummitIsTheRateOfTheFall) {
  for (const char* scheme : {"leapfrog", "runge_kutta_4", "fehlberg_78", "time_transformed"}) {
    Request top = asking("pendulum", scheme, "lyapunov");
    runs::begin(top, "q", std::acos(-1.0));
    runs::begin(top, "p", 0);
    const auto [exponent, megno] = lyapunov(top, 20);  // before rounding makes it fall
    EXPECT_NEAR(exponent, 1, 0.03) << scheme;
    EXPECT_NEAR(megno, 10, 0.5) << scheme << ": half of the time";
  }
}

TEST(Lyapunov, OfADampedOscillatorIsHalfItsDamping) {
  for (const char* scheme : {"contact_leapfrog", "contact_splitting", "dormand_prince_5"}) {
    Request request = asking("damped_oscillator", scheme, "lyapunov");
    runs::set(request, "damping", 0.3);
    EXPECT_NEAR(lyapunov(request, 100).exponent, -0.15, 0.005) << scheme;
  }
}

TEST(Lyapunov, MegnoOfARegularOrbitIsTwo) {
  for (const char* scheme : {"leapfrog", "adaptive_verlet", "bulirsch_stoer"}) {
    const auto [exponent, megno] = lyapunov(asking("henon_heiles", scheme, "lyapunov"), 1000);
    EXPECT_NEAR(megno, 2, 0.4) << scheme;
    EXPECT_LT(std::abs(exponent), 0.02) << scheme;
  }
}

// λ = .9056: Sprott, Chaos and Time-Series Analysis, 2003, table of the Lorenz system.
TEST(Lyapunov, OfLorenzIsTheKnownOne) {
  for (const char* scheme : {"runge_kutta_4", "dormand_prince_5"}) {
    const auto [exponent, megno] = lyapunov(asking("lorenz", scheme, "lyapunov"), 400);
    EXPECT_NEAR(exponent, 0.9056, 0.03) << scheme;
    EXPECT_NEAR(megno, 0.9056 * 400 / 2, 12) << scheme;
  }
}

/// ln |δ(T)| / T of two runs that begin at a distance along the direction in which `lyapunov` looks.
double growth_of_a_difference(Request request, double end, double distance) {
  request.end = runs::scene(request).start + end;
  request.diagnostics = {};
  std::vector<double> ends[2];
  for (const double side : {-0.5, 0.5}) {
    Request displaced = request;
    auto& initial = runs::scene(displaced).initial;
    double size = 0;
    for (std::size_t i = 0; i < initial.size(); ++i) size += 1 / double(i + 1);
    for (std::size_t i = 0; i < initial.size(); ++i) initial[i] += side * distance / std::sqrt(size * double(i + 1));
    ends[side > 0] = runs::go(displaced).outcome.final;
  }
  double square = 0;
  for (std::size_t i = 0; i < ends[0].size(); ++i) square += std::pow(ends[1][i] - ends[0][i], 2);
  return std::log(std::sqrt(square) / distance) / end;
}

// The states of a coarse run lie on no one orbit: the motion's derivatives along them would grow by .38 and .25 a unit
// of time here, as in a chaotic sea.
TEST(Lyapunov, IsThatOfTheSchemesOwnMapHoweverCoarse) {
  for (const char* scheme : {"leapfrog", "galerkin_4", "runge_kutta_4"})
    for (const double step : {0.01, 0.002}) {
      Request request = asking("kepler", scheme, "lyapunov");
      runs::set(request, "step", step);
      const double grown = growth_of_a_difference(request, 95, 1e-8);
      EXPECT_LT(grown, 0.1);
      EXPECT_NEAR(lyapunov(request, 95).exponent, grown, 1e-4) << scheme << ' ' << step;
    }
}

TEST(Lyapunov, SaysWhoseDerivativeItIs) {
  const auto of = [](const char* problem, const char* scheme, double end) {
    Request request = asking(problem, scheme, "lyapunov");
    request.end = runs::scene(request).start + end;
    return word(request, "lyapunov/derivative");
  };
  EXPECT_EQ(of("pendulum", "leapfrog", 10), "scheme");
  EXPECT_EQ(of("pendulum", "leapfrog", 10.003), "scheme") << "a last step that was cut short does not count";
  EXPECT_EQ(of("lorenz", "runge_kutta_4", 1), "scheme");
  EXPECT_EQ(of("kepler", "time_transformed", 5), "scheme");
  EXPECT_EQ(of("damped_oscillator", "contact_splitting", 5), "scheme");
  EXPECT_EQ(of("pendulum", "dormand_prince_5", 10), "motion");
}

TEST(Lyapunov, IsThereOnEveryScene) {
  for (const ProblemCard& problem : runs::problem_cards()) {
    const SchemeCard& scheme = schemes()[problem.schemes.front()];
    Request request = asking(problem.id.c_str(), scheme.id.c_str(), "lyapunov");
    const auto [exponent, megno] = lyapunov(request, 0.1 * (request.end - runs::scene(request).start));
    EXPECT_TRUE(std::isfinite(exponent)) << problem.id;
    EXPECT_TRUE(std::isfinite(megno)) << problem.id;
  }
}

}  // namespace
