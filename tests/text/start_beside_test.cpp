// Starts at a singularity of the coordinates that the motion passes.
#include "core/catalogue/start_beside.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <ctime>

#include "core/text/scene.hpp"
#include "tests/support/texts.hpp"

namespace {

using namespace texts;

constexpr auto typed_l = Definition::Kind::lagrangian, typed_h = Definition::Kind::hamiltonian;

Scene scene_of(const Definition& definition, const std::vector<double>& start, double t = 0) {
  const auto mechanics = mechanics_of(definition);
  Scene scene{mechanics, {}, {}, t};
  for (const auto& parameter : mechanics->card().parameters) scene.parameters.push_back(parameter.value);
  std::size_t next = 0;
  for (const auto& variable : mechanics->card().variables)
    scene.initial.push_back(variable.hidden || next == start.size() ? 0 : start[next++]);
  return scene;
}
/// final_of() returns the text's variables at the end of a run from a start beside the singularity; empty where there
/// is no such start.
std::vector<double> final_of(Scene scene, std::string_view scheme, double end) {
  const auto other = start_beside(scene);
  if (!other) return {};
  scene.initial = *other;
  Request request = runs::defaults("kepler", "runge_kutta_4");
  request.scheme = find_scheme(scheme).value();
  request.settings.clear();
  for (const auto& setting : schemes()[request.scheme].parameters) request.settings.push_back(setting.value);
  request.scene = std::make_shared<const Scene>(scene);
  request.columns = {0};
  request.diagnostics.clear();
  request.end = scene.start + end;
  runs::only_final(request);
  const auto outcome = runs::go(request).outcome;
  EXPECT_EQ(outcome.stop.reason, ReturnCode::completed) << scheme << " " << outcome.stop.detail;
  std::vector<double> shown;
  for (std::size_t i = 0; i < scene.card().variables.size(); ++i)
    if (!scene.card().variables[i].hidden) shown.push_back(outcome.final[i]);
  return shown;
}

Definition sphere(const std::string& potential = "-cos(theta)") {
  return of(typed_l, {"theta", "phi"}, {}, "(vtheta^2 + sin(theta)^2*vphi^2)/2 - (" + potential + ")");
}
Definition sphere_by_momenta() {
  return of(typed_h, {"theta", "phi"}, {}, "ptheta^2/2 + pphi^2/(2*sin(theta)^2) - cos(theta)");
}

// Without a momentum about the pole it is a plane pendulum, whose equations have no pole.
TEST(StartAtThePole, OfASphericalPendulumIsThatOfAPlaneOne) {
  const Definition plane = of(typed_l, {"theta"}, {}, "vtheta^2/2 + cos(theta)");
  for (const double rate : {1.0, -0.3, 2.5}) {
    Request request = runs::defaults("kepler", "taylor");
    request.scene = std::make_shared<const Scene>(scene_of(plane, {0, rate}));
    request.columns = {0};
    request.diagnostics.clear();
    request.end = 10;
    runs::only_final(request);
    const auto truth = runs::go(request).outcome.final;
    const std::size_t momentum = truth.size() / 2;
    for (const auto& definition : {sphere(), sphere_by_momenta()})
      for (const char* scheme : {"taylor", "fehlberg_78"}) {
        const auto x = final_of(scene_of(definition, {0, 0.4, rate, 0}), scheme, 10);
        ASSERT_EQ(x.size(), 4U) << scheme;
        const double close = std::string_view(scheme) == "taylor" ? 1e-9 : 1e-6;
        EXPECT_NEAR(x[0], truth[0], close) << scheme;
        EXPECT_NEAR(x[1], 0.4, 1e-12) << scheme;
        EXPECT_NEAR(x[2], truth[momentum], close) << scheme;
        EXPECT_EQ(x[3], 0) << scheme;
      }
  }
}

// At rest on top of the sphere nothing happens, for as long as rounding permits.
TEST(StartAtThePole, AtRestStaysThere) {
  for (const char* potential : {"cos(theta)", "-cos(theta)"}) {
    const auto x = final_of(scene_of(sphere(potential), {0, 0, 0, 0}), "taylor", 40);
    ASSERT_EQ(x.size(), 4U) << potential;
    EXPECT_LT(std::abs(x[0]), 1e-30) << potential;
  }
}

// Polar coordinates in the plane: straight through the middle of an oscillator, r = sin t; and where two poles meet.
TEST(StartAtThePole, OfOtherCoordinates) {
  const Definition polar = of(typed_l, {"r", "phi"}, {}, "(vr^2 + r^2*vphi^2 - r^2)/2");
  auto x = final_of(scene_of(polar, {0, 0.2, 1, 0}), "taylor", 2);
  ASSERT_EQ(x.size(), 4U);
  EXPECT_NEAR(x[0], std::sin(2), 1e-10);
  const Definition both =
      of(typed_l, {"r", "phi", "u", "psi"}, {}, "(vr^2 + r^2*vphi^2 - r^2)/2 + (vu^2 + u^2*vpsi^2 - 4*u^2)/2");
  x = final_of(scene_of(both, {0, 0.2, 0, 0.1, 1, 0, 2, 0}), "taylor", 2);
  ASSERT_EQ(x.size(), 8U);
  EXPECT_NEAR(x[0], std::sin(2), 1e-10);
  EXPECT_NEAR(x[2], std::sin(4), 1e-10);
  // A flow x' = sin(x)/x from 0: t(x) is the integral of u/sin u, x + x³/18 + 7x⁵/1800 + …
  const Definition sinc = flow({"x"}, {}, {{"x", "sin(x)/x"}});
  x = final_of(scene_of(sinc, {0}), "taylor", 1);
  ASSERT_EQ(x.size(), 1U);
  const double u = x[0], t = u + std::pow(u, 3) / 18 + 7 * std::pow(u, 5) / 1800 + 31 * std::pow(u, 7) / 105840 +
                             127 * std::pow(u, 9) / 5443200 + 73 * std::pow(u, 11) / 37635840;
  EXPECT_NEAR(t, 1, 1e-6);
}

TEST(StartAtThePole, IsRefusedWhereTheMotionHasNoLimit) {
  const struct {
    Definition definition;
    std::vector<double> start;
    const char* advice;
  } rows[] = {
      {sphere_by_momenta(), {0, 0, 0.3, 0.1}, "at theta = 0.001"},  // a momentum about the pole
      {of(typed_l, {"r", "phi"}, {}, "(vr^2 + r^2*vphi^2)/2 + 1/r"), {0, 0, 0, 0}, "at r = 0.001"},
      {of(typed_h, {"x", "y"}, {}, "(px^2 + py^2)/2 - 1/sqrt(x^2 + y^2)"), {0, 0, 1, 0}, "at x = 0.001"},
      {flow({"x", "v"}, {}, {{"x", "v"}, {"v", "-1/x"}}), {0, 1}, "at x = 0.001"},
      // v = c x² for every c, so that many motions begin at x = 0.
      {flow({"x", "v"}, {}, {{"x", "1"}, {"v", "1 + 2*v/x"}}), {0, 0}, "at x = 0.001"},
      // Lane and Emden's equation: only its series knows that v/t is 1/3 of the force at the start.
      {flow({"x", "v"}, {}, {{"x", "v"}, {"v", "-2*v/t - x"}}),
       {1, 0},
       "at t = 0.001, it is regular: start there, with"},
      {flow({"x"}, {}, {{"x", "log(x)"}}), {0}, "at x = 0.001"},
      // Two vortices at one point: beside it they rotate so fast that a few steps show nothing.
      {flow({"x", "y"}, {}, {{"x", "(x-1)/((x-1)^2+(y-1)^2)"}, {"y", "-(y-1)/((x-1)^2+(y-1)^2)"}}),
       {1, 1},
       "at x = 1.001"},
      {of(Definition::Kind::potential, {"x"}, {}, "sqrt(x^2)^3/x^3"), {0, 0}, "at x = 0.001"},  // a jump
      {of(Definition::Kind::potential, {"x"}, {}, "sqrt(-1 - x^2)"), {0, 0}, ""},
  };
  for (const auto& [definition, start, advice] : rows) {
    const Scene scene = scene_of(definition, start);
    ASSERT_TRUE(scene.mechanics->text()->objection_to_start(scene.parameters, scene.start, scene.initial));
    EXPECT_FALSE(start_beside(scene)) << definition.formula << advice;
    const std::string said = advice_on_start(scene);
    EXPECT_TRUE(*advice == '\0' ? said.empty() : said.find(advice) != std::string::npos) << said;
  }
}

// Where a scene without a given start can begin.
TEST(RegularStart, IsAtZeroOrWithOneCoordinateApartOrAll) {
  const struct {
    Definition definition;
    std::vector<double> start;  // empty: there is none
  } rows[] = {
      {of(Definition::Kind::potential, {"x", "y"}, {}, "x^2 + y^2"), {0, 0}},
      {of(typed_l, {"x", "y"}, {}, "(vx^2 + vy^2)/2 + 1/sqrt(x^2 + y^2)"), {1, 0}},
      {of(typed_l, {"phi", "r"}, {}, "(vr^2 + r^2*vphi^2)/2 + 1/r"), {0, 1}},
      {of(typed_h, {"x", "y", "z"}, {}, "(px^2 + py^2 + pz^2)/2 - 1/sqrt((x - y)^2) - 1/z"), {1, 2, 3}},
      {flow({"x", "v"}, {}, {{"x", "v"}, {"v", "-1/x"}}), {1, 0}},
      {of(Definition::Kind::potential, {"x"}, {}, "sqrt(-1 - x^2)"), {}},
  };
  for (const auto& [definition, start] : rows)
    EXPECT_EQ(regular_start(scene_of(definition, {})).value_or(std::vector<double>{}), start) << definition.formula;
}

// Forty bodies at one place: each other start that is tried evaluates 780 attractions anew, for 120 coordinates.
TEST(RegularStart, OfManyBodiesFewStartsAreLookedAt) {
  constexpr double enough = 1.5;  // seconds of the processor; all of them took 4.4
  text::TypedScene typed;
  typed.scene = of(Definition::Kind::potential, {"x[40]", "y[40]", "z[40]"}, {},
                   "-sum(i=1..40, j=i+1..40, 1/sqrt((x[i]-x[j])^2 + (y[i]-y[j])^2 + (z[i]-z[j])^2))");
  auto made = custom_mechanics(typed);
  ASSERT_TRUE(std::holds_alternative<std::shared_ptr<const Mechanics>>(made));
  const auto mechanics = std::get<std::shared_ptr<const Mechanics>>(made);
  const Scene scene{mechanics, {}, std::vector<double>(mechanics->card().variables.size(), 0.0), 0};
  const std::clock_t from = std::clock();
  EXPECT_FALSE(start_beside(scene));
  EXPECT_EQ(advice_on_start(scene), "");
  ASSERT_TRUE(regular_start(scene));
  EXPECT_EQ(regular_start(scene)->back(), 120) << "all apart";
  EXPECT_LT(static_cast<double>(std::clock() - from) / CLOCKS_PER_SEC, enough);
}

}  // namespace
