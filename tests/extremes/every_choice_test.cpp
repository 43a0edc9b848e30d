// Every pair of problem and scheme with every choice the scheme offers (compositions, splittings, numbers of stages):
// every run ends in a status, and its numbers are finite.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/extremes/asking.hpp"

namespace {

using namespace least;
using namespace asking;

/// for_each_choice() calls f for the request as it is, then with every other value of each choice, whole number and
/// flag of its scheme, and with null where that is allowed; it leaves out what the scheme itself objects to.
template <class F>
void for_each_choice(const Request& request, F&& f) {
  f(request);
  const SchemeCard& scheme = scheme_of(request);
  const auto attempt = [&](std::size_t i, double x) {
    Request next = request;
    next.settings[i] = x;
    if (scheme.conflicts == nullptr || scheme.conflicts(next.settings, problem_of(next)).empty()) f(next);
  };
  for (std::size_t i = 0; i < scheme.parameters.size(); ++i) {
    const ParameterCard& card = scheme.parameters[i];
    if (card.nullable && !std::isnan(request.settings[i])) attempt(i, std::nan(""));
    if (card.kind == Kind::number) continue;
    const double low = card.kind == Kind::integer ? card.range.low : 0;
    const double high = card.kind == Kind::integer  ? card.range.high
                        : card.kind == Kind::choice ? static_cast<double>(card.choices.size()) - 1
                                                    : 1;
    for (double x = low; x <= high; x += 1)
      if (x != request.settings[i]) attempt(i, x);
  }
}
/// for_each_run() calls f for these choices with the defaults, with a threshold below the kinetic energy of an orbit's
/// start, and with the presets of schemes that choose their own steps.
template <class F>
void for_each_run(F&& f) {
  for (const ProblemCard& problem : runs::problem_cards())
    for (const std::size_t index : problem.schemes) {
      const SchemeCard& scheme = schemes()[index];
      Request request = of(problem.id, {scheme.id}, {});
      if (scheme.id == "jacobi_maupertuis") request = set(request, {{"critical_kinetic_energy", 0.005}});
      for_each_choice(request, f);
      if (!scheme.own_clock) continue;
      for (const SchemePresetCard& card : scheme.presets) {
        Request preset = request;
        for (const auto& [name, value] : card.settings) runs::set(preset, name, value);
        if (scheme.conflicts && !scheme.conflicts(preset.settings, problem).empty()) continue;
        if (!card.settings.empty()) for_each_choice(preset, f);
      }
    }
}
/// With κ = −E₀ the pace of the steps depends on the potential alone, which has to be negative, as on Kepler orbits.
bool needs_negative_potential(const Request& request) {
  return scheme_of(request).id == "time_transformed" && std::isnan(request.settings[1]);
}
std::string described(const Request& request) {
  std::string text = name(request);
  for (const double x : request.settings) text += ' ' + std::to_string(x);
  return text;
}

TEST(EveryChoice, AnswersEverythingThatCanBeAskedOfIt) {
  for_each_run([](const Request& plain) {
    Request request = everything(plain, false);
    request.limits.seconds = 60;                   // on a busy machine under a sanitizer, too
    if (problem_of(request).id == "lane_emden") {  // its energy at t = 0 is not defined; and a star with no surface
      request = set(request, {{"n", 5}});
      runs::scene(request).start = 0.1;
      runs::scene(request).initial = *runs::regular_start(request, 0.1);
    }
    const auto result = go(steps(request, 50));
    if (needs_negative_potential(request) && problem_of(request).id != "kepler") {
      const ReturnCode why = result.outcome.stop.reason;
      EXPECT_TRUE(why == ReturnCode::completed || why == ReturnCode::singular) << described(request);
    } else {
      ASSERT_EQ(result.outcome.stop.reason, ReturnCode::completed)
          << described(request) << ": " << result.outcome.stop.detail;
    }
    const bool completed = result.outcome.stop.reason == ReturnCode::completed;
    EXPECT_EQ(result.rows.size(), static_cast<std::size_t>(completed ? 50 : result.outcome.stop.step) + 1)
        << described(request);
    EXPECT_EQ(result.outcome.diagnostics.size(), request.diagnostics.size()) << described(request);
    for (std::size_t i = 0; i < request.diagnostics.size(); ++i)
      EXPECT_EQ(result.outcome.diagnostics[i].key, problem_of(request).diagnostics[request.diagnostics[i]].name);
    // The diagnostics and columns did not change the run.
    Request blind = request;
    blind.diagnostics.clear();
    const auto same = runs::go(steps(blind, 50));
    for (std::size_t i = 0; i < result.outcome.final.size(); ++i) {
      if (std::isnan(result.outcome.final[i])) continue;  // not carried
      EXPECT_EQ(same.outcome.final[i], result.outcome.final[i]) << described(request);
    }
  });
}

TEST(EveryChoice, TakesASingleStep) {
  for_each_run([](const Request& plain) {
    const Request request = steps(plain, 1);
    const auto result = go(request);
    if (needs_negative_potential(request) && result.outcome.stop.reason == ReturnCode::singular) return;
    ASSERT_EQ(result.outcome.stop.reason, ReturnCode::completed) << described(request);
    EXPECT_EQ(result.rows.size(), 2U) << described(request);
    if (scheme_of(request).own_clock)
      EXPECT_GT(result.outcome.t, 0) << described(request);
    else
      EXPECT_EQ(result.outcome.t, request.settings[0]) << described(request);
    EXPECT_EQ(result.outcome.cost.steps, 1) << described(request);
    for (std::size_t i = 1; i < request.columns.size(); ++i)
      EXPECT_EQ(result.rows[1][i], result.outcome.final[request.columns[i] - 1]) << described(request);
  });
}

TEST(EveryChoice, EndsForStepsOfAnyLength) {
  const runs::TurnedClock clock(1e-3);
  for_each_run([](const Request& plain) {
    for (const double h : {0.0, 5e-324, 1e-100, 1e-12, 1.0, 30.0, 1e3, 1e100, 1.7e308}) {
      Request request = everything(plain, false);
      request.settings[0] = h;
      request.limits.seconds = 0.004;
      go(steps(request, 20));
    }
  });
}

// Every pair takes every extreme value with its defaults; of the further choices, about ten a pair, each takes every
// third value, in turn.
TEST(EveryChoice, EndsForEveryStartAndParameter) {
  const runs::TurnedClock clock(1e-3);
  std::string pair;
  std::size_t choices = 0, asked = 0;
  for_each_run([&](const Request& plain) {
    choices = name(plain) == pair ? choices + 1 : 0;
    pair = name(plain);
    std::size_t value = 0;
    const auto try_next = [&](auto&& change) {
      if (choices > 0 && (value++ + choices) % 3 != 0) return;
      Request extreme = steps(everything(plain, false), 8);
      extreme.limits.seconds = 0.02;
      change(extreme);
      go(extreme);
      ++asked;
    };
    const double huge = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < plain.scene->initial.size(); ++i)
      for (const double x : {0.0, 1e-300, -1e10, 1e70, 1e300, -huge})
        try_next([&](Request& extreme) { runs::scene(extreme).initial[i] = x; });
    for (std::size_t i = 0; i < plain.scene->parameters.size(); ++i) {
      const auto& card = problem_of(plain).parameters[i];
      if (card.kind == Kind::choice) continue;
      const double low = card.range.low_open ? std::nextafter(card.range.low, huge) : card.range.low;
      for (const double x : {low, card.range.high, 0.0})
        if (card.range.contains(x)) try_next([&](Request& extreme) { runs::scene(extreme).parameters[i] = x; });
    }
    for (const double t : {-1e10, -1e-3, 1e-300, 1e10, 1e300})
      try_next([&](Request& extreme) { runs::scene(extreme).start = t; });
  });
  EXPECT_GT(asked, 10 * runs::problem_cards().size());
}

}  // namespace
