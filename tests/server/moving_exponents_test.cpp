// Powers whose exponents move, as 2^x, in everything that is made of series.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

class MovingExponents : public Asking {
 protected:
  static Json scene(const std::string& kind, const Json& text) {
    return {{"problem", {{"id", "custom"}, {"variables", {"x"}}, {"parameters", {{"c", 0.05}}}, {kind, text}}},
            {"initial", {{"x", 0.3}}},
            {"scheme", "taylor"},
            {"until", 3}};
  }
  /// Two ways to write one potential have one motion, and one derivative of it by c and by the start.
  static void expect_one_motion(const std::string& power, const std::string& exponential) {
    Json of_power = scene("potential", power), of_exponential = scene("potential", exponential);
    for (Json* one : {&of_power, &of_exponential})
      (*one)["sensitivities"] = {{"by", {"/problem/c", "/initial/x"}}, {"order", 2}};
    const Json found = answer(of_power), known = answer(of_exponential);
    for (const char* name : {"x", "px"}) EXPECT_NEAR(found["final"][name], known["final"][name], 1e-11) << power;
    for (const char* what : {"final", "second"}) {
      const Json here = found["sensitivities"][what].flatten(), there = known["sensitivities"][what].flatten();
      ASSERT_EQ(here.size(), there.size()) << found;
      for (const auto& [place, value] : there.items())
        EXPECT_NEAR(here[place], value, 1e-8 * (1 + std::abs(value.get<double>()))) << power << ' ' << what << place;
    }
  }
};

// 2^(-x) grows at the rate ln 2; ln x at the rate 2^t.
TEST_F(MovingExponents, HaveTheMotionsThatAreKnownInClosedForm) {
  Json request = scene("equations", {{"x", "-2^x"}});
  for (const int order : {0, 12, 25}) {
    request["scheme"] = {{"id", "taylor"}, {"order", order}};
    EXPECT_NEAR(answer(request)["final"]["x"], -std::log2(std::exp2(-0.3) + 3 * std::log(2.0)), 1e-11) << order;
  }
  const double by_time = 0.3 * std::exp(7 / std::log(2.0));
  EXPECT_NEAR(answer(scene("equations", {{"x", "x*2^t"}}))["final"]["x"], by_time, 1e-10 * by_time);
}

TEST_F(MovingExponents, MoveAsTheExponentialsThatTheyAre) {
  expect_one_motion("x^2/2 + c*2^x", "x^2/2 + c*exp(x*log(2))");
  expect_one_motion("x^2/2 + c*(2 + x)^x", "x^2/2 + c*exp(x*log(2 + x))");
  expect_one_motion("x^2/2 + c^x", "x^2/2 + exp(x*log(c))");
  expect_one_motion("x^2/2 + c*sum(k=1..3, k^(x/k))", "x^2/2 + c*sum(k=1..3, exp(x/k*log(k)))");
}

}  // namespace
}  // namespace least::server::test
