// The rows, columns and diagnostics of a request change neither the run nor its warnings.
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
  /// end_of() returns how and where a run ends, and its warnings.
  static Json end_of(const Json& request) {
    Json made = answer(request), end;
    for (const char* key : {"status", "stop", "final", "warnings"}) end[key] = made[key];
    return end;
  }
};

// With steps far too long for the energy level the shorter steps to samples fail; this must not end the run.
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

// By default the scheme takes the threshold κ that the drive needs, which does not follow from natural units.
TEST_F(Asked, DuffingRunsByTransformedStepsAsItStands) {
  EXPECT_EQ(answer({{"problem", "duffing"}, {"scheme", "time_transformed"}})["status"], "completed");
}

// The largest error is 0.1016; the control run, which compares fewer states, does not call it large.
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

// The largest error is no smaller than any error in the column, also where dense output is less accurate than steps.
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
