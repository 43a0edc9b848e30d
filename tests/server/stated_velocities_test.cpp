// Starts that are stated in velocities.
#include <cmath>

#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

using StatedVelocities = Asking;

Json final_only(const Json& problem, double until) {
  return {{"problem", problem}, {"scheme", "taylor"}, {"until", until}, {"record", {{"every", 0}}}};
}

// core/scenes/foucault.json says vx = vy = 0: with p = v + Ω sin φ (−y, x) at x = 3.
TEST_F(StatedVelocities, OfACatalogueSceneStayWhereAParameterChanges) {
  const double turning = 7.2921e-5 * std::sin(0.8527);
  const Json named = answer(final_only({{"id", "foucault"}, {"preset", "paris"}}, 20));
  const Json changed = answer(final_only({{"id", "foucault"}, {"omega", 7.2921e-5}}, 20));
  EXPECT_EQ(changed["initial"], named["initial"]);
  EXPECT_EQ(changed["final"], named["final"]);
  EXPECT_NEAR(changed["initial"]["py"], 3 * turning, 1e-18);
  // Of coordinates that the request gives, too.
  Json elsewhere = final_only({{"id", "foucault"}, {"preset", "paris"}}, 20);
  elsewhere["initial"] = {{"x", 4}};
  EXPECT_NEAR(answer(elsewhere)["initial"]["py"], 4 * turning, 1e-18);
  // What the request says of momenta, it means.
  elsewhere["initial"] = {{"x", 4}, {"py", 0.25}};
  const Json said = answer(elsewhere)["initial"];
  EXPECT_EQ(said["py"], 0.25);
  EXPECT_EQ(said["px"], 0);
  // What an answer says of the start, in momenta, repeats the run.
  Json again = final_only(changed["problem"], 20);
  again["initial"] = changed["initial"];
  EXPECT_EQ(answer(again)["final"], changed["final"]);
}

TEST_F(StatedVelocities, OfACatalogueSceneAreThoseOfAllMembers) {
  const std::vector<double> rates{1e-4, 0.03, 0.1};
  const Json scheme{{"id", "runge_kutta_4"}, {"step", 0.1}};
  const Json made = answer({{"problem", {{"id", "foucault"}}},
                            {"scheme", scheme},
                            {"until", 20},
                            {"members", {{"vary", {{"/problem/omega", {{"values", rates}}}}}}},
                            {"keep", {"final"}},
                            {"columns", {"x", "y", "px", "py"}}},
                           "/v1/ensemble");
  EXPECT_EQ(made["members"]["holds"], "velocities");
  for (std::size_t k = 0; k < rates.size(); ++k) {
    Json request = final_only({{"id", "foucault"}, {"omega", rates[k]}}, 20);
    request["scheme"] = scheme;
    const Json alone = answer(request)["final"];
    for (const char* column : {"x", "y", "px", "py"})
      EXPECT_NEAR(made["final"][column][k], alone[column], 1e-14) << column << rates[k];
  }
}

// A mass that vanishes at the start: no momentum knows the velocity that was said.
TEST_F(StatedVelocities, AreNotLostWhereAMassVanishes) {
  Json request = final_only(custom(R"({"variables":["x"],"lagrangian":"x^2*vx^2/2"})"), 2);
  request["initial"] = {{"x", 0}, {"vx", 1}};
  const Json fault = fault_of(request);
  EXPECT_EQ(fault["pointer"], "/problem/lagrangian");
  EXPECT_NE(fault["detail"].get<std::string>().find("no inverse there"), std::string::npos) << fault;
  // At the pole of a sphere the motion goes on with the velocity that was said.
  Json sphere =
      final_only(custom(R"~({"variables":["theta","phi"],"lagrangian":"(vtheta^2 + sin(theta)^2*vphi^2)/2"})~"), 2);
  sphere["initial"] = {{"theta", 0}, {"vtheta", 0.5}};
  EXPECT_NEAR(answer(sphere)["final"]["theta"], 1, 1e-9);
}

}  // namespace
}  // namespace least::server::test
