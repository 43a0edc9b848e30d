// Damping, driving and an action that blows up at their extremes: METHODS, section 7, row by row, and beside each
// extreme a benign twin. flow_extremes_test.cpp has the problems that are not mechanical.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/extremes/asking.hpp"

namespace {

using namespace least;
using namespace asking;

Request damped(std::string_view scheme, double h, double alpha, double stiffness = 1) {
  Request request = of("damped_oscillator", {scheme, {{"step", h}}}, {{"damping", alpha}, {"stiffness", stiffness}});
  return steps(request, 400);
}

// ── αh ≥ 2 ──────────────────────────────────────────────────────────────────────────────────────────────────────────

TEST(DampingSign, IsWarnedOfAndMeansThatTheMomentumAlternates) {
  const double h = 0.1;
  for (const std::string_view scheme : {"contact_leapfrog", "contact_variational_midpoint"})
    for (const double alpha : {20.0, 30.0, 1000.0}) {
      Request request = at(damped(scheme, h, alpha, 1e-12), {{"q", 0}, {"p", 1}});
      request.steps = 6;
      const auto result = go(request);
      EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << scheme << ' ' << alpha;
      ASSERT_TRUE(warned(result, "damping_sign")) << scheme << ' ' << alpha;
      const double factor = (2 - alpha * h) / (2 + alpha * h);
      for (std::size_t i = 1; i < result.rows.size(); ++i)
        EXPECT_NEAR(value(request, result.rows[i], "p"), factor * value(request, result.rows[i - 1], "p"), 1e-12)
            << scheme << ' ' << alpha << ' ' << i;
    }
}

/// A composition reverses the momentum where an odd number of its stages does, not where its longest stage does.
TEST(DampingSign, OfACompositionIsThatOfItsStages) {
  for (const char* scheme : {"contact_leapfrog", "contact_variational_midpoint"})
    for (const auto& [composition, alpha, turns] :
         {std::tuple{"suzuki_4", 25.0, false}, {"yoshida_6", 15.0, false}, {"yoshida_6", 16.0, true}}) {
      Request request =
          choose(at(damped(scheme, 0.1, alpha, 1e-9), {{"q", 0}, {"p", 1}}), {{"composition", composition}});
      request.steps = 3;
      const auto result = go(request);
      ASSERT_EQ(result.outcome.stop.reason, ReturnCode::completed) << composition << ' ' << alpha;
      EXPECT_EQ(warned(result, "damping_sign"), turns) << composition << ' ' << alpha;
      EXPECT_EQ(value(request, result.rows[1], "p") < 0, turns) << composition << ' ' << alpha;
    }
}

/// The first-order scheme warns from αh = 1 on, where it loses the momentum.
TEST(DampingSign, OfTheFirstOrderSchemeIsWarnedOfFromOneOn) {
  const double h = 0.1;
  for (const double alpha : {9.9, 10.0, 15.0}) {
    Request request = at(damped("contact_symplectic_euler", h, alpha, 1e-12), {{"q", 0}, {"p", 1}});
    request.steps = 6;
    const auto result = go(request);
    EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << alpha;
    EXPECT_EQ(warned(result, "damping_sign"), alpha >= 10) << alpha;
    if (alpha >= 10) {
      EXPECT_TRUE(result.outcome.warnings.back().detail.text().starts_with("αh ≥ 1 at")) << alpha;
    }
    for (std::size_t i = 1; i < result.rows.size(); ++i)
      EXPECT_NEAR(value(request, result.rows[i], "p"), (1 - alpha * h) * value(request, result.rows[i - 1], "p"), 1e-12)
          << alpha << ' ' << i;
  }
}

TEST(DampingSign, IsNotWarnedOfBelowTwoNorWhereNothingTurnsOver) {
  for (const std::string_view scheme : {"contact_leapfrog", "contact_variational_midpoint"})
    EXPECT_FALSE(warned(go(damped(scheme, 0.1, 19.9)), "damping_sign")) << scheme;
  for (const std::string_view splitting : {"plain", "merged", "automatic"}) {
    const Request request =
        choose(at(damped("contact_splitting", 0.1, 30, 1e-12), {{"q", 0}, {"p", 1}}), {{"splitting", splitting}});
    const auto result = go(request);
    EXPECT_FALSE(warned(result, "damping_sign")) << splitting;
    EXPECT_EQ(warned(result, "stiff_step"), splitting == "plain") << splitting;
    for (std::size_t i = 1; i < 20; ++i)
      EXPECT_NEAR(value(request, result.rows[i], "p"), std::exp(-3.0) * value(request, result.rows[i - 1], "p"), 1e-12);
  }
  EXPECT_FALSE(warned(go(damped("contact_gauss", 0.1, 30)), "damping_sign"));
}

TEST(DampingSign, OfADampingThatVariesIsFoundOnTheWay) {
  for (const std::string_view id : {"modulated_oscillator", "perturbed_kepler"}) {
    const double alpha = 2.001 / 0.01;  // αh sin(πt) reaches 2 about t = ½ only
    Request request = of(id, {"contact_leapfrog", {{"step", 0.01}}}, {{"alpha", alpha}});
    request.end = 0.6;
    const auto result = go(request);
    ASSERT_TRUE(warned(result, "damping_sign")) << id;
    const std::string detail = result.outcome.warnings.back().detail.text();
    EXPECT_NEAR(std::stod(detail.substr(detail.find("t = ") + 4)), 0.5, 0.02) << detail;
    EXPECT_FALSE(warned(go(set(request, {{"alpha", 0.99 * alpha}})), "damping_sign")) << id;
  }
}

// ── ωh ──────────────────────────────────────────────────────────────────────────────────────────────────────────────

/// expect_bound() runs on both sides of a bound: below it the run completes and stays bounded, above it stops at the
/// start.
void expect_bound(const Request& below, const Request& above, const std::string& what) {
  const auto inside = go(below);
  EXPECT_EQ(inside.outcome.stop.reason, ReturnCode::completed) << what << ": " << inside.outcome.stop.detail;
  EXPECT_TRUE(warned(inside, "step_near_stability_bound")) << what;
  const auto beyond = go(above);
  EXPECT_EQ(beyond.outcome.stop.reason, ReturnCode::unstable_step) << what;
  EXPECT_EQ(beyond.outcome.stop.step, 0) << what;
  EXPECT_EQ(beyond.rows.size(), 1U) << what << ": the start is a good state";
  // Just below the bound the numerical motion is on a long, but closed ellipse.
  EXPECT_LT(largest(below, inside, "q"), 40) << what;
}

TEST(StabilityBound, OfLeapfrogAndPlainSplittingIsTwoAtEveryDamping) {
  for (const double alpha : {0.0, 0.01, 0.1, 0.9, 1.0, 10.0}) {
    const auto leapfrog = [&](double h) { return damped("contact_leapfrog", h, alpha); };
    const auto plain = [&](double h) {
      return choose(damped("contact_splitting", h, alpha), {{"splitting", "plain"}});
    };
    expect_bound(leapfrog(1.999), leapfrog(2.001), "contact_leapfrog " + std::to_string(alpha));
    expect_bound(plain(1.999), plain(2.001), "plain " + std::to_string(alpha));
    EXPECT_FALSE(warned(go(leapfrog(0.99)), "step_near_stability_bound"));
    EXPECT_TRUE(warned(go(leapfrog(1.01)), "step_near_stability_bound")) << "from half the bound on";
  }
}

TEST(StabilityBound, OfTheMergedSplitting) {  // 2√(x/tanh x), x = αh/2
  for (const double alpha : {0.1, 1.0, 10.0, 100.0}) {
    const double x = alpha / 2, bound = 2 * std::sqrt(x / std::tanh(x));
    const auto merged = [&](double z) {
      return choose(damped("contact_splitting", 1, alpha, z * z), {{"splitting", "merged"}});
    };
    expect_bound(merged(0.999 * bound), merged(1.001 * bound), "merged " + std::to_string(alpha));
  }
}

TEST(StabilityBound, OfRungeKuttaIsItsIntervalOnEitherAxis) {
  EXPECT_EQ(reason(damped("runge_kutta_4", 2.82, 0)), ReturnCode::completed);
  EXPECT_EQ(reason(damped("runge_kutta_4", 2.84, 0)), ReturnCode::unstable_step);
  EXPECT_EQ(reason(damped("runge_kutta_4", 0.0278, 100)), ReturnCode::completed);
  EXPECT_EQ(reason(damped("runge_kutta_4", 0.0279, 100)), ReturnCode::unstable_step);
  EXPECT_EQ(reason(damped("contact_galerkin_4", 2.82, 0)), ReturnCode::completed);
  EXPECT_EQ(reason(damped("contact_galerkin_4", 2.84, 0)), ReturnCode::unstable_step);
  EXPECT_EQ(reason(damped("contact_variational_midpoint", 500, 0.1)), ReturnCode::completed);  // no bound
  for (const double stages : {1, 2, 3})
    EXPECT_EQ(reason(set(damped("contact_gauss", 500, 0.1), {{"stages", stages}})), ReturnCode::completed) << stages;
}

TEST(StabilityBound, HoldsWhateverTheProblemCallsItsFrequency) {
  struct Row {
    std::string_view problem, parameter;
  };
  for (const auto& [problem, parameter] :
       {Row{"modulated_oscillator", "stiffness"}, Row{"driven_oscillator", "stiffness"},
        Row{"damped_pendulum", "gravity"}, Row{"scalar_field_cosmology", "mass"}, Row{"spin_orbit", "epsilon"}})
    for (const std::string_view scheme : {"contact_leapfrog", "contact_splitting"}) {
      const double h = 0.1;
      const auto with = [&](double omega) {
        double x = parameter == "mass" ? omega : omega * omega;
        if (parameter == "epsilon") x *= 0.999 / 2;  // its estimate of ω² is 2ε/(1 − |λ|)
        return reason(steps(of(problem, {scheme, {{"step", h}}}, {{std::string(parameter), x}}), 50));
      };
      EXPECT_EQ(with(1.99 / h), ReturnCode::completed) << problem << ' ' << scheme;
      EXPECT_EQ(with(2.01 / h), ReturnCode::unstable_step) << problem << ' ' << scheme;
    }
}

TEST(StabilityBound, OfASelfInteractingField) {  // ω² = m² + 3λq², met where the field is large
  for (const std::string_view scheme : {"contact_leapfrog", "contact_splitting"}) {
    const auto with = [&](double q) {
      return go(at(of("scalar_field_cosmology", {scheme, {{"step", 0.05}}}, {{"lambda", 1000}}), {{"q", q}, {"p", 0}}));
    };
    EXPECT_EQ(with(0.5).outcome.stop.reason, ReturnCode::completed) << scheme;
    EXPECT_EQ(with(0.75).outcome.stop.reason, ReturnCode::unstable_step) << scheme;
    EXPECT_EQ(with(1e60).outcome.stop.reason, ReturnCode::unstable_step) << scheme;
  }
}

// ── poles of contact_leapfrog ───────────────────────────────────────────────────────────────────────────────────────

TEST(Pole, OfANegativeWeightIsRefusedWithItsBound) {
  const double cube = std::cbrt(2.0), quartic = 1 / (4 - std::cbrt(4.0));
  struct Row {
    std::string_view composition;
    double weight;
  };
  for (const std::string_view scheme : {"contact_leapfrog", "contact_variational_midpoint"})
    for (const auto& [composition, weight] : {Row{"yoshida_4", cube / (2 - cube)}, Row{"suzuki_4", 4 * quartic - 1}}) {
      const double alpha = 100, bound = 2 / (alpha * weight);
      const Request beyond = choose(damped(scheme, 1.0001 * bound, alpha, 1e-6), {{"composition", composition}});
      const auto refused = go(beyond);
      EXPECT_EQ(refused.outcome.stop.reason, ReturnCode::singular) << scheme << ' ' << composition;
      EXPECT_EQ(refused.outcome.stop.step, 0);
      EXPECT_TRUE(refused.rows.empty());
      EXPECT_EQ(refused.outcome.final[0], beyond.scene->initial[0]);
      const std::string detail = refused.outcome.stop.detail.text();
      const auto number = detail.rfind("αh = ");
      ASSERT_NE(number, std::string::npos) << detail;
      EXPECT_NEAR(std::stod(detail.substr(number + std::string("αh = ").size())), alpha * bound, 1e-3) << detail;
      EXPECT_NE(reason(set(beyond, {{"step", 0.999 * bound}})), ReturnCode::singular) << scheme << ' ' << composition;
    }
}

TEST(Pole, OfDrivingIsRefusedAndSplittingGrowsAsTheMotionDoes) {
  for (const std::string_view scheme : {"contact_leapfrog", "contact_variational_midpoint"}) {
    for (const double alpha : {-20.0, -20.1, -1000.0}) {
      const auto refused = go(damped(scheme, 0.1, alpha));
      EXPECT_EQ(refused.outcome.stop.reason, ReturnCode::singular) << scheme << ' ' << alpha;
      EXPECT_EQ(refused.outcome.stop.step, 0);
      EXPECT_TRUE(refused.rows.empty());
      EXPECT_NE(refused.outcome.stop.detail.text().find("αh = −2"), std::string::npos) << refused.outcome.stop.detail;
    }
    Request near = damped(scheme, 0.1, -19.9);
    near.steps = 3;
    EXPECT_EQ(reason(near), ReturnCode::completed) << scheme;
  }
  // H e^{αt} is conserved while the amplitude grows by e^{−αt/2}: 1e11 here.
  for (const std::string_view splitting : {"plain", "merged"}) {
    Request request = choose(damped("contact_splitting", 0.001, -1), {{"splitting", splitting}});
    request.until_steps = false;
    request.end = 50;
    request.record.count = 0;
    request = ask(request, {"error", "energy"});
    const auto result = go(request);
    EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed);
    EXPECT_GT(std::abs(result.outcome.final[0]), 1e9);
    EXPECT_LT(runs::number(result.outcome.diagnostics, "error/max"), 1e-5) << splitting;
    EXPECT_NEAR(runs::number(result.outcome.diagnostics, "energy/final") /
                    runs::number(result.outcome.diagnostics, "energy/initial") * std::exp(-50.0),
                1, 1e-3);
  }
}

TEST(Pole, OfADampingThatVariesEndsTheRunWhereItIsMet) {
  Request request = of("modulated_oscillator", {"contact_leapfrog", {{"step", 0.1}}}, {{"alpha", 100}});
  request.end = 10;  // the damping turns into driving at t = 1
  const auto result = go(request);
  EXPECT_EQ(result.outcome.stop.reason, ReturnCode::singular);
  EXPECT_NEAR(result.outcome.stop.t, 1, 0.11);
  EXPECT_EQ(result.rows.size(), static_cast<std::size_t>(result.outcome.stop.step) + 1);
  EXPECT_EQ(reason(set(request, {{"alpha", 10}})), ReturnCode::completed);
}

// ── the action blows up ─────────────────────────────────────────────────────────────────────────────────────────────

Request falling(std::string_view scheme, double s, std::initializer_list<Named> parameters = {}) {
  return at(of("cosmological_oscillator", {scheme, {}}, parameters), {{"q", 0}, {"p", 0}, {"s", s}});
}

void expect_blow_up(const Request& request, double when, double tolerance, const std::string& what) {
  const auto result = go(request);
  const Termination& stop = result.outcome.stop;
  EXPECT_EQ(stop.reason, ReturnCode::singular) << what << ": " << stop.detail;
  ASSERT_TRUE(stop.singular_at.has_value()) << what;
  EXPECT_NEAR(*stop.singular_at, when, tolerance) << what;
  EXPECT_GE(*stop.singular_at, stop.t - (is_adaptive(request) ? when * std::max(request.settings[0], 1e-12) : 0))
      << what;
  EXPECT_GT(stop.t, when - 0.2 * std::max(1.0, when)) << what;
  ASSERT_EQ(result.rows.size(), static_cast<std::size_t>(stop.step) + 1) << what << ": all samples before it kept";
  EXPECT_EQ(value(request, result.rows.back(), "s"), result.outcome.final[2]) << what;
}

// s₀ = −2, γ = R = 1: the time is artanh(1/√2)·√2. The splitting solves this motion exactly; leapfrog has its own
// errors.
TEST(BlowUp, IsFoundInTime) {
  const double when = std::sqrt(2.0) * std::atanh(std::sqrt(0.5));
  EXPECT_NEAR(when, 1.24645048028, 1e-11);
  for (const std::string_view composition : {"none", "yoshida_4", "suzuki_4", "kahan_li_6", "kahan_li_8"})
    expect_blow_up(choose(falling("contact_splitting", -2), {{"composition", composition}}), when, 1e-10,
                   "splitting " + std::string(composition));
  for (const double h : {0.05, 0.01, 0.002})
    expect_blow_up(set(falling("contact_leapfrog", -2), {{"step", h}}), when, 0.7 * h, "leapfrog");
  expect_blow_up(choose(falling("contact_leapfrog", -2), {{"composition", "kahan_li_8"}}), when, 1e-3, "kahan_li_8");
  for (const std::string_view scheme : adaptive)
    for (const double tolerance : {1e-14, 1e-8, 1e-3})
      expect_blow_up(set(falling(scheme, -2), {{"tolerance", tolerance}}), when, 1e-10, std::string(scheme));
  // A start above the repelling point goes to the attracting one.
  const Request benign = falling("contact_splitting", -1.4);
  EXPECT_EQ(reason(benign), ReturnCode::completed);
  EXPECT_NEAR(go(benign).outcome.final[2], std::sqrt(2.0), 1e-6);
}

TEST(BlowUp, WithoutSourceWithASinkAndOfWeakCurvature) {
  expect_blow_up(falling("contact_splitting", -2.03, {{"R", 0}}), 2 / 2.03, 1e-12, "R = 0");
  expect_blow_up(falling("contact_splitting", 0, {{"R", -1}}), pi / std::sqrt(2.0), 1e-10, "R < 0");
  expect_blow_up(falling("contact_splitting", 3, {{"R", -1}}),
                 (pi / 2 + std::atan(3 / std::sqrt(2.0))) * std::sqrt(2.0), 1e-10, "R < 0 from above");
  Request weak = set(falling("contact_splitting", -2000, {{"gamma", 1e-6}}), {{"step", 0.5}});
  weak.end = 3000;
  expect_blow_up(weak, 1246.4504802804610, 1e-7, "γ small");
  expect_blow_up(falling("contact_splitting", -2, {{"gamma", 1000}, {"R", 1000}}), 1.2464504802804610e-3, 1e-12,
                 "within the first step");
  Request field =
      at(of("scalar_field_cosmology", {"contact_splitting", {}}, {{"gamma", 1}}), {{"q", 0}, {"p", 0}, {"s", -2.03}});
  expect_blow_up(field, 2 / 2.03, 1e-12, "field");
  EXPECT_EQ(reason(falling("contact_splitting", -2, {{"gamma", 0}})), ReturnCode::completed) << "without curvature";
}

// The flow of γs²/2 has a pole at γsh = −2. In schemes without such a part the source turns s back: from −30, at the
// rate 1000 − 450 of the start.
TEST(BlowUp, PolesOfPartsAreThoseOfSchemesThatHaveThem) {
  for (const std::size_t index : runs::problem_card("cosmological_oscillator").schemes) {
    const SchemeCard& scheme = schemes()[index];
    if (scheme.own_clock) continue;
    const Request request = steps(set(falling(scheme.id, -30, {{"R", 1000}}), {{"step", 0.1}}), 1);
    const auto result = go(request);
    const bool plain =
        scheme.id == "explicit_euler" || scheme.id == "explicit_midpoint" || scheme.id == "runge_kutta_4";
    EXPECT_EQ(result.outcome.stop.reason, plain ? ReturnCode::completed : ReturnCode::singular) << scheme.id;
    if (scheme.id == "explicit_euler") {
      EXPECT_NEAR(result.outcome.final[2], 25, 1e-12);
    }
  }
}

// With a sink the action falls to −∞ in every interval π/w, w = √(γ|R|/2) = 707: steps longer than that cannot miss it.
TEST(BlowUp, IsNotLeaptOverByALongStep) {
  const double w = 500 * std::sqrt(2.0);
  for (const double s : {0.0, 100.0})
    for (const double turns : {0.99, 1.0, 1.01, 2.0, 7.3})
      expect_blow_up(
          set(falling("contact_splitting", s, {{"R", -1000}, {"gamma", 1000}}), {{"step", turns * 2 * pi / w}}),
          (pi / 2 + std::atan(500 * s / w)) / w, 1e-12, std::to_string(turns));
}

// For q, p ≠ 0 the momentum grows and turns s back before it is infinite: a step that resolves this passes.
TEST(BlowUp, OffTheAxisIsATurnThatAShortStepPasses) {
  for (const std::string_view scheme : {"contact_splitting", "contact_leapfrog"}) {
    Request request = at(falling(scheme, -3), {{"q", 0.5}, {"p", 0.3}});
    request.end = 2;
    const auto long_steps = go(set(request, {{"step", 0.1}}));
    EXPECT_FALSE(long_steps.outcome.stop.singular_at.has_value()) << scheme << ": it does not blow up";
    const auto a = go(set(request, {{"step", 2e-4}})), b = go(set(request, {{"step", 1e-4}}));
    ASSERT_EQ(a.outcome.stop.reason, ReturnCode::completed) << scheme;
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a.outcome.final[i], b.outcome.final[i], 2e-3) << scheme << ' ' << i;
  }
}

TEST(BlowUp, EndsEverySchemeInAStatus) {
  for (const std::size_t index : runs::problem_card("cosmological_oscillator").schemes) {
    const auto result = go(falling(schemes()[index].id, -2));
    EXPECT_NE(result.outcome.stop.reason, ReturnCode::completed) << schemes()[index].id;
    EXPECT_LT(result.outcome.stop.t, 2) << schemes()[index].id;
    EXPECT_EQ(result.rows.size(), static_cast<std::size_t>(result.outcome.stop.step) + 1);
  }
}

// ── collision ───────────────────────────────────────────────────────────────────────────────────────────────────────

TEST(Collision, OfThePerturbedKeplerProblemIsStoppedOrWarnedOf) {
  const auto& card = runs::problem_card("perturbed_kepler");
  for (const std::size_t index : card.schemes) {
    const std::string_view scheme = schemes()[index].id;
    Request request = at(of("perturbed_kepler", {scheme}, {}), {{"x", 1}, {"py", 0}});
    if (!schemes()[index].own_clock) request = set(request, {{"step", 1e-3}});
    request.end = 3;  // reaches r = 0 at t = π/√8 = 1.11
    const auto result = go(request);
    if (is_adaptive(request)) {
      EXPECT_EQ(result.outcome.stop.reason, ReturnCode::singular) << scheme;
      EXPECT_NEAR(result.outcome.t, 1.1118010326, 1e-8) << scheme << ": a little later, being damped";
    } else {
      EXPECT_TRUE(result.outcome.stop.reason == ReturnCode::unstable_step || !result.outcome.warnings.empty())
          << scheme;
    }
    request.end = 0.5;
    const auto benign = go(request);
    EXPECT_EQ(benign.outcome.stop.reason, ReturnCode::completed) << scheme;
    EXPECT_TRUE(benign.outcome.warnings.empty()) << scheme;
    const auto centre = go(at(request, {{"x", 0}}));
    EXPECT_EQ(centre.outcome.stop.reason, ReturnCode::singular) << scheme;
    EXPECT_EQ(centre.outcome.stop.step, 0) << scheme;
    EXPECT_TRUE(centre.rows.empty()) << scheme;
    const auto repelled = go(set(request, {{"gamma", 1}}));
    EXPECT_EQ(repelled.outcome.stop.reason, ReturnCode::completed) << scheme;
  }
}

}  // namespace
