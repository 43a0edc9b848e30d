// Closed orbits that do not exist, and requests that are refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include "tests/server/orbits.hpp"
#include "tests/support/runs.hpp"

namespace least::server::test {
namespace {

class PeriodicFaults : public AskingForOrbits {
 protected:
  static std::string reason(const Json& request) {
    const Json made = orbit(request);
    EXPECT_EQ(made["status"], "not_closed") << made;
    EXPECT_TRUE(made["stable"].is_null());
    EXPECT_TRUE(made["multipliers"].empty());
    EXPECT_TRUE(made.contains("initial") && made.contains("period"));
    return made["reason"];
  }
  static void expect_reason(const Json& request, const char* part) {
    const std::string found = reason(request);
    EXPECT_NE(found.find(part), std::string::npos) << found;
  }
  static void expect_fault(Json request, const std::string& pointer, const char* part) {
    const Json fault = fault_of(request, "/v1/periodic");
    EXPECT_EQ(fault["pointer"], pointer) << request << fault;
    EXPECT_NE(fault["detail"].get<std::string>().find(part), std::string::npos) << fault;
  }
};

TEST_F(PeriodicFaults, AreAnswersWithAReasonWhereNothingCloses) {
  expect_reason({{"problem", pendulum()}, {"initial", {{"a", 0}}}, {"period", 6.3}}, "the guess is at an equilibrium");
  expect_reason({{"problem", pendulum()}, {"initial", {{"a", 0.5}, {"va", 1}}}, {"period", 1e-10}}, "far too short");
  const Json blows_up = custom(R"~({"variables": ["x"], "equations": {"x": "x^2"}})~");
  expect_reason({{"problem", blows_up}, {"initial", {{"x", 1}}}, {"period", 6}}, "beyond t = 0.99999");
  const Json falls = custom(R"~({"variables": ["x"], "potential": "x"})~");
  const Json made = orbit({{"problem", falls}, {"initial", {{"x", 1}}}, {"period", 2}});
  EXPECT_EQ(made["status"], "not_closed");
  EXPECT_GT(made["closure"], 1e-3);  // how near it came
  EXPECT_EQ(made["reason"], "Newton's method comes nearer only in a time that goes to 0");
  const Json damped = custom(R"~({"variables": ["x"], "potential": "x^2/2", "damping": 0.1})~");
  expect_reason({{"problem", damped}, {"initial", {{"x", 1}}}, {"period", 6.3}}, "has led to an equilibrium");
}

TEST_F(PeriodicFaults, AreFaultsWithAPlace) {
  const Json good{{"problem", pendulum()}, {"initial", {{"a", 1}}}, {"period", 6.5}};
  const auto with = [&](const char* key, Json value) {
    Json request = good;
    request[key] = std::move(value);
    return request;
  };
  expect_fault(with("period", 0), "/period", "greater than 0");
  expect_fault(with("period", -1), "/period", "greater than 0");
  expect_fault(with("period", "x"), "/period", "");
  expect_fault(with("fixed", {"b"}), "/fixed/0", "");
  expect_fault(with("fixed", {"s"}), "/fixed/0", "");
  expect_fault(with("until", 3), "/until", "");
  expect_fault(with("scheme", "leapfrog"), "/scheme", "");
  expect_fault(with("scheme", {{"id", "taylor"}, {"step", 1}}), "/scheme/step", "");
  expect_fault(with("symmetric", 1), "/symmetric", "true or false");
  expect_fault(with("family", {{"by", "/initial/b"}, {"to", 1}}), "/family/by", "");
  expect_fault(with("family", {{"by", "/scheme/tolerance"}, {"to", 1}}), "/family/by", "");
  expect_fault(with("family", {{"by", "energy"}}), "/family/to", "required");
  expect_fault(with("family", {{"by", "energy"}, {"to", 1}, {"count", 1}}), "/family/count", "");
  expect_fault(with("family", {{"by", "period"}, {"to", -1}}), "/family/to", "greater than 0");
  expect_fault(with("manifolds", {{"count", 1000}}), "/manifolds/count", "");
  expect_fault(with("manifolds", {{"until", 0}}), "/manifolds/until", "greater than 0");
  Json none = good;
  none.erase("period");
  expect_fault(none, "/period", "required");
}

// A start may say velocities, but orbits are followed in momenta: a refusal of the one names the other.
TEST_F(PeriodicFaults, SayWhichMomentumAVelocityHas) {
  Json request{{"problem", pendulum()}, {"initial", {{"a", 0.5}, {"va", 0}}}, {"period", 6.4}, {"fixed", {"va"}}};
  Json fault = fault_of(request, "/v1/periodic");
  EXPECT_EQ(fault["pointer"], "/fixed/0");
  EXPECT_EQ(fault["allowed"], "pa");
  expect_fault(request, "/fixed/0", "is a velocity");
  request["fixed"] = {"a"};
  request["family"] = {{"by", "/initial/va"}, {"to", 1}, {"count", 3}};
  fault = fault_of(request, "/v1/periodic");
  EXPECT_EQ(fault["allowed"], "/initial/pa");
  expect_fault(request, "/family/by", "is a velocity");
}

TEST_F(PeriodicFaults, KnowTheScene) {
  const Json driven = custom(R"~({"variables": ["x"], "potential": "x^2/2 - x*cos(2*t)"})~");
  const Json request{{"problem", driven}, {"initial", {{"x", 1}}}, {"period", 3}};
  expect_fault(request, "/period", "do not repeat");
  Json right = request;
  right["period"] = "2*pi";  // twice that of the drive
  EXPECT_EQ(reply(right, "/v1/periodic").status, 200);
  right["symmetric"] = true;
  expect_fault(right, "/symmetric", "driven");
  right["symmetric"] = false;
  right["family"] = {{"by", "period"}, {"to", 1}};
  expect_fault(right, "/family/by", "that of the drive");
  expect_fault({{"problem", pendulum()}, {"initial", {{"a", 1}, {"va", .1}}}, {"period", 6.5}, {"symmetric", true}},
               "/symmetric", "no crossing at right angles");
  expect_fault({{"problem", "van_der_pol"}, {"period", 6.5}, {"family", {{"by", "energy"}, {"to", 1}}}}, "/family/by",
               "no energy");
  expect_fault({{"problem", pendulum()},
                {"initial", {{"a", 1}}},
                {"period", 6.5},
                {"fixed", {"a"}},
                {"family", {{"by", "/initial/a"}, {"to", 2}}}},
               "/family/by", "fixed");
  const Json chain = custom(R"~({"variables": ["x[40]"], "potential": "sum(i=1..39, (x[i+1]-x[i])^2/2)"})~");
  expect_fault({{"problem", chain}, {"period", 6}}, "/problem", "too many");
}

TEST_F(PeriodicFaults, LimitsHold) {
  const Json problem = custom(R"~({"variables": ["x[6]", "y[6]"], "lagrangian":
      "sum(i=1..6, (vx[i]^2+vy[i]^2)/2 + sum(j=i+1..6, 1/sqrt((x[i]-x[j])^2+(y[i]-y[j])^2)))"})~");
  Json request{{"problem", problem},
               {"initial", {{"x", {1, 2, 3, 4, 5, 6}}, {"vy", {1, -1, 1, -1, 1, -1}}}},
               {"period", 500},
               {"limits", {{"seconds", 0.2}}}};
  const auto from = std::chrono::steady_clock::now();
  Json made = orbit(request);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - from;
  EXPECT_EQ(made["status"], "not_closed");
  EXPECT_EQ(made["stop"]["reason"], "deadline") << made;
  EXPECT_LT(taken.count(), 15);
  for (const int steps : {1, 10, 20, 40}) {
    request["limits"] = {{"steps", steps}};
    made = orbit(request);
    EXPECT_EQ(made["stop"]["reason"], "step_limit") << made;
    EXPECT_EQ(made["reason"], "the steps that the request has were taken") << steps;
  }
}

// What a limit ends keeps its best: how near the guess came is known once its motion was followed.
TEST_F(PeriodicFaults, LimitsKeepTheBest) {
  runs::problem_called("lorenz");
  Json request{{"problem", "lorenz"}, {"initial", {{"x", -13.76}, {"y", -19.58}, {"z", 27}}}, {"period", 1.5586}};
  const double extent = 40;  // of z, to a third
  const Json there = after("lorenz", request["initial"], 1.5586);
  double missing = 0;
  for (const char* name : {"x", "y", "z"})
    missing = std::max(missing, std::abs(there[name].get<double>() - request["initial"][name].get<double>()));
  for (const int steps : {100, 150, 180, 200, 220}) {
    request["limits"] = {{"steps", steps}};
    const Json made = orbit(request);
    EXPECT_EQ(made["status"], "not_closed") << made;
    EXPECT_EQ(made["stop"]["reason"], "step_limit");
    EXPECT_EQ(made["reason"], "the steps that the request has were taken");
    ASSERT_TRUE(made["closure"].is_number()) << steps << made;
    EXPECT_LT(made["closure"], 1.5 * missing / extent) << steps;
    if (made["monodromy"].empty()) {
      EXPECT_GT(made["closure"], missing / extent / 1.5) << steps;
    }
  }
  EXPECT_FALSE(orbit(request)["monodromy"].empty());
}

TEST_F(PeriodicFaults, LimitsOfFamiliesAreTold) {
  runs::problem_called("lorenz");
  for (int steps = 300; steps < 1000; steps += 33) {
    const Json made = orbit({{"problem", "lorenz"},
                             {"initial", {{"x", -13.76}, {"y", -19.58}, {"z", 27}}},
                             {"period", 1.5586},
                             {"limits", {{"steps", steps}}},
                             {"family", {{"by", "/problem/rho"}, {"to", 30}, {"count", 10}}}});
    ASSERT_EQ(made["stop"]["reason"], "step_limit");
    EXPECT_EQ(made["family_end"], "the steps that the request has were taken") << steps;
  }
  const Json roessler = custom(R"~({"variables": ["x", "y", "z"], "parameters": {"a": 0.2, "b": 0.2, "c": 2.5},
      "equations": {"x": "-y-z", "y": "x+a*y", "z": "b+z*(x-c)"}})~");
  for (const int count : {2, 3, 4}) {
    const Json made = orbit({{"problem", roessler},
                             {"initial", {{"x", -2}, {"y", -3}, {"z", .05}}},
                             {"period", 5.7},
                             {"family", {{"by", "/problem/c"}, {"to", 6}, {"count", count}}}});
    EXPECT_EQ(made["family"].size(), count) << made;  // of which one is a bifurcation
  }
}

// The derivatives of such long equations, written out, would exceed the limit of a tape. They are followed all the
// same, as far as the limits of the request go; and where nothing moves, that is what is told.
TEST_F(PeriodicFaults, LongEquationsAreTold) {
  const Json problem = custom(R"~({"variables": ["x[32]"], "potential":
      "sum(i=1..32, j=i+1..32, (1+sin(x[i]-x[j])^2)*exp(-(x[i]-x[j])^2)*sqrt(2+cos(x[i]*x[j])))"})~");
  Json places = Json::array();
  for (int i = 0; i < 32; ++i) places.push_back(0.3 * i + 0.01 * i * i);
  expect_reason({{"problem", problem}, {"initial", {{"x", places}}}, {"period", 3}, {"limits", {{"steps", 3}}}},
                "the steps that the request has were taken");
  expect_reason({{"problem", problem}, {"period", 3}}, "the guess is at an equilibrium");
}

}  // namespace
}  // namespace least::server::test
