// Schemes that choose their own steps on extreme orbits: eccentric, unbound and straight ones, and orbits on which the
// hybrid is never or always in its fast mode; beside each extreme a benign twin. Settings, budgets and samples are
// tested in clock_runs_test.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/extremes/asking.hpp"

namespace {

using namespace least;
using namespace asking;

Request only_final(Request request) {
  runs::only_final(request);
  return ask(request, {"energy", "error"});
}
/// ellipse() requests the planar orbit with a = 1 and μ = 1 from its apoapsis below the centre; the period is 2π.
Request ellipse(double e, const Scheme& scheme) {
  return at(of("kepler", scheme, {}), {{"x", 0}, {"y", -1 - e}, {"px", -std::sqrt((1 - e) / (1 + e))}, {"py", 0}});
}
/// hyperbola() requests the orbit with E₀ = 0.475, e = 1.073; with `side` −1 its mirror image.
Request hyperbola(const Scheme& scheme, double side = 1) {
  return at(of("kepler", scheme, {}), {{"x", 0}, {"y", -4}, {"px", -0.1 * side}, {"py", 1.2}});
}
std::int64_t switches(const runs::Result& result) {
  return std::ranges::count_if(result.outcome.events, [](const Report& event) {
    return std::get<std::string>(std::get<std::vector<Report>>(event.value)[1].value) == "switch";
  });
}

// ── eccentric, unbound ──────────────────────────────────────────────────────────────────────────────────────────────

TEST(ClockEccentricity, NearlyOne) {
  struct Row {
    Scheme scheme;
    double error, energy;  // along one period; that of the energy grows as 1/r at the periapsis
  };
  for (const auto& [scheme, error, energy] :
       {Row{{"jacobi_maupertuis"}, 5e-5, 4e-9},
        Row{{"jacobi_maupertuis", {{"critical_kinetic_energy", 0.1}}}, 5e-5, 4e-9},
        Row{{"jacobi_maupertuis", {{"critical_kinetic_energy", 5}}}, 1.5e-4, 5e-4},
        Row{{"jacobi_maupertuis", {{"order", 6}}}, 1e-6, 1e-11}, Row{{"jacobi_maupertuis", {{"order", 2}}}, 0.05, 1e-4},
        Row{{"time_transformed", {{"sigma", 0.01}, {"kappa", null}}}, 8e-6, 1e-10},
        Row{{"time_transformed", {{"kappa", null}, {"composition", 4}}}, 1e-13, 2e-10},
        Row{{"adaptive_verlet"}, 6e-6, 0.08}})
    for (const double e : {0.99, 0.999, 0.9999}) {
      const auto result = go(only_final(until(ellipse(e, scheme), 2 * pi)));
      const std::string what = std::string(scheme.id) + ' ' + std::to_string(e);
      EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << what;
      EXPECT_LT(number(result, "error/final"), error) << what;
      EXPECT_LT(number(result, "energy/max_abs_error"), energy) << what;
      for (const auto& warning : result.outcome.warnings) {  // a small delay is a large error where the body is fast
        EXPECT_EQ(warning.code, "large_error") << what;
        EXPECT_GT(number(result, "error/max"), 0.1) << what;
      }
      EXPECT_LT(result.outcome.cost.steps, 6000) << what;
    }
}

TEST(ClockEccentricity, AStepOfAnyLengthIsHalvedUntilItTurnsLittle) {
  for (const double theta : {1.0, 1e3, 1e300}) {
    const auto control = [&](Request request, double period) {
      return number(go(only_final(until(set(request, {{"theta", theta}}), period))), "error/final");
    };
    EXPECT_LT(control(of("kepler", {"jacobi_maupertuis"}, {}), 18.893743377439769), 4e-5) << theta;  // e = 0.961
    for (const double e : {0.99, 0.9999})
      EXPECT_LT(control(ellipse(e, {"jacobi_maupertuis"}), 2 * pi), 8e-5) << theta << ' ' << e;
    for (const double e : {0.5, 0.961, 0.9999})  // without control: any status, but finite numbers
      for (const double order : {2, 4, 6})
        go(set(ellipse(e, {"jacobi_maupertuis"}), {{"theta", theta}, {"alpha_max", null}, {"order", order}}));
  }
}

TEST(ClockUnbound, AndRetrogradeOrbits) {
  struct Row {
    Scheme scheme;
    double error;  // along the passage
  };
  for (const auto& [scheme, error] :
       {Row{{"jacobi_maupertuis"}, 1.5e-5}, Row{{"jacobi_maupertuis", {{"order", 6}}}, 7e-8},
        Row{{"time_transformed", {{"sigma", 0.01}, {"kappa", null}}}, 8e-4},
        Row{{"time_transformed", {{"kappa", null}, {"composition", 4}}}, 1e-12}, Row{{"adaptive_verlet"}, 2e-5}}) {
    Request request = only_final(until(hyperbola(scheme), 10));
    const auto there = go(request), mirrored = go(only_final(until(hyperbola(scheme, -1), 10)));
    for (const auto* result : {&there, &mirrored}) {
      EXPECT_EQ(result->outcome.stop.reason, ReturnCode::completed) << scheme.id;
      EXPECT_LT(number(*result, "error/max"), error) << scheme.id;
    }
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_NEAR(mirrored.outcome.final[i], there.outcome.final[i] * (i % 2 == 0 ? -1 : 1), 1e-10) << scheme.id;
    const double last[] = {7.0549956, -5.8577964, 0.80297945, -0.72341503};  // the reference state at t = 10
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(there.outcome.final[i], last[i], 1e-4) << scheme.id;
  }
}

// From σ√(2E₀) = 2 on a step jumps to the other branch of the hyperbola.
TEST(ClockUnbound, NoStepLeadsToTheOtherBranch) {
  const double level = 0.475, bound = 2 / std::sqrt(2 * level);
  for (const double kappa : {null, -level, -level * (1 + 1e-12), -level * (1 + 1e-6), -level * (1 - 1e-6)})
    for (const double sigma : {1.001 * bound, 1.5 * bound, 2 * bound, 10.0, 1e3, 1e100, 1e300}) {
      const auto result = go(only_final(hyperbola({"time_transformed", {{"sigma", sigma}, {"kappa", kappa}}})));
      EXPECT_EQ(result.outcome.stop.reason, ReturnCode::singular) << kappa << ' ' << sigma;
    }
  for (double composition = 0; composition < 9; ++composition)
    for (const double sigma : {0.01, 0.1, 1.0, 2.0, 3.0, 5.0}) {
      const Scheme scheme{"time_transformed", {{"sigma", sigma}, {"kappa", null}, {"composition", composition}}};
      const auto result = go(only_final(hyperbola(scheme)));
      if (result.outcome.stop.reason == ReturnCode::completed) {
        EXPECT_LT(number(result, "error/final"), 0.05) << composition << ' ' << sigma;
      } else {
        EXPECT_GE(sigma, 1) << composition;
      }
    }
}

// ── straight into the centre ────────────────────────────────────────────────────────────────────────────────────────

/// collision() returns when a body at the distance r with the radial velocity v falls into the centre; μ = 1.
double collision(double r, double v) {
  const double a = 1 / (2 / r - v * v), eta = std::acos(1 - r / a), part = eta - std::sin(eta);
  return a * std::sqrt(a) * (v > 0 ? 2 * pi - part : part);
}
struct Line {
  std::string_view problem;
  std::vector<double> start;
  double r, v;
};
std::vector<Line> lines() {
  return {{"kepler", {0, -4, 0, 0.1}, 4, -0.1},       {"kepler", {0, -4, 0, -0.1}, 4, 0.1},
          {"kepler", {4, 0, 0.1, 0}, 4, 0.1},         {"kepler", {-4, 0, 0.1, 0}, 4, -0.1},
          {"kepler", {1, 0, 0, 0}, 1, -0.0},          {"kepler_3d", {0, 0, 3, 0, 0, -0.3}, 3, -0.3},
          {"kepler_3d", {0, -2, 0, 0, 0, 0}, 2, -0.0}};
}
Request along(const Line& line, const Scheme& scheme) {
  Request request = of(line.problem, scheme, {});
  runs::scene(request).initial = line.start;
  request.limits.steps = 200'000;
  return until(only_final(request), collision(line.r, line.v) + 3);
}

TEST(ClockCollision, EndsInAnUnderflow) {
  for (const Line& line : lines())
    for (const double order : {4, 6})
      for (const double midpoint : {0, 1}) {
        const Scheme scheme{"jacobi_maupertuis", {{"order", order}, {"quadrature", midpoint}}};
        const Request request = along(line, scheme);
        const auto result = go(request);
        const std::string what =
            std::string(line.problem) + ' ' + std::to_string(line.start[0]) + " order " + std::to_string(order);
        ASSERT_EQ(result.outcome.stop.reason, ReturnCode::parameter_step_underflow) << what;
        EXPECT_NEAR(result.outcome.t, collision(line.r, line.v), 1e-5) << what;
        EXPECT_EQ(reason(until(request, collision(line.r, line.v) - 0.1)), ReturnCode::completed) << what;
      }
}

// In the limit e → 1 the ellipse turns back at the centre. With κ = −E₀ steps follow it through the centre; with other
// values the state behind the centre is right or the run has ended.
TEST(ClockCollision, TurnsBackOrEnds) {
  for (const Line& line : lines()) {
    for (const double sigma : {0.01, 0.05}) {
      const Scheme scheme{"time_transformed", {{"sigma", sigma}, {"kappa", null}, {"composition", 4}}};
      const auto result = go(along(line, scheme));
      EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << line.start[0];
      EXPECT_LT(number(result, "error/final"), 1e-9) << line.start[0];
    }
    for (const Scheme& scheme : {Scheme{"time_transformed"}, Scheme{"time_transformed", {{"composition", 4}}},
                                 Scheme{"adaptive_verlet"}, Scheme{"adaptive_verlet", {{"monitor", 0}}}}) {
      const auto result = go(along(line, scheme));
      const ReturnCode why = result.outcome.stop.reason;
      if (why == ReturnCode::completed) {
        EXPECT_EQ(scheme.id, "time_transformed");
        EXPECT_LT(number(result, "error/final"), 2e-3) << line.start[0];
      } else {
        EXPECT_TRUE(why == ReturnCode::singular || why == ReturnCode::not_finite || why == ReturnCode::unstable_step);
        EXPECT_NEAR(result.outcome.t, collision(line.r, line.v), 0.05) << line.start[0];
      }
    }
  }
}

// Steps shorten until the time no longer changes by them, just before the collision or, by their error, behind it.
TEST(ClockCollision, OfAdaptiveStepsEndsWhereItHappens) {
  for (const Line& line : lines())
    for (const std::string_view scheme : adaptive)
      for (const double tolerance : {1.1e-15, 1e-12, 1e-8, 1e-4}) {
        Request request = along(line, {scheme, {{"tolerance", tolerance}}});
        request.diagnostics.clear();
        const auto result = go(request);
        const std::string what = std::string(line.problem) + ' ' + std::string(scheme) + std::to_string(tolerance);
        const double when = collision(line.r, line.v);
        ASSERT_EQ(result.outcome.stop.reason, ReturnCode::singular) << what;
        EXPECT_NEAR(result.outcome.t, when, when * std::max(10 * tolerance, 1e-10)) << what;
        EXPECT_NEAR(result.outcome.stop.singular_at.value_or(0), when, 1e-4 * when) << what;
        EXPECT_NE(result.outcome.stop.detail.text().find("tolerance"), std::string::npos) << result.outcome.stop.detail;
        EXPECT_EQ(reason(until(request, when - 0.1)), ReturnCode::completed) << what;
      }
}

// On an oblique line round-off and the error of the scheme give the orbit an angular momentum: it may turn back.
TEST(ClockCollision, AlongAnyLineEndsOrTurnsBack) {
  int ended = 0;
  for (int k = 0; k < 24; ++k) {  // every third a diagonal
    const double angle = (k % 3 == 0 ? 0 : 0.13) + pi / 4 + k * pi / 6, c = std::cos(angle), s = std::sin(angle);
    const auto result = go(along({"kepler", {2 * c, 2 * s, -0.1 * c, -0.1 * s}, 2, -0.1}, {"jacobi_maupertuis"}));
    if (result.outcome.stop.reason == ReturnCode::parameter_step_underflow)
      ++ended;
    else
      EXPECT_LT(number(result, "error/final"), 2e-3) << angle;
  }
  EXPECT_GE(ended, 12);
}

// ── the threshold ───────────────────────────────────────────────────────────────────────────────────────────────────

TEST(ClockThreshold, BelowEveryKineticEnergyOfTheOrbit) {
  const auto with = [](double threshold) {
    return columns(until(of("kepler", {"jacobi_maupertuis", {{"critical_kinetic_energy", threshold}}}, {}), 18.9),
                   {"t", "mode", "parameter", "step_size"});
  };
  const Request request = ask(with(0.0047), {"error"});
  const auto result = go(request);
  EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed);
  EXPECT_EQ(switches(result), 1);
  for (std::size_t i = 1; i < result.rows.size(); ++i) {
    EXPECT_EQ(value(request, result.rows[i], "mode"), 1) << i;
    EXPECT_TRUE(value(request, result.rows[i], "parameter") == 0 || value(request, result.rows[i], "parameter") == 1);
  }
  EXPECT_LT(number(result, "error/max"), 4e-6);
  EXPECT_EQ(go(with(0)).outcome.final, result.outcome.final) << "a threshold of 0 is exceeded as well";
  EXPECT_EQ(go(with(5e-324)).outcome.final, result.outcome.final);
}

TEST(ClockThreshold, NeverReachedLeavesTheComposedScheme) {
  for (const auto& [order, composition] : {std::pair{2.0, "none"}, {4.0, "suzuki_4"}, {6.0, "kahan_li_6"}})
    for (const std::string_view id : {"kepler", "pendulum", "henon_heiles"}) {
      const auto slow = [&](double threshold) {
        return go(until(of(id, {"jacobi_maupertuis", {{"critical_kinetic_energy", threshold}, {"order", order}}}, {}),
                        10.003));
      };
      const auto never = slow(null), high = slow(1e300);
      EXPECT_EQ(never.outcome.final, high.outcome.final) << id;
      EXPECT_EQ(never.outcome.cost.force_evaluations, high.outcome.cost.force_evaluations);
      EXPECT_EQ(switches(never), 0);
      // One run ends by dense output, the other by a shorter step: they agree at whole steps only.
      const auto leapfrog = go(until(choose(of(id, {"leapfrog"}, {}), {{"composition", composition}}), 10.003));
      ASSERT_GE(never.rows.size() + 1, leapfrog.rows.size()) << id << ' ' << order;
      for (std::size_t k = 0; k + 1 < leapfrog.rows.size(); k += 10)
        for (std::size_t i = 0; i < leapfrog.rows[k].size(); ++i)
          EXPECT_NEAR(never.rows[k][i], leapfrog.rows[k][i], 2e-12) << id << ' ' << order << ' ' << k;
    }
}

TEST(ClockThreshold, AMotionThatComesToRestBelowIt) {  // with none there is no way back to steps in time
  const auto with = [](double threshold) {
    return go(of("harmonic_oscillator", {"jacobi_maupertuis", {{"critical_kinetic_energy", threshold}}}, {}));
  };
  const auto result = with(0);
  ASSERT_EQ(result.outcome.stop.reason, ReturnCode::parameter_step_underflow);
  EXPECT_NEAR(result.outcome.t, pi, 1e-3) << "the turning point";
  EXPECT_EQ(with(0.1).outcome.stop.reason, ReturnCode::completed);
}

TEST(ClockThreshold, IsNotCrossedToAndFro) {  // K swings between 0.4999 and 0.5001
  const double e = 1e-4;
  const auto chattering = [&](double hysteresis, double order) {
    const Scheme scheme{"jacobi_maupertuis",
                        {{"critical_kinetic_energy", 0.4999}, {"hysteresis", hysteresis}, {"order", order}}};
    const double fast = std::sqrt((1 + e) / (1 - e));
    const auto result =
        go(only_final(until(at(of("kepler", scheme, {}), {{"x", 1 - e}, {"y", 0}, {"px", 0}, {"py", fast}}), 20 * pi)));
    EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed);
    return switches(result);
  };
  for (const double order : {2, 4, 6}) EXPECT_LE(chattering(0.9, order), 4) << order;
  EXPECT_GT(chattering(1, 2), 10);
}

}  // namespace
