// What is told of derivatives beside them, over HTTP: their uncertainty, the structure of a map, why there are none.
#include <gtest/gtest.h>

#include <string>

#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

class SensitivitiesTold : public Asking {
 protected:
  static Json by(const Json& pointers) { return {{"by", pointers}, {"of", "motion"}}; }
};

// Masses of 1 to 8e-9 make entries of 1e8 and 1e-8: in units of which both are about 1 the map is symplectic to
// rounding, whether one scheme or another makes it. Euler's steps keep no form in any units.
TEST_F(SensitivitiesTold, TheStructureIsMeasuredInBalancedUnits) {
#ifdef __SANITIZE_ADDRESS__
  const std::vector<const char*> all{"leapfrog", "explicit_euler"};  // in such a build `auto` has no time for others
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

// What is made of the jumps of equations that switch is held against runs, of which one may start at another time.
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
