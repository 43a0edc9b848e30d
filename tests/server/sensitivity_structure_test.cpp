// The factor of the map of a run, over HTTP: where motion contracts, it is far smaller than what rounding leaves of a
// determinant.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/server/fixture.hpp"
#include "tests/support/runs.hpp"

namespace least::server::test {
namespace {

class SensitivityStructure : public Asking {
 protected:
  static Json of_whole_start(Json request, const char* of) {
    request["sensitivities"] = {{"by", "initial"}, {"of", of}};
    return request;
  }
  static Json lorenz(double until) {
    return of_whole_start({{"problem", "lorenz"}, {"until", until}, {"scheme", "taylor"}, {"record", {{"every", 0}}}},
                          "motion");
  }
  static double factor_of(const Json& request) {
    const Json made = answer(request), found = made["sensitivities"];
    EXPECT_TRUE(found["structure"]["factor"].is_number()) << found;
    return found["structure"]["factor"].is_number() ? found["structure"]["factor"].get<double>() : NAN;
  }
  static void expect_ratio(double found, double truth, double within) {
    EXPECT_NEAR(found / truth, 1, within) << found << " instead of " << truth;
  }
};

// By Liouville's theorem volumes change by e^{∫div ẋ dt}, and the divergence of Lorenz's equations is −41/3 everywhere.
TEST_F(SensitivityStructure, VolumesOfContractingFlowsFollowLiouville) {
  runs::problem_called("lorenz");
  for (const double until : {0.3, 3.0, 5.0, 30.0})
    expect_ratio(factor_of(lorenz(until)), std::exp(-41.0 / 3 * until), 1e-10);
}

// An event at a set time multiplies volumes by the determinant of what it does; one that ends the run, or that sets a
// variable to a number, leaves none.
TEST_F(SensitivityStructure, VolumesChangeAtEventsToo) {
  runs::problem_called("lorenz");
  Json request = lorenz(3);
  const auto with = [&](Json event) {
    event["name"] = "k";
    request["events"] = Json::array({std::move(event)});
    return factor_of(request);
  };
  expect_ratio(with({{"expression", "t - 1"}, {"set", {{"z", "z/2"}}}}), std::exp(-41.0) / 2, 1e-10);
  EXPECT_EQ(with({{"expression", "t - 1"}, {"set", {{"z", "20"}}}}), 0);
  EXPECT_EQ(with({{"expression", "z - 30"}, {"stop", true}}), 0);
  // Where z = 30 t ends the run, neighbours end at other times, and 1 + ż ∂t/∂z = 30/(30 − ż) is left
  request["events"] = Json::array({{{"name", "k"}, {"expression", "z - 30*t"}, {"direction", "down"}, {"stop", true}}});
  const Json made = answer(request);
  const double t = made["final"]["t"], x = made["final"]["x"], y = made["final"]["y"], z = made["final"]["z"];
  const double rate = x * y - 8.0 / 3 * z;
  EXPECT_LT(t, 3);
  expect_ratio(made["sensitivities"]["structure"]["factor"], std::exp(-41.0 / 3 * t) * 30 / (30 - rate), 1e-9);
}

// The contact form of a damped motion is multiplied by e^{−∫α dt}, also where neighbours fly apart, and by schemes that
// keep the form as by the motion.
TEST_F(SensitivityStructure, ContactFactorsOfChaoticMotionAreThoseOfTheDamping) {
  const Json pendulum =
      custom(R"~({"variables": ["x"], "potential": "-cos(x) - 1.2*x*cos(2*t/3)", "damping": "1/2"})~");
  const Json run{
      {"problem", pendulum}, {"initial", {{"x", 0.2}, {"vx", 0.1}}}, {"until", 100}, {"record", {{"every", 0}}}};
  Json motion = of_whole_start(run, "motion"), map = of_whole_start(run, "scheme");
  motion["scheme"] = "taylor";
  map["scheme"] = {{"id", "contact_splitting"}, {"step", 0.05}};
  for (const Json& request : {motion, map}) {
    expect_ratio(factor_of(request), std::exp(-50.0), 1e-9);
    EXPECT_TRUE(answer(request)["sensitivities"]["structure"]["max_defect"].is_number());
  }
}

// The map of Euler's rule has the determinant Π det(1 + h ∂ẋ/∂x), which is evaluated here at the states of the run.
TEST_F(SensitivityStructure, VolumesOfAMapAreProductsOverItsSteps) {
  runs::problem_called("lorenz");
  constexpr double h = 0.005;
  Json request{{"problem", "lorenz"},
               {"until", 4},
               {"scheme", {{"id", "explicit_euler"}, {"step", h}}},
               {"record", {{"every", 1}}},
               {"columns", {"x", "y", "z"}}};
  const Json rows = answer(request)["trajectory"];
  double truth = 1;
  for (std::size_t k = 0; k + 1 < rows["x"].size(); ++k) {
    const double x = rows["x"][k], y = rows["y"][k], z = rows["z"][k];
    const double a[3][3] = {{1 - 10 * h, 10 * h, 0}, {(28 - z) * h, 1 - h, -x * h}, {y * h, x * h, 1 - 8.0 / 3 * h}};
    truth *= a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]);
  }
  expect_ratio(factor_of(of_whole_start(request, "scheme")), truth, 1e-9);
}

}  // namespace
}  // namespace least::server::test
