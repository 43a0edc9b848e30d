// Derivatives of the maps of schemes, over HTTP.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "core/catalogue/catalogue.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

class SchemeSensitivities : public Asking {};

// One step of leapfrog from (x, p): p½ = p − hkx/2, x₁ = x + hp½, p₁ = p½ − hkx₁/2, and its derivatives.
TEST_F(SchemeSensitivities, OfALeapfrogStepAreThoseOfItsFormula) {
  const double h = 0.5, k = 2, x = 1, p = 0.25;
  const Json made = answer({{"problem", custom(R"({"variables":["x"],"parameters":{"k":2},"potential":"k*x^2/2"})")},
                            {"initial", {{"x", x}, {"px", p}}},
                            {"scheme", {{"id", "leapfrog"}, {"step", h}}},
                            {"until", {{"steps", 1}}},
                            {"sensitivities", {{"by", {"/initial/x", "/initial/px", "/problem/k"}}}}});
  const Json& found = made["sensitivities"];
  EXPECT_EQ(found["of"], "scheme");
  const double x1 = x + h * (p - h * k * x / 2), x1_by_k = -h * h * x / 2;
  EXPECT_DOUBLE_EQ(found["final"][0][0], 1 - h * h * k / 2);
  EXPECT_DOUBLE_EQ(found["final"][0][1], h);
  EXPECT_DOUBLE_EQ(found["final"][0][2], x1_by_k);
  EXPECT_DOUBLE_EQ(found["final"][1][2], -h * x / 2 - h / 2 * (x1 + k * x1_by_k));
  EXPECT_LT(found["uncertainty"], 1e-10);
}

// The end that an event moves has its derivatives along the motion: the time to fall from x is √(2x), and the speed
// there as much. Of the scheme there are none, whoever asks for them.
TEST_F(SchemeSensitivities, OfAnEndThatAnEventMovesAreThoseOfTheMotion) {
  Json request{{"problem", {{"id", "custom"}, {"variables", {"x"}}, {"potential", "x"}}},
               {"initial", {{"x", 1}}},
               {"scheme", "leapfrog"},
               {"until", 5},
               {"events", {{{"name", "floor"}, {"expression", "x"}, {"stop", true}}}},
               {"sensitivities", {{"by", {"/initial/x"}}}}};
  const Json made = answer(request), &found = made["sensitivities"];
  EXPECT_EQ(found["of"], "motion");
  EXPECT_NEAR(found["final"][0][0], 0, 1e-12);
  EXPECT_NEAR(found["final"][1][0], -std::sqrt(0.5), 1e-10);
  request["sensitivities"]["of"] = "scheme";
  EXPECT_EQ(answer(request)["sensitivities"]["of"], "scheme");
}

// A step across a jump of the force does not feel where in it the jump lies: the derivative of the map is 1, that of
// the motion 0.17, and differences of runs confirm the former. Where the force has a corner only, both are one.
TEST_F(SchemeSensitivities, AreInDoubtWhereTheForceJumps) {
  const auto of = [](const char* potential) {
    return answer({{"problem", {{"id", "custom"}, {"variables", {"x"}}, {"potential", potential}}},
                   {"initial", {{"x", 1}}},
                   {"scheme", {{"id", "leapfrog"}, {"step", 0.001}}},
                   {"until", 2},
                   {"sensitivities", {{"by", {"/initial/x"}}}}});
  };
  const Json jumps = of("abs(x)"), bends = of("if(x < 0, x^2, 2*x^2)");
  EXPECT_GT(jumps["sensitivities"]["uncertainty"], 0.1);
  EXPECT_NE(jumps["warnings"].dump().find("uncertain_sensitivities"), std::string::npos);
  EXPECT_LT(bends["sensitivities"]["uncertainty"], 1e-4);
}

// Every problem of the catalogue by every scheme of equal steps: derivatives against runs of the scheme, and its
// structure.
TEST_F(SchemeSensitivities, OfEveryPairAreDifferencesOfItsRuns) {
  std::size_t pairs = 0;
  std::set<std::string> without;
  for (const auto& problem : problem_list()) {
    const ProblemCard& card = problem->card();
    if (card.id == "lane_emden") continue;  // its default start is singular
    Json pointers = Json::array();
    for (const ParameterCard& parameter : card.parameters)
      if (parameter.kind == Kind::number && parameter.value > parameter.range.low &&
          parameter.value < parameter.range.high)
        pointers.push_back("/problem/" + parameter.name);
    for (const std::size_t place : card.schemes) {
      const SchemeCard& scheme = schemes()[place];
      if (scheme.own_clock) continue;
      SCOPED_TRACE(card.id + " by " + scheme.id);
      Json request{{"problem", card.id},
                   {"scheme", scheme.id},
                   {"until", {{"steps", 12}}},
                   {"record", {{"every", 0}}},
                   {"sensitivities", {{"by", "initial"}, {"of", "scheme"}}}};
      const Reply reply = ask(port(), post("/v1/simulate", request.dump()));
      if (reply.status == 422) {
        EXPECT_TRUE(says(only_fault(reply), "there is no derivative")) << reply.body;
        without.insert(card.id + " " + scheme.id);
        continue;
      }
      ++pairs;
      const Json found = Json::parse(reply.body)["sensitivities"];
      ASSERT_TRUE(found["final"].is_array()) << found;
      EXPECT_LT(found["uncertainty"], 1e-8) << found;
      if (scheme.structure == "symplectic" && found["structure"]["kind"] == "symplectic") {
        EXPECT_LT(found["structure"]["max_defect"], 1e-11) << found;
      }
      if (pointers.empty()) continue;
      request["sensitivities"]["by"] = pointers;
      const Json by_parameters = answer(request)["sensitivities"];
      ASSERT_TRUE(by_parameters["final"].is_array()) << by_parameters;
      EXPECT_LT(by_parameters["uncertainty"], 1e-8) << by_parameters;
    }
  }
  EXPECT_GT(pairs, 2 * problem_list().size());
  std::string all;
  for (const std::string& pair : without) all += pair + "; ";
  EXPECT_LT(without.size(), 12U) << all;
}

TEST_F(SchemeSensitivities, OfScenesAsTextOfEveryForm) {
  const struct {
    const char *scene, *scheme;
  } all[] = {
      {R"~({"variables":["a","b","d"],"parameters":{"c":0.3},"potential":"a^4/4 + c*a*b + b^2 + c*d^2"})~",
       "galerkin_4"},
      {R"~({"variables":["a","b"],"parameters":{"c":0.3},"lagrangian":"va^2/2 + c*va*vb + vb^2 - a^2 - b^4"})~",
       "variational_midpoint"},
      {R"~({"variables":["a"],"parameters":{"c":2},"potential":"a^4/4","masses":{"a":"c"},"damping":"c/(9+t^2)"})~",
       "contact_leapfrog"},
      {R"~({"variables":["a"],"parameters":{"c":0.3},"potential":"a^2/2","action_curvature":"c","offset":"0.1"})~",
       "contact_variational_midpoint"},
      {R"~({"variables":["a","b"],"parameters":{"c":2},"lagrangian":"va^2/2*(c+cos(b)) + vb^2/2 - a^2"})~",
       "galerkin_4"},
      {R"~({"variables":["a"],"parameters":{"c":0.2},"hamiltonian":"pa^2/2 + a^2/2 + 0.1*a*pa + c*s*a"})~",
       "contact_gauss"},
      {R"~({"variables":["a","b"],"parameters":{"c":0.2},"equations":{"a":"b","b":"-a + c*sin(t)"}})~",
       "runge_kutta_4"},
      {R"~({"variables":["q[24]"],"parameters":{"c":0.5},
                 "potential":"sum(i=1..24, q[i]^4/4) + c*sum(i=1..23, (q[i+1]-q[i])^2)"})~",
       "leapfrog"},
      {R"~({"variables":["q[24]"],"parameters":{"c":0.5},"damping":"c*(1+sin(t)/2)",
                 "potential":"sum(i=1..24, q[i]^4/4) + c*sum(i=1..23, (q[i+1]-q[i])^2)"})~",
       "contact_splitting"},
      {R"~({"variables":["q[24]"],"parameters":{"c":0.5},"damping":"c",
                 "potential":"sum(i=1..24, q[i]^4/4) + c*sum(i=1..23, (q[i+1]-q[i])^2)"})~",
       "contact_symplectic_euler"}};
  for (const auto& [scene, scheme] : all) {
    SCOPED_TRACE(scene);
    const Json problem = custom(scene);
    const std::string first = problem["variables"][0], name = first == "q[24]" ? "q[1]" : first;
    for (const int end : {1, -1}) {
      const Json found =
          answer({{"problem", problem},
                  {"initial", {{name, 0.8}}},
                  {"scheme", {{"id", scheme}, {"step", 0.03}}},
                  {"until", end},
                  {"record", {{"every", 10}}},
                  {"sensitivities", {{"by", {"/initial/" + name, "/problem/c"}}, {"at", "samples"}}}})["sensitivities"];
      ASSERT_TRUE(found["final"].is_array()) << found;
      EXPECT_EQ(found["of"], "scheme");
      EXPECT_LT(found["uncertainty"], 1e-9) << found;
      EXPECT_EQ(found["samples"].size(), 4U);
    }
  }
}

// Schemes whose steps are made of what they find in a text: derivatives by the start.
TEST_F(SchemeSensitivities, OfSchemesThatAreFoundInTexts) {
  const struct {
    const char *scene, *scheme;
    bool symplectic;
  } all[] = {{R"~({"variables":["x","y","z"],"parameters":{"c":1},
                  "lagrangian":"(vx^2+vy^2+vz^2)/2 + (x*vy-y*vx)*(c/(x^2+y^2+z^2)^1.5 + 1/2)"})~",
              "boris", false},
             {R"~({"variables":["x","y"],"parameters":{"c":0.3},"potential":"x^2/2+y^2+x*y/3+c*x^2*y"})~",
              "harmonic_splitting", true},
             {R"~({"variables":["x","y"],"parameters":{"c":0.1},"potential":"-1/sqrt(x^2+y^2)+c*x^2"})~",
              "kepler_splitting", true}};
  for (const auto& [scene, scheme, symplectic] : all) {
    SCOPED_TRACE(scheme);
    Json request{{"problem", custom(scene)},
                 {"initial", {{"x", 0.8}, {"y", 0.1}, {"px", 0.1}, {"py", 0.9}}},
                 {"scheme", {{"id", scheme}, {"step", 0.05}}},
                 {"until", {{"steps", 30}}},
                 {"record", {{"every", 10}}},
                 {"sensitivities", {{"by", "initial"}, {"of", "scheme"}, {"at", "samples"}}}};
    const Json found = answer(request)["sensitivities"];
    ASSERT_TRUE(found["final"].is_array()) << found;
    EXPECT_LT(found["uncertainty"], 1e-8) << found;
    EXPECT_EQ(found["samples"].size(), 4U);
    if (symplectic) {
      EXPECT_LT(found["structure"]["max_defect"], 1e-11) << found;
    }
    request["sensitivities"] = {{"by", {"/problem/c"}}, {"of", "scheme"}};
    EXPECT_TRUE(says(fault_of(request), "no derivative by parameters"));
    request["sensitivities"].erase("of");
    EXPECT_EQ(answer(request)["sensitivities"]["of"], "motion");
  }
}

// Derivatives of the scheme's map differ from those of the motion, and agree in the limit of short steps.
TEST_F(SchemeSensitivities, BecomeThoseOfTheMotion) {
  Json request{{"problem", "kepler"},
               {"initial", {{"x", 1}, {"y", 0}, {"px", 0}, {"py", 1.1}}},
               {"until", 3},
               {"record", {{"every", 0}}},
               {"sensitivities", {{"by", {"/initial/x", "/problem/mu"}}}}};
  request["scheme"] = "taylor";
  const Json motion = answer(request)["sensitivities"];
  EXPECT_EQ(motion["of"], "motion");
  double errors[2];
  for (int halved = 0; halved < 2; ++halved) {
    request["scheme"] = {{"id", "leapfrog"}, {"step", halved ? 0.005 : 0.01}};
    const Json found = answer(request)["sensitivities"];
    errors[halved] = 0;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t k = 0; k < 2; ++k)
        errors[halved] = std::max(errors[halved],
                                  std::abs(found["final"][i][k].get<double>() - motion["final"][i][k].get<double>()));
  }
  EXPECT_GT(errors[0], 1e-5);
  EXPECT_NEAR(errors[0] / errors[1], 4, 0.1);
}

// Dry friction and the well |x|: rates jump where the motion turns, or crosses the middle. From x = 0 with the velocity
// v in the well |x| the body comes back after 2v, with −v.
TEST_F(SchemeSensitivities, OfTheMotionGoOverJumps) {
  Json request{{"problem", custom(R"~({"variables":["x"],"parameters":{"f":1},"potential":"f*abs(x)"})~")},
               {"initial", {{"x", 0.5}, {"vx", 1}}},
               {"scheme", "taylor"},
               {"until", 5},
               {"sensitivities", {{"by", {"/initial/x", "/initial/vx", "/problem/f"}}}}};
  Json found = answer(request)["sensitivities"];
  // It crosses the middle at T = v + √(v² + 2x) with the velocity −w, w = √(v² + 2x); then x(t) = −w(t − T) + (t −
  // T)²/2.
  const double w = std::sqrt(2.0), first = 1 + w, later = 5 - first;
  ASSERT_LT(later, 2 * w);
  const double w_by_x = 1 / w, w_by_v = 1 / w;
  EXPECT_NEAR(found["final"][0][0], -w_by_x * later + (w - later) * w_by_x, 1e-10);
  EXPECT_NEAR(found["final"][0][1], -w_by_v * later + (w - later) * (1 + w_by_v), 1e-10);
  EXPECT_LT(found["uncertainty"], 1e-7) << found;
  request["problem"] = custom(R"~({"variables":["x","v"],"parameters":{"c":0.1},
      "equations":{"x":"v","v":"-x - c*sign(v)"}})~");
  request["initial"] = {{"x", 1}, {"v", -0.3}};
  request["until"] = 7;
  request["sensitivities"]["by"] = {"/initial/x", "/initial/v", "/problem/c"};
  found = answer(request)["sensitivities"];
  EXPECT_LT(found["uncertainty"], 1e-7) << found;
  request["sensitivities"]["order"] = 2;
  EXPECT_TRUE(says(only_fault(ask(port(), post("/v1/simulate", request.dump()))), "switch sides"));
}

// Close to the centre a change of 1e-5 of the momentum leads to another orbit: a large discrepancy shows the limits of
// the differences, not of the derivatives.
TEST_F(SchemeSensitivities, AreSureOfThemselvesOnNearlyRadialOrbits) {
  for (const char* scheme : {"leapfrog", "runge_kutta_4"}) {
    const Json found = answer({{"problem", "kepler"},
                               {"initial", {{"x", 1}, {"y", 0}, {"px", 0}, {"py", 0.1}}},
                               {"scheme", {{"id", scheme}, {"step", 1e-4}}},
                               {"until", 1.3},
                               {"record", {{"every", 0}}},
                               {"sensitivities", {{"by", "initial"}}}})["sensitivities"];
    EXPECT_LT(found["uncertainty"], 1e-6) << scheme;
    EXPECT_GT(found["uncertainty"], 0) << scheme;
  }
}

TEST_F(SchemeSensitivities, AreOfTheMotionWhereTheMapHasNone) {
  const Json plain{{"problem", "harmonic_oscillator"}, {"scheme", "leapfrog"}, {"until", 1}};
  const auto of = [&](const Json& asked, const Json& more = Json::object()) {
    Json request = plain;
    request.update(more);
    request["sensitivities"] = asked;
    return answer(request)["sensitivities"]["of"];
  };
  EXPECT_EQ(of({{"by", "initial"}}), "scheme");
  EXPECT_EQ(of({{"by", "initial"}, {"at", "samples"}}, {{"record", {{"every", 10}}}}), "scheme");
  EXPECT_EQ(of({{"by", "initial"}, {"at", "samples"}}, {{"record", {{"samples", 5}}}}), "motion");
  EXPECT_EQ(of({{"by", "initial"}, {"order", 2}}), "motion");
  EXPECT_EQ(of({{"by", {"/initial/t"}}}), "motion");
  const Json kick{{"name", "kick"}, {"expression", "q - 0.9"}, {"set", {{"p", "0.9*p"}}}};
  EXPECT_EQ(of({{"by", "initial"}}, {{"events", {kick}}}), "motion");
  const Json forced = custom(R"~({"variables":["x"],"potential":"x^2/2","forces":{"x":"-vx^3"}})~");
  EXPECT_EQ(of({{"by", "initial"}}, {{"problem", forced}}), "motion");
}

TEST_F(SchemeSensitivities, AreRefusedByName) {
  Json request{{"problem", "kepler"}, {"scheme", "dormand_prince_5"}, {"until", 1}};
  const auto refused = [&](const Json& asked, const std::string& pointer, std::string_view words) {
    request["sensitivities"] = asked;
    const Json fault = only_fault(ask(port(), post("/v1/simulate", request.dump())));
    EXPECT_EQ(fault["pointer"], pointer) << fault;
    EXPECT_TRUE(says(fault, words)) << fault;
  };
  refused({{"by", "initial"}, {"of", "scheme"}}, "/sensitivities/of", "sets its steps itself");
  request["scheme"] = "leapfrog";
  refused({{"by", {"/initial/t"}}, {"of", "scheme"}}, "/sensitivities/by/0", "moves the steps");
  request["record"] = {{"samples", 10}};
  refused({{"by", "initial"}, {"of", "scheme"}, {"at", "samples"}}, "/sensitivities/at", "whole steps");
}

}  // namespace
}  // namespace least::server::test
