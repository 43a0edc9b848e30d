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
