// What is asked for of a run, its rows, columns and diagnostics, changes neither the run nor what it warns of.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"
#include "tests/support/runs.hpp"

namespace least::server::test {
namespace {

class Asked : public Asking {
 protected:
  /// What a run comes to: how it ends, where, and its warnings.
  static Json end_of(const Json& request) {
    Json made = answer(request), end;
    for (const char* key : {"status", "stop", "final", "warnings"}) end[key] = made[key];
    return end;
  }
};

// Of steps that are far too long for the energy level shorter ones fail, which samples are found by.
TEST_F(Asked, RowsChangeNoRun) {
  Json request = {{"problem", "duffing"},
                  {"scheme", {{"id", "time_transformed"}, {"sigma", 0.02}, {"kappa", 1}}},
                  {"until", 5.03},
                  {"record", {{"every", 0}}}};
  const Json alone = end_of(request);
  ASSERT_EQ(alone["status"], "stopped") << "a run with such steps is needed here";
  for (const Json& record : {Json{{"samples", 13}}, Json{{"samples", 20}}, Json{{"curve", 30}}, Json{{"every", 1}},
                             Json{{"times", {1.8, 2.0, 2.2, 5}}}}) {
    request["record"] = record;
    EXPECT_EQ(end_of(request), alone) << record;
  }
}

// By default it takes the threshold κ that its drive needs, which is no part of the natural units.
TEST_F(Asked, DuffingRunsByTransformedStepsAsItStands) {
  EXPECT_EQ(answer({{"problem", "duffing"}, {"scheme", "time_transformed"}})["status"], "completed");
}

// The error is 0.1016 at most, which the control run, that looks at fewer states, does not call large.
TEST_F(Asked, DiagnosticsChangeNoWarnings) {
  Json request = {{"problem", "thermostat"},
                  {"scheme", "explicit_midpoint"},
                  {"until", 5.03},
                  {"record", {{"every", 0}}},
                  {"diagnostics", Json::array()}};
  const Json alone = end_of(request);
  request["diagnostics"] = {"error"};
  ASSERT_GT(answer(request)["diagnostics"]["error"]["max"], 0.1) << "an error about as large as that is needed here";
  EXPECT_EQ(end_of(request), alone);
}

// The largest error is no smaller than any that the column has, also where dense output is worse than steps.
TEST_F(Asked, TheLargestErrorIsThatOfAllRows) {
  runs::problem_called("spin_orbit");  // or it is skipped
  const Json requests[] = {
      {{"problem", "spin_orbit"},
       {"scheme", {{"id", "bulirsch_stoer"}, {"tolerance", 1e-6}}},
       {"record", {{"times", {8.4, 9.37, 20}}}}},
      {{"problem", "spherical_pendulum"},
       {"scheme", {{"id", "dormand_prince_5"}, {"tolerance", 1e-9}}},
       {"record", {{"samples", 4001}}}},
      {{"problem", "kapitza"}, {"scheme", "dormand_prince_5"}, {"record", {{"samples", 4001}}}},
      {{"problem", "van_der_pol"}, {"scheme", "dormand_prince_5"}, {"record", {{"samples", 4001}}}}};
  for (Json request : requests) {
    request["until"] = request["problem"] == "kapitza" ? 5 : 20;
    request["columns"] = {"error"};
    request["diagnostics"] = {"error"};
    const Json made = answer(request);
    const auto errors = made["trajectory"]["error"].get<std::vector<double>>();
    EXPECT_GE(made["diagnostics"]["error"]["max"], 0.97 * *std::ranges::max_element(errors)) << request["problem"];
  }
}

}  // namespace
}  // namespace least::server::test
