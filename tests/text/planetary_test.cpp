// Which scenes as text are recognized as orbiting bodies, and what is found in them.
#include "core/text/planetary.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/catalogue/found_schemes.hpp"
#include "tests/support/texts.hpp"

namespace planetary_texts {
namespace {

using namespace texts;
using text::NotPlanetary;
using text::Planetary;
constexpr auto typed_v = Definition::Kind::potential, typed_h = Definition::Kind::hamiltonian,
               typed_l = Definition::Kind::lagrangian;

std::variant<Planetary, NotPlanetary> found_in(const Definition& definition) {
  const auto mechanics = mechanics_of(definition);
  std::vector<double> parameters;
  for (const auto& parameter : definition.parameters) parameters.push_back(parameter.second);
  const text::TextScene& text = *mechanics->text();
  auto found = text::planetary(*text.form, parameters, text.definition.variables);
  const auto& schemes = mechanics->card().schemes;
  const bool offered = std::ranges::find(schemes, find_scheme("kepler_splitting").value()) != schemes.end();
  EXPECT_EQ(offered, std::holds_alternative<Planetary>(found)) << definition.formula;
  return found;
}
Planetary bodies_in(const Definition& definition) {
  auto found = found_in(definition);
  if (const auto* none = std::get_if<NotPlanetary>(&found)) {
    ADD_FAILURE() << definition.formula << ": " << none->why;
    return {};
  }
  return std::get<Planetary>(std::move(found));
}
std::string objection_to(const Definition& definition) {
  const auto found = found_in(definition);
  const auto* none = std::get_if<NotPlanetary>(&found);
  return none ? none->why : "";
}
Definition with_masses(Definition definition, Definition::Named masses) {
  definition.masses = std::move(masses);
  return definition;
}

TEST(PlanetaryText, AFixedCentreIsFoundHoweverItIsWritten) {
  for (const char* v :
       {"-k/sqrt(x^2+y^2)", "-k*(x^2+y^2)^(-1/2)", "-k/hypot(x, y)", "-k/(x*x+y*y)^0.5", "-2*k/sqrt(4*x^2+4*y^2)",
        "-sqrt(k^2/(x^2+y^2))", "-(k/2)/sqrt(x^2/4+y^2/4)", "-1/sqrt((x^2+y^2)/k^2)"}) {
    const auto found = bodies_in(of(typed_v, {"x", "y"}, {{"k", 3}}, v));
    ASSERT_EQ(found.bodies.size(), 1U) << v;
    EXPECT_NEAR(found.bodies[0].strength, 3, 1e-14) << v;
    EXPECT_FALSE(found.about_body);
    EXPECT_EQ(found.rest.outputs(), 0U);
  }
  const auto elsewhere = bodies_in(of(typed_l, {"x", "y", "z"}, {{"a", 0.1}},
                                      "(vx^2+vy^2+vz^2)/2 + 2/sqrt((x-3)^2 + (y+a)^2 + z^2) - 3*(cos(x)*t)"));
  EXPECT_EQ(elsewhere.centre, (std::array<double, 3>{3, -0.1, 0}));
  EXPECT_EQ(elsewhere.bodies[0].strength, 2);
  ASSERT_EQ(elsewhere.rest.outputs(), 3U);
  const double at[] = {0.5, 1, 1};
  double slopes[3];
  elsewhere.rest.evaluate(at, 2.0, slopes);
  EXPECT_NEAR(slopes[0], -std::sin(0.5) * 6, 1e-15);
  EXPECT_EQ(slopes[1], 0);
}

TEST(PlanetaryText, TheHeavyBodyIsTheCentre) {
  // The coordinates have no order at all.
  const auto found =
      bodies_in(with_masses(of(typed_v, {"a", "u", "b", "v", "w", "c"}, {},
                               "-(6/sqrt((a-b)^2+(u-v)^2) + 3*((c-b)^2+(w-v)^2)^(-0.5)) - 0.5/hypot(a-c, w-u) + a*t"),
                            {{"b", "7"}, {"v", "7"}, {"a", "2"}, {"u", "2"}}));
  ASSERT_EQ(found.bodies.size(), 3U);
  EXPECT_TRUE(found.about_body);
  EXPECT_EQ(found.bodies[0].mass, 7);
  EXPECT_EQ(found.bodies[0].coordinates[0], 2U);
  EXPECT_EQ(found.bodies[0].coordinates[1], 3U);
  EXPECT_EQ(found.bodies[1].mass, 2);
  EXPECT_EQ(found.bodies[1].strength, 6);
  EXPECT_EQ(found.bodies[2].strength, 3);
  EXPECT_EQ(found.bodies[2].coordinates[0], 5U);
  EXPECT_EQ(found.bodies[2].coordinates[1], 4U);
  ASSERT_EQ(found.pairs.size(), 1U);
  EXPECT_EQ(found.pairs[0].strength, 0.5);
  EXPECT_EQ(found.rest.outputs(), 6U);

  // Two bodies: their coordinates occur in the same term, and only masses tell them apart.
  const auto two = bodies_in(
      with_masses(of(typed_v, {"a", "b", "c", "d"}, {}, "-1/sqrt((a-b)^2+(c-d)^2)"), {{"b", "2"}, {"c", "2"}}));
  ASSERT_EQ(two.bodies.size(), 2U);
  EXPECT_EQ(two.bodies[0].mass, 2);
  EXPECT_EQ(two.bodies[0].coordinates[1], 2U) << "b and c are one body";
}

TEST(PlanetaryText, WhatIsNoneIsRefusedByName) {
  const auto says = [](const Definition& definition, const char* words) {
    EXPECT_NE(objection_to(definition).find(words), std::string::npos) << objection_to(definition);
  };
  const auto v = [](std::vector<std::string> variables, std::string formula) {
    return of(typed_v, std::move(variables), {}, std::move(formula));
  };
  says(v({"x", "y"}, "x^4/4 + y^2"), "no term −k/r");
  says(v({"x", "y"}, "-1/sqrt(x^2+y^2+0.01)"), "no term −k/r");
  says(v({"x", "y"}, "-1/sqrt(x^2+2*y^2)"), "no term −k/r");
  says(v({"x", "y"}, "-1/sqrt(x^2+x*y+y^2)"), "no term −k/r");
  says(v({"x", "y"}, "-1/(x^2+y^2)"), "no term −k/r");
  says(v({"x", "y"}, "-(1+t)/sqrt(x^2+y^2)"), "no term −k/r");
  says(v({"x"}, "-1/sqrt(x^2)"), "no term −k/r");
  says(v({"x", "y", "u", "v"}, "-1/sqrt((x-u)^2+(y-v)^2 + x*u)"), "no term −k/r");
  says(v({"x", "y", "u", "v"}, "-1/sqrt((x+u)^2+(y-v)^2)"), "no term −k/r");
  says(v({"x", "y", "z"}, "-1/sqrt(x^2+y^2) + z^2"), "z stands in no term");
  says(v({"x", "y"}, "-1/sqrt(x^2+y^2) - 1/sqrt((x-1)^2+y^2)"), "several terms");
  says(v({"x", "y", "u", "v"}, "-1/sqrt(x^2+y^2) - 1/sqrt((u-1)^2+v^2)"), "not the same");
  says(with_masses(v({"x", "y"}, "-1/sqrt(x^2+y^2)"), {{"x", "2"}}), "masses of x and y");
  says(of(typed_h, {"x", "y"}, {}, "px^2+px*py+py^2-1/sqrt(x^2+y^2)"), "not Σ p²/2m");
  const std::string eight = "-1/sqrt((x1-x2)^2+(y1-y2)^2)-1/sqrt((x2-x3)^2+(y2-y3)^2)-1/sqrt((x1-x3)^2+(y1-y3)^2)";
  says(v({"x1", "y1", "x2", "y2", "x3", "y3"}, eight), "no body is heavier");
  says(v({"x1", "y1", "x2", "y2", "x3", "y3", "x4", "y4"},
         "-1/sqrt((x1-x2)^2+(y1-y2)^2)-1/sqrt((x2-x3)^2+(y2-y3)^2)-1/sqrt((x3-x4)^2+(y3-y4)^2)"),
       "each of the others");
  says(v({"x1", "y1", "x2", "y2", "x3", "y3"},
         "-1/sqrt((x1-x2)^2+(y1-y2)^2)-1/sqrt((x1-x3)^2+(y1-y3)^2)-1/sqrt((x2-x3)^2+(y1-y2)^2)"),
       "are those of one body");
}

// The default of the text is a planetary scene, but the parameters of a request are not.
TEST(PlanetaryText, ParametersMayUndoIt) {
  const auto mechanics = mechanics_of(of(typed_v, {"x", "y"}, {{"soft", 0}}, "-1/sqrt(x^2+y^2+soft)"));
  EXPECT_EQ(objection_to_scheme({mechanics, {0}, {}, 0}, "kepler_splitting"), "");
  EXPECT_NE(objection_to_scheme({mechanics, {0.1}, {}, 0}, "kepler_splitting"), "");
  EXPECT_EQ(objection_to_scheme({mechanics, {0.1}, {}, 0}, "leapfrog"), "");
}

// The shared parts of nested powers are examined only once.
TEST(PlanetaryText, LargeTextsAreLookedAtQuickly) {
  std::string power = "x";
  for (int i = 0; i < 40; ++i) power = "(" + power + ")^2";
  for (const std::string& formula :
       {"-1/sqrt(" + power + " + y^2)", "-(" + power + ")/sqrt(x^2 + y^2)", std::string(power)})
    EXPECT_NE(objection_to(of(typed_v, {"x", "y"}, {}, formula)), "") << formula;
}

}  // namespace
}  // namespace planetary_texts
