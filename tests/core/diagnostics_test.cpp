// Diagnostics against values that are known: those of the paper's orbit, and of runs whose errors are known.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/reference/reference.hpp"
#include "core/run/measures.hpp"
#include "tests/core/asking.hpp"

namespace {

using namespace least;
using namespace asks;

constexpr double period = 18.893743377439769;

// METHODS, section 3: leapfrog on the orbit of Nair, Ober-Blöbaum and Marsden.
TEST(Orbit, LeapfrogTurnsThePapersEllipse) {
  for (const auto& [h, rotation] : {std::pair{0.01, 0.0454}, std::pair{0.005, 0.0117}}) {
    Request request = asking("kepler", "leapfrog", "orbit");
    request.settings[0] = h;
    request.end = 1.2 * period;  // the ellipse turns backward: the starting direction is reached a little later
    EXPECT_EQ(ask(request, "orbit/revolutions"), 1);
    EXPECT_NEAR(ask(request, "orbit/apsidal_rotation"), rotation, 0.02 * rotation) << h;
    request.end = 11.5 * period;  // the mean of ten and more revolutions is the same
    EXPECT_GE(ask(request, "orbit/revolutions"), 10);
    EXPECT_NEAR(ask(request, "orbit/apsidal_rotation"), rotation, 0.02 * rotation) << h;
    EXPECT_NEAR(ask(request, "orbit/eccentricity"), 0.96083297, 1e-3);
    EXPECT_NEAR(ask(request, "orbit/semi_major_axis"), 2.0833333, 2e-2);
  }
}

TEST(Orbit, IsTheSameMirroredTurnedAndInSpace) {
  Request request = asking("kepler", "leapfrog", "orbit");
  request.end = 2.1 * period;
  const double plane = ask(request, "orbit/apsidal_rotation");
  runs::scene(request).initial = {0, -4, 0.1, -0.1};
  EXPECT_NEAR(ask(request, "orbit/apsidal_rotation"), -plane, 1e-10) << "mirrored: the other way round";
  runs::scene(request).initial = {4, 0, 0.1, -0.1};
  EXPECT_NEAR(ask(request, "orbit/apsidal_rotation"), plane, 1e-10) << "turned by a right angle";
  Request space = asking("kepler_3d", "leapfrog", "orbit");
  space.settings[0] = 0.01;
  space.end = 2.1 * period;
  const double c = 0.8, s = 0.6;
  runs::scene(space).initial = {0, -4 * c, -4 * s, -0.1, -0.1 * c, -0.1 * s};
  EXPECT_NEAR(ask(space, "orbit/apsidal_rotation"), -plane, 1e-8) << "about L, along which the motion is positive";
}

// Steps that are long where the body is slow sweep most of a revolution at a close passage.
TEST(Orbit, CountsRevolutionsWhateverAStepTurns) {
  for (const double e : {0.0, 0.9, 0.9999, 0.99999}) {
    Request request = asking("kepler", "time_transformed", "orbit");
    runs::set(request, "composition", "kahan_li_6");
    runs::set(request, "kappa", unknown);  // the energy
    for (const double direction : {1.0, -1.0}) {
      runs::scene(request).initial = {1 - e, 0, 0, direction * std::sqrt((1 + e) / (1 - e))};
      request.end = 20.5 * std::numbers::pi;
      EXPECT_EQ(ask(request, "orbit/revolutions"), 10) << e;
      runs::scene(request).initial = {-1 - e, 0, 0, direction * std::sqrt((1 - e) / (1 + e))};
      EXPECT_EQ(ask(request, "orbit/revolutions"), 10) << e << " from afar";
    }
  }
}

// The series of a circular orbit converges everywhere: steps are longer than a revolution.
TEST(Orbit, CountsRevolutionsWithinAStep) {
  for (const double end : {20.5 * std::numbers::pi, 1.9 * std::numbers::pi}) {
    Request request = asking("kepler", "taylor", "orbit");
    runs::scene(request).initial = {1, 0, 0, 1};
    runs::set(request, "order", 40);
    runs::set(request, "tolerance", 1e-3);
    request.end = end;
    const auto run = runs::go(request);
    EXPECT_LT(double(run.outcome.cost.steps), 1 + end / (2 * std::numbers::pi)) << "steps are shorter than a turn";
    EXPECT_EQ(runs::number(run.outcome.diagnostics, "orbit/revolutions"), std::floor(end / (2 * std::numbers::pi)));
    for (const char* expression : {"x-50", "t-5"}) {  // an event that never comes, and one within a step
      MeasureReader reader(*request.scene);
      EXPECT_FALSE(reader.read("end", expression));
      Request watched = request;
      watched.events = {{0, true}};
      watched.watched = reader.made();
      const auto same = runs::go(watched);
      EXPECT_EQ(runs::number(same.outcome.diagnostics, "orbit/revolutions"),
                std::floor(same.outcome.t / (2 * std::numbers::pi)))
          << expression << " until " << same.outcome.t;
    }
  }
}

TEST(Orbit, ClosesWhereTheSchemeIsAccurate) {
  Request request = asking("kepler", "leapfrog", "orbit");
  runs::scene(request).initial = {1, 0, 0, 1.1};
  request.settings = {0.01, 7};  // kahan_li_8
  EXPECT_LT(ask(request, "orbit/closure"), 1e-10);
  EXPECT_LT(std::abs(ask(request, "orbit/apsidal_rotation")), 1e-11);
  request.settings = {0.05, 0};
  EXPECT_GT(ask(request, "orbit/closure"), 1e-6);
  EXPECT_NEAR(ask(request, "orbit/semi_major_axis"), 1 / (2 - 1.21), 1e-3);
}

TEST(Orbit, OfACircleHasNoApsisToTurn) {
  Request request = asking("kepler", "leapfrog", "orbit");
  runs::scene(request).initial = {1, 0, 0, 1};
  EXPECT_TRUE(std::isnan(ask(request, "orbit/apsidal_rotation")));
  EXPECT_GT(ask(request, "orbit/revolutions"), 5);
  runs::scene(request).initial = {1, 0, 0, 1.001};
  EXPECT_FALSE(std::isnan(ask(request, "orbit/apsidal_rotation")));
}

TEST(Orbit, IsNotDefinedBeforeARevolutionNorOnAStraightLine) {
  Request request = asking("kepler", "leapfrog", "orbit");
  request.end = 5;
  EXPECT_TRUE(std::isnan(ask(request, "orbit/closure")));
  runs::scene(request).initial = {0, -4, 0, 0.5};
  request.end = 1;
  EXPECT_EQ(ask(request, "orbit/revolutions"), 0);
}

TEST(Energy, StaysBoundedUnderLeapfrogAndDriftsUnderRungeKutta) {
  Request request = asking("pendulum", "leapfrog", "energy");
  request.settings[0] = 0.2;
  request.end = 200;
  const double short_run = ask(request, "energy/max_abs_error");
  request.end = 20'000;
  EXPECT_LT(ask(request, "energy/max_abs_error"), 1.01 * short_run);
  EXPECT_LT(std::abs(ask(request, "energy/drift_per_time")), 1e-8);
  Request control = asking("pendulum", "runge_kutta_4", "energy");
  control.settings[0] = 0.2;
  control.end = 200;
  const double early = ask(control, "energy/max_abs_error");
  control.end = 20'000;
  EXPECT_GT(ask(control, "energy/max_abs_error"), 50 * early);
  EXPECT_LT(ask(control, "energy/drift_per_time"), -1e-7) << "it loses energy";
}

// A drive changes the energy all the time: within steps as long as the motion oscillates, too, and in proportion to
// their length. The values are compared with steps of a thousandth.
TEST(Energy, OfADrivenMotionIsLookedAtWithinLongSteps) {
  const auto driven = [](const char* scheme) {
    Request request = asking("driven_oscillator", scheme, "energy");
    for (const auto& [name, value] :
         {std::pair{"damping", 0.0}, {"amplitude", 0.7}, {"frequency", 1.3}, {"phase", 0.4}})
      runs::set(request, name, value);
    return request;
  };
  for (const double end : {7.0, 31.0, 200.0}) {
    Request fine = driven("contact_leapfrog");
    runs::set(fine, "step", 1e-3);
    fine.end = end;
    for (const auto& [scheme, tolerance] : {std::pair{"taylor", 1e-12},
                                            {"taylor", 1e-5},
                                            {"dormand_prince_5", 1e-7},
                                            {"fehlberg_78", 1e-6},
                                            {"bulirsch_stoer", 1e-6}}) {
      Request request = driven(scheme);
      runs::set(request, "tolerance", tolerance);
      request.end = end;
      for (const char* number : {"energy/max_abs_error", "energy/max_rel_error", "energy/drift_per_time"})
        EXPECT_NEAR(ask(request, number) / ask(fine, number), 1, 0.02) << number << ' ' << scheme << ' ' << end;
      EXPECT_EQ(word(request, "energy/relative_to"), word(fine, "energy/relative_to")) << scheme;
    }
  }
}

TEST(Energy, OfTheOscillatorUnderExplicitEulerGrowsAsItMust) {  // by 1 + h² a step
  Request request = asking("harmonic_oscillator", "explicit_euler", "energy");
  request.until_steps = true;
  request.steps = 50;
  const double grown = 0.5 * std::pow(1.01, 50);
  double q = 1, p = 0, kinetic = 0;
  for (int n = 0; n < 50; ++n) {
    const double force = -q;
    q += 0.1 * p;
    p += 0.1 * force;
    kinetic = std::max(kinetic, p * p / 2);
  }
  EXPECT_NEAR(ask(request, "energy/final"), grown, 1e-12);
  EXPECT_NEAR(ask(request, "energy/max_abs_error"), grown - 0.5, 1e-12);
  EXPECT_NEAR(ask(request, "energy/max_rel_error"), (grown - 0.5) / kinetic, 1e-12);
  EXPECT_DOUBLE_EQ(ask(request, "energy/initial"), 0.5);
}

// On a parabola the energy is zero, and its error is not.
TEST(Energy, ThatBeginsAtZeroIsHeldAgainstTheLargestKineticEnergy) {
  Request request = asking("kepler", "leapfrog", "energy");
  runs::scene(request).initial = {1, 0, 0, std::sqrt(2.0)};  // away from the centre: K is largest at the start
  EXPECT_LT(std::abs(ask(request, "energy/initial")), 1e-15);
  EXPECT_GT(ask(request, "energy/max_abs_error"), 1e-6);
  EXPECT_NEAR(ask(request, "energy/max_rel_error"), ask(request, "energy/max_abs_error"), 1e-9) << "K = 1 there";
  EXPECT_EQ(word(request, "energy/relative_to"), "largest kinetic energy");
  runs::scene(request).initial = {1, 0, 0, 0.1};
  request.end = 0.1;
  EXPECT_EQ(word(request, "energy/relative_to"), "initial energy");
  const double e0 = std::abs(ask(request, "energy/initial"));
  EXPECT_NEAR(ask(request, "energy/max_rel_error") * e0, ask(request, "energy/max_abs_error"), 1e-18);
  Request rest = asking("harmonic_oscillator", "leapfrog", "energy");
  runs::scene(rest).initial = {0, 0};
  EXPECT_TRUE(std::isnan(ask(rest, "energy/max_rel_error"))) << "relative to nothing";
  EXPECT_EQ(word(rest, "energy/relative_to"), "");
  EXPECT_EQ(word(asking("generic_oscillator", "contact_splitting", "energy"), "energy/relative_to"), "largest energy");
}

TEST(Momenta, AreKeptBySymplecticSchemesAndNotByOthers) {
  for (const std::string_view scheme : {"leapfrog", "symplectic_euler", "ruth_3", "variational_midpoint", "galerkin_4"})
    EXPECT_LT(ask(asking("kepler", scheme, "momenta"), "momenta/angular_momentum/max_abs_error"), 1e-12) << scheme;
  for (const std::string_view scheme : {"explicit_euler", "explicit_midpoint", "runge_kutta_4"})
    EXPECT_GT(ask(asking("kepler", scheme, "momenta"), "momenta/angular_momentum/max_abs_error"), 1e-8) << scheme;
}

TEST(Structure, IsMeasuredNotDeclared) {
  EXPECT_LT(ask(asking("henon_heiles", "leapfrog", "structure"), "structure/max_defect"), 1e-13);
  Request request = asking("henon_heiles", "runge_kutta_4", "structure");
  request.settings[0] = 0.5;
  EXPECT_GT(ask(request, "structure/max_defect"), 1e-4);
}

TEST(Structure, IsThatOfTheStepsThatWereTaken) {
  Request request = asking("harmonic_oscillator", "runge_kutta_4", "structure");
  request.settings[0] = 3;  // beyond the stability bound: no step is taken
  const auto none = runs::go(request);
  EXPECT_EQ(none.outcome.cost.steps, 0);
  EXPECT_TRUE(std::isnan(runs::number(none.outcome.diagnostics, "structure/max_defect")));
  Request failing = asking("henon_heiles", "variational_midpoint", "structure");
  runs::scene(failing).initial = {0, 0.1, 2, 0};
  const auto some = runs::go(failing);
  EXPECT_NE(some.outcome.stop.reason, ReturnCode::completed);
  EXPECT_GT(some.outcome.cost.steps, 10);
  EXPECT_GE(runs::number(some.outcome.diagnostics, "structure/max_defect"), 0);
}

// H^−(n+1) η∧(dη)ⁿ is conserved only where H is conserved and not zero; elsewhere there is nothing to measure.
TEST(Volume, HasNoResidualWhereThereIsNoInvariant) {
  for (const char* driven : {"driven_oscillator", "modulated_oscillator", "lane_emden", "perturbed_kepler"}) {
    Request request = asking(driven, "contact_splitting", "volume");
    request.end = 5;
    EXPECT_TRUE(std::isnan(ask(request, "volume/invariant_residual"))) << driven;
    EXPECT_NE(word(request, "volume/reason").find("time"), std::string::npos) << driven;
  }
  Request request = asking("cosmological_oscillator", "contact_splitting", "volume");
  runs::scene(request).initial = {0.6, 0.8, 1};  // p²/2 + q²/2 + s²/2 = R
  EXPECT_TRUE(std::isnan(ask(request, "volume/invariant_residual")));
  EXPECT_NE(word(request, "volume/reason").find("zero"), std::string::npos);
  EXPECT_LT(ask(request, "volume/max_defect"), 1e-12) << "of the map, which is there all the same";
  runs::scene(request).initial = {0.5, 0.3, 0.1};
  request.end = 2;
  EXPECT_GT(ask(request, "volume/invariant_residual"), 1e-9);
  EXPECT_LT(ask(request, "volume/invariant_residual"), 1e-2);
  EXPECT_EQ(word(request, "volume/reason"), "");
  EXPECT_NE(word(asking("damped_oscillator", "bulirsch_stoer", "volume"), "volume/reason"), "") << "no derivatives";
}

TEST(Error, OfTheOscillatorUnderLeapfrogIsItsPhaseError) {
  // cos(ω′t) against cos t with ω′ = (2/h) asin(h/2) = 1 + h²/24 + …; the momentum carries the factor √(1 − h²/4).
  Request request = asking("harmonic_oscillator", "leapfrog", "error");
  request.settings[0] = 0.1;
  request.end = 20;
  const double phase = 20 * (2 / 0.1) * std::asin(0.05);
  const double q = std::cos(phase) - std::cos(20.0);
  const double p = -std::sin(phase) * std::sqrt(1 - 0.0025) + std::sin(20.0);
  EXPECT_NEAR(ask(request, "error/final"), std::max(std::abs(q), std::abs(p)), 1e-12);
  EXPECT_GE(ask(request, "error/max"), ask(request, "error/final"));
  EXPECT_LT(ask(request, "error/uncertainty"), 1e-15);
}

TEST(Error, ComesFromTheReferenceStatesWhereThereIsNoClosedForm) {
  Request request = asking("double_pendulum", "galerkin_4", "error");
  request.end = 20;
  request.limits.seconds = 60;  // half of it suffices for the true solution with a sanitizer, too
  const auto result = runs::go(request);
  const double reference[] = {-0.47540433018888473236, -0.35081662361852581039, -1.7417567272239908697,
                              -0.83762857573527496312};
  double difference = 0;
  for (std::size_t i = 0; i < 4; ++i)
    difference = std::max(difference, std::abs(result.outcome.final[i] - reference[i]));
  EXPECT_NEAR(runs::number(result.outcome.diagnostics, "error/final"), difference / 1.7417567272239908697, 1e-15);
  EXPECT_LT(runs::number(result.outcome.diagnostics, "error/uncertainty"), 2e-16);
}

TEST(Error, MeansNothingWhereTheTruthIsNotFinite) {
  const State<1> x{0, {1}, {0}, {}};
  for (const double broken : {std::nan(""), HUGE_VAL}) {
    EXPECT_FALSE(std::isfinite(state_error(x, State<1>{0, {broken}, {0}, {}})));
    EXPECT_FALSE(std::isfinite(state_error(x, State<1>{0, {1}, {broken}, {}})));
  }
  EXPECT_EQ(state_error(x, State<1>{0, {1}, {-4}, {}}), 1);
}

TEST(Error, CountsFromTheStartOfTheRun) {
  Request request = asking("henon_heiles", "leapfrog", "error");
  request.end = 20;
  const double early = ask(request, "error/max");
  runs::scene(request).start = 1000;
  request.end = 1020;
  EXPECT_NEAR(ask(request, "error/max"), early, 1e-9 * early);
}

TEST(Error, OfARunThatWasCutShortIsThatOfTheShortRun) {
  Request request = asking("harmonic_oscillator", "leapfrog", "error");
  request.until_steps = true;
  request.steps = 1015;
  const double asked = ask(request, "error/max");
  request.steps = 10'000'000;
  request.limits.steps = 1015;
  const auto cut = runs::go(request);
  EXPECT_EQ(cut.outcome.stop.reason, ReturnCode::step_limit);
  EXPECT_EQ(runs::number(cut.outcome.diagnostics, "error/max"), asked);
}

TEST(Error, SaysWhenTheReferenceWasNotFinished) {
  Request request = asking("double_pendulum", "variational_midpoint", "error");
  request.settings = {0.02, 0};
  request.end = 200;
  request.limits.seconds = 0.05;
  const runs::TurnedClock clock(1e-3);
  const auto result = runs::go(request);
  EXPECT_TRUE(std::isnan(runs::number(result.outcome.diagnostics, "error/max")));
  ASSERT_FALSE(result.outcome.warnings.empty());
  EXPECT_EQ(result.outcome.warnings.back().code, "reference_not_finished");
}

TEST(Diagnostics, AreNotComputedUnlessAsked) {
  EXPECT_TRUE(runs::go(runs::defaults("kepler", "leapfrog")).outcome.diagnostics.empty());
}

}  // namespace
