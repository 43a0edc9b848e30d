// Where families of closed orbits end, where they land, and that they stay on their curve.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/server/orbits.hpp"
#include "tests/support/runs.hpp"

namespace least::server::test {
namespace {

class PeriodicCurves : public AskingForOrbits {
 protected:
  static Json family(const Json& problem, const Json& initial, const Json& period, const char* by, double to,
                     int count) {
    return orbit({{"problem", problem},
                  {"initial", initial},
                  {"period", period},
                  {"family", {{"by", by}, {"to", to}, {"count", count}}}});
  }
  /// The number at which a family is told to end in an equilibrium; NaN where it is not.
  static double equilibrium_at(const Json& made) {
    const std::string end = made["family_end"];
    if (end.find("the family ends in an equilibrium at ") != 0) return std::nan("");
    return std::stod(end.substr(end.rfind('=') + 1));
  }
  /// Whether the values of all members go one way.
  static bool goes_one_way(const Json& members) {
    for (std::size_t i = 2; i < members.size(); ++i) {
      const double way = members[1]["value"].get<double>() - members[0]["value"].get<double>();
      if ((members[i]["value"].get<double>() - members[i - 1]["value"].get<double>()) * way <= 0) return false;
    }
    return true;
  }
};

// The subcritical Hopf bifurcation of Lorenz is at σ(σ+β+3)/(σ−β−1): there the family shrinks to an equilibrium.
TEST_F(PeriodicCurves, EndWhereAHopfBifurcationIs) {
  const Json problem = custom(R"~({"variables": ["x", "y", "z"], "parameters": {"sigma": 10, "rho": 24, "beta": "8/3"},
      "equations": {"x": "sigma*(y-x)", "y": "x*(rho-z)-y", "z": "x*y-beta*z"}})~");
  const Json made = family(problem, {{"x", 6.8}, {"y", 5.9}, {"z", 23}}, .66, "/problem/rho", 26, 40);
  const double beta = 8. / 3, hopf = 10 * (10 + beta + 3) / (10 - beta - 1);
  EXPECT_NEAR(equilibrium_at(made), hopf, 1e-6) << made["family_end"];
  EXPECT_TRUE(goes_one_way(made["family"]));
  for (const Json& member : made["family"]) EXPECT_TRUE(member["bifurcation"].is_null()) << member;
}

// A pendulum at rest has the energy −1, and its small swings the period 2π.
TEST_F(PeriodicCurves, EndWhereAPendulumRests) {
  const struct {
    const char* by;
    double to, at;
    std::vector<int> counts;
  } ways[] = {{"energy", -1.2, -1, {6, 40}},
              {"energy", -1, -1, {40}},
              {"period", 6, 2 * pi, {6, 40}},
              {"/initial/a", -.5, 0, {6, 40}}};
  for (const auto& [by, to, at, counts] : ways)
    for (const int count : counts) {
      const Json made = family(pendulum(), {{"a", .5}}, 6.4, by, to, count);
      EXPECT_NEAR(equilibrium_at(made), at, 1e-7) << by << made["family_end"];
      EXPECT_TRUE(goes_one_way(made["family"])) << by;
      for (const Json& member : made["family"]) {
        EXPECT_TRUE(member["bifurcation"].is_null()) << member;
        EXPECT_GT(member["initial"]["a"], 0) << by;
      }
    }
}

// The energy of an oscillator is the square of its amplitude: a step that is expected to end before `to` ends beyond
// it.
TEST_F(PeriodicCurves, LandOnWhatWasAsked) {
  for (const auto& [to, count] : {std::pair(5., 4), {20., 8}, {5., 3}}) {
    const Json made = family("harmonic_oscillator", {{"q", 1.5}}, 6.28, "energy", to, count);
    EXPECT_EQ(made["family_end"], "") << to;
    EXPECT_NEAR(made["family"].back()["value"], to, 1e-14 * to);
    EXPECT_NEAR(made["family"].back()["initial"]["q"], std::sqrt(2 * to), 1e-12);
    EXPECT_TRUE(goes_one_way(made["family"]));
  }
}

// A number just before a fold, beyond which a step bends back.
TEST_F(PeriodicCurves, LandBeforeAFold) {
  const Json problem = custom(R"~({"variables": ["x", "v"], "parameters": {"f": 0.2},
      "equations": {"x": "v", "v": "x - x^3 - 0.2*v + f*cos(t)"}})~");
  const Json made = family(problem, {{"x", 1}}, 2 * pi, "/problem/f", .2586, 40);  // the fold is at .25860746
  EXPECT_EQ(made["family_end"], "") << made["family_end"];
  EXPECT_NEAR(made["family"].back()["value"], .2586, 1e-15);
  EXPECT_TRUE(goes_one_way(made["family"]));
  for (const Json& member : made["family"]) EXPECT_TRUE(member["bifurcation"].is_null()) << member;
}

// Of the circles of an oscillator the one of amplitude 2 alone goes on as a cycle of van der Pol: r' = εr(1 − r²/4)/2
// in the mean. Source: Guckenheimer, Holmes, Nonlinear Oscillations, 1983, 4.1.
TEST_F(PeriodicCurves, GoOnFromACenterOnlyWhereTheMeanVanishes) {
  runs::problem_called("van_der_pol");
  for (const int count : {5, 50}) {
    for (const double x : {1.5, 3.}) {
      const Json made =
          family({{"id", "van_der_pol"}, {"epsilon", 0}}, {{"x", x}, {"v", 0}}, 6.28, "/problem/epsilon", .1, count);
      EXPECT_EQ(made["family"].size(), 0U) << x;
      EXPECT_NE(made["family_end"].get<std::string>().find("alone"), std::string::npos) << made["family_end"];
    }
    const Json made =
        family({{"id", "van_der_pol"}, {"epsilon", 0}}, {{"x", 2}, {"v", 0}}, 6.28, "/problem/epsilon", .1, count);
    EXPECT_EQ(made["family_end"], "");
    for (const Json& member : made["family"]) {
      const double epsilon = member["value"];
      EXPECT_NEAR(member["period"], 2 * pi * (1 + epsilon * epsilon / 16), 1e-5);  // up to ε⁴
    }
  }
}

// A force that breaks a rotation leaves of the straight swings those along its axes.
TEST_F(PeriodicCurves, GoOnFromASymmetryOnlyAlongTheAxesOfWhatBreaksIt) {
  const Json problem = custom(R"~({"variables": ["x", "y"], "parameters": {"k": 0},
      "potential": "(x^2+y^2)/2 + (x^2+y^2)^2/4 + k*x*y"})~");
  for (const double angle : {.3, pi / 4}) {
    const bool along = angle > .5;
    const Json made =
        family(problem, {{"x", .8 * std::cos(angle)}, {"y", .8 * std::sin(angle)}}, 5, "/problem/k", .1, 5);
    ASSERT_EQ(made["status"], "closed") << made;
    EXPECT_EQ(made["family_end"] == "", along) << made["family_end"];
    for (const Json& member : made["family"])
      EXPECT_NEAR(member["initial"]["x"].get<double>(), member["initial"]["y"], along ? 1e-9 : 0) << member;
  }
}

// The answer does not depend on how many members are asked for: the few are on the curve of the many. From the first
// orbit of this chain, steps that are too long lead to others near it.
TEST_F(PeriodicCurves, AreTheSameHoweverManyMembersAreAskedFor) {
  const Json problem = custom(R"~({"variables": ["x[4]"], "parameters": {"n": 4, "k": [1, 1.1, 1.2, 1.3]},
      "definitions": {"at(i)": "if(i==0 or i>n,0,x[i])"},
      "potential": "sum(i=1..n,(at(i+1)-at(i))^2/2*k[i]+x[i]^4/4)"})~");
  const auto members = [&](double to, int count) {
    const Json made = orbit({{"problem", problem},
                             {"initial", {{"x", {.5, .7, .7, .5}}}},
                             {"period", 9},
                             {"symmetric", true},
                             {"family", {{"by", "energy"}, {"to", to}, {"count", count}}}});
    EXPECT_TRUE(goes_one_way(made["family"])) << made;
    return made["family"];
  };
  const Json few = members(2, 5), many = members(.5, 100);
  for (const Json& member : few) {
    double nearest = 1;
    for (const Json& one : many)
      nearest = std::min(nearest, distance(one["initial"], member["initial"], {"x[1]", "x[2]", "x[3]", "x[4]"}));
    EXPECT_LT(nearest, 2e-2) << member;
  }
}

// Of a chain of equal springs the curve bends back at 1.978556, which members 400 and 1000 to the curve agree on; it
// has neighbours that reach 2 without a fold.
TEST_F(PeriodicCurves, BendBackHoweverManyMembersAreAskedFor) {
  const Json problem = custom(R"~({"variables": ["x[4]"], "parameters": {"n": 4},
      "definitions": {"at(i)": "if(i==0 or i>n,0,x[i])"},
      "potential": "sum(i=1..n,(at(i+1)-at(i))^2/2+x[i]^4/4)"})~");
  for (const int count : {60, 150}) {
    const Json made = orbit({{"problem", problem},
                             {"initial", {{"x", {.5, .7, .7, .5}}}},
                             {"period", 9},
                             {"symmetric", true},
                             {"limits", {{"seconds", 60}}},  // under a sanitizer, too
                             {"family", {{"by", "energy"}, {"to", 2}, {"count", count}}}});
    std::vector<double> folds;
    for (const Json& member : made["family"])
      if (!member["bifurcation"].is_null()) folds.push_back(member["value"]);
    ASSERT_EQ(folds.size(), 1U) << count;
    EXPECT_NEAR(folds[0], 1.978556, 1e-6);
  }
}

}  // namespace
}  // namespace least::server::test
