// The cards of forced scenes: their text, schemes and diagnostics, and which forces are refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/number/exponential.hpp"
#include "tests/support/forced.hpp"

namespace forced {
namespace {

std::vector<std::string> schemes_of(const Definition& definition) {
  std::vector<std::string> all;
  const auto mechanics = mechanics_of(definition);
  for (const auto index : mechanics->card().schemes) all.push_back(schemes()[index].id);
  std::ranges::sort(all);
  return all;
}
bool has(const Definition& definition, std::string_view scheme) {
  return std::ranges::count(schemes_of(definition), scheme) > 0;
}

TEST(ForcedCards, SayWhatIsForced) {
  const auto mechanics = mechanics_of(double_pendulum());
  EXPECT_TRUE(mechanics->text()->form->forced);
  EXPECT_EQ(mechanics->text()->form->kind, text::FormKind::metric);
  EXPECT_FALSE(mechanics->card().keeps_energy);
  EXPECT_FALSE(mechanics->card().keeps_form);
  EXPECT_NE(mechanics->card().offers.find("with forces beside it"), std::string::npos);
  EXPECT_EQ(mechanics->card().variables.size(), 4U) << "the work is no variable";
  const std::vector<std::string> general{"bulirsch_stoer",    "dormand_prince_5", "explicit_euler",
                                         "explicit_midpoint", "fehlberg_78",      "galerkin_4",
                                         "runge_kutta_4",     "taylor",           "variational_midpoint"};
  EXPECT_EQ(schemes_of(double_pendulum()), general);

  const Definition drag = with(of(typed_v, {"x"}, {}, "x^2/2"), {{"x", "-0.1*vx*abs(vx)"}});
  const Definition friction = with(of(typed_v, {"x"}, {}, "x^2/2"), {{"x", "-0.1*vx"}});
  for (const char* scheme : {"leapfrog", "symplectic_euler"}) EXPECT_TRUE(has(drag, scheme)) << scheme;
  for (const char* scheme : {"jacobi_maupertuis", "time_transformed", "adaptive_verlet", "energy_momentum",
                             "contact_leapfrog", "contact_splitting", "contact_gauss"})
    EXPECT_FALSE(has(friction, scheme)) << scheme;
  EXPECT_TRUE(has(friction, "ruth_3"));
  EXPECT_FALSE(has(drag, "ruth_3")) << "its order needs exact kicks";
  EXPECT_NE(mechanics_of(friction)->card().summary.find("contact form"), std::string::npos);
  EXPECT_EQ(mechanics_of(drag)->card().summary.find("contact form"), std::string::npos);
  const Definition driven = with(of(typed_v, {"x"}, {}, "x^2/2"), {{"x", "1 - 0.1*vx"}});
  EXPECT_EQ(mechanics_of(driven)->card().summary.find("contact form"), std::string::npos);
}

TEST(ForcedCards, DerivedEquationsContainTheForces) {
  const auto said = [](const Definition& definition, std::size_t i) {
    return mechanics_of(definition)->text()->equations().at(i).second;
  };
  EXPECT_EQ(said(with(of(typed_v, {"x"}, {}, "x^2/2"), {{"x", "-vx^3"}}), 1), "-px^3 - x");
  Definition heavy = with(of(typed_v, {"x"}, {{"m", 2}, {"c", 1}}, "x^2/2"), {{"x", "-c*vx"}});
  heavy.masses = {{"x", "m"}};
  EXPECT_NE(said(heavy, 1).find("c*"), std::string::npos) << said(heavy, 1);
  EXPECT_NE(said(heavy, 1).find("/m"), std::string::npos) << "velocities are momenta over masses: " << said(heavy, 1);
  EXPECT_NE(said(double_pendulum(), 2).find("c*"), std::string::npos);
  const auto card = mechanics_of(with(of(typed_v, {"x"}, {}, "x^2/2"), {{"x", "-vx^3"}}, "vx^2"))->card();
  EXPECT_NE(card.formula.find("<msub><mi>F</mi><mi>x</mi></msub>"), std::string::npos);
  EXPECT_NE(card.formula.find("<mi>D</mi>"), std::string::npos);
}

TEST(ForcedCards, AreTheirContent) {
  const Definition free = of(typed_v, {"x"}, {}, "x^2/2");
  const Definition all[] = {free, with(free, {{"x", "-vx"}}), with(free, {{"x", "-2*vx"}}), with(free, {}, "vx^2/2"),
                            with(free, {{"x", "-vx"}}, "vx^2/2")};
  for (const auto& one : all)
    for (const auto& other : all) EXPECT_EQ(one.key() == other.key(), &one == &other);
  EXPECT_FALSE(mechanics_of(free)->text()->form->forced);
}

TEST(ForcedCards, WhatIsRefusedSaysWhereAndWhy) {
  const Definition v = of(typed_v, {"x"}, {}, "x^2/2"), h = of(typed_h, {"x"}, {}, "px^2/2 + x^2/2");
  const Definition::Named x{{"x", "1"}};
  struct Refused {
    Definition definition;
    std::string pointer, detail;
  };
  Definition curved = quadratic(v, "0.1", "0"), equations = flow({"x", "v"}, {}, {{"x", "v"}, {"v", "-x"}});
  const Refused all[] = {
      {with(damped(v, "0.1"), x), "/forces", "damping"},
      {with(damped(v, "0.1"), {}, "vx^2"), "/dissipation", "damping"},
      {with(curved, x), "/forces", "action_curvature"},
      {with(of(typed_l, {"x"}, {}, "vx^2/2 - 0.1*s"), x), "/forces", "s in the mechanics"},
      {with(of(typed_h, {"x"}, {}, "px^2/2 + 0.1*s^2*x"), x), "/forces", "s in the mechanics"},
      {with(of(typed_l, {"x"}, {}, "vx^2/2 + vx^4"), x), "/forces", "not quadratic in the velocities"},
      {with(equations, x), "/forces", "equations"},
      {with(v, {{"y", "1"}}), "/forces/y", "no variable"},
      {with(v, {{"x", "1"}, {"x", "2"}}), "/forces/x", "once more"},
      {with(v, {{"x", "c*vx"}}), "/forces/x", "nobody knows the name c"},
      {with(v, {{"x", "px"}}), "/forces/x", "px is a momentum"},
      {with(v, {{"x", "s"}}), "/forces/x", "s is the action"},
      {with(h, {{"x", "-vx"}}), "/forces/x", "vx is a velocity"},
      {with(h, {}, "px^2"), "/dissipation", "px is a momentum"},
      {with(v, {{"x", "vx +"}}), "/forces/x", "ends where"},
      {with(v, {{"x", ""}}), "/forces/x", "is empty"}};
  for (const auto& [definition, pointer, detail] : all) {
    const auto made = custom_mechanics(definition);
    const auto* faults = std::get_if<std::vector<text::DefinitionFault>>(&made);
    ASSERT_TRUE(faults) << pointer << detail;
    EXPECT_EQ(faults->front().pointer, pointer);
    EXPECT_NE(faults->front().fault.detail.find(detail), std::string::npos) << faults->front().fault.detail;
  }
}

text::TypedScene chain(int n) {
  text::TypedScene typed;
  typed.scene = of(typed_v, {"x[n]"}, {{"n", double(n)}, {"c", 0.05}}, "sum(i=0..n, (at(i+1) - at(i))^2/2)");
  typed.definitions = {{"at(i)", "if(i < 1 or i > n, 0, x[i])"}, {"vat(i)", "if(i < 1 or i > n, 0, vx[i])"}};
  return typed;
}
std::shared_ptr<const Mechanics> made(text::TypedScene typed) {
  auto found = custom_mechanics(std::move(typed));
  if (const auto* faults = std::get_if<std::vector<text::DefinitionFault>>(&found))
    throw std::invalid_argument(faults->front().pointer + " " + faults->front().fault.detail);
  return std::get<std::shared_ptr<const Mechanics>>(found);
}

TEST(ForcedCards, AreOfManyOfAKind) {
  text::TypedScene typed = chain(30);
  typed.scene.dissipation = "sum(i=0..n, c*(vat(i+1) - vat(i))^2/2)";
  typed.scene.forces = {{"x[i]", "if(i == 1, 0.3*cos(t), 0)"}};
  const auto mechanics = made(typed);
  const End leap = run(asked(mechanics, "leapfrog", {1}, 10), 0.1, "kahan_li_8"),
            series = run(asked(mechanics, "taylor", {1}, 10));
  for (std::size_t i = 0; i < 60; ++i) EXPECT_NEAR(leap.state[i], series.state[i], 1e-9) << i;
  EXPECT_NEAR(leap.work, series.work, 1e-9);
  EXPECT_LT(leap.work, -0.1);

  // Friction that couples more coordinates than the matrix of a kick may have, and equal friction of each coordinate
  // alone.
  typed = chain(100);
  typed.scene.dissipation = "sum(i=0..n, c*(vat(i+1) - vat(i))^2/2)";
  const auto coupled = made(typed);
  EXPECT_FALSE(runs::fits(coupled->card(), find_scheme("leapfrog").value()));
  EXPECT_NE(coupled->card().offers.find("coupling more than 64 momenta"), std::string::npos);
  EXPECT_TRUE(runs::fits(coupled->card(), find_scheme("taylor").value()));
  typed.scene.dissipation.reset();
  typed.scene.forces = {{"x[i]", "-c*vx[i]*abs(vx[i])"}};
  EXPECT_LT(run(asked(made(typed), "leapfrog", {1}, 5), 0.05, "suzuki_4").balance, 1e-5);

  typed = chain(3);
  typed.scene.forces = {{"x[i]", "-vx[i+1]"}};
  const auto wrong = custom_mechanics(typed);
  const auto& faults = std::get<std::vector<text::DefinitionFault>>(wrong);
  EXPECT_EQ(faults.front().pointer, "/forces/x[i]");
  EXPECT_NE(faults.front().fault.detail.find("for i = 3"), std::string::npos) << faults.front().fault.detail;
}

TEST(ForcedCards, DiagnosticsKnowForces) {
  const Definition damped = with(of(typed_v, {"x"}, {}, "x^2/2"), {{"x", "-0.1*vx"}});
  for (const char* scheme : {"leapfrog", "taylor"}) {
    Request request = asked(damped, scheme, {1}, 200);
    for (const char* one : {"structure", "lyapunov", "error"}) runs::ask(request, one);
    const auto reports = runs::go(request).outcome.diagnostics;
    EXPECT_NEAR(runs::number(reports, "lyapunov/exponent"), -0.05, 0.01) << scheme;
    EXPECT_LT(runs::number(reports, "error/final"), 1e-4);
    EXPECT_EQ(std::get<std::string>(std::get<std::vector<Report>>(reports.front().value).front().value), "none");
  }
  // A force with |v| has no series; its reference is another scheme.
  Request request = asked(with(of(typed_v, {"x"}, {}, "x^2/2"), {{"x", "-0.1*vx*abs(vx)"}}), "taylor", {1}, 10);
  runs::ask(request, "error");
  const auto reports = runs::go(request).outcome.diagnostics;
  EXPECT_LT(runs::number(reports, "error/final"), 1e-11);
  EXPECT_LT(runs::number(reports, "error/uncertainty"), 1e-13);
}

TEST(ForcedCards, ScenesWithoutForcesSayNoWork) {
  Request request = asked(of(typed_v, {"x"}, {}, "x^2/2"), "leapfrog", {1}, 1);
  runs::ask(request, "energy");
  EXPECT_THROW(runs::number(runs::go(request).outcome.diagnostics, "energy/work"), std::out_of_range);
}

/// φ₁ and φ₂ against their series, where that has all digits.
TEST(Exponential, IsThatOfItsSeries) {
  for (const double z : {-0.9, -0.5, -1e-9, 0.0, 0.3, 0.51, 2.0}) {
    double one = 0, two = 0, term = 1;
    for (int k = 1; k < 40; ++k) one += term / k, two += term / (k * (k + 1.0)), term *= z / k;
    const Phi found = phi(z);
    EXPECT_NEAR(found.one, one, 1e-15 * one) << z;
    EXPECT_NEAR(found.two, two, 1e-15 * two) << z;
  }
  // Of a matrix with the eigenvectors (1, 1) and (1, −1).
  for (const double large : {-1e6, -3.0, 0.2}) {
    const double small = -0.4, mean = (large + small) / 2, half = (large - small) / 2;
    const double rounding = 1e-13 + 1e-16 * std::abs(large);  // relative to the larger entries
    const MatrixPhi found = phi(2, {mean, half, half, mean});
    EXPECT_NEAR(found.one[0] + found.one[1], phi(large).one, rounding) << large;
    EXPECT_NEAR(found.one[0] - found.one[1], phi(small).one, rounding) << large;
    EXPECT_NEAR(found.two[0] + found.two[1], phi(large).two, rounding) << large;
    EXPECT_NEAR(found.two[0] - found.two[1], phi(small).two, rounding) << large;
  }
}

}  // namespace
}  // namespace forced
