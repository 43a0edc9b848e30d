// Scenes with H quadratic in s and more than ten coordinates: schemes that keep the contact form.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/sized.hpp"

namespace sized_quadratic {
namespace {

using namespace sized;

/// n oscillators in one expanding universe, H = Σ(p² + q²)/2 + γs²/2 − R, each bound to the next; with a kinetic matrix
/// that couples or not.
std::shared_ptr<const Mechanics> oscillators(int n, double bond = 0, bool coupled = false) {
  text::TypedScene typed;
  const std::string rest = "sum(i=1..n, q[i]^2/2) + b*sum(i=1..n-1, (q[i+1] - q[i])^4/4)";
  typed.scene = quadratic(of(Definition::Kind::potential, {"q[n]"}, {{"n", double(n)}, {"b", bond}}, rest), "1", "1");
  if (coupled)
    typed.scene = of(Definition::Kind::lagrangian, {"q[n]"}, {{"n", double(n)}, {"b", bond}},
                     "sum(i=1..n, v[i]^2/2) + sum(i=1..n-1, v[i]*v[i+1])/4 - s^2/2 + 1 - (" + rest + ")");
  return made(typed);
}
std::vector<double> start_of(int n, double s) {
  std::vector<double> x;
  for (int i = 0; i < 2 * n; ++i) x.push_back(0.4 * std::sin(1 + 2.3 * i * i));
  x.push_back(s);
  return x;
}
constexpr const char* schemes_of_any_size[] = {"contact_leapfrog", "contact_splitting", "contact_symplectic_euler"};
constexpr const char* implicit_schemes[] = {"contact_variational_midpoint", "contact_galerkin_4", "contact_gauss"};

/// Where all move alike, Q = √n q is a single oscillator, and every scheme gives the same motion for both.
void expect_one_motion(const char* scheme, int n) {
  Request one = runs::defaults("cosmological_oscillator", scheme);
  one.end = 6;
  runs::set(one, "step", 0.1);
  runs::only_final(one);
  const auto& initial = one.scene->initial;
  const double share = 1 / std::sqrt(double(n));
  std::vector<double> start(std::size_t(n), share * initial[0]);
  start.resize(2 * std::size_t(n), share * initial[1]);
  start.push_back(initial[2]);
  const auto all = final_of(stepped(scheme, oscillators(n), start, 6, 0.1)), known = final_of(one);
  EXPECT_GT(std::abs(known[2] - initial[2]), 0.5) << scheme << ": s moves";
  for (std::size_t i = 0; i < std::size_t(n); ++i) {
    EXPECT_NEAR(all[i], share * known[0], 1e-13) << scheme << i;
    EXPECT_NEAR(all[std::size_t(n) + i], share * known[1], 1e-13) << scheme << i;
  }
  EXPECT_NEAR(all.back(), known[2], 2e-13) << scheme;
}

TEST(SizedQuadratic, ManyThatMoveAlikeMoveAsTheCompiledOne) {
  for (const char* scheme : schemes_of_any_size) expect_one_motion(scheme, 300);
  for (const char* scheme : implicit_schemes) expect_one_motion(scheme, 16);
}

/// Where s has come to rest at √(2R/γ), what moves it is a difference of equal terms: their rounding is no error of a
/// step.
TEST(SizedQuadratic, StepsGoOnWhereAllComesToRest) {
  for (const char* scheme : implicit_schemes) {
    const Solution outcome = runs::go(stepped(scheme, oscillators(1), {0.5, 0.3, -1}, 40, 0.05)).outcome;
    EXPECT_EQ(outcome.stop.reason, ReturnCode::completed) << scheme << ' ' << outcome.stop.detail;
    EXPECT_NEAR(outcome.final.back(), std::sqrt(2.0), 1e-9) << scheme;
  }
}

TEST(SizedQuadratic, SchemesHaveTheirOrdersAndKeepTheForm) {
  constexpr int n = 12;
  const auto start = start_of(n, 0.3);
  for (const bool coupled : {false, true}) {
    const auto bound = oscillators(n, 1, coupled);
    const auto truth = final_of(request_by("taylor", bound, start, 2));
    const auto check = [&](const char* scheme, int order) {
      const auto off = [&](double step) { return distance(final_of(stepped(scheme, bound, start, 2, step)), truth); };
      EXPECT_NEAR(std::log2(off(0.05) / off(0.025)), order, 0.25) << scheme << coupled;
      Request request = stepped(scheme, bound, start, 0.5, 0.1);
      runs::ask(request, "structure");
      const auto reports = runs::go(request).outcome.diagnostics;
      EXPECT_LT(runs::number(reports, "structure/max_defect"), 1e-12) << scheme << coupled;
      EXPECT_GT(std::abs(runs::number(reports, "structure/factor") - 1), 1e-3) << scheme << ": s takes part";
    };
    for (const char* scheme : {"contact_leapfrog", "contact_splitting", "contact_variational_midpoint"})
      check(scheme, 2);
    check("contact_symplectic_euler", 1);
    check("contact_galerkin_4", 4);
    check("contact_gauss", 4);
  }
}

/// ṡ = −s²/2 where nothing else moves: s diverges at t = −2/s₀, and the run says so.
TEST(SizedQuadratic, ManyBlowUpWhenTheActionDoes) {
  text::TypedScene typed;
  typed.scene = quadratic(of(Definition::Kind::potential, {"q[20]"}, {}, "0*q[1]"), "1", "0");
  std::vector<double> start(41, 0.0);
  start.back() = -2.5;
  const auto mechanics = made(typed);
  for (const char* scheme : schemes_of_any_size) {
    const auto outcome = runs::go(stepped(scheme, mechanics, start, 2, 0.01)).outcome;
    EXPECT_EQ(outcome.stop.reason, ReturnCode::singular) << scheme;
    EXPECT_NEAR(outcome.stop.singular_at.value_or(0), 0.8, 1e-12) << scheme;
  }
}

// Schemes without a part γs²/2 do not have its pole at γsh = −2: the source turns s back.
TEST(SizedQuadratic, PolesOfPartsAreThoseOfSchemesThatHaveThem) {
  text::TypedScene typed;
  typed.scene = quadratic(of(Definition::Kind::potential, {"q[20]"}, {}, "0*q[1]"), "1", "1000");
  std::vector<double> start(41, 0.0);
  start.back() = -30;
  const auto mechanics = made(typed);
  for (const char* scheme : {"explicit_euler", "explicit_midpoint", "runge_kutta_4"})
    EXPECT_EQ(runs::go(stepped(scheme, mechanics, start, 0.1, 0.1)).outcome.stop.reason, ReturnCode::completed)
        << scheme;
  EXPECT_NEAR(final_of(stepped("explicit_euler", mechanics, start, 0.1, 0.1)).back(), 25, 1e-12);
  for (const char* scheme : schemes_of_any_size)
    EXPECT_EQ(runs::go(stepped(scheme, mechanics, start, 0.1, 0.1)).outcome.stop.reason, ReturnCode::singular)
        << scheme;
}

TEST(SizedQuadratic, WhatHasAFullMatrixIsOfSomeCoordinatesOnly) {
  const auto few = oscillators(256), many = oscillators(257);
  for (const char* scheme : implicit_schemes) {
    EXPECT_TRUE(runs::fits(few->card(), find_scheme(scheme).value())) << scheme;
    EXPECT_FALSE(runs::fits(many->card(), find_scheme(scheme).value())) << scheme;
  }
  EXPECT_NE(many->card().offers.find("more coordinates than the 256"), std::string::npos);
}

}  // namespace
}  // namespace sized_quadratic
