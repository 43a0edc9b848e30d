// Runs that begin on a kink of the potential: across it with a velocity, down from a ridge, at rest in an edge where
// the forces of both sides lead back.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/texts.hpp"

namespace {

using namespace texts;

Solution from(const std::string& formula, std::vector<std::string> variables, const std::vector<double>& state,
              double end, std::string_view scheme) {
  const std::size_t count = variables.size();
  Request request = typed_as(runs::defaults("damped_oscillator", scheme),
                             mechanics_of(of(Definition::Kind::potential, std::move(variables), {}, formula)));
  auto& scene = runs::scene(request);
  scene.start = 0;
  for (std::size_t i = 0; i < count; ++i) {
    runs::begin(request, runs::card(request).variables[i].name, state[i]);
    const std::string momentum = text::momentum_name(runs::card(request).variables[i].name);
    runs::begin(request, momentum, state[count + i]);
  }
  request.end = end;
  request.control = true;
  runs::only_final(request);
  return runs::go(request).outcome;
}
bool warns(const Solution& outcome, std::string_view code) {
  return std::ranges::any_of(outcome.warnings, [&](const Warning& warning) { return warning.code == code; });
}
constexpr std::string_view closely[] = {"taylor", "dormand_prince_5", "fehlberg_78", "bulirsch_stoer"};
constexpr std::string_view in_equal_steps[] = {"leapfrog", "runge_kutta_4", "symplectic_euler"};

// V = |x| from x = 0: up to 1/2, back at t = 2, down to −1/2 at t = 3. V = −|x|: ever faster.
TEST(KinkStart, WithAVelocityIsCrossed) {
  for (const std::string_view scheme : closely)
    for (const double p : {1.0, -1.0}) {
      const auto edge = from("abs(x)", {"x"}, {0, p}, 3, scheme), ridge = from("-abs(x)", {"x"}, {0, p}, 3, scheme);
      ASSERT_EQ(edge.stop.reason, ReturnCode::completed) << scheme << edge.stop.detail;
      EXPECT_NEAR(edge.final[0], -0.5 * p, 1e-8) << scheme;
      ASSERT_EQ(ridge.stop.reason, ReturnCode::completed) << scheme << ridge.stop.detail;
      EXPECT_NEAR(ridge.final[0], 7.5 * p, 1e-7) << scheme;
      EXPECT_TRUE(edge.warnings.empty()) << scheme << edge.warnings[0].code;
      EXPECT_LT(edge.cost.steps, 200) << scheme;
    }
}

// Nothing moves, and no number of ever shorter steps is spent on it.
TEST(KinkStart, AtRestInAnEdgeIsSaid) {
  for (const std::string_view scheme : closely)
    for (const char* formula : {"abs(x)", "max(2*x,-x)", "x^2+abs(x)"}) {
      const auto outcome = from(formula, {"x"}, {0, 0}, 3, scheme);
      EXPECT_EQ(outcome.stop.reason, ReturnCode::singular) << scheme << formula;
      EXPECT_NE(outcome.stop.detail.text().find("begins on a kink"), std::string::npos) << outcome.stop.detail;
      EXPECT_EQ(outcome.cost.steps, 0) << scheme << formula;
    }
  for (const std::string_view scheme : in_equal_steps) {
    const auto outcome = from("abs(x)", {"x"}, {0, 0}, 3, scheme);
    EXPECT_EQ(outcome.stop.reason, ReturnCode::completed) << scheme;
    EXPECT_NEAR(outcome.final[0], 0, 0.1) << scheme;
    EXPECT_TRUE(warns(outcome, "starts_on_kink")) << scheme;
    EXPECT_FALSE(warns(outcome, "off_energy_level")) << scheme;
  }
}

// Dry friction holds what rests: schemes that know that have nothing to say, others say why they stop.
TEST(KinkStart, UnderDryFrictionRests) {
  Definition held = of(Definition::Kind::potential, {"x"}, {}, "x^2/2");
  held.forces = {{"x", "-0.3*sign(vx)"}};
  const auto run = [&](std::string_view scheme) {
    Request request = typed_as(runs::defaults("damped_oscillator", scheme), mechanics_of(held));
    auto& scene = runs::scene(request);
    std::fill(scene.initial.begin(), scene.initial.end(), 0);
    scene.initial[0] = 0.1;
    scene.start = 0;
    request.end = 3;
    request.control = true;
    runs::only_final(request);
    return runs::go(request).outcome;
  };
  const auto rests = run("leapfrog"), stops = run("taylor");
  EXPECT_EQ(rests.stop.reason, ReturnCode::completed);
  EXPECT_EQ(rests.final[0], 0.1);
  EXPECT_FALSE(warns(rests, "starts_on_kink"));
  EXPECT_EQ(stops.stop.reason, ReturnCode::singular);
  EXPECT_TRUE(warns(stops, "force_jumps"));
}

// Down the edge x = y of max(|x|, |y|), by half of either force: x = 1 − t²/4.
TEST(KinkStart, AlongAnEdgeIsFollowedByEqualSteps) {
  const auto slid = from("max(abs(x),abs(y))", {"x", "y"}, {1, 1, 0, 0}, 1, "leapfrog");
  ASSERT_EQ(slid.stop.reason, ReturnCode::completed);
  EXPECT_NEAR(slid.final[0], 0.75, 0.02);
  EXPECT_TRUE(warns(slid, "starts_on_kink"));
  EXPECT_EQ(from("max(abs(x),abs(y))", {"x", "y"}, {1, 1, 0, 0}, 1, "taylor").stop.reason, ReturnCode::singular);
}

// What is left, what is smooth in spite of a choice, and what is stiff is no such start.
TEST(KinkStart, ElsewhereIsNone) {
  for (const std::string_view scheme : closely) {
    const auto ridge = from("-abs(x)", {"x"}, {0, 0}, 3, scheme);
    ASSERT_EQ(ridge.stop.reason, ReturnCode::completed) << scheme << ridge.stop.detail;
    EXPECT_NEAR(std::abs(ridge.final[0]), 4.5, 1e-7) << scheme;
    for (const char* formula : {"max(x,0)^2", "1e8*max(x-1,0)^2+x^2", "if(x<1,x^2,2*x-1)"}) {
      const auto outcome = from(formula, {"x"}, {1, 0}, 0.1, scheme);
      EXPECT_EQ(outcome.stop.reason, ReturnCode::completed) << scheme << formula << outcome.stop.detail;
    }
  }
}

}  // namespace
