// Problems that are not mechanical at their extremes: relaxation, negative substeps, a heat bath at temperature zero, a
// thermostat too narrow for its step.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/extremes/asking.hpp"

namespace {

using namespace least;
using namespace asking;

bool monotone(const runs::Result& result) {
  for (const auto& report : result.outcome.diagnostics)
    if (report.key == "entropy")
      for (const auto& part : std::get<std::vector<Report>>(report.value))
        if (part.key == "monotone") return std::get<bool>(part.value);
  throw std::out_of_range("monotone");
}

// ── van der Pol ─────────────────────────────────────────────────────────────────────────────────────────────────────

// The slope of the flow itself, v̇/v, is infinite where v = 0: two turning points a cycle.
TEST(Slope, HasAPoleAtEveryTurningPoint) {
  Request request = columns(of("van_der_pol", {"contact_splitting", {{"step", 0.002}}}, {}), {"t", "x", "v", "slope"});
  request = ask(at(request, {{"x", 0.5}, {"v", 1}}), {"poles", "cycle"});
  const auto result = go(request);
  ASSERT_EQ(result.outcome.stop.reason, ReturnCode::completed);
  std::vector<double> turns;
  for (std::size_t i = 1; i < result.rows.size(); ++i) {
    const auto &a = result.rows[i - 1], &b = result.rows[i];
    if ((a[2] < 0) != (b[2] < 0)) turns.push_back(a[0] + (b[0] - a[0]) * a[2] / (a[2] - b[2]));
  }
  const auto poles = runs::list(result.outcome.diagnostics, "poles");
  ASSERT_EQ(poles.size(), turns.size());
  EXPECT_GE(poles.size(), 8U);
  for (std::size_t i = 0; i < poles.size(); ++i) EXPECT_NEAR(poles[i], turns[i], 2e-3) << i;
  for (const auto& row : result.rows) {
    const double x = row[1], v = row[2], flow = ((1 - x * x) * v - x) / v;
    EXPECT_NEAR(std::atan(row[3]), std::atan(flow), 2e-2) << row[0];
  }
}

TEST(Slope, AtItsPoleIsUnknownAndNeverInfinite) {
  for (const std::size_t index : runs::problem_card("van_der_pol").schemes) {
    const std::string_view scheme = schemes()[index].id;
    Request request = columns(of("van_der_pol", {scheme, {}}, {}), {"t", "slope"});
    const auto result = go(request);  // go() checks that nothing is infinite
    EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << scheme;
    EXPECT_TRUE(std::isnan(result.rows[0][1])) << scheme << ": at rest at the turning point x = 2";
    for (std::size_t i = 1; i < result.rows.size(); ++i) EXPECT_TRUE(std::isfinite(result.rows[i][1])) << scheme;
    const auto still = go(at(request, {{"x", 0}, {"v", 0}}));
    EXPECT_EQ(still.outcome.stop.reason, ReturnCode::completed) << scheme;
    for (const auto& row : still.rows) EXPECT_TRUE(std::isnan(row[1])) << scheme << ": a fixed point has no slope";
    EXPECT_EQ(go(at(request, {{"slope", 0.25}})).rows[0][1], 0.25) << scheme;
    for (const double steep : {0.0, 1e-300, -1e70, 1e150}) {
      const auto given = go(at(request, {{"slope", steep}}));
      EXPECT_EQ(given.outcome.stop.reason, ReturnCode::completed) << scheme << ' ' << steep;
      EXPECT_NEAR(given.rows[0][1], steep, 1e-15 * std::abs(steep)) << scheme;
    }
  }
}

TEST(Stiffness, IsWarnedOfAboveAHalf) {
  const auto with = [](std::string_view scheme, double epsilon, double h) {
    return go(steps(of("van_der_pol", {scheme, {{"step", h}}}, {{"epsilon", epsilon}}), 200));
  };
  for (const std::string_view scheme : {"contact_splitting", "runge_kutta_4"})
    for (const double epsilon : {10.0, 100.0, 1e4}) {
      EXPECT_FALSE(warned(with(scheme, epsilon, 0.49 / epsilon), "stiff_step")) << scheme << ' ' << epsilon;
      EXPECT_TRUE(warned(with(scheme, epsilon, 0.51 / epsilon), "stiff_step")) << scheme << ' ' << epsilon;
    }
  EXPECT_EQ(with("runge_kutta_4", 100, 0.05).outcome.stop.reason, ReturnCode::not_finite);
  EXPECT_EQ(with("contact_splitting", 100, 0.05).outcome.stop.reason, ReturnCode::completed);
}

// ── gradient flow ───────────────────────────────────────────────────────────────────────────────────────────────────

// Backward in time the double well throws a point to infinity: a negative stage that reaches so far ends the run.
TEST(NegativeStage, OnAGradientFlowEndsInAStatusOrIsHarmless) {
  for (const std::string_view composition : {"yoshida_4", "suzuki_4", "yoshida_6", "kahan_li_6", "yoshida_8",
                                             "suzuki_umeno_8", "kahan_li_8", "sofroniou_spaletta_10"})
    for (const double h : {0.05, 1.0, 1e3})
      for (const double x : {0.1, -3.0, 1e3, 1e70}) {
        const Request request = choose(at(of("gradient_flow", {"contact_splitting", {{"step", h}}}, {}), {{"x", x}}),
                                       {{"composition", composition}});
        const auto result = go(steps(request, 200));
        const std::string what = std::string(composition) + ' ' + std::to_string(h) + ' ' + std::to_string(x);
        if (h < 0.1 && std::abs(x) < 10) {
          EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << what;
          EXPECT_NEAR(std::abs(result.outcome.final[0]), std::sqrt(1.09), 1e-3) << what << ": U′ = 0 in either well";
        } else if (result.outcome.stop.reason != ReturnCode::completed) {
          EXPECT_EQ(result.outcome.stop.reason, ReturnCode::not_finite) << what;
        }
      }
  // Without negative stages the fall from far away into the well is exact.
  Request request = at(of("gradient_flow", {"contact_splitting", {}}, {{"c", 0}}), {{"x", 1e70}});
  EXPECT_NEAR(value(request, go(request).rows[1], "x"), 1 / std::sqrt(1 - std::exp(-0.1)), 1e-12);
  EXPECT_EQ(reason(at(of("gradient_flow", {"runge_kutta_4", {}}, {}), {{"x", 1e70}})), ReturnCode::not_finite);
}

TEST(GradientFlow, WithoutAnySlopeStaysWhereItIs) {
  const Request request = of("gradient_flow", {"contact_splitting", {}}, {{"a", 0}, {"b", 0}, {"c", 0}});
  EXPECT_EQ(go(request).outcome.final, runs::scene(request).initial);
}

TEST(GradientFlow, OfASaddleRunsOff) {  // b = 0: U falls without bound along x y < 0
  const auto result = go(of("gradient_flow", {"contact_splitting", {}}, {{"b", 0}, {"c", 1000}}));
  EXPECT_EQ(result.outcome.stop.reason, ReturnCode::not_finite);
}

// ── GENERIC ─────────────────────────────────────────────────────────────────────────────────────────────────────────

TEST(Heat, FromColdToHot) {
  for (const std::string_view scheme : {"contact_splitting", "runge_kutta_4"})
    for (const double u : {5e-324, 1e-300, 1e-6, 1.0, 1e60}) {
      const auto result = go(everything(at(of("generic_oscillator", {scheme, {}}, {}), {{"U", u}})));
      EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << scheme << ' ' << u;
      EXPECT_TRUE(monotone(result)) << scheme << ' ' << u;
      if (scheme == "contact_splitting") {
        EXPECT_LT(runs::number(result.outcome.diagnostics, "energy/max_abs_error"), 2e-14 * std::max(1.0, u));
      }
    }
}

TEST(Heat, OfNoneHasNoEntropyToRecord) {
  for (const double u : {0.0, -1.0}) {
    const Request request = at(of("generic_oscillator", {"contact_splitting", {}}, {}), {{"U", u}});
    EXPECT_EQ(reason(request), ReturnCode::completed) << u << ": the motion does not read U";
    const auto asked = go(columns(request, {"t", "entropy"}));
    EXPECT_EQ(asked.outcome.stop.reason, ReturnCode::not_finite) << u;
    EXPECT_EQ(asked.outcome.stop.step, 0) << u;
    EXPECT_TRUE(asked.rows.empty()) << u;
    EXPECT_FALSE(std::isfinite(runs::number(go(ask(request, {"entropy"})).outcome.diagnostics, "entropy/initial")));
  }
}

TEST(Heat, CapacityAtTheEndsOfItsRange) {
  for (const double c : {1e-6, 1e6}) {
    const Request request = columns(of("generic_oscillator", {"contact_splitting", {}}, {{"heat_capacity", c}}),
                                    {"t", "U", "entropy", "temperature"});
    const auto result = go(request);
    EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed);
    for (const auto& row : result.rows) {
      EXPECT_EQ(row[2], c * std::log(row[1]));
      EXPECT_EQ(row[3], row[1] / c);
    }
  }
  EXPECT_EQ(reason(of("generic_oscillator", {"contact_splitting", {}}, {{"gamma", 1000}})), ReturnCode::completed);
  EXPECT_EQ(reason(of("generic_oscillator", {"runge_kutta_4", {}}, {{"gamma", 1000}})), ReturnCode::not_finite);
}

// ── thermostat ──────────────────────────────────────────────────────────────────────────────────────────────────────

TEST(Thermostat, AtTheEndsOfItsRanges) {
  for (const std::size_t index : runs::problem_card("thermostat").schemes)
    for (const double beta : {1e-3, 1.0, 1e3})
      for (const double scale : {1e-3, 0.1, 1e3})
        for (const double kappa : {5e-324, 0.5, 1.0})
          for (const double s : {-1e60, -1e3, 0.0, 1e3, 1e60}) {
            Request request =
                of("thermostat", {schemes()[index].id, {}}, {{"beta", beta}, {"scale", scale}, {"kappa", kappa}});
            request = ask(steps(at(request, {{"s", s}}), 100), {"moments"});
            go(request);
          }
  // In the limit of no density (κ → 0) s alone moves: s(t) = s₀ − t.
  Request request = of("thermostat", {"contact_splitting", {}}, {{"kappa", 1e-12}});
  const auto still = go(request);
  EXPECT_NEAR(still.outcome.final[0], 0.5, 1e-9);
  EXPECT_NEAR(still.outcome.final[2], -100, 1e-8);
}

TEST(Thermostat, AtRestCoolsForEver) {  // q = p = 0 is never left, and s falls
  const auto result = go(at(of("thermostat", {"contact_splitting", {}}, {}), {{"q", 0}, {"p", 0}}));
  EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed);
  EXPECT_EQ(result.outcome.final[0], 0);
  EXPECT_NEAR(result.outcome.final[2], -100, 1e-10);
}

// ── Lorenz ──────────────────────────────────────────────────────────────────────────────────────────────────────────

TEST(Lorenz, AtTheEndsOfItsRanges) {
  for (const std::size_t index : runs::problem_card("lorenz").schemes)
    for (const double sigma : {0.0, 1e3})
      for (const double rho : {-1e3, 0.0, 1e3})
        for (const double beta : {0.0, 1e3})
          go(steps(of("lorenz", {schemes()[index].id, {}}, {{"sigma", sigma}, {"rho", rho}, {"beta", beta}}), 500));
  const auto rest = go(of("lorenz", {"contact_splitting", {}}, {{"rho", 0.5}}));
  EXPECT_LT(std::abs(rest.outcome.final[0]), 0.05) << "heating too weak";
}

}  // namespace
