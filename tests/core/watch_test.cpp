// Events of the caller's own: the zeros of expressions along a run, and runs that end at them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/run/measures.hpp"
#include "tests/core/asking.hpp"

namespace {

using namespace least;
using namespace asks;

constexpr double full_turn = 2 * std::numbers::pi;

struct Watched {
  const char* name;
  const char* expression;
  int direction = 0;
  bool stop = false;
};
Request watching(Request request, std::initializer_list<Watched> all) {
  MeasureReader reader(*request.scene);
  for (const Watched& one : all) {
    const auto fault = reader.read(one.name, one.expression);
    if (fault) throw std::invalid_argument(fault->detail);
    request.events.push_back({one.direction, one.stop});
  }
  request.watched = reader.made();
  return request;
}

struct Found {
  double t;
  std::string name;
  std::vector<Report> state;
};
/// found() returns the events of the caller's own.
std::vector<Found> found(const Solution& outcome) {
  std::vector<Found> all;
  for (const Report& event : outcome.events) {
    const auto& parts = std::get<std::vector<Report>>(event.value);
    if (word(parts, "kind") == "event")
      all.push_back({runs::number(parts, "t"), word(parts, "name"), std::get<std::vector<Report>>(parts[3].value)});
  }
  return all;
}

/// ellipse() requests a Kepler orbit of eccentricity .6 and period 2π (a = 1) from its periapsis.
Request ellipse(std::string_view scheme, double turns) {
  Request request = runs::defaults("kepler", scheme);
  runs::scene(request).initial = {0.4, 0, 0, 2};
  request.end = turns * full_turn;
  runs::only_final(request);
  return request;
}
constexpr const char* radial = "x*px+y*py";

TEST(Watch, LocatesTheApsidesOfAnEllipse) {
  struct Case {
    const char* scheme;
    std::vector<std::pair<const char*, double>> settings;
    double tolerance;
  };
  const Case table[] = {
      {"taylor", {{"tolerance", 1e-15}}, 1e-12 * full_turn},
      {"bulirsch_stoer", {{"tolerance", 1e-13}}, 1e-11 * full_turn},
      {"leapfrog", {{"step", full_turn / 3000}, {"composition", 7}}, 1e-12 * full_turn},
  };
  for (const auto& [scheme, settings, tolerance] : table) {
    Request request = ellipse(scheme, 5.75);
    for (const auto& [name, value] : settings)
      if (std::string_view(name) == "composition")
        runs::set(request, name, "kahan_li_8");
      else
        runs::set(request, name, value);
    const auto run =
        runs::go(watching(request, {{"apsis", radial}, {"perihelion", radial, 1}, {"aphelion", radial, -1}}));
    ASSERT_EQ(run.outcome.stop.reason, ReturnCode::completed) << run.outcome.stop.detail;
    int apsis = 0, perihelion = 0, aphelion = 0;
    double last = 0;
    for (const Found& event : found(run.outcome)) {
      EXPECT_GE(event.t, last) << "in the order of time";
      last = event.t;
      const double turn = event.name == "apsis"        ? 0.5 * ++apsis
                          : event.name == "perihelion" ? 1.0 * ++perihelion
                                                       : ++aphelion - 0.5;
      EXPECT_NEAR(event.t, turn * full_turn, tolerance) << scheme << " " << event.name << " " << turn;
      const bool near = turn == std::floor(turn);
      EXPECT_NEAR(runs::number(event.state, "x"), near ? 0.4 : -1.6, 1e-9) << scheme;
      EXPECT_NEAR(runs::number(event.state, "y"), 0, 1e-9) << scheme;
      EXPECT_EQ(event.state.size(), 4U) << "x, y, px, py and no s";
    }
    EXPECT_EQ(apsis, 11) << scheme << ": the start is none";
    EXPECT_EQ(perihelion, 5) << scheme;
    EXPECT_EQ(aphelion, 6) << scheme;
  }
}

// Whatever chooses the steps: each event lies on a zero, directions alternate, and the run has the same bits.
TEST(Watch, IsWithoutInfluenceOnEveryScheme) {
  for (const char* problem : {"kepler", "perturbed_kepler", "damped_oscillator", "van_der_pol", "lane_emden"}) {
    const ProblemCard& card = runs::problem_card(problem);
    const std::string x = card.variables[0].name;
    for (const std::size_t scheme : card.schemes) {
      const std::string& id = schemes()[scheme].id;
      Request plain = runs::defaults(problem, id);
      plain.record = {Record::Mode::every, 7, {}};
      plain.diagnostics.clear();
      for (std::size_t i = 0; i < card.diagnostics.size(); ++i)
        if (card.diagnostics[i].name == "energy" || card.diagnostics[i].name == "zeros") plain.diagnostics.push_back(i);
      const auto alone = runs::go(plain);
      const std::string level = x + (std::string(problem) == "lane_emden" ? "-0.3" : "-0.05");
      const auto run = runs::go(watching(plain, {{"rise", level.c_str(), 1}, {"fall", level.c_str(), -1}}));
      EXPECT_EQ(run.outcome.final.size(), alone.outcome.final.size());
      for (std::size_t i = 0; i < alone.outcome.final.size(); ++i) {
        const double expected = alone.outcome.final[i];
        EXPECT_TRUE(run.outcome.final[i] == expected || std::isnan(expected)) << problem << " " << id;
      }
      EXPECT_EQ(run.rows, alone.rows) << problem << " " << id;
      EXPECT_EQ(run.outcome.cost.steps, alone.outcome.cost.steps) << problem << " " << id;
      EXPECT_EQ(run.outcome.cost.force_evaluations, alone.outcome.cost.force_evaluations) << problem << " " << id;
      for (const Report& report : run.outcome.diagnostics) {
        if (report.key == "energy") {
          EXPECT_EQ(runs::number(run.outcome.diagnostics, "energy/max_abs_error"),
                    runs::number(alone.outcome.diagnostics, "energy/max_abs_error"))
              << problem << " " << id;
        }
        if (report.key == "zeros") {
          EXPECT_EQ(runs::list(run.outcome.diagnostics, "zeros"), runs::list(alone.outcome.diagnostics, "zeros")) << id;
        }
      }
      if (alone.outcome.stop.reason != ReturnCode::completed && id == "explicit_euler") continue;
      const auto events = found(run.outcome);
      EXPECT_FALSE(events.empty()) << problem << " " << id;
      std::string before;
      for (const Found& event : events) {
        EXPECT_NE(event.name, before) << problem << " " << id << " at " << event.t;
        before = event.name;
        const double level_here = std::string(problem) == "lane_emden" ? 0.3 : 0.05;
        EXPECT_NEAR(runs::number(event.state, x), level_here, 1e-10) << problem << " " << id << " at " << event.t;
      }
    }
  }
}

TEST(Watch, EndsTheRunAtAnEvent) {
  for (const char* scheme : {"leapfrog", "galerkin_4", "taylor", "dormand_prince_5", "time_transformed"}) {
    Request request = ellipse(scheme, 5.75);
    request.diagnostics = asking("kepler", scheme, "energy").diagnostics;
    request.record = {Record::Mode::every, 1, {}};
    const Request ending =
        watching(request, {{"later", "t-20"}, {"end", radial, -1, true}, {"never", "x-50", 0, true}, {"first", "t-1"}});
    const auto run = runs::go(ending);
    EXPECT_EQ(run.outcome.stop.reason, ReturnCode::completed) << scheme;
    EXPECT_EQ(run.outcome.event, "end") << scheme;
    const auto events = found(run.outcome);
    ASSERT_EQ(events.size(), 2U) << scheme;
    EXPECT_EQ(events[0].name, "first");
    EXPECT_NEAR(events[0].t, 1, 1e-14);
    EXPECT_EQ(events[1].name, "end");
    EXPECT_EQ(run.outcome.t, events[1].t) << scheme;
    const auto& state = run.outcome.final;
    EXPECT_NEAR(state[0] * state[2] + state[1] * state[3], 0, 1e-12) << scheme;
    EXPECT_EQ(state[0], runs::number(events[1].state, "x")) << scheme;
    EXPECT_LT(run.rows.back()[0], run.outcome.t) << scheme << ": up to the last step before it";
    EXPECT_EQ(std::ssize(run.rows), run.outcome.cost.steps) << scheme << ": each step but the last, and the start";
    // The energy is that of a run with this end from the first.
    Request until = request;
    until.end = run.outcome.t;
    const auto whole = runs::go(until);
    for (const char* part : {"energy/final", "energy/max_abs_error"})
      EXPECT_NEAR(runs::number(run.outcome.diagnostics, part), runs::number(whole.outcome.diagnostics, part), 1e-12)
          << scheme << " " << part;
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(state[i], whole.outcome.final[i], 1e-11) << scheme;
  }
}

TEST(Watch, EndsSamplesAndCurvesThere) {
  for (const char* scheme : {"leapfrog", "taylor"}) {
    Request request = watching(ellipse(scheme, 2), {{"end", "y+0.1", -1, true}});
    request.record = {Record::Mode::samples, 101, {}};
    const auto samples = runs::go(request);
    EXPECT_EQ(samples.outcome.event, "end") << scheme;
    const double end = samples.outcome.t;
    EXPECT_EQ(double(samples.rows.size()), std::floor(end / (2 * full_turn / 100)) + 1) << scheme;
    EXPECT_LE(samples.rows.back()[0], end) << scheme;
    request.record = {Record::Mode::curve, 50, {}};
    const auto curve = runs::go(request);
    EXPECT_EQ(curve.outcome.t, end) << scheme;
    EXPECT_EQ(curve.rows.size(), 50U) << scheme;
    EXPECT_EQ(curve.rows.back()[0], end) << scheme;
    EXPECT_EQ(curve.rows.back()[1], curve.outcome.final[0]) << scheme;
    request.record = {Record::Mode::times, 0, {0.5, 1.0, end, end + 1}};
    EXPECT_EQ(runs::go(request).rows.size(), 3U) << scheme << ": the one at the event too";
  }
}

// Steps are longer than the period of an oscillation, or nearly: two zeros within a step leave the sign at its ends
// alike.
TEST(Watch, FindsTwoZerosOfOneLongStep) {
  for (const std::size_t index : runs::problem_card("harmonic_oscillator").schemes) {
    const SchemeCard& scheme = schemes()[index];
    if (!scheme.own_clock) continue;
    Request request = runs::defaults("harmonic_oscillator", scheme.id);
    request.end = 30.16 * std::numbers::pi;
    runs::only_final(request);
    runs::begin(request, "q", 1);
    runs::begin(request, "p", 0);
    for (const double tolerance : {1e-2, 1e-4, 1e-8}) {
      if (scheme.find("tolerance")) runs::set(request, "tolerance", tolerance);
      const auto run = runs::go(watching(request, {{"zero", "q"}, {"fast", "cos(2*t)"}, {"many", "sin(20*q)"}}));
      ASSERT_EQ(run.outcome.stop.reason, ReturnCode::completed) << scheme.id << " " << run.outcome.stop.detail;
      int zeros = 0, fast = 0, many = 0;
      for (const Found& event : found(run.outcome))
        (event.name == "zero" ? zeros : event.name == "fast" ? fast : many) += 1;
      const bool coarse = scheme.find("tolerance") && tolerance > 1e-3;  // its phase is wrong in the end
      if (!coarse) {
        EXPECT_EQ(zeros, 30) << scheme.id << " " << tolerance << ", " << run.outcome.cost.steps << " steps";
        EXPECT_EQ(many, 30 * 13 + 1) << scheme.id << " " << tolerance << ", " << run.outcome.cost.steps << " steps";
      }
      EXPECT_EQ(fast, 60) << scheme.id << " " << tolerance << ", " << run.outcome.cost.steps << " steps";
      if (!scheme.find("tolerance")) break;
    }
  }
}

// An expression whose extremum lies barely beyond zero is beyond zero for less than a step, wherever in a step that is.
TEST(Watch, FindsTheZerosOnEitherSideOfATurn) {
  const double level = 0.9999, half = std::acos(level);  // q is above it for 1/222 of the period
  for (const std::size_t index : runs::problem_card("harmonic_oscillator").schemes) {
    const SchemeCard& scheme = schemes()[index];
    for (const double turned : {0.0, 0.3, 1.01, 2.6}) {
      Request request = runs::defaults("harmonic_oscillator", scheme.id);
      request.end = 10.5 * full_turn;
      runs::only_final(request);
      runs::begin(request, "q", std::cos(turned));
      runs::begin(request, "p", std::sin(turned));
      if (scheme.find("step")) runs::set(request, "step", 0.09);
      const auto run = runs::go(watching(request, {{"above", "q-.9999*sqrt(2*energy)"},
                                                   {"up", "q-.9999*sqrt(q^2+p^2)", 1},
                                                   {"down", "q-.9999*sqrt(q^2+p^2)", -1},
                                                   {"touch", "q-1.01*sqrt(q^2+p^2)"}}));
      ASSERT_EQ(run.outcome.stop.reason, ReturnCode::completed) << scheme.id << " " << run.outcome.stop.detail;
      int above = 0, up = 0, down = 0;
      double rise = unknown;
      for (const Found& event : found(run.outcome)) {
        above += event.name == "above";
        up += event.name == "up";
        down += event.name == "down";
        EXPECT_NE(event.name, "touch") << scheme.id;
        if (event.name == "up") rise = event.t;
        if (event.name == "down" && !std::isnan(rise)) {
          EXPECT_NEAR(event.t - rise, 2 * half, 5e-4) << scheme.id;
        }
      }
      const int rises = turned == 0 ? 10 : 11;
      EXPECT_EQ(up, rises) << scheme.id << " " << turned;
      EXPECT_EQ(down, 11) << scheme.id << " " << turned;
      EXPECT_EQ(above, 11 + rises) << scheme.id << " " << turned;
    }
  }
}

// Wherever time begins, also for expressions with sharp minima, as distances have, and with others watched beside.
TEST(Watch, FindsSharpTurnsAtAnyTime) {
  for (const double start : {0.0, 1e7})
    for (const char* scheme : {"leapfrog", "runge_kutta_4", "taylor"})
      for (int phase = 0; phase < 10; ++phase) {
        Request request = runs::defaults("harmonic_oscillator", scheme);
        runs::scene(request).start = start;
        request.end = start + 10;
        runs::only_final(request);
        runs::begin(request, "q", 1);
        runs::begin(request, "p", 0);
        if (std::string_view(scheme) != "taylor") runs::set(request, "step", 0.1);
        const std::string turn = std::to_string(start + 5 + 0.01 * phase);
        const std::string sharp = "sqrt(1e-6+(t-" + turn + ")^2)-.003", smooth = "(t-" + turn + ")^2-1e-4";
        for (const std::string& one : {sharp, smooth}) {
          EXPECT_EQ(found(runs::go(watching(request, {{"alone", one.c_str()}})).outcome).size(), 2U)
              << scheme << " " << one;
        }
        const auto among = found(runs::go(watching(request, {{"never", "q-50", 0, true},
                                                             {"tick", "sin(40*t)", -1},
                                                             {"sharp", sharp.c_str()},
                                                             {"smooth", smooth.c_str()}}))
                                     .outcome);
        EXPECT_EQ(std::ranges::count(among, "sharp", &Found::name), 2) << scheme << " from " << start << ", " << turn;
        EXPECT_EQ(std::ranges::count(among, "smooth", &Found::name), 2) << scheme << " from " << start << ", " << turn;
      }
}

// An expression that falls to zero exactly at the end changes no sign there, and no further step shows that it would.
TEST(Watch, FindsAZeroAtTheVeryEnd) {
  for (const char* scheme : {"leapfrog", "galerkin_4", "taylor", "dormand_prince_5", "bulirsch_stoer"})
    for (const double end : {1.0, 1.003}) {
      Request request = ellipse(scheme, 1);
      request.end = end;
      const std::string left = std::to_string(end) + "-t", passed = "t-" + std::to_string(end);
      const auto events = found(runs::go(watching(request, {{"down", left.c_str(), -1},
                                                            {"up", left.c_str(), 1},
                                                            {"rise", passed.c_str(), 1},
                                                            {"fall", passed.c_str(), -1},
                                                            {"nothing", "0*x"}}))
                                    .outcome);
      ASSERT_EQ(events.size(), 2U) << scheme << " " << end;
      EXPECT_EQ(events[0].name, "rise") << scheme;
      EXPECT_EQ(events[1].name, "down") << scheme;
      for (const Found& event : events) EXPECT_EQ(event.t, end) << scheme;
      const std::string late = "(t-0.3)*(" + left + ")";  // below zero where the run begins
      EXPECT_EQ(found(runs::go(watching(request, {{"late", late.c_str(), -1}})).outcome).size(), 1U) << scheme;
      const auto ending = runs::go(watching(request, {{"down", left.c_str(), -1, true}}));
      EXPECT_EQ(ending.outcome.stop.reason, ReturnCode::completed) << scheme;
      EXPECT_EQ(ending.outcome.event, "down") << scheme;
      EXPECT_EQ(ending.outcome.t, end) << scheme;
    }
}

TEST(Watch, TakesAPoleForNoZero) {
  for (const char* scheme : {"leapfrog", "taylor"}) {
    const auto run = runs::go(watching(ellipse(scheme, 3.2), {{"pole", "1/x"}, {"zero", "x"}, {"none", "log(x)+50"}}));
    int zeros = 0;
    for (const Found& event : found(run.outcome)) {
      EXPECT_EQ(event.name, "zero") << scheme << " " << event.t;
      ++zeros;
    }
    EXPECT_EQ(zeros, 7) << scheme;
  }
}

TEST(Watch, TakesAStartOnAZeroForNoEvent) {
  for (const char* scheme : {"leapfrog", "taylor", "dormand_prince_5"}) {
    for (const char* expression : {"y", "-y", "x*px+y*py", "-x*px-y*py", "y^2", "-y^2"}) {
      const auto run = runs::go(watching(ellipse(scheme, 0.25), {{"start", expression, 0, true}}));
      EXPECT_TRUE(run.outcome.events.empty()) << scheme << " " << expression;
      EXPECT_TRUE(run.outcome.event.empty()) << scheme << " " << expression;
    }
  }
}

// For n = 1, θ = sin ξ/ξ: from a series at the start to the surface at ξ = π, where the motion ends.
TEST(Watch, SeesTheSeriesAtTheStartAndNothingBeyondTheSurface) {
  for (const char* scheme : {"contact_leapfrog", "contact_splitting", "runge_kutta_4", "taylor", "dormand_prince_5"}) {
    if (!runs::fits("lane_emden", scheme)) continue;
    Request request = runs::defaults("lane_emden", scheme);
    runs::set(request, "n", 1);
    runs::only_final(request);
    const bool by_itself = std::string_view(scheme) == "contact_splitting";  // its steps begin at the singularity
    const std::string q = runs::card(request).variables[0].name;
    const auto run = runs::go(watching(
        request,
        {{"early", "t-0.003"}, {"half", (q + "-sin(2)/2").c_str()}, {"late", "t-3.1415"}, {"beyond", "t-3.1417"}}));
    EXPECT_EQ(run.outcome.stop.reason, ReturnCode::left_domain) << scheme;
    const auto events = found(run.outcome);
    ASSERT_EQ(events.size(), 3U) << scheme;
    EXPECT_EQ(events[0].name, "early");
    EXPECT_NEAR(events[0].t, 0.003, 1e-15) << scheme;
    EXPECT_NEAR(runs::number(events[0].state, q), 1 - 0.003 * 0.003 / 6, by_itself ? 1e-6 : 1e-11) << scheme;
    EXPECT_EQ(events[1].name, "half");
    EXPECT_NEAR(events[1].t, 2, 1e-3) << scheme;
    EXPECT_EQ(events[2].name, "late");
    // An event in the part of the last step that lies inside the star.
    const auto ended = runs::go(watching(request, {{"late", "t-3.1415", 1, true}}));
    EXPECT_EQ(ended.outcome.stop.reason, ReturnCode::completed) << scheme;
    EXPECT_EQ(ended.outcome.event, "late") << scheme;
    EXPECT_NEAR(ended.outcome.t, 3.1415, 1e-12) << scheme;
  }
}

// An expression with s makes a run carry s, and so does one with the energy where that needs s.
TEST(Watch, CarriesWhatExpressionsRead) {
  Request request = runs::defaults("damped_oscillator", "contact_leapfrog");
  const auto& variables = runs::card(request).variables;
  ASSERT_EQ(variables.back().name, "s");
  const auto lean = runs::go(watching(request, {{"q", "q"}}));
  EXPECT_TRUE(std::isnan(lean.outcome.final.back()));
  const auto full = runs::go(watching(request, {{"both", "q+0*s+s-s"}}));
  EXPECT_TRUE(std::isfinite(full.outcome.final.back()));
  ASSERT_FALSE(found(full.outcome).empty());
  EXPECT_NO_THROW(runs::number(found(full.outcome).front().state, "s"));
  runs::show_all(request);
  const auto rows = runs::go(request).rows;
  const auto at_half = runs::go(watching(request, {{"half", "energy-0.25"}}));
  for (const Found& event : found(at_half.outcome)) EXPECT_TRUE(std::isfinite(event.t));
}

}  // namespace
