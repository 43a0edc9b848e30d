// Mechanics whose formulas change where a condition does: forces with kinks and jumps, with known motions.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <variant>

#include "core/run/suggestions.hpp"
#include "tests/support/texts.hpp"

namespace choices {
namespace {

using namespace texts;

double last_of(Request request, const char* scheme, double end) {
  request.scheme = find_scheme(scheme).value();
  request.settings = plain_settings(&runs::card(request), schemes()[request.scheme], nullptr);
  runs::only_final(request);
  request.end = end;
  const auto outcome = runs::go(request).outcome;
  EXPECT_EQ(outcome.stop.reason, ReturnCode::completed) << scheme << " " << outcome.stop.detail;
  return outcome.final[0];
}
Request from(const Definition& definition, std::initializer_list<double> start) {
  Request request = typed_as(runs::defaults("van_der_pol", "taylor"), mechanics_of(definition));
  begin_at(request, std::vector<double>(start));
  return request;
}

/// between_slopes() returns the position of a ball in V = |x| from rest at x = 1: parabolas, with the period 4 sqrt(2).
double between_slopes(double t) {
  const double period = 4 * std::sqrt(2.0), phase = std::fmod(t, period), quarter = period / 4;
  const double away = phase < 2 * quarter ? phase : period - phase;  // since the start, or until it is back
  return away < quarter ? 1 - away * away / 2 : (2 * quarter - away) * (2 * quarter - away) / 2 - 1;
}

TEST(Choices, EndTheStepsOfSchemesWithAClockOfTheirOwn) {
  constexpr auto V = Definition::Kind::potential;
  for (const char* text :
       {"abs(x)", "max(x, -x)", "sign(x)*x", "if(x < 0, -x, x)", "if(not (x >= 0 and 1 < 2), -x, x)", "-min(x, -x)"}) {
    const Request request = from(of(V, {"x"}, {}, text), {1, 0});
    for (const double t : {1.0, 3.0, 20.0}) {
      EXPECT_NEAR(last_of(request, "taylor", t), between_slopes(t), 1e-11) << text << " at " << t;
      for (const char* scheme : {"dormand_prince_5", "fehlberg_78", "bulirsch_stoer"})
        EXPECT_NEAR(last_of(request, scheme, t), between_slopes(t), 1e-7) << text << " at " << t << " by " << scheme;
    }
  }
}

// v' = -v|v|: v = v0/(1 + |v0| t).
TEST(Choices, QuadraticDragSlowsEitherWay) {
  for (const double v : {3.0, -2.0}) {
    const Request request = from(flow({"v"}, {{"c", 1}}, {{"v", "-c*v*abs(v)"}}), {v});
    for (const char* scheme : {"taylor", "fehlberg_78"})
      EXPECT_NEAR(last_of(request, scheme, 5), v / (1 + std::abs(v) * 5), 1e-9) << scheme;
  }
}

// A spring that is stiffer on one side: the motion consists of half periods of either side.
TEST(Choices, SpringsMayHaveTwoSides) {
  const Request request = from(of(Definition::Kind::potential, {"x"}, {{"k", 4}}, "if(x > 0, x^2, k*x^2)/2"), {1, 0});
  const double pi = 3.141592653589793, period = pi + pi / 2;
  EXPECT_NEAR(last_of(request, "taylor", period), 1, 1e-12);
  EXPECT_NEAR(last_of(request, "taylor", period / 2), -0.5, 1e-12);
  EXPECT_NEAR(last_of(request, "leapfrog", 10 * period), 1, 1e-3);
}

/// against_a_wall() returns the position in V = x²/2 + k max(x − c, 0)², two springs, from (x, v) below c: in phase
/// space arcs of circles, one after the other.
double against_a_wall(double k, double c, double x, double v, double t) {
  const double pi = 3.141592653589793;
  for (bool above = false;; above = !above) {
    const double w = above ? std::sqrt(1 + 2 * k) : 1, middle = above ? 2 * k * c / (1 + 2 * k) : 0;
    const double radius = std::hypot(x - middle, v / w), phase = std::atan2(-v / w, x - middle);
    if (!above && radius <= c) return middle + radius * std::cos(w * t + phase);
    const double border = (above ? 1 : -1) * std::acos((c - middle) / radius);  // where it is crossed outwards
    const double angle = std::remainder(border - phase - pi, 2 * pi) + pi, until = angle / w;
    if (until >= t) return middle + radius * std::cos(w * t + phase);
    x = c;
    v = -radius * w * std::sin(border);
    t -= until;
  }
}

// Steps are longer than half a period, and rounding makes some of them end just before the wall.
TEST(Choices, NoStepGoesOverAWall) {
  for (const double k : {1.0, 5.0, 20.0})
    for (const double c : {0.15, 0.45, 0.8})
      for (int i = 0; i < 5; ++i) {
        const double x = 0.1 - 0.07 * i, v = 1.2 - 0.11 * i;
        const Request request =
            from(of(Definition::Kind::potential, {"x"}, {{"k", k}, {"c", c}}, "x^2/2 + k*max(x - c, 0)^2"), {x, v});
        EXPECT_NEAR(last_of(request, "taylor", 20), against_a_wall(k, c, x, v, 20), 1e-10) << k << ' ' << c << ' ' << i;
      }
}

// Where a pulse may come later, a step is checked against the equations; behind a switch the equations are other ones.
TEST(Choices, CostNoStepsMoreBesideASleepingForce) {
  constexpr const char* pulse = "exp(-60*(t-5.4)^2)";
  const auto run = [](const Definition& definition) {
    Request request = from(definition, {1, 0.2});
    runs::only_final(request);
    request.end = 4;
    return runs::go(request).outcome;
  };
  const auto as_without = [&](const Definition& alone, const Definition& beside, std::int64_t most) {
    const auto quiet = run(alone), asleep = run(beside);
    ASSERT_EQ(asleep.stop.reason, ReturnCode::completed) << asleep.stop.detail;
    EXPECT_LE(quiet.cost.steps, most);
    EXPECT_LE(asleep.cost.steps, most);
    for (std::size_t i = 0; i < quiet.final.size(); ++i) EXPECT_NEAR(asleep.final[i], quiet.final[i], 1e-11);
  };
  for (const char* text : {"abs(x)", "if(x < -0.2, 0, x^2)", "max(x - 0.3, 0)^2", "x*if(t < 2, 1, 3)"}) {
    SCOPED_TRACE(text);
    const auto potential = [&](const std::string& more) {
      return of(Definition::Kind::potential, {"x"}, {}, std::string("x^2/2 + ") + text + more);
    };
    as_without(potential(""), potential(std::string(" + x*") + pulse), 6);
  }
  for (const char* text : {"-0.3*sign(vx)", "-0.3*sign(x)", "-0.3*vx*abs(vx)"}) {
    SCOPED_TRACE(text);
    const auto under = [&](const std::string& force) {
      Definition pushed = of(Definition::Kind::potential, {"x"}, {}, "x^2/2");
      pushed.forces = {{"x", force}};
      return pushed;
    };
    as_without(under(text), under(std::string(text) + " + " + pulse), 6);
  }
}

/// under_a_square_wave() returns x from rest at 0, where x'' alternates between 1 and −1 with the frequency w, first 1.
double under_a_square_wave(double w, double t) {
  const double half = std::acos(-1.0) / w, turns = std::floor(t / half), left = t - turns * half;
  const bool up = std::fmod(turns, 2) == 0;  // then v is 0 at the start of the half turn, else `half`
  return half * half * (turns / 2) + (up ? left * left / 2 : half * left - left * left / 2);
}

// The series of a slow motion says nothing of a force that changes its sign twice, or thirty times, within a step.
TEST(Choices, AreSeenHoweverOftenTheyChangeInAStep) {
  for (const double w : {3.0, 20.0, 200.0}) {
    const Request request = from(flow({"x", "v"}, {{"w", w}}, {{"x", "v"}, {"v", "sign(sin(w*t))"}}), {0, 0});
    EXPECT_NEAR(last_of(request, "taylor", 5), under_a_square_wave(w, 5), 1e-11) << w;
    const Truth truth = request.scene->mechanics->truth(*request.scene, {1, 5}, [] { return true; });
    ASSERT_TRUE(truth.complete) << w;
    for (const std::size_t i : {std::size_t(0), std::size_t(1)})
      EXPECT_NEAR(truth.states[i][0], under_a_square_wave(w, i == 0 ? 1 : 5), 1e-14) << w;
    EXPECT_LT(truth.uncertainty, 1e-13) << w;
  }
  // The force acts only for a short time in each turn: in that time the series sees only a parabola, up and down again.
  const double pi = std::acos(-1.0), share = std::acos(0.99) / pi;
  const Request rare = from(flow({"x"}, {}, {{"x", "if(cos(7*t) > 0.99, 1, 0)"}}), {0});
  EXPECT_NEAR(last_of(rare, "taylor", 2 * pi), 2 * pi * share, 1e-11);
  const Truth truth = rare.scene->mechanics->truth(*rare.scene, {2 * pi}, [] { return true; });
  ASSERT_TRUE(truth.complete);
  EXPECT_NEAR(truth.states[0][0], 2 * pi * share, 1e-14);
  // A choice by the state: a bump that a fast ball crosses.
  const Request bump = from(flow({"x", "v"}, {}, {{"x", "v"}, {"v", "if(abs(x - 1) < 0.001, 10, 0)"}}), {0, 2});
  EXPECT_NEAR(last_of(bump, "taylor", 0.4995), 0.999, 1e-12);
  const double beyond = std::sqrt(4 + 2 * 10 * 0.002), through = (beyond - 2) / 10;
  EXPECT_NEAR(last_of(bump, "taylor", 2), 1.001 + beyond * (2 - 0.4995 - through), 1e-11);
}

// At a start on the border, at rest or not, the state does not yet say to which side the motion goes.
TEST(Choices, MayBeginOnTheBorder) {
  constexpr auto V = Definition::Kind::potential;
  constexpr std::int64_t few = 100, enough = 40'000;
  const auto final_of = [](const char* text, double v, const char* scheme, std::int64_t most_steps) {
    Request request = from(of(V, {"x"}, {}, text), {1, v});
    request.limits.steps = most_steps;
    return last_of(request, scheme, 1);
  };
  for (const char* text : {"if(x < 1, x^2, 4*x^2 - 3)/2", "if(x >= 1, 4*x^2 - 3, x^2)/2"}) {
    for (const double v : {0.0, -0.5}) {
      const double there = std::cos(1) + v * std::sin(1);
      EXPECT_NEAR(final_of(text, v, "taylor", few), there, 1e-12) << text << " from " << v;
      for (const char* scheme : {"dormand_prince_5", "bulirsch_stoer"})
        EXPECT_NEAR(final_of(text, v, scheme, enough), there, 1e-5) << text << " from " << v << " by " << scheme;
    }
  }
  const auto from_zero = [](double v, const char* text) {
    Request request = from(of(V, {"x"}, {}, text), {0, v});
    request.limits.steps = few;
    return last_of(request, "taylor", 1);
  };
  EXPECT_NEAR(from_zero(0, "if(x < 0, x, 2*x)"), -0.5, 1e-15);
  EXPECT_NEAR(from_zero(-1, "if(x < 0, -x, x)"), -0.5, 1e-15);
  // At (1, 1) atan2 changes between its formulas with y/x and with x/y.
  EXPECT_NEAR(final_of("atan2(x, 1)^2/2", 0, "taylor", few), final_of("atan(x)^2/2", 0, "taylor", few), 1e-12);
}

TEST(Choices, OfTheStateStandBesideThoseOfIndices) {
  text::TypedScene typed;
  typed.scene = of(Definition::Kind::potential, {"x[3]"}, {},
                   "sum(i=1..3, if(i == 2, if(x[i] < 0 and i > 1, -2*x[i], x[i]), x[i]^2/2))");
  auto made = custom_mechanics(typed);
  ASSERT_TRUE(std::holds_alternative<std::shared_ptr<const Mechanics>>(made));
  Request request =
      typed_as(runs::defaults("harmonic_oscillator", "taylor"), std::get<std::shared_ptr<const Mechanics>>(made));
  begin_at(request, std::array{1.0, 0.5, 1.0});
  runs::only_final(request);
  request.end = 1.5;  // x[2] falls by 1/2 in t = 1, then rises with 2
  const auto last = runs::go(request).outcome.final;
  EXPECT_NEAR(last[0], std::cos(1.5), 1e-12);
  EXPECT_NEAR(last[1], -0.5 + 0.25, 1e-12);
}

// Steps that follow the curvature of V find none in the gap: there they follow the kinetic energy.
TEST(Choices, MayLeaveStepsNoFrequencyToFollow) {
  Request request = from(of(Definition::Kind::potential, {"x"}, {}, "max(abs(x) - 1, 0)^4"), {2, 0});
  request.scheme = find_scheme("adaptive_verlet").value();
  request.settings = plain_settings(&runs::card(request), schemes()[request.scheme], nullptr);
  runs::only_final(request);
  request.end = 10;
  for (const char* monitor : {"frequency", "arclength"}) {
    runs::set(request, "monitor", monitor);
    EXPECT_EQ(runs::go(request).outcome.stop.reason, ReturnCode::completed) << monitor;
  }
}

// A choice by an undefined value is undefined: a run that reaches it stops, and one that begins there is refused.
TEST(Choices, AreNoNumbersByWhatIsNone) {
  constexpr auto V = Definition::Kind::potential;
  for (const char* text :
       {"if(log(p) >= 0, x^2, x^4)", "if(log(p) < 0, x^2, x^4)", "x^2*max(log(p), 1)", "x^2*min(1, log(p))",
        "x^2 + 0*log(p)", "x^2 + sign(log(p))", "if(x > 9 or log(p) > 0, x, x^2)", "if(log(x) >= 0, x^2, x^4)",
        "max(log(x), 1)*x^2", "sign(log(x))*x^2", "abs(log(x))", "if(x^1.5 < 1, x, x^2)",
        "if(asin(2 + x^2) < 0, x, x^2)"}) {
    const auto mechanics = mechanics_of(of(V, {"x"}, {{"p", -1}}, text));
    const auto refused = [&](double x, double p) {
      const std::vector<double> parameters{p};
      std::vector<double> state(mechanics->card().variables.size(), 0.0);
      state[0] = x;
      return mechanics->text()->objection(parameters) || mechanics->text()->objection_to_start(parameters, 0, state);
    };
    EXPECT_TRUE(refused(-2, -1)) << text;
    if (std::string(text).find("asin") == std::string::npos) {
      EXPECT_FALSE(refused(2, 3)) << text;
    }
  }
  // The branch not taken, and a condition that an earlier one makes irrelevant, may be undefined.
  for (const char* text : {"if(x > 0, log(x), x^2)", "if(x > 0 and log(x) > 1, x, x^2)",
                           "if(x <= 0 or log(x) > 1, x^2, x)", "if(sqrt(1 + x^2) < 1, x, x^2)"})
    EXPECT_NEAR(last_of(from(of(V, {"x"}, {}, text), {-2, -1}), "leapfrog", 0.01), -2.01 + 4 * 0.01 * 0.01 / 2, 1e-5)
        << text;
  Request falls = from(of(V, {"x"}, {}, "if(log(x) < 9, x, x^2)"), {0.5, 0});  // x = 0 at t = 1
  for (const char* scheme : {"leapfrog", "runge_kutta_4", "taylor", "dormand_prince_5"}) {
    falls.scheme = find_scheme(scheme).value();
    falls.settings = plain_settings(&runs::card(falls), schemes()[falls.scheme], nullptr);
    runs::only_final(falls);
    falls.end = 3;
    const auto outcome = runs::go(falls).outcome;
    EXPECT_NE(outcome.stop.reason, ReturnCode::completed) << scheme;
    EXPECT_NEAR(outcome.t, 1, 0.02) << scheme;
  }
}

}  // namespace
}  // namespace choices
