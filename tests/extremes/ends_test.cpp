// Motions that end at a place where their rates are infinite or not defined: every scheme that chooses its own steps
// ends there, soon, and says when. A place that only looks like an end does not stop a run.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "tests/extremes/asking.hpp"
#include "tests/support/texts.hpp"

namespace ends_of_motions {  // other files may share the translation unit
namespace {

using namespace texts;
using namespace asking;

std::string digits(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "(%.17g)", x);
  return text;
}

struct Motion {
  std::string what;
  Definition definition;
  std::vector<double> start;
  double ends;  ///< the time of the end, by a closed form
};
Motion moving(Definition::Named equations, std::vector<double> start, double ends) {
  std::vector<std::string> variables;
  std::string what;
  for (const auto& [name, formula] : equations) {
    variables.push_back(name);
    what += name + "' = " + formula + " ";
  }
  return {what, flow(variables, {}, std::move(equations)), std::move(start), ends};
}
Request of(const Motion& motion, std::string_view scheme, double end) {
  Request request = typed_as(runs::defaults("harmonic_oscillator", scheme), mechanics_of(motion.definition));
  auto& initial = runs::scene(request).initial;  // has room for variables that the equations do not use
  std::ranges::fill(initial, 0);
  std::ranges::copy(motion.start, initial.begin());
  request.end = end;
  request.limits.seconds = 5;
  runs::only_final(request);
  return request;
}

class Draw {
 public:
  explicit Draw(unsigned seed) : bits_(seed) {}
  double operator()(double low, double high) {
    return low + (high - low) * static_cast<double>(bits_()) / static_cast<double>(std::mt19937::max());
  }

 private:
  std::mt19937 bits_;
};
/// zero() returns the zero of an increasing function between 0 and `high`.
template <class F>
double zero(F&& f, double high) {
  double low = 0;
  for (int i = 0; i < 200; ++i) (f((low + high) / 2) < 0 ? low : high) = (low + high) / 2;
  return low;
}

/// x^(1 + p) = x₀^(1 + p) − (1 + p) c t.
Motion falls(Draw& draw) {
  const double c = draw(0.2, 5), x = draw(0.3, 5), p = draw(0, 1) < 0.5 ? std::floor(draw(1, 4)) : draw(0.15, 3);
  return moving({{"x", "-" + digits(c) + "*x^(-" + digits(p) + ")"}}, {x}, std::pow(x, 1 + p) / (c * (1 + p)));
}
/// x^(1 − p) = x₀^(1 − p) − (p − 1) c t.
Motion blows_up(Draw& draw) {
  const double c = draw(0.2, 5), x = draw(0.3, 5), p = draw(0, 1) < 0.5 ? std::floor(draw(2, 5)) : draw(1.3, 4);
  return moving({{"x", digits(c) + "*x^" + digits(p)}}, {x}, std::pow(x, 1 - p) / (c * (p - 1)));
}
/// The rate depends on time, too: x^(1 + p) = x₀^(1 + p) − (1 + p) (a t + b (1 − cos w t)/w).
Motion falls_in_time(Draw& draw) {
  const double a = draw(0.5, 2), b = draw(0, 0.4), w = draw(1, 20), x = draw(0.3, 2), p = draw(0.3, 3);
  const auto left = [=](double t) { return (1 + p) * (a * t + b * (1 - std::cos(w * t)) / w) - std::pow(x, 1 + p); };
  return moving({{"x", "-(" + digits(a) + "+" + digits(b) + "*sin(" + digits(w) + "*t))*x^(-" + digits(p) + ")"}}, {x},
                zero(left, 1e3));
}
/// The rate depends on another variable: x² = x₀² + y₀² − (y₀ + t)².
Motion falls_beside(Draw& draw) {
  const double x = draw(0.3, 3), y = draw(0.1, 3);
  return moving({{"x", "-y/x"}, {"y", "1"}}, {x, y}, std::hypot(x, y) - y);
}
/// A fall from rest onto a centre.
Motion collides(Draw& draw) {
  const double k = draw(0.2, 5), x = draw(0.3, 5);
  return moving({{"x", "v"}, {"v", "-" + digits(k) + "/x^2"}}, {x, 0}, pi * std::sqrt(x * x * x / (8 * k)));
}
/// A universe that collapses: a = m sin²θ/k.
Motion falls_together(Draw& draw) {
  const double m = draw(0.3, 2), k = draw(0.1, 0.9), a = draw(0.1, 0.9) * m / k,
               angle = std::asin(std::sqrt(k * a / m));
  return moving({{"a", "-sqrt(" + digits(m) + "/a - " + digits(k) + ")"}}, {a},
                m * std::pow(k, -1.5) * (angle - std::sin(angle) * std::cos(angle)));
}
/// A motion to where the rate vanishes and has no derivative, fast enough that the time of arrival is well defined:
/// x^(1 − q) = x₀^(1 − q) − (1 − q) t.
Motion comes_to_rest(Draw& draw) {
  const double x = draw(0.3, 5), q = draw(0.15, 0.5);
  return moving({{"x", "-x^" + digits(q)}}, {x}, std::pow(x, 1 - q) / (1 - q));
}

void ends(const Motion& motion, std::string_view scheme) {
  const auto outcome = runs::go(of(motion, scheme, 3 * motion.ends)).outcome;
  const std::string what = motion.what + std::string(scheme);
  EXPECT_TRUE(outcome.stop.reason == ReturnCode::singular || outcome.stop.reason == ReturnCode::not_finite)
      << what << ": " << name(outcome.stop.reason);
  EXPECT_LT(outcome.cost.steps, 5000) << what;
  EXPECT_NEAR(outcome.stop.singular_at.value_or(-1), motion.ends, 1e-4 * motion.ends) << what;
  const auto before = runs::go(of(motion, scheme, 0.9 * motion.ends)).outcome;
  EXPECT_EQ(before.stop.reason, ReturnCode::completed) << what;
  EXPECT_FALSE(before.stop.singular_at) << what;
}

TEST(MotionEnds, WhereRatesAreInfinite) {
  Draw draw(36);
  for (int k = 0; k < 12; ++k)
    for (const auto family : {falls, blows_up, falls_in_time, falls_beside, collides, falls_together}) {
      const Motion motion = family(draw);
      for (const std::string_view scheme : adaptive) ends(motion, scheme);
    }
}

TEST(MotionEnds, WhereRatesAreNotDefined) {
  Draw draw(37);
  for (int k = 0; k < 25; ++k) {
    const Motion motion = comes_to_rest(draw);
    for (const std::string_view scheme : {"dormand_prince_5", "fehlberg_78", "bulirsch_stoer"}) ends(motion, scheme);
  }
}

// At the largest size of a closed universe the rate vanishes and has no derivative: the motion may rest there or turn
// back, and no scheme spends its time on the choice.
TEST(MotionEnds, WhereItHasTwoWaysToGoOn) {
  Draw draw(38);
  for (int k = 0; k < 10; ++k) {
    const double m = draw(0.5, 2), a = draw(0.1, 0.9) * m;
    const double angle = std::asin(std::sqrt(a / m)), turns = m * (pi / 2 - angle + std::sin(angle) * std::cos(angle));
    const Motion motion = moving({{"a", "sqrt(" + digits(m) + "/a - 1)"}}, {a}, turns);
    for (const std::string_view scheme : {"dormand_prince_5", "fehlberg_78"}) {
      const auto outcome = runs::go(of(motion, scheme, 6 * turns)).outcome;
      EXPECT_LT(outcome.cost.steps, 5000) << motion.what << scheme;
      EXPECT_NEAR(outcome.final[0], m, 1e-5) << motion.what << scheme;
      if (outcome.stop.singular_at) {
        EXPECT_NEAR(*outcome.stop.singular_at, turns, 1e-4 * turns) << motion.what << scheme;
      }
    }
  }
}

// Steps of equal length overflow some time after the end; control runs say where it is.
TEST(MotionEnds, OfEqualStepsIsToldByControls) {
  Draw draw(39);
  for (int k = 0; k < 20; ++k) {
    const Motion motion = blows_up(draw);
    for (const std::string_view scheme : {"explicit_euler", "runge_kutta_4"}) {
      Request request = of(motion, scheme, 3 * motion.ends);
      runs::set(request, "step", 1e-3 * motion.ends);
      const auto outcome = runs::go(request).outcome;
      ASSERT_EQ(outcome.stop.reason, ReturnCode::not_finite) << motion.what;
      EXPECT_NEAR(outcome.stop.singular_at.value_or(-1), motion.ends, 1e-4 * motion.ends) << motion.what << scheme;
    }
  }
}

struct NoEnd {
  Motion motion;
  double start, end;
  std::vector<ReturnCode> reasons;
};

// Numbers that overflow, steps that a stiff or fast motion keeps short, friction that changes sign with the velocity,
// and a time so large that rounding changes it: none of these is a singularity.
TEST(MotionEnds, NotWhereItOnlyLooksLikeIt) {
  constexpr auto limit = ReturnCode::step_limit, completed = ReturnCode::completed;
  const NoEnd all[] = {
      {moving({{"x", "x"}}, {1}, 0), 0, 1000, {ReturnCode::not_finite}},
      {moving({{"x", "exp(exp(t))"}}, {1}, 0), 0, 10, {ReturnCode::not_finite}},
      {moving({{"x", "cos(exp(t))"}}, {1}, 0), 0, 40, {limit}},
      {moving({{"x", "-1e20*x"}}, {1}, 0), 0, 5, {limit}},
      {moving({{"x", "v"}, {"v", "-1e18*x"}}, {1, 0}, 0), 0, 5, {limit}},
      // Steps that resolve this are too short to change the time, so that the run may call it singular.
      {moving({{"x", "-tanh(1e20*x)"}}, {1}, 0), 0, 5, {limit, completed, ReturnCode::singular}},
      {moving({{"x", "-tanh(1e9*x)"}}, {1}, 0), 0, 5, {limit, completed}},
      {moving({{"x", "x^2*(1-x)"}}, {1e-7}, 0), 0, 1e9, {limit, completed}},  // a flame, stiff once it burns
      {moving({{"x", "v"}, {"v", "-x"}}, {1, 0}, 0), 1e17, 2e17, {ReturnCode::singular, limit}},
      // An orbit close to its sun, in a run so long that every step is short against it.
      {moving({{"x", "u"}, {"y", "w"}, {"u", "-x*(x^2+y^2)^(-1.5)"}, {"w", "-y*(x^2+y^2)^(-1.5)"}},
              {1.96, 0, 0, std::sqrt(0.04 / 1.96)}, 0),
       0,
       1e7,
       {limit}},
  };
  for (const NoEnd& one : all)
    for (const std::string_view scheme : {"dormand_prince_5", "fehlberg_78", "bulirsch_stoer", "taylor"}) {
      Request request = of(one.motion, scheme, one.end);
      runs::scene(request).start = one.start;
      request.limits.steps = 30'000;
      const auto outcome = runs::go(request).outcome;
      EXPECT_FALSE(outcome.stop.singular_at) << one.motion.what << scheme;
      EXPECT_NE(std::ranges::find(one.reasons, outcome.stop.reason), one.reasons.end())
          << one.motion.what << scheme << ": " << name(outcome.stop.reason) << ' ' << outcome.stop.detail;
    }
  // Robertson's problem, whose numerical motion escapes at a loose tolerance.
  const Motion robertson =
      moving({{"a", "-0.04*a+1e4*b*c"}, {"b", "0.04*a-1e4*b*c-3e7*b^2"}, {"c", "3e7*b^2"}}, {1, 0, 0}, 0);
  for (const std::string_view scheme : {"dormand_prince_5"}) {
    Request request = of(robertson, scheme, 40);
    runs::set(request, "tolerance", 1e-4);
    const auto outcome = runs::go(request).outcome;
    EXPECT_NE(outcome.stop.reason, ReturnCode::completed) << scheme << ": it no longer runs away, nothing is tested";
    EXPECT_FALSE(outcome.stop.singular_at) << scheme;
  }
}

// ── references ──────────────────────────────────────────────────────────────────────────────────────────────────────

// A reference ends at the same place, and says at once that it goes no further.
TEST(MotionEnds, OfTheReferenceTakesNoTime) {
  Draw draw(40);
  for (int k = 0; k < 6; ++k)
    for (const auto family : {comes_to_rest, falls, falls_together}) {
      const Motion motion = family(draw);
      for (const std::string_view scheme : {"explicit_euler", "dormand_prince_5"}) {
        Request request = of(motion, scheme, 1.5 * motion.ends);
        if (scheme == "explicit_euler") runs::set(request, "step", 0.01 * motion.ends);
        request.limits = {10, 100'000, 1'000'000};
        runs::ask(request, "error");
        const double before = read_clock();
        const auto outcome = runs::go(request).outcome;
        const std::string what = motion.what + std::string(scheme);
        EXPECT_LT(read_clock() - before, 3) << what;
        if (outcome.t < motion.ends) continue;  // it stopped before the end: there is a true solution
        EXPECT_TRUE(std::isnan(runs::number(outcome.diagnostics, "error/max"))) << what;
        EXPECT_EQ(std::ranges::count(outcome.warnings, "reference_not_finished", &Warning::code), 1) << what;
      }
    }
}

// A chaotic motion loses thirty digits after some time. From then on nothing is known of errors.
TEST(Reference, ThatIsAsUncertainAsTheErrorIsNone) {
  const Motion lorenz = moving({{"x", "10*(y-x)"}, {"y", "x*(28-z)-y"}, {"z", "x*y-8/3*z"}}, {-13.76, -19.58, 27}, 0);
  for (const double end : {10.0, 120.0}) {
    Request request = of(lorenz, "runge_kutta_4", end);
    runs::set(request, "step", 0.002);
    request.limits = {30, 1'000'000, 1'000'000};
    request.record = {Record::Mode::samples, 5, {}};
    request.columns = {0, runs::position(runs::card(request).columns, "error", &ColumnCard::name)};
    runs::ask(request, "error");
    const auto [outcome, rows] = runs::go(request);
    const bool known = end < 50;
    EXPECT_EQ(std::isfinite(runs::number(outcome.diagnostics, "error/max")), known) << end;
    EXPECT_EQ(std::isfinite(runs::number(outcome.diagnostics, "error/final")), known) << end;
    EXPECT_EQ(std::isfinite(rows.back()[1]), known) << end;
    EXPECT_EQ(std::ranges::count(outcome.warnings, "reference_not_finished", &Warning::code), known ? 0 : 1) << end;
    EXPECT_EQ(runs::number(outcome.diagnostics, "error/uncertainty") > 0.1, !known) << end;
  }
}

}  // namespace
}  // namespace ends_of_motions
