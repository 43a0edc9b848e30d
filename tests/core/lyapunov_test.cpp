// lyapunov: exponents that are known, MEGNO of regular and of chaotic motion, whatever the scheme of the run.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/catalogue/compiled.hpp"
#include "core/catalogue/custom.hpp"
#include "core/problems/kepler.hpp"
#include "core/run/tangent_length.hpp"
#include "tests/core/asking.hpp"
#include "tests/support/texts.hpp"

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
    const auto [exponent, megno] = lyapunov(top, 20);  // before rounding makes the pendulum fall
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

// λ = .9056: Sprott, Chaos and Time-Series Analysis, 2003, table of the Lorenz system. The estimate fluctuates with the
// interval of time: over 400 by .03, over 1500 by .01.
TEST(Lyapunov, OfLorenzIsTheKnownOne) {
  for (const char* scheme : {"runge_kutta_4", "dormand_prince_5"}) {
    const auto [exponent, megno] = lyapunov(asking("lorenz", scheme, "lyapunov"), 1500);
    EXPECT_NEAR(exponent, 0.9056, 0.015) << scheme;
    EXPECT_NEAR(megno, 0.9056 * 1500 / 2, 15) << scheme;
  }
}

using Orbit = problems::Kepler<>;
StateOf<Orbit> state_of(const std::vector<double>& variables, double t) {
  StateOf<Orbit> x;
  x.t = t;
  for (std::size_t i = 0; i < 4; ++i) x[i] = variables[i];
  return x;
}
/// growth_of_a_difference() returns ln |δ(T)| / T of two runs along Kepler's orbit whose starts differ by `distance` in
/// the direction that `lyapunov` follows.
double growth_of_a_difference(Request request, double end, double distance) {
  request.end = runs::scene(request).start + end;
  request.diagnostics = {};
  const CompiledBackend<Orbit, StateOf<Orbit>> orbit{Orbit()};
  const TangentLength length(orbit, run_state(state_of(runs::scene(request).initial, 0)), end,
                             kinds_of(runs::scene(request).card()), [] { return true; });
  std::vector<double> ends[2];
  for (const double side : {-0.5, 0.5}) {
    Request displaced = request;
    auto& initial = runs::scene(displaced).initial;
    for (std::size_t i = 0; i < initial.size(); ++i) initial[i] += side * distance * length.first()[i];
    ends[side > 0] = runs::go(displaced).outcome.final;
  }
  Vec<4> apart;
  for (std::size_t i = 0; i < 4; ++i) apart[i] = (ends[1][i] - ends[0][i]) / distance;
  return std::log(length(run_state(state_of(ends[0], end)), apart.data())) / end;
}

// The states of a coarse run do not lie on one orbit: the derivatives of the true motion along them would grow by .38
// and .25 a unit of time here, as in a chaotic motion. Steps in a fictitious time reach neighbours at different times,
// and the run of a neighbour has its own energy level.
TEST(Lyapunov, IsThatOfTheSchemesOwnMapHoweverCoarse) {
  for (const char* scheme : {"leapfrog", "galerkin_4", "runge_kutta_4"})
    for (const double step : {0.01, 0.002}) {
      Request request = asking("kepler", scheme, "lyapunov");
      runs::set(request, "step", step);
      const double grown = growth_of_a_difference(request, 95, 2e-9);
      EXPECT_LT(grown, 0.1);
      EXPECT_NEAR(lyapunov(request, 95).exponent, grown, 1e-4) << scheme << ' ' << step;
    }
  for (const double kappa : {0.24, 1.0})
    for (const double sigma : {0.1, 0.02}) {
      Request request = asking("kepler", "time_transformed", "lyapunov");
      runs::set(request, "kappa", kappa);
      runs::set(request, "sigma", sigma);
      EXPECT_NEAR(lyapunov(request, 95).exponent, growth_of_a_difference(request, 95, 1e-6), 2e-6)
          << kappa << ' ' << sigma;
    }
  const Request hybrid = asking("kepler", "jacobi_maupertuis", "lyapunov");
  EXPECT_NEAR(lyapunov(hybrid, 95).exponent, growth_of_a_difference(hybrid, 95, 1e-7), 1e-5);
}

// On an orbit of eccentricity .96 the growth is in a component of u that is smaller than the others by a factor of |u|.
// The true values are from the variational equations by Fehlberg's pair of order 8 in long double at 1e-17, in steps of
// .05 at most.
TEST(Lyapunov, OfAnEccentricOrbitTendsToThatOfARegularOne) {
  struct Truth {
    double end, exponent, megno;
  };
  for (const Truth& truth : {Truth{1000, 0.0049960, 1.790}, Truth{10'000, 0.00074058, 1.9605}})
    for (const char* scheme :
         {"taylor", "fehlberg_78", "dormand_prince_5", "bulirsch_stoer", "adaptive_verlet", "time_transformed"}) {
      if (truth.end > 1000 && scheme == std::string("adaptive_verlet")) continue;  // many steps
      const auto [exponent, megno] = lyapunov(asking("kepler", scheme, "lyapunov"), truth.end);
      EXPECT_NEAR(exponent / truth.exponent, 1, 0.005) << scheme << ' ' << truth.end;
      EXPECT_NEAR(megno, truth.megno, 0.004) << scheme << ' ' << truth.end;
    }
  // The hybrid steps along a coordinate, and in some steps uses the true motion instead: the tangents have the same
  // size.
  const auto [exponent, megno] = lyapunov(asking("kepler", "jacobi_maupertuis", "lyapunov"), 1000);
  EXPECT_NEAR(exponent / 0.0049960, 1, 0.01);
  EXPECT_NEAR(megno, 1.790, 0.02);
  Request fine = asking("kepler", "leapfrog", "lyapunov");
  runs::set(fine, "step", 0.001);
  EXPECT_NEAR(lyapunov(fine, 1000).megno, 1.790, 0.01);
}

// x in units of 1/1000, t in units of 1/50000 of those of the default orbit.
TEST(Lyapunov, DependsOnNoUnit) {
  const double length = 1e3, time = 5e4, speed = length / time;
  for (const char* scheme : {"taylor", "dormand_prince_5", "time_transformed"}) {
    const Request plain = asking("kepler", scheme, "lyapunov");
    Request scaled = plain;
    runs::set(scaled, "mu", length * speed * speed);
    for (const char* name : {"x", "y"}) runs::begin(scaled, name, length * runs::scene(plain).initial[name[0] == 'y']);
    for (const char* name : {"px", "py"}) runs::begin(scaled, name, -0.1 * speed);
    if (scheme == std::string("time_transformed")) {
      runs::set(scaled, "sigma", 0.02 * speed * speed * time);
      runs::set(scaled, "kappa", 0.75 * speed * speed);
    }
    const Found here = lyapunov(plain, 1000), there = lyapunov(scaled, 1000 * time);
    EXPECT_NEAR(there.megno, here.megno, 1e-3) << scheme;
    EXPECT_NEAR(there.exponent * time / here.exponent, 1, 1e-3) << scheme;
  }
}

TEST(Lyapunov, SaysWhatItMeans) {
  const auto verdict = [](const char* problem, double end,
                          std::initializer_list<std::pair<const char*, double>> start) {
    Request request = asking(problem, "taylor", "lyapunov");
    request.end = end;
    for (const auto& [name, value] : start) runs::begin(request, name, value);
    const std::string words = word(request, "lyapunov/verdict");
    return words.substr(0, words.find(':'));
  };
  EXPECT_EQ(verdict("kepler", 2000, {}), "regular");
  EXPECT_EQ(verdict("harmonic_oscillator", 200, {}), "steady");
  EXPECT_EQ(verdict("henon_heiles", 500, {{"x", 0}, {"y", -0.1}, {"px", 0.55}, {"py", 0.05}}), "unstable");
  EXPECT_EQ(verdict("van_der_pol", 100, {}), "steady") << "along the cycle nothing grows or shrinks";
  EXPECT_EQ(verdict("damped_oscillator", 200, {}), "contracts");
}

// The far end of a chain, while still at rest, has the same weight as what moves: in a linear chain nothing ever grows.
TEST(Lyapunov, OfALinearChainIsNeverChaos) {
  text::TypedScene typed;
  typed.scene.variables = {"x[32]"};
  typed.scene.kind = text::Definition::Kind::potential;
  typed.scene.formula = "sum(i=1..31, (x[i+1] - x[i])^2/2) + x[1]^2/2 + x[32]^2/2";
  auto made = custom_mechanics(typed);
  ASSERT_TRUE(std::holds_alternative<std::shared_ptr<const Mechanics>>(made));
  for (const double end : {1.0, 5.0, 10.0, 20.0, 40.0}) {
    const double start[] = {1};
    Request request = texts::request_by("leapfrog", std::get<std::shared_ptr<const Mechanics>>(made), start, end);
    runs::ask(request, "lyapunov");
    const auto [exponent, megno] = lyapunov(request, end);
    EXPECT_LT(std::abs(megno), 2.5) << end;
    EXPECT_LT(exponent * end, 3) << end;
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
