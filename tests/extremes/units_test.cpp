// The same scene in other units is the same run: as many steps by default, the same error. The units of length, time
// and mass are natural for a planet, an electron and a galaxy, expressed in SI; and random ones over 32 decades each.
#include <gtest/gtest.h>

#include <cstdio>
#include <random>

#include "core/run/suggestions.hpp"
#include "tests/extremes/asking.hpp"
#include "tests/support/texts.hpp"

namespace {

using namespace least;
using namespace asking;

/// Units holds the natural units of length, time and mass in the units of the scene.
struct Units {
  double length = 1, time = 1, mass = 1;
  double momentum() const { return mass * length / time; }
  double energy() const { return momentum() * length / time; }
};

/// Posed is a scene in such units, with the units of its variables, and its span.
struct Posed {
  std::shared_ptr<const Scene> scene;
  std::vector<double> units;
  double span = 0;
};

using Values = std::vector<Named>;
Posed pose(std::shared_ptr<const Mechanics> mechanics, const Values& parameters, const Values& initial,
           std::vector<double> units, double span) {
  const ProblemCard& card = mechanics->card();
  auto scene = std::make_shared<Scene>(Scene{mechanics, {}, {}, 0});
  const auto fill = [](const auto& cards, const Values& given, std::vector<double>& into) {
    for (const auto& one : cards) {
      const auto found = std::ranges::find(given, one.name, &Named::first);
      into.push_back(found == given.end() ? one.value : found->second);
    }
  };
  fill(card.parameters, parameters, scene->parameters);
  fill(card.variables, initial, scene->initial);
  return {scene, std::move(units), span};
}

Posed kepler(const Units& u) {
  const double l = u.length, v = u.length / u.time;
  return pose(runs::problem_called("kepler"), {{"mu", v * v * l}},
              {{"x", 0}, {"y", -4 * l}, {"px", -0.1 * v}, {"py", -0.1 * v}}, {l, l, v, v}, 12 * u.time);
}
Posed oscillator(const Units& u) {
  return pose(runs::problem_called("harmonic_oscillator"),
              {{"mass", u.mass}, {"stiffness", u.mass / (u.time * u.time)}}, {{"q", u.length}, {"p", 0}},
              {u.length, u.momentum()}, 20 * u.time);
}
Posed damped(const Units& u) {
  const double v = u.length / u.time;
  return pose(runs::problem_called("damped_oscillator"),
              {{"stiffness", 1 / (u.time * u.time)}, {"damping", 0.1 / u.time}},
              {{"q", -0.25 * u.length}, {"p", 0.75 * v}}, {u.length, v}, 50 * u.time);
}
std::shared_ptr<const Mechanics> typed(text::Definition definition) {
  return std::get<std::shared_ptr<const Mechanics>>(custom_mechanics(std::move(definition)));
}
Posed coupled(const Units& u) {
  const double k = u.mass / (u.time * u.time);
  auto definition = texts::of(text::Definition::Kind::lagrangian, {"x", "y"}, {{"m", 1}, {"k", 1}, {"c", 1}},
                              "m*(vx^2 + vy^2)/2 - k*(x^2 + 2*y^2)/2 - c*x^2*y^2");
  return pose(typed(definition), {{"m", u.mass}, {"k", k}, {"c", k / (u.length * u.length)}},
              {{"x", u.length}, {"y", 0.5 * u.length}}, {u.length, u.length, u.momentum(), u.momentum()}, 10 * u.time);
}
Posed damped_text(const Units& u) {
  auto definition = texts::damped(
      texts::of(text::Definition::Kind::potential, {"x"}, {{"f", 2}, {"l", 1}, {"a", 0.2}, {"m", 1}}, "-f*l*cos(x/l)"),
      "a");
  definition.masses = {{"x", "m"}};
  return pose(typed(definition),
              {{"f", 2 * u.mass * u.length / (u.time * u.time)}, {"l", u.length}, {"a", 0.2 / u.time}, {"m", u.mass}},
              {{"x", 1.2 * u.length}}, {u.length, u.momentum()}, 20 * u.time);
}

/// A Hamiltonian of a form that is solved at every stage for positions and momenta at once.
Posed quartic(const Units& u) {
  const double p = u.momentum();
  auto definition = texts::of(text::Definition::Kind::hamiltonian, {"q"}, {{"m", 1}, {"k", 1}, {"b", 1}},
                              "p^2/(2*m) + p^4/(4*b) + k*q^2/2");
  return pose(typed(definition), {{"m", u.mass}, {"k", u.mass / (u.time * u.time)}, {"b", p * p / u.energy() * p * p}},
              {{"q", u.length}}, {u.length, p}, 10 * u.time);
}

Request request_of(const Posed& posed, std::size_t scheme) {
  Request request;
  request.scene = posed.scene;
  request.scheme = scheme;
  request.settings = suggested_settings(*posed.scene, schemes()[scheme]);
  request.end = posed.span;
  request.record = {Record::Mode::every, 0, {}};
  return request;
}
/// natural_end() returns the final state in natural units, without hidden and optional variables.
std::vector<double> natural_end(const Posed& posed, const Request& request, const Solution& solution) {
  std::vector<double> end;
  for (std::size_t i = 0; i < solution.final.size(); ++i) {
    const VariableCard& variable = problem_of(request).variables[i];
    if (!variable.hidden && !variable.optional) end.push_back(solution.final[i] / posed.units.at(end.size()));
  }
  return end;
}
double distance_between(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

/// foreign_units() returns units far from the natural ones in every quantity on which defaults depend.
std::vector<Units> foreign_units() {
  std::vector<Units> all{{1.5e11, 5e6, 2e30}, {5.3e-11, 2.4e-17, 9.1e-31}, {2e20, 1e15, 1e40}};
  const auto far = [](double unit) { return std::abs(std::log10(unit)) > 2.5; };
  std::mt19937_64 random(20261126);
  const auto draw = [&] { return std::pow(10, -16 + 32 * (static_cast<double>(random() >> 11) * 0x1p-53)); };
  while (all.size() < 9) {
    const Units units{draw(), draw(), draw()};
    if (far(units.length) && far(units.time) && far(units.energy()) && far(units.energy() / units.mass))
      all.push_back(units);
  }
  return all;
}

void expect_the_same_in_all_units(Posed (*scene)(const Units&), Names choices = {}) {
  const Posed natural = scene({});
  const std::size_t fine = find_scheme("taylor").value();
  const Request exact = request_of(natural, fine);
  const std::vector<double> truth = natural_end(natural, exact, go(exact).outcome);
  int compared = 0;
  for (const std::size_t scheme : natural.scene->card().schemes) {
    const SchemeCard& card = schemes()[scheme];
    if (choices.size() > 0 && !card.find(choices.begin()->first)) continue;
    const auto run = [&](const Posed& posed) {
      Request request = choose(request_of(posed, scheme), choices);
      if (card.id == "energy_momentum")
        request.end *= 2.0 / 3;  // where the motion turns back its steps depend on chance
      return std::pair(request, go(request).outcome);
    };
    const auto [asked, here] = run(natural);
    ASSERT_EQ(here.stop.reason, ReturnCode::completed) << card.id;
    const double error = distance_between(natural_end(natural, asked, here), truth);
    for (const Units& units : foreign_units()) {
      const Posed posed = scene(units);
      const auto [request, there] = run(posed);
      const auto where = [&] {
        return name(request) + " in units of " + std::to_string(std::log10(units.length)) + ", " +
               std::to_string(std::log10(units.time)) + ", " + std::to_string(std::log10(units.mass));
      };
      EXPECT_EQ(there.stop.reason, ReturnCode::completed) << where() << there.stop.detail;
      const double ratio = static_cast<double>(there.cost.steps) / static_cast<double>(here.cost.steps);
      // In very short units of time the highest orders of a series overflow, in very long ones they underflow; and the
      // steps of some ten orders by extrapolation are few.
      const double more = card.id == "taylor" ? 6 : is_adaptive(card) ? 3 : 2;
      EXPECT_GT(ratio, 1 / more) << where();
      EXPECT_LT(ratio, more) << where();
      if (card.id != "energy_momentum") {
        // What steps within a tolerance come to is in part chance, above all of those by extrapolation.
        const double within = is_adaptive(card) ? 100 * request.setting("tolerance", card) : 0;
        const double allowed = (is_adaptive(card) ? 3 : 2) * error + within + 1e-9;
        EXPECT_LT(distance_between(natural_end(posed, request, there), truth), allowed) << where();
      }
      ++compared;
    }
  }
  EXPECT_GT(compared, 0);
}

TEST(UnitsOfAScene, AKeplerOrbitIsTheSameInAll) { expect_the_same_in_all_units(kepler); }
TEST(UnitsOfAScene, AnOscillatorIsTheSameInAll) { expect_the_same_in_all_units(oscillator); }
TEST(UnitsOfAScene, ADampedOscillatorIsTheSameInAll) { expect_the_same_in_all_units(damped); }
TEST(UnitsOfAScene, ATypedLagrangianIsTheSameInAll) { expect_the_same_in_all_units(coupled); }
TEST(UnitsOfAScene, ATypedPotentialWithDampingIsTheSameInAll) { expect_the_same_in_all_units(damped_text); }
TEST(UnitsOfAScene, AHamiltonianOfNoSimplerFormIsTheSameInAll) { expect_the_same_in_all_units(quartic); }
TEST(UnitsOfAScene, TheGraphsLengthIsMeasuredInAll) {
  expect_the_same_in_all_units(kepler, {{"monitor", "arclength"}});
}

// The residual of the law of decay is relative to the energy of the scene, however small that is.
TEST(UnitsOfAScene, TheResidualOfADecayIsTheSameInAll) {
  const auto residual = [](const Units& units) {
    const Posed posed = damped(units);
    return number(go(ask(request_of(posed, find_scheme("contact_splitting").value()), {"decay"})),
                  "decay/max_residual");
  };
  const double natural = residual({});
  EXPECT_GT(natural, 1e-5);
  for (const Units& units : foreign_units()) EXPECT_NEAR(residual(units), natural, 0.03 * natural) << units.length;
}

// On a circular orbit the radial momentum is only rounding: the size it is compared with, that of an orbit that is no
// circle, does not depend on how long the orbit is followed.
TEST(UnitsOfAScene, WhatRestsHasTheSameSizeOverAnySpan) {
  const auto polar = texts::mechanics_of(
      texts::of(text::Definition::Kind::lagrangian, {"r", "phi"}, {}, "(vr^2 + r^2*vphi^2)/2 + 1/r"));
  const Scene circle{polar, {}, {1, 0, 0, 1}, 0};
  for (const double span : {10.0, 100.0, 1000.0}) {
    const Truth truth = polar->truth(circle, {span / 2, span}, [] { return true; });
    ASSERT_TRUE(truth.complete) << span;
    EXPECT_GT(truth.sizes.at(2), 0.5) << span;
    EXPECT_LT(truth.sizes.at(2), 5) << span;
  }
}

// A time that is long in the scene's units is not a long step.
TEST(UnitsOfAScene, SeriesStepAsFarWhereTheUnitOfTimeIsShort) {
  const std::size_t taylor = find_scheme("taylor").value();
  for (Posed (*scene)(const Units&) : {kepler, oscillator}) {
    const auto steps = [&](const Units& units) { return go(request_of(scene(units), taylor)).outcome.cost.steps; };
    for (const Units& units : {Units{2e20, 1e15, 1}, Units{1e17, 1e12, 1}, Units{1.5e11, 5e6, 1}})
      EXPECT_LE(steps(units), 6 * steps({})) << units.time;  // lower order, because the highest terms underflow
  }
}

// ── which defaults change, and which do not ─────────────────────────────────────────────────────────────────────────

TEST(SuggestedSettings, AreThoseOfTheCardsWhereTheSceneIs) {
  for (const auto& mechanics : problem_list())
    for (const std::size_t scheme : mechanics->card().schemes) {
      const Request request = runs::defaults(mechanics->card().id, schemes()[scheme].id);
      const auto plain = plain_settings(&mechanics->card(), schemes()[scheme], nullptr);
      const auto suggested = suggested_settings(*request.scene, schemes()[scheme]);
      for (std::size_t i = 0; i < plain.size(); ++i)
        EXPECT_TRUE(plain[i] == suggested[i] || std::isnan(plain[i])) << name(request);
      EXPECT_EQ(suggested_span(*request.scene, nullptr), mechanics->card().span) << name(request);
    }
}

TEST(SuggestedSettings, DoNotChangeWithOrdinaryParametersAndStarts) {
  const auto step = [](const Request& request) {
    return suggested_settings(*request.scene, scheme_of(request)).front();
  };
  const Request oscillator = runs::defaults("harmonic_oscillator", "leapfrog"),
                orbit = runs::defaults("kepler", "leapfrog");
  for (const double stiffness : {0.01, 0.1, 3.0, 10.0})
    EXPECT_EQ(step(set(oscillator, {{"stiffness", stiffness}})), 0.1) << stiffness;
  EXPECT_EQ(step(at(oscillator, {{"q", 0}, {"p", 1e-6}})), 0.1);
  EXPECT_EQ(step(at(oscillator, {{"q", 0}, {"p", 0}})), 0.1) << "of an equilibrium the frequency is known";
  EXPECT_EQ(step(at(orbit, {{"x", 1}, {"y", 0}, {"px", 0}, {"py", 1}})), 0.01);
  // An oscillation of frequency 20 would be unstable at 0.1.
  EXPECT_NEAR(step(set(oscillator, {{"stiffness", 400}})), 0.1 / 20, 1e-4);
  EXPECT_NEAR(step(set(oscillator, {{"stiffness", 1e-6}})), 0.1 * 1000, 1);
}

// The step follows Kepler's third law, wherever on the orbit a run begins.
TEST(SuggestedSettings, OfAnOrbitFollowItsPeriod) {
  const double mu = 1.327e20, a = 2e12, e = 0.6;
  const auto step = [&](double r) {
    Request request = set(runs::defaults("kepler", "leapfrog"), {{"mu", mu}});
    request = at(request, {{"x", r}, {"y", 0}, {"px", 0}, {"py", std::sqrt(mu * (2 / r - 1 / a))}});
    return suggested_settings(*request.scene, scheme_of(request)).front();
  };
  constexpr double period = 18.893743377439769;  // of the default orbit
  const double expected = 0.01 * 2 * pi * std::sqrt(a * a * a / mu) / period;
  EXPECT_NEAR(step(a * (1 + e)), expected, 0.006 * expected);
  EXPECT_NEAR(step(a * (1 - e)), expected, 0.006 * expected);
}

// Where the derivative of the force vanishes at the start, the Taylor series of the motion still shows its time scale.
TEST(SuggestedSettings, OfAScenesSeriesAreFoundWhereItsForceHasNoSlope) {
  const auto mechanics = typed(texts::of(text::Definition::Kind::potential, {"q"}, {{"k", 1e-20}}, "k*sin(q)"));
  Scene scene{mechanics, {1e-20}, {}, 0};
  scene.initial.assign(mechanics->card().variables.size(), 0.0);
  const double step = suggested_settings(scene, schemes()[find_scheme("leapfrog").value()]).front();
  EXPECT_GT(step, 0.003e10);
  EXPECT_LT(step, 0.1e10);
}

}  // namespace
