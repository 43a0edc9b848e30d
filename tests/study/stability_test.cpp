// How long a step may be.
#include <cmath>
#include <numbers>

#include "core/composition.hpp"
#include "tests/study/studies.hpp"

namespace {

using namespace studies;

StabilityLimit limit(std::string_view problem, std::string_view scheme, std::string_view composition = "",
                     std::initializer_list<std::pair<std::string_view, double>> parameters = {}) {
  Request request = scene(problem);
  for (const auto& [name, value] : parameters) runs::set(request, name, value);
  return longest_stable_step_of(request, choice(request, scheme, composition), never);
}

void expect_limit(const StabilityLimit& limit, double step, std::string_view failure) {
  SCOPED_TRACE(name(limit.scheme));
  EXPECT_NEAR(limit.step, step, 2e-3 * step);
  EXPECT_NEAR(limit.theory, step, 1e-3 * step);
  EXPECT_EQ(limit.failure, failure);
}

TEST(StabilityLimit, IsThatOfLinearTheory) {
  expect_limit(limit("harmonic_oscillator", "leapfrog"), 2, "energy_growth");
  expect_limit(limit("harmonic_oscillator", "leapfrog", "", {{"stiffness", 100}}), 0.2, "energy_growth");
  expect_limit(limit("harmonic_oscillator", "symplectic_euler"), 2, "energy_growth");
  expect_limit(limit("harmonic_oscillator", "runge_kutta_4"), 2 * std::numbers::sqrt2, "energy_growth");
  expect_limit(limit("harmonic_oscillator", "galerkin_4", "none"), 2 * std::numbers::sqrt2, "energy_growth");
  for (const double damping : {0.01, 0.1, 0.5, 0.9})
    expect_limit(limit("damped_oscillator", "contact_leapfrog", "none", {{"damping", damping}}), 2, "energy_growth");
  expect_limit(limit("damped_oscillator", "runge_kutta_4", "", {{"damping", 100}}), 0.0278532, "energy_growth");
}

/// The merged splitting's bound ωh < 2 √(x/tanh x), x = αh/2, as the largest h.
TEST(StabilityLimit, OfTheSplittingsWithDamping) {
  for (const double damping : {0.1, 1.0}) {
    Request request = scene("damped_oscillator");
    runs::set(request, "damping", damping);
    SchemeConfig scheme = choice(request, "contact_splitting", "none");
    Request probe = with(request, scheme);
    runs::set(probe, "splitting", "plain");
    expect_limit(longest_stable_step_of(request, {scheme.scheme, probe.settings}, never), 2, "energy_growth");
    runs::set(probe, "splitting", "merged");
    double h = 2;
    for (int k = 0; k < 100; ++k) h = 2 * std::sqrt(damping * h / 2 / std::tanh(damping * h / 2));
    expect_limit(longest_stable_step_of(request, {scheme.scheme, probe.settings}, never), h, "energy_growth");
  }
}

TEST(StabilityLimit, OfCompositionsIsTheMeasuredBound) {
  for (const std::string_view composition : {"suzuki_4", "yoshida_4", "kahan_li_6", "kahan_li_8"}) {
    const StabilityLimit found = limit("harmonic_oscillator", "leapfrog", composition);
    SCOPED_TRACE(composition);
    EXPECT_GT(found.step, 0.5);
    EXPECT_LT(found.step, 6);
    EXPECT_NEAR(found.step, found.theory, 2e-3 * found.theory);
    EXPECT_EQ(found.failure, "energy_growth");
  }
}

TEST(StabilityLimit, SaysHowItFails) {
  expect_limit(limit("damped_oscillator", "contact_leapfrog", "none", {{"damping", 10}}), 0.2, "sign_flip");
  expect_limit(limit("damped_oscillator", "contact_leapfrog", "suzuki_4", {{"damping", 100}}), 0.02, "sign_flip");
  EXPECT_TRUE(std::isnan(limit("harmonic_oscillator", "variational_midpoint", "none").step));
  EXPECT_TRUE(limit("harmonic_oscillator", "variational_midpoint", "none").failure.empty());
  EXPECT_EQ(limit("damped_pendulum", "contact_variational_midpoint", "none").failure, "solver_failed");
  const StabilityLimit euler = limit("harmonic_oscillator", "explicit_euler");
  EXPECT_EQ(euler.theory, 0) << "it grows at every step";
  EXPECT_EQ(euler.failure, "energy_growth");
  EXPECT_TRUE(std::isnan(limit("kepler", "time_transformed").step)) << "no fixed steps";
  EXPECT_LT(limit("kepler", "leapfrog").step, 0.2);
  EXPECT_EQ(limit("kepler", "explicit_euler").failure, "energy_growth") << "it flies away";
  EXPECT_TRUE(std::isnan(limit("kepler", "leapfrog").theory));
}

// Where the motion is not linear, the limit is ragged; well below it runs are stable.
TEST(StabilityLimit, RunsBelowAreStable) {
  for (const auto& [problem, scheme] :
       {std::pair("henon_heiles", "leapfrog"), std::pair("van_der_pol", "runge_kutta_4"),
        std::pair("lorenz", "contact_splitting"), std::pair("pendulum", "ruth_3")}) {
    const StabilityLimit found = limit(problem, scheme);
    SCOPED_TRACE(problem);
    ASSERT_TRUE(found.step > 0);
    EXPECT_FALSE(found.failure.empty());
    for (const double factor : {0.1, 0.3, 0.5, 0.7}) {
      Request request = with(scene(problem), found.scheme);
      runs::set(request, "step", factor * found.step);
      request.until_steps = true;
      request.steps = 2000;
      const auto result = runs::go(request);
      EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << factor;
      for (std::size_t i = 0; i < 2; ++i) EXPECT_LT(std::abs(result.outcome.final[i]), 1e4) << factor;
    }
  }
}

// An angle that turns for ever is no growth: the free rotor, whose every step is exact.
TEST(StabilityLimit, TurningIsNoGrowth) {
  Request rotor = scene("spin_orbit");
  runs::set(rotor, "epsilon", 0);
  const StabilityLimit found = longest_stable_step_of(rotor, choice(rotor, "contact_splitting", "none"), never);
  EXPECT_TRUE(found.failure.empty()) << found.failure << found.step;
}

}  // namespace
