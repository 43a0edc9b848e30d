// Which scenes as text are recognized as coupled oscillators, and the modes that are found.
#include "core/text/harmonic.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/catalogue/found_schemes.hpp"
#include "tests/support/texts.hpp"

namespace harmonic_texts {
namespace {

using namespace texts;
using text::Harmonic;
constexpr auto typed_v = Definition::Kind::potential, typed_h = Definition::Kind::hamiltonian,
               typed_l = Definition::Kind::lagrangian;

std::variant<Harmonic, std::string> found_in(const Definition& definition) {
  const auto mechanics = mechanics_of(definition);
  std::vector<double> parameters;
  for (const auto& parameter : definition.parameters) parameters.push_back(parameter.second);
  auto found = text::harmonic(*mechanics->text()->form, parameters);
  EXPECT_EQ(runs::fits(mechanics->card(), find_scheme("harmonic_splitting").value()),
            std::holds_alternative<Harmonic>(found))
      << definition.formula;
  return found;
}
Harmonic oscillators_in(const Definition& definition) {
  auto found = found_in(definition);
  if (const auto* why = std::get_if<std::string>(&found)) {
    ADD_FAILURE() << definition.formula << ": " << *why;
    return {};
  }
  return std::get<Harmonic>(std::move(found));
}
std::string objection_to(const Definition& definition) {
  const auto found = found_in(definition);
  const auto* why = std::get_if<std::string>(&found);
  return why ? *why : "";
}

TEST(HarmonicText, IsFoundHoweverItIsWritten) {
  for (const char* v : {"x^2/2 + 2*y^2 + x^4", "(x^2 + 4*y^2)/2 + x^4", "x^2*(1/2 + x^2) + 2*y*y", "1 - cos(x) + 2*y^2",
                        "exp(x) - x + 2*y^2", "(x - y)^2/2 + x*y + 3*y^2/2"}) {
    const Harmonic found = oscillators_in(of(typed_v, {"x", "y"}, {}, v));
    EXPECT_FALSE(found.mixed) << v;
    ASSERT_EQ(found.squares.size(), 2U);
    EXPECT_NEAR(found.squares[0], 1, 1e-15) << v;
    EXPECT_NEAR(found.squares[1], 4, 1e-15) << v;
    EXPECT_EQ(found.gradient.outputs(), 2U);
  }
}

// Two masses on three springs have the modes 1 and 3; masses and full kinetic matrices are taken into account.
TEST(HarmonicText, CoupledOnesAreModes) {
  const Harmonic springs = oscillators_in(of(typed_v, {"x", "y"}, {}, "x^2/2 + (x-y)^2/2 + y^2/2 + x^3"));
  EXPECT_TRUE(springs.mixed);
  EXPECT_NEAR(springs.squares[0], 1, 1e-14);
  EXPECT_NEAR(springs.squares[1], 3, 1e-14);
  const Harmonic full =
      oscillators_in(of(typed_h, {"x", "y"}, {{"c", 0.5}}, "(px^2 + py^2)/2 + c*px*py + (x^2+y^2)/2"));
  EXPECT_TRUE(full.mixed);
  EXPECT_NEAR(full.squares[0], 0.5, 1e-14);
  EXPECT_NEAR(full.squares[1], 1.5, 1e-14);
  const Harmonic by_velocities =
      oscillators_in(of(typed_l, {"x", "y"}, {{"c", 0.5}}, "(vx^2 + vy^2)/2 + c*vx*vy - (x^2+y^2)/2"));
  EXPECT_NEAR(by_velocities.squares[0], 1 / 1.5, 1e-14);
  EXPECT_NEAR(by_velocities.squares[1], 1 / 0.5, 1e-14);
}

TEST(HarmonicText, WhatIsNoneIsRefusedByName) {
  const auto says = [](const Definition& definition, const char* words) {
    EXPECT_NE(objection_to(definition).find(words), std::string::npos) << objection_to(definition);
  };
  says(of(typed_v, {"x", "y"}, {}, "x^4 + y^4"), "V has no quadratic part at the origin");
  says(of(typed_v, {"x", "y"}, {}, "-1/sqrt(x^2+y^2)"), "where it is not smooth");
  says(of(typed_v, {"x"}, {}, "x^2*(1 + cos(t)/2)"), "the quadratic part of V depends on time");
  says(of(typed_l, {"x", "y"}, {}, "(vx^2 + vy^2*(1+x^2))/2 - x^2/2"), "H is not ½ pᵀM⁻¹p + V(q, t)");
  says(of(typed_l, {"x"}, {}, "vx^2/2 - x^2/2 - s/10"), "H is not ½ pᵀM⁻¹p + V(q, t)");
}

TEST(HarmonicText, ItIsSaidWithTheParametersOfTheRequest) {
  const auto mechanics = mechanics_of(of(typed_v, {"x"}, {{"k", 1}}, "k*x^2/2 + x^4"));
  EXPECT_EQ(objection_to_scheme({mechanics, {2}, {}, 0}, "harmonic_splitting"), "");
  EXPECT_NE(objection_to_scheme({mechanics, {0}, {}, 0}, "harmonic_splitting").find("no quadratic part"),
            std::string::npos);
}

}  // namespace
}  // namespace harmonic_texts
