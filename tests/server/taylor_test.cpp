// The Taylor scheme for a client: over real sockets, against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/server/client.hpp"
#include "tests/server/faults.hpp"
#include "tests/server/fixture.hpp"
#include "tests/support/runs.hpp"

namespace least::server::test {
namespace {

using TaylorHttp = Serving;

TEST_F(TaylorHttp, ARunSaysWhatItIsAndCosts) {
  runs::problem_called("damped_oscillator");
  const Json answer = Json::parse(ask(port(), post("/v1/simulate", R"({"problem":"damped_oscillator",
      "initial":{"q":1,"p":0},"scheme":"taylor","until":{"t":20},"record":{"samples":41},
      "columns":["t","q"],"diagnostics":["error"]})"))
                                      .body);
  ASSERT_EQ(answer.value("status", ""), "completed") << answer;
  EXPECT_EQ(answer["scheme"], Json::parse(R"({"id":"taylor","tolerance":1e-12,"order":0})"));
  const double delta = 0.05, omega = std::sqrt(1 - delta * delta);  // of k = 1, α = 0.1
  for (std::size_t k = 0; k < 41; ++k) {
    const double t = answer["trajectory"]["t"][k], q = answer["trajectory"]["q"][k];
    EXPECT_EQ(t, 0.5 * static_cast<double>(k));
    EXPECT_NEAR(q, std::exp(-delta * t) * (std::cos(omega * t) + delta / omega * std::sin(omega * t)), 1e-11) << t;
  }
  EXPECT_LT(answer["diagnostics"]["error"]["max"], 1e-11);
  const std::int64_t steps = answer["cost"]["steps"], forces = answer["cost"]["force_evaluations"];
  EXPECT_LT(steps, 20);
  EXPECT_EQ(forces % steps, 0) << "as many for each step as its order";
}

TEST_F(TaylorHttp, OrderAndToleranceHaveBounds) {
  runs::problem_called("kepler");
  const auto with = [&](const std::string& settings) {
    return ask(port(), post("/v1/simulate",
                            R"({"problem":"kepler","until":{"steps":3},"scheme":{"id":"taylor",)" + settings + "}}"));
  };
  const Json fixed = Json::parse(with(R"("order":17,"tolerance":1e-15)").body);
  EXPECT_EQ(fixed["cost"]["force_evaluations"], 3 * 17) << fixed;
  EXPECT_EQ(only_fault(with(R"("order":41)"))["pointer"], "/scheme/order");
  EXPECT_EQ(only_fault(with(R"("order":2.5)"))["pointer"], "/scheme/order");
  EXPECT_EQ(only_fault(with(R"("tolerance":0.1)"))["pointer"], "/scheme/tolerance");
  EXPECT_EQ(only_fault(with(R"("tolerance":0)"))["pointer"], "/scheme/tolerance");
}

TEST_F(TaylorHttp, NoLargestStepIsKnown) {
  runs::problem_called("kepler");
  const Json limits =
      Json::parse(ask(port(), post("/v1/stability", R"({"problem":"kepler","schemes":["taylor"]})")).body);
  ASSERT_TRUE(limits.contains("limits")) << limits;
  EXPECT_TRUE(limits["limits"][0]["step"].is_null()) << limits;
  EXPECT_FALSE(limits["limits"][0].value("why", "").empty()) << limits;
}

}  // namespace
}  // namespace least::server::test
