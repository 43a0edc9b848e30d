// Closed orbits over HTTP: their periods and multipliers against published values.
#include <gtest/gtest.h>

#include <string>

#include "tests/server/orbits.hpp"
#include "tests/support/runs.hpp"

namespace least::server::test {
namespace {

class Periodic : public AskingForOrbits {};

// Periods: METHODS, section 6; multiplier: e^∮ε(1 − x²)dt, Andersen & Geer, SIAM J. Appl. Math. 42, 678 (1982).
TEST_F(Periodic, OfVanDerPolHasThePublishedPeriod) {
  const double truth[][3] = {{1, 6.5, 6.66328685932313}, {10, 18, 19.0783695669390}, {100, 160, 162.837071092370}};
  for (const auto& [epsilon, guess, period] : truth) {
    const Json made = orbit({{"problem", {{"id", "van_der_pol"}, {"epsilon", epsilon}}},
                             {"initial", {{"x", 2}, {"v", 0}, {"slope", 5}}},
                             {"period", guess}});
    ASSERT_EQ(made["status"], "closed") << made;
    EXPECT_NEAR(made["period"], period, 1e-13 * period);
    EXPECT_EQ(made["trivial_by"], Json::parse(R"({"time":1,"invariants":0,"symmetries":0})"));
    EXPECT_EQ(made["stable"], true);
    EXPECT_TRUE(made["initial"]["slope"].is_null());  // what follows from the others does not stay that of the guess
    if (epsilon == 1) {
      EXPECT_NEAR(made["multipliers"][1]["re"], 8.5969506e-4, 1e-10);
    }
  }
}

TEST_F(Periodic, OfLorenzIsTheShortestOfAll) {
  const Json problem = custom(R"~({"variables": ["x", "y", "z"], "parameters": {"sigma": 10, "rho": 28, "beta": "8/3"},
      "equations": {"x": "sigma*(y-x)", "y": "x*(rho-z)-y", "z": "x*y-beta*z"}})~");
  const Json made = orbit(
      {{"problem", problem}, {"initial", {{"x", -13.5}, {"y", -19}, {"z", 27}}}, {"period", 1.5}, {"fixed", {"z"}}});
  EXPECT_NEAR(made["period"], 1.5586522107161747, 1e-13);
  EXPECT_EQ(made["initial"]["z"], 27);
  EXPECT_NEAR(made["initial"]["x"], -13.7636106821342, 1e-11);
  EXPECT_NEAR(made["initial"]["y"], -19.5787519424518, 1e-11);
  EXPECT_LT(made["closure"], 1e-14);
  EXPECT_EQ(made["stable"], false);
  // Volumes shrink at the rate σ + 1 + β everywhere.
  const auto all = others(made);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_NEAR(all[0].real(), 4.7129472734, 1e-9);
  EXPECT_NEAR(std::real(all[0] * all[1]) / std::exp(-(11 + 8. / 3) * 1.5586522107161747), 1, 1e-5);
}

// METHODS 9e; in the rotating frame p = v + (−y, x).
TEST_F(Periodic, OfArenstorfIsFoundByShootingInParts) {
  const double x = .994, py = x - 2.00158510637908252240537862224;
  const Json problem = restricted("xy", .012277471);
  Json request{{"problem", problem},
               {"initial", {{"x", x}, {"y", 0}, {"px", 0}, {"py", -1.0075}}},
               {"period", 17},
               {"fixed", {"x"}},
               {"symmetric", true}};
  for (const bool symmetric : {true, false}) {
    request["symmetric"] = symmetric;
    if (!symmetric) request["initial"]["py"] = py + 1e-8;
    const Json made = orbit(request);
    ASSERT_EQ(made["status"], "closed") << made["reason"];
    EXPECT_GT(made["segments"], 1);
    EXPECT_NEAR(made["period"], 17.0652165601579625588917206249, 1e-11);
    EXPECT_NEAR(made["initial"]["py"], py, 1e-13);
    EXPECT_EQ(made["trivial"], 2);
    EXPECT_EQ(made["stable"], false);
    EXPECT_LT(made["pairing_defect"], 1e-8);
    const auto all = others(made);
    EXPECT_NEAR(all[0].real(), 285.403711748, 1e-6);
    EXPECT_NEAR(all[1].real() * 285.403711748, 1, 1e-8);
    if (symmetric) {
      EXPECT_EQ(made["initial"]["px"], 0);
    }
  }
}

// Simó, Contemporary Mathematics 292, 209 (2002): e^{±2πiν} with ν = .00842272, .29809253, and nothing else but 1.
TEST_F(Periodic, OfTheFigureEightKnowsWhatIsKeptAndItsSymmetries) {
  const Json problem = custom(R"~({"variables": ["x[3]", "y[3]"], "lagrangian":
      "sum(i=1..3, (vx[i]^2+vy[i]^2)/2 + sum(j=i+1..3, 1/sqrt((x[i]-x[j])^2+(y[i]-y[j])^2)))"})~");
  const double v = .3471168881, w = .5327249454;
  const Json made = orbit({{"problem", problem},
                           {"initial", {{"x", {-1, 1, 0}}, {"vx", {v, v, -2 * v}}, {"vy", {w, w, -2 * w}}}},
                           {"period", 6.3259139829}});
  ASSERT_EQ(made["status"], "closed") << made;
  EXPECT_NEAR(made["period"], 6.3259139829, 1e-9);
  EXPECT_EQ(made["trivial"], 8);
  EXPECT_EQ(made["trivial_by"], Json::parse(R"({"time":1,"invariants":4,"symmetries":3})"));
  EXPECT_EQ(made["stable"], true);
  EXPECT_LT(made["pairing_defect"], 1e-11);
  const auto all = others(made);
  ASSERT_EQ(all.size(), 4U);
  std::vector<double> angles;
  for (const auto& value : all) angles.push_back(std::abs(std::arg(value)) / (2 * pi));
  std::ranges::sort(angles);
  EXPECT_NEAR(angles[0], .008422724708, 1e-8);
  EXPECT_NEAR(angles[3], .298092529005, 1e-8);
}

// The energy of a mode at rest is conserved, but its gradient vanishes along the orbit, so that no unit multiplier
// follows from it. The mode's multipliers are e^{±iωT}.
TEST_F(Periodic, OfAModeThatRestsHasTheMultipliersOfTheMode) {
  struct Scene {
    const char* potential;
    double period;  // of a drive, or a guess
    bool driven;
  };
  for (const auto& [potential, period, driven] :
       {Scene{"x^2/2+x^4/4+3*y^2/2", 5, false}, Scene{"x^2/2+x^4/4+3*y^2/2-0.3*x*cos(1.2*t)", 2 * pi / 1.2, true}}) {
    const Json problem{{"id", "custom"}, {"variables", {"x", "y"}}, {"potential", potential}};
    const Json made = orbit({{"problem", problem}, {"initial", {{"x", 0.9}, {"y", 0}}}, {"period", period}});
    ASSERT_EQ(made["status"], "closed") << made;
    EXPECT_EQ(made["trivial_by"]["invariants"], driven ? 0 : 1) << potential;
    EXPECT_LT(made["pairing_defect"], 1e-9);
    const double angle = std::sqrt(3.0) * made["period"].get<double>();
    const auto all = others(made);
    const auto of_mode = [&](const std::complex<double>& value) {
      return std::abs(value.real() - std::cos(angle)) < 1e-8 &&
             std::abs(std::abs(value.imag()) - std::abs(std::sin(angle))) < 1e-8;
    };
    EXPECT_EQ(std::ranges::count_if(all, of_mode), 2) << potential << made["multipliers"];
  }
}

TEST_F(Periodic, OfKeplerIsAnEllipseOfAnyGuess) {
  if (std::string(LEAST_LEFT_OUT).find(" kepler ") != std::string::npos) GTEST_SKIP();
  const Json made =
      orbit({{"problem", "kepler"}, {"initial", {{"x", 1}, {"y", 0}, {"px", 0}, {"py", 1.2}}}, {"period", 11}});
  const double energy = made["invariant"]["energy"];
  EXPECT_NEAR(made["period"], 2 * pi * std::pow(-2 * energy, -1.5), 1e-11);
  EXPECT_NEAR(made["invariant"]["angular_momentum"], 1.2, 0.1);
  EXPECT_EQ(made["trivial"], 4);
  EXPECT_TRUE(others(made).empty());
  EXPECT_EQ(made["stable"], true);
}

// A rotating pendulum closes after one turn, 2π farther; T = 2k K(k), k² = 2/(1 + E).
TEST_F(Periodic, OfAPendulumThatTurnsOverClosesAWholeTurnLater) {
  const Json made =
      orbit({{"problem", pendulum()}, {"initial", {{"a", 0}, {"va", 3}}}, {"period", 2.5}, {"fixed", {"a", "pa"}}});
  ASSERT_EQ(made["status"], "closed") << made["reason"];
  const double k = std::sqrt(2 / (1 + 3.5));
  EXPECT_NEAR(made["period"], 2 * k * std::comp_ellint_1(k), 1e-13);
  EXPECT_EQ(made["initial"]["pa"], 3);
}

// Two pendulums, from a guess out of phase by a tenth, near the equilibrium, which is closed for every period.
TEST_F(Periodic, OfASmallSwingDoesNotComeToRest) {
  const Json problem = custom(R"~({"variables": ["a", "b"],
      "lagrangian": "va^2 + vb^2/2 + va*vb*cos(a-b) + 2*cos(a) + cos(b)"})~");
  const Json made = orbit({{"problem", problem}, {"initial", {{"a", .01}, {"b", -.013}}}, {"period", 3.1}});
  ASSERT_EQ(made["status"], "closed") << made["reason"];
  EXPECT_NEAR(made["period"], 2 * pi / std::sqrt(2 + std::sqrt(2)), 1e-3);  // that of the linear motion
  EXPECT_GT(made["invariant"]["energy"].get<double>(), -3 + 1e-5);
}

// Multipliers of (q, p) in contact scenes: pairs have the product e^{−∫α dt}, and where H is not linear in s e^{−∫∂H/∂s
// dt}, along the contact hyperplanes.
TEST_F(Periodic, OfDrivenContactScenesHasPairs) {
  const Json constant = custom(R"~({"variables": ["x"], "potential": "-x^2/2 + x^4/4 - 0.2*x*cos(1.2*t)",
      "damping": 0.3})~");
  const Json changing =
      custom(R"~({"variables": ["x"], "potential": "x^2/2 - x*cos(t)", "damping": "0.2 + 0.1*sin(t)^2"})~");
  const Json nonlinear = custom(R"~({"variables": ["q"], "potential": "q^2/2 - 0.3*q*cos(t)", "action_curvature": 0.5,
      "offset": 1})~");
  const struct {
    Json problem, initial;
    double period, product;
  } scenes[] = {{constant, {{"x", 1}}, 2 * pi / 1.2, std::exp(-.3 * 2 * pi / 1.2)},
                {changing, {{"x", .5}}, 2 * pi, std::exp(-.25 * 2 * pi)},
                {nonlinear, {{"q", .5}, {"s", 1}}, 2 * pi, 0}};
  for (const auto& [problem, initial, period, product] : scenes) {
    const Json made = orbit({{"problem", problem}, {"initial", initial}, {"period", period}});
    ASSERT_EQ(made["status"], "closed") << made["reason"];
    EXPECT_EQ(made["period"], period);
    EXPECT_EQ(made["trivial"], 0);
    EXPECT_EQ(made["multipliers"].size(), 2U);
    EXPECT_EQ(made["stable"], true);
    EXPECT_LT(made["pairing_defect"], 1e-12) << problem;
    if (product > 0) {
      EXPECT_NEAR(made["pair_product"], product, 1e-13);
    }
  }
}

// λ = e^{(−5 ± √24)·2π}, .53 and 2e-27: rounding hides the second one, which follows from the product of the pair. With
// two such pairs rounding hides two, and the product does not determine them.
TEST_F(Periodic, OfStrongDampingKnowsWhatItCannotTell) {
  const Json one = custom(R"~({"variables":["x"],"potential":"x^2/2-0.3*x*cos(t)","damping":"10"})~");
  const Json two = custom(R"~({"variables":["x","y"],"potential":"x^2/2+0.9*y^2/2-0.3*x*cos(t)-0.2*y*cos(t)",
      "damping":"10"})~");
  const double least = std::exp((-std::sqrt(24.0) - 5) * 2 * pi), most = std::exp((std::sqrt(24.0) - 5) * 2 * pi);
  const Json made = orbit({{"problem", one}, {"initial", {{"x", 1}}}, {"period", "2*pi"}});
  const Json& all = made["multipliers"];
  ASSERT_EQ(all.size(), 2U) << made;
  EXPECT_NEAR(all[0]["re"], most, 1e-12);
  EXPECT_NEAR(all[1]["re"].get<double>() / least, 1, 1e-10);
  for (const Json& multiplier : all) EXPECT_EQ(multiplier["kind"], "hyperbolic");
  EXPECT_TRUE(made["pairing_defect"].is_null());
  EXPECT_EQ(made["stable"], true);
  const Json both = orbit({{"problem", two}, {"initial", {{"x", 1}}}, {"period", "2*pi"}});
  ASSERT_EQ(both["multipliers"].size(), 4U) << both;
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(both["multipliers"][i]["kind"].is_null(), i > 1) << both;
}

// In the plane the multiplier of a cycle is e^{∮div ẋ dt} > 0. Where the computed derivative over a period is only
// rounding, it has neither a meaningful sign nor a direction for a manifold.
TEST_F(Periodic, OfStronglyAttractingCyclesTheProductTells) {
  const std::pair<double, double> known[] = {{3, 6.98947568e-16}, {5, 7.73855e-38}};  // by quadrature of 1 − x²
  for (const auto& [epsilon, truth] : known) {
    const Json made = orbit({{"problem", {{"id", "van_der_pol"}, {"epsilon", epsilon}}},
                             {"period", epsilon == 3 ? 8.8 : 11.6},
                             {"manifolds", {{"count", 2}, {"until", 1}}},
                             {"limits", {{"seconds", 60}}}});  // under a sanitizer, too
    const Json& last = made["multipliers"][1];
    EXPECT_NEAR(last["re"].get<double>() / truth, 1, 1e-5) << made["multipliers"];
    EXPECT_EQ(last["kind"], "hyperbolic");
    const Json& stable = made["manifolds"]["stable"];
    EXPECT_NEAR(stable["multiplier"].get<double>() / truth, 1, 1e-5) << stable["multiplier"];
    EXPECT_EQ(stable["trajectories"].size(), 4U);
    EXPECT_FALSE(std::signbit(stable["trajectories"][0]["t"][0].get<double>())) << "0, not −0";
  }
  const Json stiff = orbit({{"problem", {{"id", "van_der_pol"}, {"epsilon", 100}}},
                            {"period", 162.8},
                            {"manifolds", {{"count", 2}, {"until", 1}}},
                            {"limits", {{"seconds", 60}}}});  // under a sanitizer, too
  EXPECT_NE(stiff["multipliers"][1]["kind"], "inverse_hyperbolic");
  EXPECT_EQ(stiff["manifolds"]["stable"]["reason"], "backward, differences of the motion grow too fast to be followed");
  EXPECT_TRUE(stiff["manifolds"]["stable"]["trajectories"].empty());
}

// A damping of 0 is none: the scenes equal those without damping.
TEST_F(Periodic, OfContactScenesWithoutDampingAreThoseOfMechanics) {
  for (const char* needed : {"damped_pendulum", "pendulum", "perturbed_kepler"}) runs::problem_called(needed);
  const Json start{{"q", 1}, {"p", 0}};
  const Json damped =
      orbit({{"problem", {{"id", "damped_pendulum"}, {"damping", 0}}}, {"initial", start}, {"period", 6.7}});
  const Json plain = orbit({{"problem", "pendulum"}, {"initial", start}, {"period", 6.7}});
  const Json kepler = orbit({{"problem", {{"id", "perturbed_kepler"}, {"alpha", 0}}}, {"period", 6.28}});
  for (const Json& made : {damped, plain, kepler}) {
    EXPECT_EQ(made["trivial"], made["multipliers"].size()) << made;
    EXPECT_EQ(made["stable"], true);
    EXPECT_TRUE(made["invariant"]["energy"].is_number());
  }
  EXPECT_EQ(damped["multipliers"], plain["multipliers"]);
}

// Angular momentum decays with the damping, but rotations are a symmetry all the same; where the damping averages to 0
// angular momentum is conserved over a period, and causes another unit multiplier.
TEST_F(Periodic, OfDampedScenesKnowsTheirTurns) {
  runs::problem_called("perturbed_kepler");
  const auto about_a_center = [](const char* damping) {
    Json scene = custom(R"~({"variables": ["x", "y"], "potential": "(1+0.3*cos(t))*(x^2+y^2)^2/4"})~");
    scene["damping"] = damping;
    return scene;
  };
  const Json with_drive = orbit({{"problem", {{"id", "perturbed_kepler"}, {"preset", "circular"}}}, {"period", 6}});
  ASSERT_EQ(with_drive["status"], "closed") << with_drive;
  EXPECT_EQ(with_drive["trivial"], 2) << with_drive;
  for (const char* damping : {"0", "0.1*sin(t)"}) {
    const Json made =
        orbit({{"problem", about_a_center(damping)}, {"initial", {{"x", 1}, {"vy", 1}}}, {"period", "2*pi"}});
    ASSERT_EQ(made["status"], "closed") << made;
    EXPECT_EQ(made["trivial"], 2) << made;
    EXPECT_EQ(made["stable"], true);
    EXPECT_EQ(made["pair_product"], 1);
    EXPECT_LT(made["pairing_defect"], 1e-12);
  }
  // A drive that rotates with the orbit balances the damping, but breaks the symmetry.
  const Json driven = custom(R"~({"variables": ["x", "y"],
      "potential": "(x^2+y^2)/2 - 0.2*(x*cos(1.5*t)+y*sin(1.5*t))", "damping": "0.1"})~");
  const Json made = orbit({{"problem", driven}, {"initial", {{"x", -.1}}}, {"period", "2*pi/1.5"}});
  ASSERT_EQ(made["status"], "closed") << made;
  EXPECT_EQ(made["trivial"], 0) << made;
}

// Forces beside the mechanics do not preserve areas: the answer says nothing of pairs.
TEST_F(Periodic, OfForcedScenesHasNoPairs) {
  const Json problem =
      custom(R"~({"variables": ["x"], "lagrangian": "vx^2/2 - x^2/2", "forces": {"x": "(1 - x^2)*vx"}})~");
  const Json made = orbit({{"problem", problem}, {"initial", {{"x", 2}}}, {"period", 6.6}});
  ASSERT_EQ(made["status"], "closed") << made;
  EXPECT_NEAR(made["period"], 6.66328685932313, 1e-12);
  EXPECT_TRUE(made["pairing_defect"].is_null());
  EXPECT_EQ(made["trivial"], 1);
}

// An unstable closed orbit about the first Lagrange point: neighbours separate at the rate of its multiplier.
TEST_F(Periodic, ManifoldsPartAtTheRateOfTheirMultipliers) {
  const Json problem = restricted("xyz", .012150585609624);
  const Json made = orbit({{"problem", problem},
                           {"initial", {{"x", .8234}, {"z", .0224}, {"py", .9575}}},
                           {"period", 2.76},
                           {"symmetric", true},
                           {"fixed", {"z"}},
                           {"manifolds", {{"count", 2}, {"until", 2.7463735574062}}}});
  ASSERT_EQ(made["status"], "closed") << made["reason"];
  EXPECT_EQ(made["initial"]["z"], .0224);
  EXPECT_EQ(made["multipliers"].size(), 6U);
  EXPECT_EQ(made["trivial"], 2);
  const double fast = others(made)[0].real();
  EXPECT_NEAR(fast, 2193.54, .1);
  for (const char* which : {"unstable", "stable"}) {
    const Json& manifold = made["manifolds"][which];
    ASSERT_EQ(manifold["trajectories"].size(), 4U) << manifold["reason"];
    const bool stable = which == std::string("stable");
    EXPECT_NEAR(manifold["multiplier"].get<double>() / (stable ? 1 / fast : fast), 1, 1e-5);
    for (std::size_t k = 0; k < 2; ++k) {  // the first point, both sides
      const Json& curve = manifold["trajectories"][k];
      double first = 0, last = 0;
      for (const auto& row : made["rows"]) {
        const std::string name = row;
        const double here = made["initial"][name];
        first += std::pow(curve[name].front().get<double>() - here, 2);
        last += std::pow(curve[name].back().get<double>() - here, 2);
      }
      EXPECT_NEAR(std::sqrt(last / first) / fast, 1, .02) << which;
      EXPECT_EQ(curve["t"].back().get<double>() < 0, stable);
    }
  }
}

// The start in an answer is a closed orbit in the next request, and in any run.
TEST_F(Periodic, AnswersAreClosedWhenTheyAreSentBack) {
  Json request{{"problem", pendulum()}, {"initial", {{"a", 1}}}, {"period", 6.5}};
  const Json made = orbit(request);
  request["initial"] = made["initial"];
  request["period"] = made["period"];
  const Json again = orbit(request);
  EXPECT_EQ(again["iterations"], 0);
  EXPECT_EQ(again["initial"], made["initial"]);
  EXPECT_EQ(again["monodromy"], made["monodromy"]);
  EXPECT_LT(distance(after(pendulum(), made["initial"], made["period"]), made["initial"], made["rows"]), 1e-13);
  const Json slopes = answer({{"problem", pendulum()},
                              {"initial", made["initial"]},
                              {"scheme", {{"id", "taylor"}, {"tolerance", 1e-15}}},
                              {"until", made["period"]},
                              {"sensitivities", {{"by", "initial"}}}})["sensitivities"]["final"];
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j)
      EXPECT_NEAR(slopes[i][j], made["monodromy"][i][j].get<double>(), 1e-12) << i << j;
}

}  // namespace
}  // namespace least::server::test
