// `auto` on scenes in any units, on motions that are long or stiff for the time allowed, up to events, and over kinks:
// it returns a run in time, and what it says of the error is right.
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "core/run/measures.hpp"
#include "core/study/error_study.hpp"
#include "tests/extremes/asking.hpp"
#include "tests/support/texts.hpp"

namespace {

using namespace least;
using asking::warned;
using texts::Definition;

const std::atomic<bool> never_cancelled{false};
constexpr auto potential = Definition::Kind::potential, hamiltonian = Definition::Kind::hamiltonian;

/// typed() requests a scene as text; variables that `start` does not name begin at 0.
Request typed(const Definition& definition, std::initializer_list<NamedValue> start, double end) {
  Request request = texts::typed_as(runs::defaults("harmonic_oscillator", "taylor"), texts::mechanics_of(definition));
  std::ranges::fill(runs::scene(request).initial, 0.0);
  for (const auto& [name, value] : start) runs::begin(request, name, value);
  request.end = end;
  runs::only_final(request);
  return request;
}
Request stopping_at(Request request, const char* expression, int direction) {
  MeasureReader reader(*request.scene);
  if (const auto fault = reader.read("end", expression)) throw std::invalid_argument(fault->detail);
  request.watched = reader.made();
  request.events = {{direction, true}};
  return request;
}

struct Chosen {
  Advice advice;
  Solution outcome;
};
/// by_auto() gives the search and the run one time limit together, as the service does.
Chosen by_auto(Request request, double accuracy) {
  const double begun = steady_seconds();
  Advice advice = advise(request, {accuracy, 0, {}}, never_cancelled);
  if (!advice.choice) throw std::runtime_error("no choice: " + advice.reason.text());
  request.scheme = advice.choice->scheme;
  request.settings = advice.choice->settings;
  request.limits.seconds -= steady_seconds() - begun;
  return {std::move(advice), runs::go(request).outcome};
}
double final_of(const Request& request, const Solution& outcome, std::string_view name) {
  return outcome.final[runs::position(runs::card(request).variables, name, &VariableCard::name)];
}

// ---- units

// From rest over a millionth of a metre in a constant field: the momentum is 10¹³ times the position.
TEST(AutoUnits, AnElectronIsHeldAgainstItsPlaceAndItsMomentum) {
  const double a = 1.7588200107721635e20;
  for (const double gap : {1e-6, 3e-9, 2e-3}) {
    const double arrival = std::sqrt(2 * gap / a);
    const Request request =
        stopping_at(typed(texts::of(hamiltonian, {"x"}, {{"a", a}}, "px^2/2-a*x"), {}, 1.5 * arrival),
                    ("x-" + std::to_string(gap * 1e9) + "e-9").c_str(), 1);
    const Chosen chosen = by_auto(request, 1e-6);
    EXPECT_TRUE(chosen.advice.met && chosen.advice.known) << chosen.advice.reason;
    EXPECT_EQ(chosen.outcome.event, "end") << chosen.advice.reason;
    EXPECT_NEAR(chosen.outcome.t / arrival, 1, 1e-6) << chosen.advice.reason;
    EXPECT_NEAR(final_of(request, chosen.outcome, "x") / gap, 1, 1e-6);
  }
}

/// on_ellipse() returns the position on a Kepler ellipse, from the periapsis, in units of the semi-major axis and the
/// mean motion.
std::array<double, 2> on_ellipse(double e, double mean) {
  double anomaly = mean;
  for (int i = 0; i < 50; ++i) anomaly -= (anomaly - e * std::sin(anomaly) - mean) / (1 - e * std::cos(anomaly));
  return {std::cos(anomaly) - e, std::sqrt(1 - e * e) * std::sin(anomaly)};
}

// Planets and moons in metres and seconds, from a few revolutions of a moon to a part of one of a distant planet.
TEST(AutoUnits, OrbitsInMetresAndSeconds) {
  std::mt19937_64 random(20);
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
  for (int k = 0; k < 6; ++k) {
    const double mu = std::pow(10, uniform(13, 20.5)), a = std::pow(10, uniform(7, 12.5)), e = uniform(0, 0.7);
    const double motion = std::sqrt(mu / (a * a * a)), angle = uniform(0.5, 8);
    const Request request =
        typed(texts::of(potential, {"x", "y"}, {{"mu", mu}}, "-mu/sqrt(x^2+y^2)"),
              {{"x", a * (1 - e)}, {"py", a * motion * std::sqrt((1 + e) / (1 - e))}}, angle / motion);
    const Chosen chosen = by_auto(request, 1e-6);
    EXPECT_TRUE(chosen.advice.met && chosen.advice.known) << chosen.advice.reason;
    ASSERT_EQ(chosen.outcome.stop.reason, ReturnCode::completed) << chosen.outcome.stop.detail;
    const auto [x, y] = on_ellipse(e, angle);
    EXPECT_NEAR(final_of(request, chosen.outcome, "x") / a, x, 4e-6) << chosen.advice.reason;
    EXPECT_NEAR(final_of(request, chosen.outcome, "y") / a, y, 4e-6) << chosen.advice.reason;
  }
}

// A comet: its momentum is wrong for a short while only, at the periapsis, and in metres and seconds hardly any number
// changes there. The potential of the sun is softened, so that no scheme follows the orbit exactly.
TEST(AutoUnits, ErrorsOfAPassageAreFoundInMetresAndSeconds) {
  Request request = typed(texts::of(potential, {"x", "y"}, {{"mu", 1.327e20}}, "-mu/sqrt(x^2+y^2+1e16)"),
                          {{"x", 4e12}, {"py", 500}}, 3.2e9);
  request.norm = Norm::relative;
  runs::ask(request, "error");
  for (const double accuracy : {1e-4, 1e-6, 1e-8}) {
    const Chosen chosen = by_auto(request, accuracy);
    EXPECT_TRUE(chosen.advice.met && chosen.advice.known) << chosen.advice.reason;
    const double error = runs::number(chosen.outcome.diagnostics, "error/max");
    EXPECT_LT(error, 1.1 * accuracy) << chosen.advice.reason;
    EXPECT_NEAR(chosen.advice.estimated_error / error, 1, 0.15) << chosen.advice.reason;
  }
}

// Atoms in a trap: all numbers of the state are far below 1.
TEST(AutoUnits, AtomsInATrap) {
  std::mt19937_64 random(21);
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
  for (int k = 0; k < 6; ++k) {
    const double m = std::pow(10, uniform(-27, -24)), w = std::pow(10, uniform(4, 8)),
                 size = std::pow(10, uniform(-9, -4));
    const double angle = uniform(1, 20);
    const Request request =
        typed(texts::of(hamiltonian, {"x"}, {{"m", m}, {"w", w}}, "px^2/(2*m)+m*w^2*x^2/2"), {{"x", size}}, angle / w);
    const Chosen chosen = by_auto(request, 1e-6);
    EXPECT_TRUE(chosen.advice.met && chosen.advice.known) << chosen.advice.reason;
    EXPECT_NEAR(final_of(request, chosen.outcome, "x") / size, std::cos(angle), 1.2e-6) << chosen.advice.reason;
    EXPECT_NEAR(final_of(request, chosen.outcome, "px") / (m * w * size), -std::sin(angle), 1.2e-6);
  }
}

// A radial momentum that is only rounding, and a plane that a motion never leaves, do not count as errors.
TEST(AutoUnits, WhatStaysAtRestIsNoFault) {
  const double r = 1.3, mu = 0.7;
  const Request circle = typed(texts::flow({"r", "phi", "w", "l"}, {{"mu", mu}},
                                           {{"r", "w"}, {"phi", "l/r^2"}, {"w", "l^2/r^3-mu/r^2"}, {"l", "0"}}),
                               {{"r", r}, {"l", std::sqrt(mu * r)}}, 30);
  const Chosen around = by_auto(circle, 1e-7);
  EXPECT_TRUE(around.advice.met && around.advice.known) << around.advice.reason;
  EXPECT_NEAR(final_of(circle, around.outcome, "phi"), 30 * std::sqrt(mu / (r * r * r)), 3e-6);
  const Request flat =
      typed(texts::of(potential, {"x", "y", "z"}, {}, "(x^2+4*y^2+z^2)/2"), {{"x", 1e-3}, {"y", 2e-3}}, 9);
  const Chosen plane = by_auto(flat, 1e-7);
  EXPECT_TRUE(plane.advice.met && plane.advice.known) << plane.advice.reason;
  EXPECT_NEAR(final_of(flat, plane.outcome, "y"), 2e-3 * std::cos(18), 2e-3 * 1.2e-7);
}

// ---- time

struct Hard {
  const char* name;
  Definition definition;
  std::vector<NamedValue> start;
  double end;
};
Hard relaxation(double m) {
  return {"van der Pol", texts::flow({"x", "v"}, {{"m", m}}, {{"x", "v"}, {"v", "m*(1-x^2)*v-x"}}), {{"x", 2}}, m};
}
/// Relaxation oscillations, thousands of small cycles, a pendulum whose pivot is shaken.
std::vector<Hard> hard_ones() {
  return {relaxation(50),
          relaxation(200),
          {"Lotka and Volterra",
           texts::flow({"a", "b"}, {}, {{"a", "a-a*b"}, {"b", "a*b-b"}}),
           {{"a", 1.01}, {"b", 1}},
           32'000},
          {"a centre", texts::of(potential, {"x"}, {}, "x^2/2"), {{"x", 1}}, 32'000},
          {"Kapitza", texts::of(potential, {"u"}, {}, "-(1-90*cos(30*t))*cos(u)"), {{"u", 3}}, 40}};
}

// The search takes half of the time and leaves the other half to the run, which completes. It does not claim an
// accuracy that it could not measure.
TEST(AutoTime, ComesBackWithARun) {
  for (const Hard& hard : hard_ones()) {
    Request request = typed(hard.definition, {}, hard.end);
    for (const auto& [name, value] : hard.start) runs::begin(request, name, value);
    request.limits.seconds = 4;
    const double begun = steady_seconds();
    const Chosen chosen = by_auto(request, 1e-6);
    EXPECT_LT(steady_seconds() - begun, 4.5) << hard.name;
    ASSERT_EQ(chosen.outcome.stop.reason, ReturnCode::completed)
        << hard.name << " at " << chosen.outcome.t << ": " << chosen.advice.reason;
    if (std::string_view(hard.name) != "van der Pol") {
      EXPECT_EQ(chosen.advice.reason.text().find("stiff"), std::string::npos) << chosen.advice.reason;
    }
    Request fine = request;
    fine.scheme = find_scheme("taylor").value();
    fine.settings = runs::defaults("harmonic_oscillator", "taylor").settings;
    runs::set(fine, "tolerance", 1e-14);
    fine.limits.seconds = 20;
    const auto truth = runs::go(fine).outcome;
    ASSERT_EQ(truth.stop.reason, ReturnCode::completed);
    for (std::size_t i = 0; i < truth.final.size(); ++i)
      EXPECT_NEAR(chosen.outcome.final[i], truth.final[i], 3e-5 * std::max(1.0, std::abs(truth.final[i])))
          << hard.name << ": " << chosen.advice.reason;
  }
}

// With hardly any time there is a run all the same, and no claim about its error.
TEST(AutoTime, ClaimsNothingThatItHadNoTimeToMeasure) {
  std::vector<Hard> all = hard_ones();
  all.push_back(relaxation(1e4));
  for (const Hard& hard : all) {
    Request request = typed(hard.definition, {}, hard.end);
    for (const auto& [name, value] : hard.start) runs::begin(request, name, value);
    request.limits.seconds = 0.02;
    const Chosen chosen = by_auto(request, 1e-6);
    EXPECT_GT(chosen.outcome.t, 0) << hard.name;
    EXPECT_FALSE(chosen.advice.reason.empty());
    EXPECT_FALSE(chosen.advice.known && chosen.advice.met && !chosen.advice.referenced) << chosen.advice.reason;
  }
}

// ---- events and ends

// Beyond the event the motion escapes: errors are not measured there.
TEST(AutoEvents, MeasuresUpToTheOneThatEndsTheRun) {
  const Request free = typed(texts::of(potential, {"x"}, {}, "x^2/2+x^3/3"), {{"px", -0.7}}, 30);
  const Request request = stopping_at(free, "x+1.5", -1);
  const Chosen chosen = by_auto(request, 1e-6);
  EXPECT_TRUE(chosen.advice.met && chosen.advice.known) << chosen.advice.reason;
  EXPECT_EQ(chosen.outcome.event, "end");
  // The time is ∫ dx/p along the energy level.
  double time = 0;
  constexpr int parts = 20'000;
  for (int k = 0; k < parts; ++k) {
    const double x = -1.5 * (k + 0.5) / parts;
    time += 1.5 / parts / std::sqrt(0.49 - x * x - 2 * x * x * x / 3);
  }
  EXPECT_NEAR(chosen.outcome.t, time, 1e-5) << chosen.advice.reason;
  EXPECT_NE(chosen.advice.reason.text().find("end ends the run"), std::string::npos) << chosen.advice.reason;
  // Without the event the motion ends before the span does, and no error is known over all of it.
  const Chosen all = by_auto(free, 1e-6);
  EXPECT_FALSE(all.advice.known) << all.advice.reason;
}

// Light that grazes the photon sphere, until it comes back.
TEST(AutoEvents, GrazingPhotonsComeBack) {
  for (const double start : {0.0, 1e-3}) {
    const Request request =
        stopping_at(typed(texts::of(potential, {"u"}, {}, "u^2/2-u^3"), {{"u", start}, {"pu", 0.1923}}, 30), "u", -1);
    const Chosen chosen = by_auto(request, 1e-6);
    EXPECT_TRUE(chosen.advice.met && chosen.advice.known) << chosen.advice.reason;
    EXPECT_EQ(chosen.outcome.event, "end");
    const double energy = 0.1923 * 0.1923 / 2 + start * start / 2 - start * start * start;
    EXPECT_NEAR(final_of(request, chosen.outcome, "pu"), -std::sqrt(2 * energy), 2e-6);
    EXPECT_GT(chosen.outcome.t, 9);
    EXPECT_LT(chosen.outcome.t, 11);
  }
}

/// bounced() returns the motion in V = f |x| from rest at x = a: parabolas, four of them a period.
double bounced(double f, double a, double t) {
  const double quarter = std::sqrt(2 * a / f), phase = std::fmod(t, 4 * quarter);
  const double there = phase < 2 * quarter ? phase : phase - 2 * quarter, u = there - quarter;
  const double way = a - f * there * there / 2, back = -(a - f * (2 * quarter - there) * (2 * quarter - there) / 2);
  const double x = u < 0 ? way : back;
  return phase < 2 * quarter ? x : -x;
}

// The force jumps, and no series continues there; the motion does.
TEST(AutoEvents, AKinkIsNoEnd) {
  for (const auto& [f, a, end] : {std::array{1.0, 1.0, 20.0}, {2.0, 0.7, 9.0}, {0.3, 3.0, 30.0}}) {
    const Request request = typed(texts::of(potential, {"x"}, {{"f", f}}, "f*sqrt(x^2)"), {{"x", a}}, end);
    const auto known = conditioning(*request.scene, end, [] { return true; });
    EXPECT_FALSE(known->ends) << known->reached;
    const Chosen chosen = by_auto(request, 1e-4);
    if (chosen.advice.known && chosen.advice.met) {
      EXPECT_NEAR(final_of(request, chosen.outcome, "x"), bounced(f, a, end), 2e-4 * a) << chosen.advice.reason;
    }
    EXPECT_EQ(chosen.advice.reason.text().find("ends"), std::string::npos) << chosen.advice.reason;
  }
}

}  // namespace
