// Zeros of expressions that change faster than steps, on the harmonic oscillator q = cos t, p = −sin t: waves, narrow
// peaks, steep steps, high powers, poles, and intervals where they are undefined. No zero is missed without a warning.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "core/run/measures.hpp"
#include "tests/extremes/asking.hpp"

namespace {

using namespace least;
using namespace asking;

/// oscillator() requests the oscillator from q = 1 at rest.
Request oscillator(std::string_view scheme, double end, double step = null) {
  Request request = at(of("harmonic_oscillator", {scheme}, {}), {{"q", 1}, {"p", 0}});
  if (!std::isnan(step)) runs::set(request, "step", step);
  request.end = end;
  request.limits.seconds = 60;
  request.limits.samples = 10'000'000;
  runs::only_final(request);
  return request;
}

struct Watched {
  std::string expression;
  int direction = 0;
  bool stop = false;
};
Request watching(Request request, const std::vector<Watched>& all) {
  MeasureReader reader(*request.scene);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto fault = reader.read(std::to_string(i), all[i].expression);
    if (fault) throw std::invalid_argument(all[i].expression + ": " + fault->detail);
    request.events.push_back({all[i].direction, all[i].stop});
  }
  request.watched = reader.made();
  return request;
}
/// times() returns, for each watched expression, the times of its zeros.
std::vector<std::vector<double>> times(const Request& request, const runs::Result& run) {
  std::vector<std::vector<double>> all(request.events.size());
  for (const Report& event : run.outcome.events) {
    const auto& parts = std::get<std::vector<Report>>(event.value);
    const auto& name = std::get<std::string>(parts.at(runs::position(parts, "name", &Report::key)).value);
    all.at(std::stoul(name)).push_back(runs::number(parts, "t"));
  }
  return all;
}
std::vector<double> zeros(const Request& plain, const std::string& expression, bool may_warn = false) {
  const Request request = watching(plain, {{expression}});
  const auto run = runs::go(request);
  EXPECT_EQ(run.outcome.stop.reason, ReturnCode::completed) << expression << ": " << run.outcome.stop.detail;
  EXPECT_EQ(warned(run, "events_unresolved"), may_warn) << name(request) << ": " << expression;
  return times(request, run)[0];
}

constexpr const char* every_kind[] = {"leapfrog", "runge_kutta_4",    "gauss_legendre_4",
                                      "taylor",   "dormand_prince_5", "bulirsch_stoer"};
std::vector<std::string_view> fitting() {
  std::vector<std::string_view> all;
  for (const char* scheme : every_kind)
    if (find_scheme(scheme) && runs::fits("harmonic_oscillator", scheme)) all.push_back(scheme);
  return all;
}

// The times of zeros of functions of time alone are known to the last digits, whatever the scheme and its steps.
TEST(EventFamilies, WavesOfTimeAreFollowedWhateverTheStep) {
  for (const std::string_view scheme : fitting())
    for (const double rate : {5.0, 50.0, 700.0}) {
      const double step = find_scheme(scheme) && schemes()[*find_scheme(scheme)].own_clock ? null : 0.1;
      const auto found = zeros(oscillator(scheme, 20, step), "sin(" + std::to_string(rate) + "*t)");
      const auto count = static_cast<std::size_t>(20 * rate / pi);
      ASSERT_EQ(found.size(), count) << scheme << " " << rate << ": the start is none";
      for (std::size_t k = 0; k < count; ++k)
        EXPECT_NEAR(found[k], static_cast<double>(k + 1) * pi / rate, 1e-13) << scheme << " " << rate;
    }
  EXPECT_EQ(zeros(oscillator("runge_kutta_4", 40, 1), "sin(5*t)").size(), 63U);
}

// Between two zeros of such an expression lies an interval where it is undefined.
TEST(EventFamilies, ZerosBesideAnUndefinedStretchAreFound) {
  for (const std::string_view scheme : fitting())
    for (const auto& [expression, level] : {std::pair<std::string, double>{"sqrt(q)-0.5", 0.25},
                                            {"log(q)+3", std::exp(-3)},
                                            {"acos(2*q)-1", std::cos(1) / 2},
                                            {"q^1.5-0.001", 0.01},
                                            {"1/sqrt(q)-40", 1 / 1600.0}}) {
      const auto found = zeros(oscillator(scheme, 6 * pi), expression);
      ASSERT_EQ(found.size(), 6U) << scheme << " " << expression;
      const bool exact = scheme == "taylor" || scheme == "bulirsch_stoer";
      for (std::size_t k = 0; k < 6; ++k) {
        const double turn = 2 * pi * static_cast<double>((k + 1) / 2);
        EXPECT_NEAR(found[k], turn + (k % 2 == 0 ? 1 : -1) * std::acos(level), exact ? 1e-6 : 0.05) << scheme;
      }
    }
}

TEST(EventFamilies, NarrowPeaksAndSteepStepsAreFound) {
  for (const std::string_view scheme : fitting()) {
    EXPECT_EQ(zeros(oscillator(scheme, 20), "exp(-10000*(q-0.3)^2)-0.5").size(), 12U) << scheme;
    EXPECT_EQ(zeros(oscillator(scheme, 20), "exp(-1e12*(q-0.3)^2)-0.5").size(), 12U) << scheme;
    EXPECT_EQ(zeros(oscillator(scheme, 20), "1e-5/((q-0.3)^2+1e-5)-0.5").size(), 12U) << scheme;
    EXPECT_EQ(zeros(oscillator(scheme, 20), "tanh(1e6*(q-0.3))^2-0.5").size(), 12U) << scheme;
    EXPECT_EQ(zeros(oscillator(scheme, 20), "q^4000-0.5").size(), 13U) << scheme << ": the run begins in one";
  }
}

TEST(EventFamilies, WhatOnlyTouchesZeroOrHasAPoleOrEndsThereIsNone) {
  for (const std::string_view scheme : fitting())
    for (const char* expression :
         {"sqrt(q)", "q*sqrt(q)", "abs(q)", "q^2", "1/q", "1/q^3", "1/q^2", "log(q)+800", "abs(tan(t))", "1-cos(3*t)",
          "cos(50*t)-1", "cos(7*t)-1", "sin(q)/q-2", "0*q", "q-q"}) {
      EXPECT_TRUE(zeros(oscillator(scheme, 20), expression).empty()) << scheme << " " << expression;
    }
}

TEST(EventFamilies, AZeroOfAnyOrderIsOne) {
  for (const std::string_view scheme : fitting())
    for (const char* expression : {"q", "q^3", "q*abs(q)", "q^2/q", "sin(q^3)", "(q+0*t)^5"}) {
      EXPECT_EQ(zeros(oscillator(scheme, 20), expression).size(), 6U) << scheme << " " << expression;
    }
}

TEST(EventFamilies, TheFirstOfManyWithinAStepEndsTheRun) {
  for (const std::string_view scheme : fitting()) {
    const auto ends = runs::go(watching(oscillator(scheme, 20), {{"exp(-1e6*(t-1.2345)^2)-0.5", -1, true}}));
    EXPECT_EQ(ends.outcome.event, "0") << scheme;
    EXPECT_NEAR(ends.outcome.t, 1.2345 + std::sqrt(std::log(2.0)) / 1000, 1e-12) << scheme;
    const auto third = runs::go(watching(oscillator(scheme, 20), {{"sin(300*t)", 1, true}}));
    EXPECT_NEAR(third.outcome.t, 2 * pi / 300, 1e-13) << scheme << ": the first that rises";
  }
}

// Where the search cannot resolve the zeros there is a warning.
TEST(EventFamilies, WhatStaysUnresolvedIsWarnedOf) {
  for (const std::string_view scheme : fitting())
    for (const char* expression : {"sin(1e9*t)", "sin(1/q)", "exp(-1e34*(q-0.3)^2)-0.5"})
      zeros(oscillator(scheme, 3), expression, true);
}

// ── random expressions ──────────────────────────────────────────────────────────────────────────────────────────────

struct Formula {
  std::string text;
  std::function<double(double t, double q, double p)> value;
};

class Families {
 public:
  explicit Families(unsigned seed) : random_(seed) {}

  Formula any() {
    Formula f = one();
    const double chance = number(0, 1);
    if (chance < 0.25) {
      const Formula g = one();
      return {"(" + f.text + ")*(" + g.text + ")",
              [=](double t, double q, double p) { return f.value(t, q, p) * g.value(t, q, p); }};
    }
    if (chance < 0.4) {
      const Formula g = one();
      const double c = number(0.1, 2);
      return {"(" + f.text + ")+" + text(c) + "*(" + g.text + ")",
              [=](double t, double q, double p) { return f.value(t, q, p) + c * g.value(t, q, p); }};
    }
    return f;
  }

 private:
  double number(double low, double high) {  // few digits, so that the text gives the same number
    const double u = static_cast<double>(random_()) / 4294967296.0;
    return std::round((low + u * (high - low)) * 4096) / 4096;
  }
  static std::string text(double x) {
    std::string digits(40, ' ');
    digits.resize(static_cast<std::size_t>(std::snprintf(digits.data(), digits.size(), "(%.17g)", x)));
    return digits;
  }
  Formula argument() {
    const double a = number(0.3, 2), b = number(-0.5, 0.5);
    switch (random_() % 4) {
      case 0:
        return {"q", [](double, double q, double) { return q; }};
      case 1:
        return {"p", [](double, double, double p) { return p; }};
      case 2:
        return {"(" + text(a) + "*q+p)", [=](double, double q, double p) { return a * q + p; }};
      default:
        return {"(q*p+" + text(b) + ")", [=](double, double q, double p) { return q * p + b; }};
    }
  }
  Formula one() {
    const Formula x = argument();
    const double a = number(-1, 1), b = number(0.05, 0.95), w = number(5, 150);
    const double m = std::pow(10, 1 + static_cast<double>(random_() % 5));
    const std::string u = "(" + x.text + "-" + text(a) + ")", level = text(b);
    const auto of = [&](std::string shown, std::function<double(double u, double t)> f) {
      return Formula{std::move(shown), [=, v = x.value](double t, double q, double p) { return f(v(t, q, p) - a, t); }};
    };
    switch (random_() % 14) {
      case 0:
        return of("sqrt" + u + "-" + level, [=](double v, double) { return std::sqrt(v) - b; });
      case 1:
        return of("exp(-" + text(m) + "*" + u + "^2)-" + level,
                  [=](double v, double) { return std::exp(-m * v * v) - b; });
      case 2:
        return of("sin(" + text(w) + "*t)-" + level, [=](double, double t) { return std::sin(w * t) - b; });
      case 3:
        return of("sin(" + text(w) + "*" + u + ")+" + level, [=](double v, double) { return std::sin(w * v) + b; });
      case 4:
        return of("tanh(" + text(m) + "*" + u + ")-" + level, [=](double v, double) { return std::tanh(m * v) - b; });
      case 5:
        return of(u + "^40-" + level, [=](double v, double) { return std::pow(v, 40) - b; });
      case 6:
        return of("1/" + u + "-" + text(w / 8), [=](double v, double) { return 1 / v - w / 8; });
      case 7:
        return of("log" + u + "+" + text(w / 20), [=](double v, double) { return std::log(v) + w / 20; });
      case 8:
        return of("tan(" + text(w / 16) + "*" + u + ")-" + level,
                  [=](double v, double) { return std::tan(w / 16 * v) - b; });
      case 9:
        return of("1/(" + text(m) + "*" + u + "^2+1)-" + level,
                  [=](double v, double) { return 1 / (m * v * v + 1) - b; });
      case 10:
        return of("acos" + u + "-" + text(3 * b), [=](double v, double) { return std::acos(v) - 3 * b; });
      case 11:
        return of("abs" + u + "-" + text(b / 8), [=](double v, double) { return std::abs(v) - b / 8; });
      case 12:
        return of("exp(-" + text(m) + "*(cos(" + text(w / 16) + "*t)-" + text(a) + ")^2)-" + level,
                  [=](double, double t) {
                    const double d = std::cos(w / 16 * t) - a;
                    return std::exp(-m * d * d) - b;
                  });
      default:
        return of(u + "^" + text(1.5 + b) + "-" + text(b * b),
                  [=](double v, double) { return std::pow(v, 1.5 + b) - b * b; });
    }
  }

  std::mt19937 random_;
};

/// Passage is an interval between neighbouring states of the run in which the formula passes through zero.
struct Passage {
  double from, to;
  bool rises;
};
std::vector<Passage> passages(const std::vector<std::vector<double>>& rows, const Formula& formula) {
  const auto value = [&](std::size_t k) { return formula.value(rows[k][0], rows[k][1], rows[k][2]); };
  std::vector<Passage> all;
  for (std::size_t k = 2; k + 1 < rows.size(); ++k) {
    const double before = value(k - 1), after = value(k);
    if (!((before < 0 && after >= 0) || (before >= 0 && after < 0))) continue;
    // On either side of a pole the nearer of two neighbours has at least twice the value of the other.
    const bool pole = std::abs(before) > 1.9 * std::abs(value(k - 2)) || std::abs(after) > 1.9 * std::abs(value(k + 1));
    if (!pole) all.push_back({rows[k - 1][0], rows[k][0], after >= 0});
  }
  return all;
}

// Compared with states of the run itself at distances of 1/10,000: each passage has its event, in either direction.
TEST(EventFamilies, OfRandomExpressionsNoneIsMissingWithoutAWarning) {
  constexpr double end = 20;
  int expressions = 0, unresolved = 0;
  std::size_t found = 0;
  for (const char* scheme : {"leapfrog", "runge_kutta_4", "taylor", "dormand_prince_5"}) {
    Request request = oscillator(scheme, end);
    Request shown = request;
    shown.record = {Record::Mode::samples, 200'001, {}};
    const auto rows = runs::go(shown).rows;
    ASSERT_EQ(rows.size(), 200'001U);
    Families families(20261126);
    for (int k = 0; k < 60; ++k) {
      const Formula formula = families.any();
      const Request asked = watching(request, {{formula.text, 0}, {formula.text, 1}, {formula.text, -1}});
      const auto run = runs::go(asked);
      ASSERT_EQ(run.outcome.stop.reason, ReturnCode::completed) << run.outcome.stop.detail;
      ++expressions;
      if (warned(run, "events_unresolved")) {
        ++unresolved;
        continue;
      }
      const auto by_direction = times(asked, run);
      found += by_direction[0].size();
      std::vector<double> both = by_direction[1];
      both.insert(both.end(), by_direction[2].begin(), by_direction[2].end());
      std::ranges::sort(both);
      EXPECT_EQ(both, by_direction[0]) << scheme << ": " << formula.text;
      const auto expected = passages(rows, formula);
      // Two zeros between neighbours are not seen as a passage: there may be more events, but only in pairs.
      EXPECT_GE(by_direction[0].size(), expected.size()) << scheme << ": " << formula.text;
      for (const auto& [from, to, rises] : expected) {
        const auto& of_direction = by_direction[rises ? 1 : 2];
        const bool there = std::ranges::any_of(
            of_direction, [&, a = from, b = to](double t) { return a - 1e-9 <= t && t <= b + 1e-9; });
        EXPECT_TRUE(there) << scheme << ": " << formula.text << " at " << from << (rises ? " up" : " down");
      }
      const std::size_t more = by_direction[0].size() - expected.size();
      EXPECT_LE(more, 4U) << scheme << ": " << formula.text;
    }
  }
  EXPECT_GT(found, 5'000U);
  EXPECT_LE(100 * unresolved, expressions) << "a warning is for what cannot be resolved";
}

}  // namespace
