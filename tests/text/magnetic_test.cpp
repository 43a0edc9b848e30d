// Which scenes as text are recognized as charges in a magnetic field, and the parts that are found.
#include "core/text/magnetic.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/catalogue/found_schemes.hpp"
#include "tests/support/magnetic.hpp"

namespace magnetic {
namespace {

using text::Magnetic;
using text::NotMagnetic;

std::variant<Magnetic, NotMagnetic> found_in(const Definition& definition) {
  const auto mechanics = mechanics_of(definition);
  std::vector<double> parameters;
  for (const auto& parameter : definition.parameters) parameters.push_back(parameter.second);
  const text::TextScene& text = *mechanics->text();
  auto found = text::magnetic(*text.form, parameters, text.definition.variables);
  EXPECT_EQ(runs::fits(mechanics->card(), find_scheme("boris").value()), std::holds_alternative<Magnetic>(found))
      << definition.formula;
  return found;
}
Magnetic field_in(const Definition& definition) {
  auto found = found_in(definition);
  if (const auto* none = std::get_if<NotMagnetic>(&found)) {
    ADD_FAILURE() << definition.formula << ": " << none->why;
    return {};
  }
  return std::get<Magnetic>(std::move(found));
}
std::string objection_to(const Definition& definition) {
  const auto found = found_in(definition);
  const auto* none = std::get_if<NotMagnetic>(&found);
  return none ? none->why : "";
}

TEST(MagneticText, IsFoundHoweverItIsWritten) {
  const std::vector<std::string> plane{"x", "y"};
  const Definition ways[] = {
      of(lagrangian, plane, {{"m", 2}}, "m*(vx^2+vy^2)/2 + 3*x^2*vy/2 - 3*y*vx - x*y^2"),
      of(hamiltonian, plane, {{"m", 2}}, "((px + 3*y)^2 + (py - 3*x^2/2)^2)/(2*m) + x*y^2"),
      of(hamiltonian, plane, {{"m", 2}}, "(px^2 + py^2 + 6*y*px - 3*x^2*py + 9*y^2 + 9*x^4/4)/(2*m) + y*x*y")};
  for (const Definition& way : ways) {
    const Magnetic found = field_in(way);
    ASSERT_EQ(found.groups.size(), 1U) << way.formula;
    EXPECT_EQ(found.groups[0].size, 2U);
    EXPECT_TRUE(found.kicks);
    const double at[] = {0.7, -0.4};
    double fields[3], shift[2];
    ASSERT_EQ(found.fields.outputs(), 3U);
    found.fields.evaluate(at, 0.0, fields);
    found.shift.evaluate(at, 0.0, shift);
    const double root = std::sqrt(2.0);
    EXPECT_NEAR(fields[0], -0.16 / root, 1e-14) << way.formula;
    EXPECT_NEAR(fields[1], 2 * 0.7 * 0.4 / root, 1e-14) << way.formula;
    EXPECT_NEAR(fields[2], (3 * 0.7 + 3) / 2, 1e-14) << "(∂a_y/∂x − ∂a_x/∂y)/m " << way.formula;
    EXPECT_NEAR(shift[0], 1.2 / root, 1e-15);
    EXPECT_NEAR(shift[1], 1.5 * 0.49 / root, 1e-15);
  }
}

// a²/2m is removed from the potential to the last bit: with a field alone there are no kicks.
TEST(MagneticText, AFieldAloneHasNoPotential) {
  const Magnetic found = field_in(bottle());
  EXPECT_FALSE(found.kicks);
  EXPECT_EQ(found.fields.outputs(), 3U);
  EXPECT_FALSE(field_in(of(hamiltonian, {"x", "y"}, {}, "((px + sin(y))^2 + (py - x^3)^2)/2")).kicks);
}

TEST(MagneticText, CoordinatesThatTurnIntoOneAnotherAreGroups) {
  const Magnetic found = field_in(three());
  ASSERT_EQ(found.groups.size(), 3U);
  EXPECT_EQ(found.turns, 9U);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(found.groups[k].of, (std::array<std::size_t, 3>{k, k + 3, k + 6}));
  EXPECT_NEAR(found.root_mass[1], std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(found.inverse_root[2], 1 / std::sqrt(1.5), 1e-15);
}

TEST(MagneticText, WhatIsNoneIsRefusedByName) {
  const auto says = [](const char* h, const char* words) {
    const std::string why = objection_to(of(hamiltonian, {"x", "y", "z", "w"}, {{"c", 1}}, h));
    EXPECT_NE(why.find(words), std::string::npos) << h << ": " << why;
  };
  says("(1+x^2)*px^2/2 + (py^2+pz^2+pw^2)/2 + y*px", "the coefficient of px^2 depends on the place");
  says("px^2*exp(t)/2 + (py^2+pz^2+pw^2)/2 + y*px", "the coefficient of px^2 depends on time");
  says("px^4 + (py^2+pz^2+pw^2)/2 + y*px", "H is not quadratic in px");
  says("(px^2+py^2+pz^2+pw^2)/2 + c*px*py/2 + y*px", "the kinetic energy has a term px*py");
  says("(py^2-px^2+pz^2+pw^2)/2 + y*px", "the mass of x is not positive");
  says("(px^2+py^2+pz^2+pw^2)/2 + cos(t)*y*px", "what is linear in px depends on time");
  says("(px^2+py^2+pz^2+pw^2)/2 + y*px + s*x", "the motion depends on s");
  says("(px^2+py^2+pz^2+pw^2)/2 + y*px + z*py + w*pz", "the field turns more than three velocities into one another");
  EXPECT_NE(objection_to(of(hamiltonian, {"x", "y"}, {}, "(px^2+py^2)/2 + x^2*y")).find("no terms that are linear"),
            std::string::npos);
}

// The card offers the scheme by the typed parameters; with those of a request the scene may be no magnetic field.
TEST(MagneticText, ItIsSaidWithTheParametersOfTheRequest) {
  const auto mechanics =
      mechanics_of(of(hamiltonian, {"x", "y"}, {{"c", 0}}, "(px^2+py^2)/2 + c*px*py/2 + y*px + x^2/2"));
  EXPECT_TRUE(runs::fits(mechanics->card(), find_scheme("boris").value()));
  EXPECT_EQ(objection_to_scheme({mechanics, {0}, {}, 0}, "boris"), "");
  EXPECT_NE(objection_to_scheme({mechanics, {1}, {}, 0}, "boris").find("px*py"), std::string::npos);
  EXPECT_EQ(objection_to_scheme({mechanics, {1}, {}, 0}, "lifted_splitting"), "");
}

}  // namespace
}  // namespace magnetic
