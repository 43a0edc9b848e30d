// A kinetic energy that depends on the position, and friction α(t) s: q and p move without s, by Herglotz' equations.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/support/texts.hpp"

namespace damped_metric {
namespace {

using namespace texts;

constexpr auto typed_l = Definition::Kind::lagrangian;

std::shared_ptr<const Mechanics> bead(const std::string& friction) {
  return mechanics_of(of(typed_l, {"x"}, {{"a", 0.1}}, "(1 + 4*x^2)*vx^2/2 - x^2 - " + friction));
}
std::shared_ptr<const Mechanics> two_beads() {
  return mechanics_of(
      of(typed_l, {"x", "y"}, {{"a", 0.2}}, "(2 + sin(x))*vx^2/2 + vy^2/2 + 0.3*vx*vy*cos(x-y) - x^2/2 - y^2 - a*s"));
}

TEST(DampedMetric, RunsByHerglotzEquations) {
  for (const auto& [mechanics, start] : {std::pair{bead("a*s"), std::vector{0.7, 0.3}},
                                         {bead("a*cos(t)*s"), {0.7, 0.3}},
                                         {two_beads(), {0.7, -0.2, 0.3, 0.1}}}) {
    for (const auto& [scheme, order] :
         {std::pair{"contact_galerkin_4", 4.0}, {"contact_variational_midpoint", 2.0}, {"contact_gauss", 4.0}}) {
      ASSERT_TRUE(runs::fits(mechanics->card(), find_scheme(scheme).value())) << scheme;
      const auto error = [&, &from = start, &of = mechanics](double step) {
        Request request = request_by(scheme, of, from, 2);
        runs::set(request, "step", step);
        runs::ask(request, "error");
        return runs::number(runs::go(request).outcome.diagnostics, "error/final");
      };
      EXPECT_NEAR(std::log2(error(0.1) / error(0.05)), order, 0.3) << scheme;
    }
  }
}

// Errors leave out s, on which the motion does not depend.
TEST(DampedMetric, HasErrorsOfWhatMoves) {
  const auto mechanics = bead("a*s");
  EXPECT_TRUE(mechanics->card().variables.back().optional);
  Request request = request_by("runge_kutta_4", mechanics, std::vector{0.7, 0.3, 1e6}, 2);
  runs::set(request, "step", 0.2);
  runs::ask(request, "error");
  Request same = request_by("runge_kutta_4", mechanics, std::vector{0.7, 0.3, 0.0}, 2);
  runs::set(same, "step", 0.2);
  runs::ask(same, "error");
  const auto one = runs::go(request).outcome, other = runs::go(same).outcome;
  EXPECT_GT(runs::number(other.diagnostics, "error/final"), 1e-7);
  EXPECT_EQ(runs::number(one.diagnostics, "error/final"), runs::number(other.diagnostics, "error/final"));
  EXPECT_NE(one.final[2], other.final[2]);
}

}  // namespace
}  // namespace damped_metric
