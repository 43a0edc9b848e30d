// Families of closed orbits over HTTP, with their folds and branches.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <sstream>
#include <string>

#include "tests/server/orbits.hpp"

namespace least::server::test {
namespace {

class PeriodicFamilies : public AskingForOrbits {
 protected:
  static const Json* told(const Json& family, const char* bifurcation) {
    const auto found = std::ranges::find_if(family, [&](const Json& one) { return one["bifurcation"] == bifurcation; });
    return found == family.end() ? nullptr : &*found;
  }
  static std::complex<double> first_other(const Json& member, std::size_t trivial) {
    return others(member, trivial)[0];
  }
};

// T = 4K(sin(A/2)), dT/dA = 2cos(A/2) K′(k).
TEST_F(PeriodicFamilies, OfAPendulumHasThePeriodsOfEllipticIntegrals) {
  const Json request{{"problem", pendulum()},
                     {"initial", {{"a", .5}}},
                     {"period", 6.4},
                     {"fixed", {"pa"}},
                     {"family", {{"by", "/initial/a"}, {"to", 3}, {"count", 15}}}};
  const Json made = orbit(request);
  ASSERT_GT(made["family"].size(), 8U) << made;
  EXPECT_EQ(made["family_end"], "");
  EXPECT_EQ(made["family"].back()["value"], 3);
  for (const Json& member : made["family"]) {
    const double amplitude = member["value"], k = std::sin(amplitude / 2);
    const double first = std::comp_ellint_1(k), second = std::comp_ellint_2(k);
    const double slope = 2 * std::cos(amplitude / 2) * (second / (k * (1 - k * k)) - first / k);
    EXPECT_NEAR(member["period"], 4 * first, 1e-11);
    EXPECT_NEAR(member["period_slope"], slope, 1e-9 * std::max(1.0, slope)) << amplitude;
    EXPECT_EQ(member["initial"]["pa"], 0);
    EXPECT_NEAR(member["energy"], -std::cos(amplitude), 1e-13);
  }
}

// Beyond the energy 1 the pendulum rotates, and the family has no orbit there.
TEST_F(PeriodicFamilies, EndBeforeASingularity) {
  const Json request{{"problem", pendulum()},
                     {"initial", {{"a", .5}}},
                     {"period", 6.4},
                     {"family", {{"by", "energy"}, {"to", 1.5}, {"count", 40}}}};
  const Json made = orbit(request);
  EXPECT_NE(made["family_end"], "");
  for (const Json& member : made["family"]) {
    EXPECT_LT(member["value"], 1);
    EXPECT_EQ(member["value"], member["energy"]);
    const double k = std::sqrt((1 + member["energy"].get<double>()) / 2);
    EXPECT_NEAR(member["period"].get<double>() / (4 * std::comp_ellint_1(k)), 1, 1e-7);  // at the edge
  }
}

// Duffing's driven double well: up to f = .2656 every period repeats the last, from there on every second one does.
TEST_F(PeriodicFamilies, OfDuffingDoublesItsPeriodWhereRunsDo) {
  Json problem = custom(R"~({"variables": ["x", "v"], "parameters": {"f": 0.2},
      "equations": {"x": "v", "v": "x - x^3 - 0.3*v + f*cos(1.2*t)"}})~");
  const double period = 2 * pi / 1.2;
  const Json made = orbit({{"problem", problem},
                           {"initial", {{"x", 1}}},
                           {"period", period},
                           {"family", {{"by", "/problem/f"}, {"to", .3}, {"count", 10}}}});
  const Json* const found = told(made["family"], "period_doubling");
  ASSERT_TRUE(found) << made;
  EXPECT_NEAR(first_other(*found, 0).real(), -1, 1e-7);
  EXPECT_NEAR(others(*found, 0)[1].real(), -std::exp(-.3 * period), 1e-7);
  for (const Json& member : made["family"])
    if (!member["stable"].is_null()) {
      EXPECT_EQ(member["stable"], member["value"] < (*found)["value"]);
    }
  const double at = (*found)["value"];
  for (const double f : {at - .003, at + .003}) {
    problem["parameters"]["f"] = f;
    const Json settled = after(problem, (*found)["initial"], 150 * period);
    Json start = settled;
    start["t"] = 0;
    const double apart = distance(after(problem, start, period), start, {"x", "v"});
    EXPECT_EQ(apart > 1e-2, f > at) << f << " " << apart;
  }
}

// At a fold a family turns back: there may be three orbits for one force.
TEST_F(PeriodicFamilies, GoAroundFolds) {
  const Json problem = custom(R"~({"variables": ["x", "v"], "parameters": {"f": 0.2},
      "equations": {"x": "v", "v": "x - x^3 - 0.2*v + f*cos(t)"}})~");
  const Json made = orbit({{"problem", problem},
                           {"initial", {{"x", 1}}},
                           {"period", 2 * pi},
                           {"family", {{"by", "/problem/f"}, {"to", .5}, {"count", 40}}}});
  std::vector<double> folds;
  for (const Json& member : made["family"])
    if (member["bifurcation"] == "fold") {
      folds.push_back(member["value"]);
      const auto all = others(member, 0);
      EXPECT_LT(std::min(std::abs(all[0] - 1.0), std::abs(all[1] - 1.0)), 1e-6);
    }
  ASSERT_GE(folds.size(), 2U);
  EXPECT_NEAR(folds[0], .25860746, 1e-7);
  EXPECT_NEAR(folds[1], .12826935, 1e-7);
}

// An attracting circle with z' = c z - z^3 across it: its multiplier e^(2 pi c) passes through 1 where the circle
// splits into three.
TEST_F(PeriodicFamilies, PartWhereAMultiplierGoesThroughOne) {
  const Json problem = custom(R"~({"variables": ["x", "y", "z"], "parameters": {"c": -0.11},
      "equations": {"x": "x*(1-x^2-y^2) - y", "y": "y*(1-x^2-y^2) + x", "z": "c*z - z^3"}})~");
  const Json made = orbit({{"problem", problem},
                           {"initial", {{"x", 1}, {"y", 0}, {"z", 0}}},
                           {"period", 6.3},
                           {"family", {{"by", "/problem/c"}, {"to", .14}, {"count", 6}}}});
  const Json* const found = told(made["family"], "pitchfork_or_transcritical");
  ASSERT_TRUE(found) << made;
  EXPECT_NEAR((*found)["value"], 0, 1e-8);
  EXPECT_NEAR((*found)["period"], 2 * pi, 1e-10);
  for (const Json& member : made["family"]) {
    const double c = member["value"];
    double nearest = 1;
    for (const auto& one : others(member, 1)) nearest = std::min(nearest, std::abs(one - std::exp(2 * pi * c)));
    if (&member == found) continue;  // there the multiplier counts as trivial
    EXPECT_LT(nearest, 1e-9) << c;
    EXPECT_TRUE(member["bifurcation"].is_null()) << c;
    EXPECT_EQ(member["stable"], c < 0) << c;
  }
}

// The same circle with a pair across it that rotates by w and grows by c: its multipliers e^(2 pi (c +- i w)) leave the
// unit circle where the orbit becomes a torus.
TEST_F(PeriodicFamilies, BecomeATorusWhereAPairLeavesTheUnitCircle) {
  const Json problem = custom(R"~({"variables": ["x", "y", "u", "v"], "parameters": {"c": -0.11, "w": 0.3},
      "equations": {"x": "x*(1-x^2-y^2) - y", "y": "y*(1-x^2-y^2) + x",
                    "u": "c*u - w*v - u*(u^2+v^2)", "v": "c*v + w*u - v*(u^2+v^2)"}})~");
  const Json made = orbit({{"problem", problem},
                           {"initial", {{"x", 1}, {"y", 0}, {"u", 0}, {"v", 0}}},
                           {"period", 6.3},
                           {"family", {{"by", "/problem/c"}, {"to", .14}, {"count", 6}}}});
  const Json* const found = told(made["family"], "torus");
  ASSERT_TRUE(found) << made;
  EXPECT_NEAR((*found)["value"], 0, 1e-8);
  std::size_t pairs = 0;
  for (const auto& one : others(*found, 1))
    if (std::abs(one - std::polar(1.0, 2 * pi * .3)) < 1e-8 || std::abs(one - std::polar(1.0, -2 * pi * .3)) < 1e-8)
      ++pairs;
  EXPECT_EQ(pairs, 2U) << *found;
  for (const Json& member : made["family"]) {
    if (&member != found) {
      EXPECT_EQ(member["stable"], member["value"] < 0) << member;
    }
  }
}

// In conservative scenes pairs of multipliers meet on the unit circle before they leave it: an oscillation beside a
// rotating point whose frequencies are w +- sqrt(k). Meyer, Hall, Offin, Introduction to Hamiltonian Dynamical Systems,
// 2009, chapter 11.
TEST_F(PeriodicFamilies, BecomeATorusWherePairsMeetOnTheUnitCircle) {
  const Json problem = custom(R"~({"variables": ["x", "u", "v"], "parameters": {"k": 0.011, "w": 0.3},
      "hamiltonian": "(px^2+x^2)/2 + (pu^2+pv^2)/2 + w*(u*pv-v*pu) + k*(u^2+v^2)/2"})~");
  const Json made = orbit({{"problem", problem},
                           {"initial", {{"x", 1}, {"px", 0}, {"u", 0}, {"v", 0}, {"pu", 0}, {"pv", 0}}},
                           {"period", 6.2831853},
                           {"fixed", {"x"}},
                           {"family", {{"by", "/problem/k"}, {"to", -.014}, {"count", 6}}}});
  const Json* const found = told(made["family"], "torus");
  ASSERT_TRUE(found) << made;
  EXPECT_NEAR((*found)["value"], 0, 1e-5);
  for (const Json& member : made["family"])
    if (&member != found) {
      const bool before = member["value"] > 0;
      EXPECT_EQ(member["multipliers"].back()["kind"], before ? "elliptic" : "complex") << member;
      EXPECT_EQ(member["stable"], before) << member;
    }
}

// The period follows the frequency of the drive.
TEST_F(PeriodicFamilies, ByTheFrequencyOfADriveFollowItsPeriod) {
  const Json problem = custom(R"~({"variables": ["x", "v"], "parameters": {"w": 0.6},
      "equations": {"x": "v", "v": "-x - 0.2*v + cos(w*t)"}})~");
  const Json made = orbit(
      {{"problem", problem}, {"period", "2*pi/0.6"}, {"family", {{"by", "/problem/w"}, {"to", 2}, {"count", 40}}}});
  ASSERT_EQ(made["family_end"], "") << made;
  for (const Json& member : made["family"]) {
    const double w = member["value"], stiff = 1 - w * w, size = stiff * stiff + .04 * w * w;
    EXPECT_NEAR(member["period"], 2 * pi / w, 1e-13);
    EXPECT_NEAR(member["initial"]["x"], stiff / size, 1e-12);  // the response of a linear oscillator, at t = 0
    EXPECT_NEAR(member["initial"]["v"], .2 * w * w / size, 1e-12);
    EXPECT_NEAR(member["period_slope"], -2 * pi / (w * w), 1e-12);
  }
}

// The loop orbits of Hénon and Heiles become unstable at .892 of the escape energy 1/6. Brack, Foundations of Physics
// 31, 209 (2001): .8922.
TEST_F(PeriodicFamilies, OfHenonAndHeilesLosesItsStabilityWhereItIsPublished) {
  const Json problem = custom(R"~({"variables": ["x", "y"],
      "lagrangian": "(vx^2+vy^2)/2 - (x^2+y^2)/2 - x^2*y + y^3/3"})~");
  const Json made = orbit({{"problem", problem},
                           {"initial", {{"x", 0}, {"y", .1}, {"px", .3}, {"py", 0}}},
                           {"period", 6.3},
                           {"fixed", {"x"}},
                           {"family", {{"by", "energy"}, {"to", .16}, {"count", 12}}}});
  const Json* const found = told(made["family"], "period_doubling");
  ASSERT_TRUE(found) << made;
  EXPECT_NEAR((*found)["value"].get<double>() * 6, .8922, 4e-4);
  for (const Json& member : made["family"]) {
    const auto all = others(member, 2);
    EXPECT_NEAR(std::abs(all[0] * all[1] - 1.0), 0, 1e-10);
    if (&member == found) continue;
    const bool before = member["value"] < (*found)["value"];
    EXPECT_EQ(member["multipliers"][2]["kind"], before ? "elliptic" : "inverse_hyperbolic");
    EXPECT_EQ(member["stable"], before);
  }
}

// In a conservative scene an orbit is one of a family: when a parameter changes, the period is kept.
TEST_F(PeriodicFamilies, ByAParameterOfAConservativeSceneKeepThePeriod) {
  const Json problem = custom(R"~({"variables": ["a"], "parameters": {"g": 1}, "lagrangian": "va^2/2 + g*cos(a)"})~");
  const Json made = orbit({{"problem", problem},
                           {"initial", {{"a", 1}}},
                           {"period", 6.7},
                           {"symmetric", true},
                           {"family", {{"by", "/problem/g"}, {"to", 1.5}, {"count", 6}}}});
  ASSERT_EQ(made["family_end"], "") << made;
  for (const Json& member : made["family"]) {
    EXPECT_NEAR(member["period"], made["period"].get<double>(), 1e-13);
    const double k = std::sin(member["initial"]["a"].get<double>() / 2);
    EXPECT_NEAR(4 * std::comp_ellint_1(k) / std::sqrt(member["value"].get<double>()), member["period"], 1e-11);
  }
}

// The figure eight of three bodies while one mass grows: at 1.0000403006 the family turns back. Near it is another
// family, with a saddle where this one has a centre: a long step must not jump there, which would look like a
// bifurcation.
TEST_F(PeriodicFamilies, StayOnTheirCurve) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "takes minutes in such a build";
#endif
  for (const double to : {1.01, 1.0002}) {
    const Json made = orbit({{"problem", "figure_eight"},
                             {"period", 6.3259},
                             {"family", {{"by", "/problem/m/2"}, {"to", to}, {"count", to > 1.001 ? 5 : 16}}}});
    const Json* const fold = told(made["family"], "fold");
    ASSERT_TRUE(fold) << made;
    EXPECT_NEAR((*fold)["value"], 1.0000403006, 1e-10);
    for (const Json& member : made["family"]) {
      EXPECT_TRUE(&member == fold || member["bifurcation"].is_null()) << member;
      EXPECT_LT(member["value"], 1.000040301) << "beyond the fold there is none";
      if (&member == fold) {
        double nearest = 1;
        for (const auto& one : others(member, 8)) nearest = std::min(nearest, std::abs(one - 1.0));
        EXPECT_LT(nearest, 1e-3);
      }
    }
  }
}

// The period of an oscillator is the same for all amplitudes, so that no other stiffness or mass has an orbit of the
// same period: the period changes, and the amplitude is kept.
TEST_F(PeriodicFamilies, OfAnOscillatorMoveItsPeriod) {
  const Json typed = custom(R"~({"variables": ["x"], "parameters": {"stiffness": 1, "mass": 1},
      "hamiltonian": "px^2/(2*mass) + stiffness*x^2/2"})~");
  const Json modes = custom(R"~({"variables": ["x", "y"], "parameters": {"stiffness": 1, "mass": 1},
      "hamiltonian": "(px^2+py^2)/(2*mass) + stiffness*(x^2+y^2+0.7*(x-y)^2)/2"})~");
  const std::vector<std::pair<Json, Json>> scenes{{"harmonic_oscillator", {{"q", 1}, {"p", 0}}},
                                                  {typed, {{"x", .6}, {"px", .8}}},
                                                  {modes, {{"x", .6}, {"y", .6}, {"px", .2}, {"py", .2}}}};
  for (const auto& [problem, start] : scenes)
    for (const char* name : {"stiffness", "mass"}) {
      const Json made = orbit({{"problem", problem},
                               {"initial", start},
                               {"period", 6.28},
                               {"family", {{"by", std::string("/problem/") + name}, {"to", 4}, {"count", 6}}}});
      ASSERT_EQ(made["family_end"], "") << made;
      for (const Json& member : made["family"]) {
        const double root = std::sqrt(member["value"].get<double>());
        EXPECT_NEAR(member["period"], 2 * pi * (name == std::string("mass") ? root : 1 / root), 1e-11);
        for (const auto& [variable, value] : start.items())
          EXPECT_NEAR(member["initial"][variable], value, 1e-9) << name;
      }
    }
}

// Where the start is at right angles to the force, only the symmetries of the orbit change x.
TEST_F(PeriodicFamilies, GoAlongSymmetriesWhereNothingElseMovesAStart) {
  const Json made = orbit({{"problem", "kepler"},
                           {"initial", {{"x", 0}, {"y", 1}, {"px", 1.2}, {"py", 0}}},
                           {"period", 15},
                           {"family", {{"by", "/initial/x"}, {"to", 0.3}, {"count", 6}}}});
  ASSERT_EQ(made["family_end"], "") << made;
  EXPECT_EQ(made["family"].back()["value"], 0.3);
  for (const Json& member : made["family"]) {
    const Json& at = member["initial"];
    const double x = at["x"], y = at["y"], px = at["px"], py = at["py"];
    const double energy = (px * px + py * py) / 2 - 1 / std::hypot(x, y);
    EXPECT_NEAR(member["period"].get<double>() / (2 * pi * std::pow(-2 * energy, -1.5)), 1, 1e-10);
  }
}

TEST_F(PeriodicFamilies, OfOrbitsThatAreAloneSaySo) {
  const Json made = orbit({{"problem", "van_der_pol"}, {"period", 6.6}, {"family", {{"by", "/initial/x"}, {"to", 3}}}});
  EXPECT_EQ(made["status"], "closed");
  EXPECT_NE(made["family_end"].get<std::string>().find("alone"), std::string::npos) << made["family_end"];
  const Json held = orbit({{"problem", "van_der_pol"},
                           {"period", 6.6},
                           {"fixed", {"x", "v"}},
                           {"initial", made["initial"]},
                           {"family", {{"by", "/problem/epsilon"}, {"to", 3}}}});
  EXPECT_NE(held["family_end"].get<std::string>().find("fewer variables in `fixed`"), std::string::npos) << held;
}

// The lines are the members of the whole answer, which comes with the last line.
TEST_F(PeriodicFamilies, LeaveInLines) {
  const Json request{{"problem", "van_der_pol"},
                     {"period", 6.6},
                     {"family", {{"by", "/problem/epsilon"}, {"to", 3}, {"count", 5}}},
                     {"manifolds", {{"count", 1}}}};
  const Json whole = orbit(request);
  const Reply made = reply(request, "/v1/periodic", "application/x-ndjson");
  ASSERT_EQ(made.status, 200);
  std::istringstream text(made.body);
  std::vector<Json> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(Json::parse(line));
  ASSERT_EQ(lines.size(), whole["family"].size() + 2);
  EXPECT_EQ(lines.front()["kind"], "head");
  EXPECT_EQ(lines.front()["problem"]["epsilon"], 1);
  for (std::size_t i = 0; i < whole["family"].size(); ++i) {
    Json line = lines[i + 1];
    EXPECT_EQ(line["kind"], "member");
    line.erase("kind");
    EXPECT_EQ(line, whole["family"][i]);
  }
  Json end = lines.back(), rest = whole;
  EXPECT_EQ(end["kind"], "end");
  for (Json* one : {&end, &rest})
    for (const char* member : {"kind", "cost", "family"}) one->erase(member);
  EXPECT_EQ(end, rest);
  EXPECT_EQ(end["manifolds"]["unstable"]["reason"], "no multiplier is real and on that side of the unit circle");
}

}  // namespace
}  // namespace least::server::test
