// Forces narrower than a step: schemes that choose their own steps notice them, and so do references and control runs.
#include "tests/support/narrow_forces.hpp"

#include <gtest/gtest.h>

#include "tests/extremes/asking.hpp"

namespace {

using namespace least;
using narrow::Case;

class NarrowForces : public testing::TestWithParam<narrow::Family> {};

TEST_P(NarrowForces, AreSeenByTheTaylorSeries) {
  const narrow::Count count = narrow::count_of(narrow::draw(GetParam(), 50, 11), "taylor");
  EXPECT_GE(count.runs, 48);
  EXPECT_EQ(count.wrong, 0) << count.first_wrong;
  EXPECT_EQ(count.alarmed, 0);
}

// Each pair at its default tolerance, which is that of the error of a step.
TEST_P(NarrowForces, AreSeenByAdaptivePairs) {
  const std::vector<Case> cases = narrow::draw(GetParam(), 16, 12);
  for (const std::string_view scheme : {"dormand_prince_5", "fehlberg_78", "bulirsch_stoer"}) {
    const narrow::Count count = narrow::count_of(cases, scheme);
    EXPECT_GE(count.runs, 15) << scheme;
    EXPECT_EQ(count.silent, 0) << scheme << ' ' << count.first_wrong;
    EXPECT_EQ(count.wrong, 0) << scheme << ' ' << count.first_wrong;
    EXPECT_EQ(count.alarmed, 0) << scheme;
  }
}

// A reference accuses no run that is right, and accuses those that are wrong.
TEST_P(NarrowForces, AreSeenByReferencesAndControls) {
  int coarse_and_wrong = 0;
  for (const Case& one : narrow::draw(GetParam(), 20, 13)) {
    const auto with_error = [&](std::string_view scheme) {
      Request request = narrow::ask(one, scheme);
      request.control = true;
      runs::ask(request, "error");
      return request;
    };
    const auto right = runs::go(with_error("taylor"));
    EXPECT_LT(runs::number(right.outcome.diagnostics, "error/final"), 1e-7) << one.text();
    EXPECT_TRUE(right.outcome.warnings.empty()) << one.text();
    Request coarse = with_error("runge_kutta_4");
    runs::set(coarse, "step", one.end / 50);
    const auto result = runs::go(coarse);
    const double error = narrow::error_of(one, result.outcome);
    const double told = runs::number(result.outcome.diagnostics, "error/final");
    if (!(error > 0.3)) continue;
    EXPECT_GT(told, 0.003) << one.text();  // relative to the largest component, which may be the other one
    if (!(told > 0.3)) continue;
    ++coarse_and_wrong;
    EXPECT_FALSE(result.outcome.warnings.empty()) << one.text();
  }
  EXPECT_GT(coarse_and_wrong, 0) << "nothing was looked at";
}

INSTANTIATE_TEST_SUITE_P(Families, NarrowForces, testing::ValuesIn(narrow::families),
                         [](const auto& family) { return "Family" + std::to_string(family.index); });

// Where cosh overflows, 1/cosh² is 0: this is no reason to refuse a scene or to stop a series.
TEST(NarrowForce, OfAHyperbolicSecantNeedsNoOverflow) {
  for (const double k : {10.0, 100.0, 1000.0})
    for (const char* form : {"0.25/cosh(k*(x-5))^2", "0.25*cosh(k*(x-5))^(-2)", "0.25/(cosh(k*(x-5))*cosh(k*(x-5)))"}) {
      Case one{narrow::of(narrow::Definition::Kind::potential, {"x"}, {{"k", k}}, form), {0, 1}, 8, 0};
      const auto result = runs::go(narrow::ask(one, "taylor"));
      EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << form << result.outcome.stop.detail;
      // A hill of half the energy delays the motion by ∫ (1/v − 1) dx = ln 2/k.
      EXPECT_NEAR(result.outcome.final[0], 8 - std::log(2.0) / k, 1e-9) << form << " k " << k;
    }
  // A divisor that overflows in a flow: there is friction only where v is near 0.3.
  const Case flow{narrow::flow({"x", "v"}, {}, {{"x", "v"}, {"v", "-x-v/cosh(800*(v-0.3))^2"}}), {3, 0}, 10, 0};
  const auto run = runs::go(narrow::ask(flow, "taylor"));
  EXPECT_EQ(run.outcome.stop.reason, ReturnCode::completed);
  EXPECT_LT(run.outcome.cost.steps, 1000);
}

// The product of a growing and a decaying function keeps the digits of both.
TEST(NarrowForce, OfASoftWallKeepsItsDigits) {
  const Case one{
      narrow::of(narrow::Definition::Kind::potential, {"x"}, {}, "2*log(1+exp(400*(x-5)))/400"), {0, 1}, 8, 0};
  const auto taylor = runs::go(narrow::ask(one, "taylor"));
  EXPECT_EQ(taylor.outcome.stop.reason, ReturnCode::completed);
  EXPECT_NEAR(taylor.outcome.final[0], narrow::fine_end(one, "leapfrog", 4e-4), 1e-8);
}

// Scenes whose velocities have to be solved for, or whose H has no simpler form: the final momentum is the impulse of a
// pulse.
TEST(NarrowForce, IsSeenByReferencesOfScenesOfNoSimpleForm) {
  const std::string pulse = "20*x*exp(-3000*(t-5.3)^2)";
  const double impulse = 20 * std::sqrt(std::acos(-1.0) / 3000), speed = impulse / std::sqrt(1 + impulse * impulse);
  struct Form {
    narrow::Definition::Kind kind;
    std::string formula;
    double speed;
  };
  for (const auto& [kind, formula, after] :
       {Form{narrow::Definition::Kind::lagrangian, "-sqrt(1-vx^2)+" + pulse, speed},
        Form{narrow::Definition::Kind::hamiltonian, "sqrt(1+px^2)-" + pulse, speed}}) {
    const Case one{narrow::of(kind, {"x"}, {}, formula), {0, 0}, 10, 4.7 * after};
    const Request right = narrow::ask(one, "taylor");
    const Truth truth = right.scene->mechanics->truth(*right.scene, {one.end}, [] { return true; });
    ASSERT_TRUE(truth.complete) << formula;
    EXPECT_NEAR(truth.states[0][0], one.right, 5e-3) << formula;
    EXPECT_LT(truth.uncertainty, 1e-9) << formula;
    const Conditioning known = right.scene->mechanics->conditioning(*right.scene, one.end, [] { return true; });
    EXPECT_NEAR(known.sizes.at(0), one.right, 5e-3) << formula;
    Request coarse = narrow::ask(one, "runge_kutta_4");
    runs::set(coarse, "step", 0.5);
    runs::ask(coarse, "error");
    EXPECT_GT(runs::number(runs::go(coarse).outcome.diagnostics, "error/final"), 0.2) << formula;
  }
}

// The polynomial solution of x' = −√x goes through its end at t = 2 and up again, as if nothing were there.
TEST(NarrowForce, OfARootEndsWhereTheMotionDoes) {
  for (const char* rate : {"-sqrt(x)", "-x^0.25", "-2*sqrt(x)"}) {
    const Case one{narrow::flow({"x"}, {}, {{"x", rate}}), {1, 0}, 5, 0};
    const auto run = runs::go(narrow::ask(one, "taylor"));
    const double end = rate[1] == 's' ? 2 : rate[1] == 'x' ? 4.0 / 3 : 1;
    EXPECT_EQ(run.outcome.stop.reason, ReturnCode::singular) << rate;
    EXPECT_NEAR(run.outcome.t, end, 1e-5) << rate;
    EXPECT_LT(run.outcome.cost.steps, 2000) << rate;
  }
}

// Rounding of a late time is no error of a series.
TEST(LateTimes, TakeAsManyStepsAsEarlyOnes) {
  for (const double late : {0.0, 1e9, 1e10, 1e11, 1e12}) {
    Request request = runs::defaults("driven_oscillator", "taylor");
    runs::scene(request).start = late;
    request.end = late + 1;
    const auto result = runs::go(request);
    EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << late;
    EXPECT_LE(result.outcome.cost.steps, 6) << late;
  }
}

// Ends of steps are rounded to doubles: next to a pole this rounding is a part of the distance to the pole.
TEST(LateTimes, NextToAPoleAreAsGoodAsAnywhere) {
  Case one{narrow::flow({"y"}, {}, {{"y", "1/(t-1)"}}), {0, 0}, 2, 34.4342154766830557};
  one.start = {};
  Request request = narrow::ask(one, "taylor");
  runs::scene(request).start = 1.000000000000001;
  const auto result = runs::go(request);
  EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed);
  EXPECT_NEAR(result.outcome.final[0], one.right, 1e-9);
}

}  // namespace
