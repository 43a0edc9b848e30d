// Statements beside derivatives, over HTTP: their uncertainty, the structure of a map, and why there are none.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/server/fixture.hpp"
#include "tests/support/runs.hpp"

namespace least::server::test {
namespace {

class SensitivitiesTold : public Asking {
 protected:
  static Json by(const Json& pointers) { return {{"by", pointers}, {"of", "motion"}}; }
  static bool warns_of_uncertainty(const Json& made) {
    const auto code = [](const Json& one) { return one["code"]; };
    return std::ranges::count(made["warnings"], "uncertain_sensitivities", code) == 1;
  }
  /// differences() returns the derivatives by the initial x, from runs with neighbouring starts: of the final state,
  /// then of the times of events.
  static std::vector<double> differences(Json request) {
    constexpr double h = 1e-4;
    request.erase("sensitivities");
    request["scheme"] = {{"id", "taylor"}, {"tolerance", 1e-14}};
    const double x = request["initial"]["x"];
    const auto beside = [&](double by) {
      request["initial"]["x"] = x + by;
      const Json made = answer(request);
      std::vector<double> all{made["final"]["x"], made["final"]["px"]};
      for (const Json& event : made["events"]) all.push_back(event["t"]);
      return all;
    };
    const auto up = beside(h), down = beside(-h), far_up = beside(2 * h), far_down = beside(-2 * h);
    std::vector<double> slopes(up.size());
    for (std::size_t i = 0; i < slopes.size(); ++i)
      slopes[i] = (8 * (up[i] - down[i]) - (far_up[i] - far_down[i])) / (12 * h);
    return slopes;
  }
};

// Where the mechanics switch, differences of runs confirm the derivatives: these change a parameter in the texts of
// events, too, be it in what an event sets, in where it happens, or in where it stops the run.
TEST_F(SensitivitiesTold, RunsThatConfirmThemChangeTheTextsOfEvents) {
  Json request = Json::parse(R"~({"problem":{"id":"custom","variables":["x"],"parameters":{"q":0.7,"c":0.3},
    "potential":"max(x,-1)^2/2"},"initial":{"x":1},"scheme":"taylor","until":2,
    "events":[{"name":"w","expression":"x-c","direction":"down","set":{"vx":"-q*vx"}}],
    "sensitivities":{"by":["/problem/q","/problem/c"]}})~");
  Json made = answer(request);
  EXPECT_NEAR(made["sensitivities"]["final"][0][0], 0.6389179596168719, 1e-12);
  EXPECT_LT(made["sensitivities"]["uncertainty"], 1e-8);
  EXPECT_TRUE(made["warnings"].empty()) << made["warnings"];
  request["events"][0].erase("set");
  request["events"][0]["stop"] = true;
  request["sensitivities"]["by"] = {"/problem/c"};
  made = answer(request);
  EXPECT_NEAR(made["sensitivities"]["final"][0][0], 1, 1e-12) << "it ends at x = c";
  EXPECT_LT(made["sensitivities"]["uncertainty"], 1e-8);
}

// An event that sets s has it among the rows and in the final state, and runs that confirm the derivatives tell it,
// too.
TEST_F(SensitivitiesTold, TheActionThatAnEventSetsIsToldOfTheEnd) {
  const Json made = answer(Json::parse(R"~({"problem":{"id":"custom","variables":["x"],
    "lagrangian":"vx^2/2-max(x,-5)-0.2*s"},"initial":{"x":1},"scheme":"taylor","until":2,
    "events":[{"name":"w","expression":"x","direction":"down","set":{"vx":"-0.7*vx","s":"s*0.5"}}],
    "sensitivities":{"by":["/initial/x"]}})~"));
  const Json& found = made["sensitivities"];
  EXPECT_EQ(found["rows"], Json({"x", "px", "s"}));
  EXPECT_EQ(found["final"].size(), 3U);
  for (const Json& row : found["rows"]) EXPECT_TRUE(made["final"].contains(row)) << row;
  EXPECT_LT(found["uncertainty"], 1e-8) << found;
  EXPECT_FALSE(found.contains("reason")) << found["reason"];
}

// Masses from 1 to 8e-9 make entries of 1e8 and 1e-8: in units in which both are about 1 the map is symplectic to
// rounding, by one scheme or another. Euler's steps keep no form in any units.
TEST_F(SensitivitiesTold, TheStructureIsMeasuredInBalancedUnits) {
#ifdef __SANITIZE_ADDRESS__
  const std::vector<const char*> all{"leapfrog", "explicit_euler"};  // such a build is too slow for `auto`
#else
  const std::vector<const char*> all{"leapfrog", "auto", "explicit_euler"};
#endif
  for (const char* scheme : all) {
    Json request{{"problem", "outer_solar_system"}, {"scheme", scheme}, {"diagnostics", {"structure"}}};
    if (scheme == std::string("explicit_euler")) request["until"] = 2000;
    const Json made = answer(request);
    const double defect = made["diagnostics"]["structure"]["max_defect"];
    EXPECT_EQ(defect < 1e-12, scheme != std::string("explicit_euler")) << scheme << defect;
    if (scheme == std::string("leapfrog")) {
      request["sensitivities"] = by("initial");
      request["until"] = 2000;
      EXPECT_LT(answer(request)["sensitivities"]["structure"]["max_defect"], 1e-10);
    }
  }
}

// Derivatives with jumps at switches are compared with runs, also with runs that start at another time.
TEST_F(SensitivitiesTold, ByTheTimeOfTheStartOfSwitchingScenesAreHeldAgainstRuns) {
  const Json springs = custom(R"~({"variables": ["x"], "parameters": {"k": 2},
      "potential": "if(x>0, k*x^2/2, x^2/2) - 0.1*x*cos(t)"})~");
  const Json drag =
      custom(R"~({"variables": ["x"], "parameters": {"c": 0.2}, "lagrangian": "vx^2/2 - x^2/2 + x*sin(2*t)/5",
      "forces": {"x": "-c*vx*abs(vx)"}})~");
  for (const Json& problem : {springs, drag}) {
    Json request{{"problem", problem},
                 {"initial", {{"x", 1}, {"vx", 0.2}, {"t", 0.3}}},
                 {"scheme", "taylor"},
                 {"until", 7},
                 {"sensitivities", by({"/initial/x", "/initial/t"})}};
    const Json found = answer(request)["sensitivities"];
    ASSERT_TRUE(found["uncertainty"].is_number()) << found;
    EXPECT_LT(found["uncertainty"], 1e-8);
    request.erase("sensitivities");
    constexpr double h = 1e-4;
    Json ends[2];
    for (const int side : {0, 1}) {
      request["initial"]["t"] = side == 0 ? 0.3 - h : 0.3 + h;
      ends[side] = answer(request)["final"];
    }
    const double slope = (ends[1]["x"].get<double>() - ends[0]["x"].get<double>()) / (2 * h);
    EXPECT_NEAR(found["final"][0][1], slope, 1e-6);
  }
}

// A later pulse does not hide the jumps that switches cause in derivatives, of the end and of times of events.
TEST_F(SensitivitiesTold, JumpsAtSwitchesAreSeenBesideASleepingForce) {
  const auto pushed = [](const Json& more) {
    Json problem{{"id", "custom"}, {"variables", {"x"}}, {"potential", "x^2/2"}};
    problem.update(more);
    return problem;
  };
  const std::string kink = "x^2/2 + abs(x) + x*", pulse = "exp(-60*(t-5.4)^2)";
  std::vector<Json> all;
  for (const char* other : {"exp(-60*(t-5.4)^2)", "exp(-60*(t-2)^2)", "exp(-5*(t-5.4)^2)", "exp(-2000*(t-20)^2)"})
    all.push_back(pushed({{"potential", kink + other}}));
  all.push_back(pushed({{"potential", kink + pulse}, {"damping", "0.1"}}));
  for (const std::string force : {"-0.3*sign(vx)", "-0.3*sign(x)"})
    all.push_back(pushed({{"forces", {{"x", force + " + " + pulse}}}}));
  all.push_back(pushed({{"potential",
                         "0.79*x^2/2 + 0.82*hypot(x, 1.12) + 0.73*if(x < -0.24, 0, x^2)"
                         " + x*exp(-(t-5.44)^2*57.15)"}}));
  for (const Json& problem : all)
    for (const char* scheme : {"taylor", "dormand_prince_5"}) {
      const Json request{{"problem", problem},
                         {"initial", {{"x", 1.04}, {"vx", 0.31}}},
                         {"scheme", scheme},
                         {"until", 4},
                         {"record", {{"every", 0}}},
                         {"events", Json::array({{{"name", "passed"}, {"expression", "x + 0.29"}}})},
                         {"sensitivities", by({"/initial/x"})}};
      const Json made = answer(request), found = made["sensitivities"];
      EXPECT_LT(found["uncertainty"], 1e-9) << found << request;
      EXPECT_TRUE(made["warnings"].empty()) << made["warnings"];
      const std::vector<double> truth = differences(request);
      ASSERT_EQ(truth.size(), 2 + found["events"].size()) << request;
      for (std::size_t i = 0; i < truth.size(); ++i) {
        const Json& slope = i < 2 ? found["final"][i][0] : found["events"][i - 2]["t"][0];
        EXPECT_NEAR(slope, truth[i], 1e-8) << i << request;
      }
    }
}

// An event that acts begins a new step, also so close to a switch that the step between them resolves nothing.
TEST_F(SensitivitiesTold, JumpsAtSwitchesAreSeenAtTheEndOfTheShortestSteps) {
  for (const char* before : {"x - 1e-12", "x - 1e-10", "x - 1e-9", "x - 1e-8", "x - 1e-6"}) {
    const Json act{{"name", "act"}, {"expression", before}, {"direction", "down"}, {"set", {{"vx", "vx"}}}};
    const Json request{{"problem", custom(R"~({"variables": ["x"], "potential": "x^2/2 + abs(x)"})~")},
                       {"initial", {{"x", 1}, {"vx", 0.2}}},
                       {"scheme", "taylor"},
                       {"until", 4},
                       {"events", Json::array({act})},
                       {"sensitivities", by({"/initial/x"})}};
    const Json found = answer(request)["sensitivities"];
    const std::vector<double> truth = differences(request);
    ASSERT_EQ(truth.size(), 3) << before;
    for (const std::size_t i : {std::size_t(0), std::size_t(1)})
      EXPECT_NEAR(found["final"][i][0], truth[i], 1e-8) << before;
    EXPECT_LT(found["uncertainty"], 1e-9) << before;
  }
}

// At a start on a kink the derivatives to the left and to the right differ: there is no derivative.
TEST_F(SensitivitiesTold, WhatIsContradictedByRunsCarriesAWarning) {
  for (const double x : {0.0, 0.5}) {
    const Json request{{"problem", custom(R"~({"variables": ["x"], "potential": "x^2/2 + abs(x)"})~")},
                       {"initial", {{"x", x}, {"vx", 0.2}}},
                       {"scheme", "taylor"},
                       {"until", 4},
                       {"sensitivities", by({"/initial/x"})}};
    const Json made = answer(request);
    const bool worthless = x == 0;
    EXPECT_EQ(made["sensitivities"]["uncertainty"] > 0.1, worthless) << made["sensitivities"];
    EXPECT_TRUE(made["sensitivities"]["final"].is_array());
    EXPECT_EQ(warns_of_uncertainty(made), worthless) << made["warnings"];
  }
}

// Where rounding decides the motion, its derivatives are those of another motion. Two tolerances, whose motions part,
// tell where that is; the uncertainty has to say so, however far the control of the derivatives has gone astray.
TEST_F(SensitivitiesTold, DerivativesBeyondTheHorizonCarryAWarning) {
  runs::problem_called("lorenz");
  for (const double until : {25.0, 46.0, 48.0, 50.0, 60.0, 100.0}) {
    const auto with = [&](double tolerance) {
      return answer({{"problem", "lorenz"},
                     {"until", until},
                     {"scheme", {{"id", "taylor"}, {"tolerance", tolerance}}},
                     {"record", {{"every", 0}}},
                     {"sensitivities", by({"/initial/x"})}});
    };
    const Json made = with(1e-15), other = with(1e-12);
    double largest = 0, apart = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double slope = made["sensitivities"]["final"][i][0], beside = other["sensitivities"]["final"][i][0];
      largest = std::max(largest, std::abs(slope));
      apart = std::max(apart, std::abs(slope - beside));
    }
    const bool worthless = apart > 0.1 * largest;
    EXPECT_EQ(worthless, until > 40) << until;
    ASSERT_TRUE(made["sensitivities"]["uncertainty"].is_number()) << until << made["sensitivities"];
    EXPECT_EQ(made["sensitivities"]["uncertainty"] > 0.1, worthless) << until << made["sensitivities"];
    EXPECT_EQ(warns_of_uncertainty(made), worthless) << until << made["warnings"];
  }
}

// Where there is no uncertainty, or no derivative, there is a reason: here derivatives outgrow all numbers.
TEST_F(SensitivitiesTold, WhatIsMissingHasAReason) {
  runs::problem_called("lorenz");
  const Json found = answer({{"problem", "lorenz"},
                             {"until", 800},
                             {"scheme", "taylor"},
                             {"record", {{"every", 0}}},
                             {"sensitivities", by({"/initial/x"})}})["sensitivities"];
  EXPECT_TRUE(found["final"][0][0].is_null()) << found;
  EXPECT_TRUE(found["uncertainty"].is_null()) << found;
  EXPECT_TRUE(found.contains("reason")) << found;
}

// Events may read s, or the energy that contains it, where the motion itself does not need it.
TEST_F(SensitivitiesTold, EventsThatReadTheActionAreGoneThrough) {
  const Json typed = custom(R"~({"variables": ["x"], "potential": "x^2/2 + x^4/8", "damping": "0.1 + 0.05*sin(t)"})~");
  const std::vector<Json> events{{{"expression", "s + 0.1"}, {"set", {{"px", "0.9*px"}}}},
                                 {{"expression", "px"}, {"set", {{"px", "0.3 + s"}}}},
                                 {{"expression", "x"}, {"set", {{"s", "s + x + 0.2*px"}, {"px", "px - s/10"}}}},
                                 {{"expression", "s + 0.1"}},
                                 {{"expression", "energy - 0.4"}},
                                 {{"expression", "s + 0.1"}, {"stop", true}}};
  for (const double until : {4.0, -4.0})
    for (Json event : events) {
      event["name"] = "k";
      const Json request{{"problem", typed},
                         {"initial", {{"x", 1}}},
                         {"until", until},
                         {"scheme", "taylor"},
                         {"record", {{"every", 0}}},
                         {"events", Json::array({event})},
                         {"sensitivities", by({"/initial/x"})}};
      const Json made = answer(request), found = made["sensitivities"];
      ASSERT_TRUE(found["final"].is_array()) << found << event;
      EXPECT_FALSE(found.contains("reason")) << found << event;
      EXPECT_EQ(found["rows"], Json({"x", "px", "s"}));
      const std::vector<double> truth = differences(request);
      ASSERT_EQ(truth.size(), 2 + found["events"].size()) << event;
      for (std::size_t i = 0; i < truth.size(); ++i) {
        const Json& slope = i < 2 ? found["final"][i][0] : found["events"][i - 2]["t"][0];
        EXPECT_NEAR(slope, truth[i], 1e-8) << until << i << event;
      }
    }
}

// With s the map of a damped motion is a contact map, which multiplies its form by e^{−αt}; a scheme's own map stays
// that of (q, p), as events have no derivatives by it.
TEST_F(SensitivitiesTold, TheActionJoinsTheMapWhereEventsReadIt) {
  Json request{{"problem", custom(R"~({"variables": ["x"], "potential": "x^2/2", "damping": "0.1"})~")},
               {"initial", {{"x", 1}}},
               {"until", 4},
               {"scheme", "taylor"},
               {"events", Json::array({{{"name", "k"}, {"expression", "s + 0.1"}}})},
               {"sensitivities", {{"by", "initial"}, {"of", "motion"}}}};
  const Json whole = answer(request)["sensitivities"];
  EXPECT_EQ(whole["by"], Json({"/initial/x", "/initial/px", "/initial/s"}));
  EXPECT_NEAR(whole["structure"]["factor"], std::exp(-0.4), 1e-12);
  EXPECT_LT(whole["structure"]["max_defect"], 1e-12);
  request["scheme"] = "contact_leapfrog";
  request["sensitivities"] = {{"by", "initial"}};
  const Json map = answer(request)["sensitivities"];
  EXPECT_EQ(map["of"], "scheme");
  EXPECT_EQ(map["rows"], Json({"x", "px"}));
  EXPECT_TRUE(map.contains("reason")) << map;
}

TEST_F(SensitivitiesTold, TimesOfEventsOfAMapAreMissingForAReason) {
  Json request{{"problem", "kepler"},
               {"scheme", "leapfrog"},
               {"until", 5},
               {"events", Json::array({{{"name", "a"}, {"expression", "y+4.05"}}})},
               {"sensitivities", {{"by", {"/initial/x"}}}}};
  Json found = answer(request)["sensitivities"];
  EXPECT_EQ(found["of"], "scheme");
  ASSERT_FALSE(found["events"].empty()) << found;
  EXPECT_TRUE(found["final"].is_array());
  EXPECT_EQ(found["reason"], "times of events have derivatives along the motion alone: \"of\": \"motion\"");
  request["sensitivities"]["of"] = "motion";
  found = answer(request)["sensitivities"];
  EXPECT_TRUE(found["events"][0]["t"][0].is_number()) << found;
  EXPECT_FALSE(found.contains("reason"));
}

TEST_F(SensitivitiesTold, FaultsNameTheEntryThatIsMeant) {
  Json second{{"problem", "kepler"}, {"scheme", "taylor"}, {"sensitivities", by({"/initial/x", "/initial/t"})}};
  second["sensitivities"]["order"] = 2;
  EXPECT_EQ(fault_of(second)["pointer"], "/sensitivities/by/1");
}

}  // namespace
}  // namespace least::server::test
