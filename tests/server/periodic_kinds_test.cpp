// What multipliers tell of an orbit, and what they do not: multiple ones, those at bifurcations, orbits that rest.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "tests/server/orbits.hpp"

namespace least::server::test {
namespace {

class PeriodicKinds : public AskingForOrbits {};

// The periodic chain of Toda is integrable: on a closed orbit of three masses, all six multipliers are 1, in blocks of
// Jordan. Rounding moves a double one by its square root, to either side. Source: Hénon, Physical Review B 9, 1921
// (1974).
TEST_F(PeriodicKinds, OfTodaAreAllOne) {
  const Json problem = custom(R"~({"variables": ["a","b","c"], "potential": "exp(a-b)+exp(b-c)+exp(c-a)"})~");
  for (const double size : {1., 2., 4.5}) {
    const Json made = orbit({{"problem", problem}, {"initial", {{"a", size}, {"c", -size}}}, {"period", 3}});
    ASSERT_EQ(made["status"], "closed") << made;
    EXPECT_EQ(made["multipliers"].size(), 6U);
    for (const Json& one : made["multipliers"]) EXPECT_EQ(one["kind"], "unit") << size << one;
    EXPECT_TRUE(made["stable"].is_null()) << size;
  }
}

// Two oscillators alike that do not feel each other: the energy of each is conserved, and all multipliers are 1 after
// any number of turns.
TEST_F(PeriodicKinds, OfOscillatorsApartAreAllOne) {
  const Json problem = custom(R"~({"variables": ["x", "y"], "potential": "x^2/2+x^4/4+y^2/2+y^4/4"})~");
  for (int k = 0; k < 30; ++k) {
    const double x = 1 + .37 * k, steep = 1 + x * x, root = std::sqrt(x * x / (2 * steep));
    const double turn = 4 / std::sqrt(steep) * std::comp_ellint_1(root);
    const Json made = orbit({{"problem", problem},
                             {"initial", {{"x", x}, {"vy", std::sqrt(x * x + x * x * x * x / 2)}}},
                             {"period", (1 + k % 3) * turn}});
    ASSERT_EQ(made["status"], "closed") << made;
    for (const Json& one : made["multipliers"]) EXPECT_EQ(one["kind"], "unit") << k << one;
    EXPECT_TRUE(made["stable"].is_null()) << k;
  }
}

// Where a multiplier goes through the unit circle it does not tell whether the orbit is stable; another one outside
// does.
TEST_F(PeriodicKinds, AtABifurcationDoNotTell) {
  const auto at_bifurcation = [](const Json& request) {
    const Json made = orbit(request);
    for (const Json& member : made["family"])
      if (!member["bifurcation"].is_null()) return member;
    return Json();
  };
  const Json heiles = custom(R"~({"variables": ["x", "y"],
      "lagrangian": "(vx^2+vy^2)/2 - (x^2+y^2)/2 - x^2*y + y^3/3"})~");
  const Json doubled = at_bifurcation({{"problem", heiles},
                                       {"initial", {{"x", 0}, {"y", .1}, {"px", .3}, {"py", 0}}},
                                       {"period", 6.3},
                                       {"fixed", {"x"}},
                                       {"family", {{"by", "energy"}, {"to", .16}, {"count", 12}}}});
  ASSERT_EQ(doubled["bifurcation"], "period_doubling") << doubled;
  EXPECT_TRUE(doubled["stable"].is_null()) << doubled;
  for (const char* further : {"-0.2*w", "0.2*w"}) {
    Json problem = custom(R"~({"variables": ["x", "y", "z", "w"], "parameters": {"c": -0.11},
        "equations": {"x": "x*(1-x^2-y^2) - y", "y": "y*(1-x^2-y^2) + x", "z": "c*z - z^3"}})~");
    problem["equations"]["w"] = further;
    const Json parted = at_bifurcation({{"problem", problem},
                                        {"initial", {{"x", 1}, {"y", 0}, {"z", 0}, {"w", 0}}},
                                        {"period", 6.3},
                                        {"fixed", {"w"}},
                                        {"family", {{"by", "/problem/c"}, {"to", .14}, {"count", 6}}}});
    ASSERT_EQ(parted["bifurcation"], "pitchfork_or_transcritical") << parted;
    EXPECT_EQ(parted["stable"], further[0] == '-' ? Json() : Json(false)) << further;
  }
}

// A pendulum that stands on its head on a point that shakes. Near it δ'' = (1 + A w cos(wt)) δ, integrated here by the
// classical method of Runge and Kutta. Source: Landau & Lifshitz, Mechanics, 1976, section 30: it stands from A² > 2
// on.
TEST_F(PeriodicKinds, OfAnEquilibriumOfADrivenSceneTellOfItsStability) {
  constexpr double w = 10;
  const auto trace = [](double size) {
    double sum = 0;
    for (const int start : {0, 1}) {
      std::array<double, 2> x{start == 0 ? 1. : 0., start == 1 ? 1. : 0.};
      constexpr int steps = 4000;
      constexpr double h = 2 * pi / w / steps;
      for (int k = 0; k < steps; ++k) {
        const auto rates = [&](const std::array<double, 2>& at, double t) {
          return std::array<double, 2>{at[1], (1 + size * w * std::cos(w * t)) * at[0]};
        };
        const auto plus = [](const std::array<double, 2>& a, const std::array<double, 2>& b, double by) {
          return std::array<double, 2>{a[0] + by * b[0], a[1] + by * b[1]};
        };
        const double t = k * h;
        const auto a = rates(x, t), b = rates(plus(x, a, h / 2), t + h / 2), c = rates(plus(x, b, h / 2), t + h / 2),
                   d = rates(plus(x, c, h), t + h);
        for (std::size_t i = 0; i < 2; ++i) x[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
      }
      sum += x[static_cast<std::size_t>(start)];
    }
    return sum;
  };
  for (const double size : {1., 2.})
    for (const Json& angle : {Json("pi"), Json(3.1)}) {
      Json problem = custom(R"~({"variables": ["a"], "parameters": {"A": 1, "w": 10},
          "potential": "-(1+A*w*cos(w*t))*cos(a)"})~");
      problem["parameters"]["A"] = size;
      const Json made = orbit({{"problem", problem}, {"initial", {{"a", angle}}}, {"period", "2*pi/10"}});
      ASSERT_EQ(made["status"], "closed") << made;
      EXPECT_NEAR(made["initial"]["a"], pi, 1e-8);
      EXPECT_EQ(made["trivial"], 0);
      const auto all = others(made);
      EXPECT_NEAR((all[0] + all[1]).real(), trace(size), 1e-9);
      EXPECT_EQ(made["stable"], size > std::sqrt(2.)) << size;
    }
}

// The energy is told where it is conserved, as under a force at right angles to the velocity: x = .3 cos(ωt),
// y = b sin(ωt) with (1 − ω²)(2 − ω²) = .09 ω².
TEST_F(PeriodicKinds, TellAnEnergyOnlyWhereItIsConserved) {
  const Json forced = custom(R"~({"variables": ["x"], "lagrangian": "vx^2/2-x^2/2-x^4/4",
      "forces": {"x": "-0.2*vx+0.3*cos(t)"}})~");
  const Json driven = custom(R"~({"variables": ["x"], "potential": "x^2/2+x^4/4-0.3*x*cos(t)"})~");
  const Json contact = custom(R"~({"variables": ["x"], "potential": "x^2/2-0.3*x*cos(t)", "action_curvature": 0.5,
      "offset": 1})~");
  for (const Json& problem : {forced, driven, contact}) {
    const Json made = orbit({{"problem", problem}, {"initial", {{"x", -.3}}}, {"period", "2*pi"}});
    ASSERT_EQ(made["status"], "closed") << made;
    EXPECT_TRUE(made["invariant"]["energy"].is_null()) << problem;
  }
  const Json turning = custom(R"~({"variables": ["x", "y"], "lagrangian": "(vx^2+vy^2)/2-x^2/2-y^2",
      "forces": {"x": "0.3*vy", "y": "-0.3*vx"}})~");
  const double square = (3.09 - std::sqrt(3.09 * 3.09 - 8)) / 2, vy = .3 * .3 * square / (2 - square);
  const Json made =
      orbit({{"problem", turning}, {"initial", {{"x", .3}, {"vy", vy}}}, {"period", 2 * pi / std::sqrt(square)}});
  ASSERT_EQ(made["status"], "closed") << made;
  EXPECT_NEAR(made["invariant"]["energy"], .045 + vy * vy / 2, 1e-8);
}

}  // namespace
}  // namespace least::server::test
