// The longest stable step, by runs and by linear theory.
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

/// The merged splitting's bound ωh < 2 √(x/tanh x), x = αh/2, solved for the largest h.
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
  expect_limit(limit("damped_oscillator", "contact_leapfrog", "suzuki_4", {{"damping", 100}}), 0.030228,
               "energy_growth");
  EXPECT_TRUE(std::isnan(limit("harmonic_oscillator", "variational_midpoint", "none").step));
  EXPECT_TRUE(limit("harmonic_oscillator", "variational_midpoint", "none").failure.empty());
  EXPECT_EQ(limit("damped_pendulum", "contact_variational_midpoint", "none").failure, "solver_failed");
  const StabilityLimit euler = limit("harmonic_oscillator", "explicit_euler");
  EXPECT_EQ(euler.theory, 0) << "it grows at every step";
  EXPECT_EQ(euler.step, 0);
  EXPECT_EQ(euler.failure, "energy_growth");
  EXPECT_NE(limit("harmonic_oscillator", "variational_midpoint", "none").why.find("every step that was tried"),
            std::string::npos);
  EXPECT_EQ(euler.why, "");
  for (const auto& [problem, scheme] :
       {std::pair("kepler", "time_transformed"), std::pair("damped_oscillator", "time_transformed"),
        std::pair("damped_kepler", "time_transformed"), std::pair("perturbed_kepler", "time_transformed"),
        std::pair("kepler", "fehlberg_78")}) {
    const StabilityLimit none = limit(problem, scheme);
    EXPECT_TRUE(std::isnan(none.step) && std::isnan(none.theory) && none.failure.empty()) << problem;
    EXPECT_EQ(none.why, "it chooses its steps in time itself") << problem;
  }
  EXPECT_LT(limit("kepler", "leapfrog").step, 0.2);
  EXPECT_EQ(limit("kepler", "explicit_euler").failure, "energy_growth") << "it flies away";
  EXPECT_EQ(limit("kepler", "explicit_euler").step, 0);
  EXPECT_TRUE(std::isnan(limit("kepler", "leapfrog").theory));
}

// ── linear theory ───────────────────────────────────────────────────────────────────────────────────────────────────

StableSteps theory(std::string_view scheme, std::vector<double> settings, double alpha) {
  return stable_steps(find_scheme(scheme).value(), settings, 1, alpha, 50);
}
double composed(std::string_view composition) {
  return static_cast<double>(std::ranges::find(compositions::names, composition) - compositions::names.begin());
}

TEST(StableStepsTest, OfWhatIsDampedAreOnTheRayOfTheStep) {
  EXPECT_NEAR(theory("explicit_euler", {1}, 0.1).limit, 0.1, 1e-8) << "h = α/ω²";
  EXPECT_NEAR(theory("explicit_euler", {1}, 2).limit, 2, 1e-8);
  EXPECT_NEAR(theory("explicit_midpoint", {1}, 2).limit, 2, 1e-8);
  EXPECT_NEAR(theory("runge_kutta_4", {1}, 2).limit, 2.785293563405282, 1e-8) << "its interval on the real axis";
  for (const std::string_view scheme : {"explicit_euler", "explicit_midpoint"})
    EXPECT_EQ(theory(scheme, {1}, 0).limit, 0) << scheme;
  // At critical damping, a = 2 z, the step with a = 3 is stable although z = 0 with the same a is not: steps lie on the
  // ray through the origin and do not meet z = 0.
  EXPECT_FALSE(is_stable(find_scheme("runge_kutta_4").value(), std::vector{1.0}, 0, 3));
  EXPECT_TRUE(is_stable(find_scheme("runge_kutta_4").value(), std::vector{1.0}, 1.5, 3));
}

TEST(StableStepsTest, ThinGapsAreFound) {
  const auto gap = [](const StableSteps& steps) { return Interval{steps.limit, steps.islands.at(0).low}; };
  const Interval galerkin = gap(theory("galerkin_4", {1, composed("kahan_li_8")}, 0)),
                 leapfrog = gap(theory("leapfrog", {1, composed("sofroniou_spaletta_10")}, 0)),
                 thinnest = gap(theory("galerkin_4", {1, composed("sofroniou_spaletta_10")}, 0));
  EXPECT_NEAR(galerkin.low, 3.1405, 1e-4);
  EXPECT_NEAR(galerkin.high, 3.1422, 1e-4);
  EXPECT_LT(leapfrog.low, 3.1412);
  EXPECT_GT(leapfrog.high, 3.1412);
  EXPECT_NEAR(thinnest.high - thinnest.low, 3.5e-5, 1e-6);
  const StableSteps plain = theory("galerkin_4", {1, 0}, 0);
  EXPECT_NEAR(plain.limit, 2 * std::sqrt(2.0), 1e-8);
  ASSERT_EQ(plain.islands.size(), 1U);
  EXPECT_NEAR(plain.islands[0].low, 2 * std::sqrt(3.0), 1e-8);
  EXPECT_NEAR(plain.islands[0].high, 2 * std::sqrt(6.0), 1e-8);
  const StableSteps gauss = theory("contact_gauss", {1, 2}, 1);
  EXPECT_NEAR(gauss.limit, 2.6467, 1e-4);
  ASSERT_EQ(gauss.islands.size(), 1U);
  EXPECT_NEAR(gauss.islands[0].low, 2 * std::sqrt(3.0), 1e-6);
  EXPECT_TRUE(std::isinf(gauss.islands[0].high));
}

// Checks inside every interval and outside all of them, by the spectral radius. Where two eigenvalues meet, a margin of
// 1e-11 is one of 3e-6 in the radius.
TEST(StableStepsTest, AreWhereStepsDoNotGrow) {
  int borders = 0;
  const auto check = [&](std::string_view scheme, const std::vector<double>& settings, double alpha) {
    const StableSteps steps = theory(scheme, settings, alpha);
    const auto radius = [&](double h) { return growth_per_step(find_scheme(scheme).value(), settings, h, alpha * h); };
    std::vector<Interval> all{{0, steps.limit}};
    all.insert(all.end(), steps.islands.begin(), steps.islands.end());
    for (std::size_t i = 0; i < all.size(); ++i) {
      const auto [low, high] = all[i];
      if (!(high < 20)) continue;
      ++borders;
      SCOPED_TRACE(std::string(scheme) + ' ' + std::to_string(settings.back()) + ' ' + std::to_string(alpha));
      for (int k = 1; k < 1000; ++k) EXPECT_LT(radius(low + (high - low) * k / 1000), 1 + 4e-6) << k;
      const double next = i + 1 < all.size() ? all[i + 1].low : 1.5 * high;
      EXPECT_GT(radius(std::min(high * (1 + 1e-3), (high + next) / 2)), 1 + 4e-6) << high;
      for (int k = 1; k < 10; ++k) EXPECT_GT(radius(high + (next - high) * k / 10), 1 + 4e-6) << high << ' ' << k;
    }
  };
  for (double composition = 0; composition < 9; ++composition) {
    check("leapfrog", {1, composition}, 0);
    check("galerkin_4", {1, composition}, 0);
    check("variational_midpoint", {1, composition}, 0);
    for (const double alpha : {0.1, 1.0}) {
      check("contact_leapfrog", {1, composition}, alpha);
      check("contact_splitting", {1, composition, 1}, alpha);
    }
  }
  for (const double alpha : {0.1, 1.0, 2.0, 10.0})
    for (const std::string_view scheme : {"explicit_euler", "explicit_midpoint", "runge_kutta_4", "contact_galerkin_4"})
      check(scheme, {1}, alpha);
  EXPECT_GT(borders, 60);
}

// The expected numbers are from the trace of nine leapfrog steps, evaluated by hand at every 1e-6.
TEST(StableStepsTest, ThinIslandsAreFound) {
  const StableSteps steps = theory("leapfrog", {1, composed("kahan_li_6")}, 0);
  EXPECT_NEAR(steps.limit, 2.532627, 2e-6);
  ASSERT_EQ(steps.islands.size(), 2U);
  EXPECT_NEAR(steps.islands[0].low, 2.919126, 2e-6);
  EXPECT_NEAR(steps.islands[0].high, 3.328645, 2e-6);
  EXPECT_NEAR(steps.islands[1].low, 4.646921, 2e-6);
  EXPECT_NEAR(steps.islands[1].high, 4.651783, 2e-6);
}

TEST(StabilityLimit, StopsAtAThinGap) {
  const StabilityLimit found = limit("harmonic_oscillator", "leapfrog", "sofroniou_spaletta_10");
  EXPECT_NEAR(found.step, 3.14108, 2e-3);
  EXPECT_NEAR(found.theory, 3.14108, 1e-5);
  ASSERT_GE(found.islands.size(), 1U);
  EXPECT_NEAR(found.islands[0].high, 5.9737, 1e-3);
}

TEST(StabilityLimit, OfCriticalDampingIsTheRealInterval) {
  const auto critical = [](std::string_view scheme) {
    return limit("damped_oscillator", scheme, "", {{"damping", 2}});
  };
  expect_limit(critical("runge_kutta_4"), 2.785293563405282, "energy_growth");
  expect_limit(critical("explicit_midpoint"), 2, "energy_growth");
}

// Where the motion is not linear the limit is not sharp; well below it runs are stable.
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

// A steadily rotating angle is no growth: the free rotor, for which every step is exact.
TEST(StabilityLimit, TurningIsNoGrowth) {
  Request rotor = scene("spin_orbit");
  runs::set(rotor, "epsilon", 0);
  const StabilityLimit found = longest_stable_step_of(rotor, choice(rotor, "contact_splitting", "none"), never);
  EXPECT_TRUE(found.failure.empty()) << found.failure << found.step;
}

}  // namespace
