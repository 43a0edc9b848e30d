// Forces without a second derivative, such as √|x| at x = 0: tangents cannot step over such a kink, but the motion goes
// on.
#include <cmath>

#include "tests/study/studies.hpp"
#include "tests/support/texts.hpp"

namespace {

using namespace studies;

struct Kinked {
  texts::Definition definition;
  std::vector<double> start;
  double end, accuracy;

  Request request() const {
    Request made = texts::typed_as(runs::defaults("kepler", "runge_kutta_4"), texts::mechanics_of(definition));
    texts::begin_at(made, start);
    made.end = end;
    made.norm = Norm::relative;
    runs::only_final(made);
    return made;
  }
};

Kinked oscillator(const char* potential, std::vector<double> start, double end, double accuracy = 1e-4) {
  return {texts::of(texts::Definition::Kind::potential, {"x"}, {}, potential), std::move(start), end, accuracy};
}

/// distance_of_neighbours() returns the largest distance between the true end and the ends from starts that are off by
/// `delta`, divided by `delta`.
double distance_of_neighbours(const Request& request, double delta) {
  const std::vector<double> end{request.end};
  const std::vector<double> here = truth(request, end, always)->states[0];
  double most = 0, size = 0;
  for (const double x : request.scene->initial) size = std::max(size, std::abs(x));
  for (std::size_t i = 0; i < here.size(); ++i) {
    Request moved = request;
    runs::scene(moved).initial[i] += delta * size;
    most = std::max(most, state_error(truth(moved, end, always)->states[0], here, here.size()));
  }
  return most / delta;
}

TEST(Kink, NeighboursAreFollowedWhereTangentsHaveNoSteps) {
  for (const Kinked& kinked :
       {oscillator("x^2/2 + abs(x)^1.5", {0.6, 0.96}, 10), oscillator("x^2/2 + abs(x)^1.1", {0.6, 0.96}, 10),
        oscillator("x^2/2 + abs(x)^1.5", {0, 0.96}, 10)}) {
    const auto known = conditioning(kinked.request(), always);
    EXPECT_TRUE(known->complete && !known->ends) << known->reached;
    const double measured = distance_of_neighbours(kinked.request(), 1e-7);
    EXPECT_NEAR(known->growth, measured, 0.05 * measured);
  }
}

// If each of 800 passages multiplied differences by 1.06, they would grow by e⁵⁰; those of an oscillator grow in
// proportion to time.
TEST(Kink, MakesNoChaosOfManyPassages) {
  const auto known = conditioning(oscillator("x^2/2 + abs(x)^1.5", {0.6, 0.96}, 2000).request(), always);
  EXPECT_TRUE(known->complete && !known->ends);
  EXPECT_LT(known->most_growth, 2000);
  EXPECT_FALSE(known->chaotic(Norm::relative));
}

TEST(Kink, IsToldFromWhatBecomesInfinite) {
  for (const auto& [potential, end] : {std::pair("-x^4", 0.92703734), std::pair("-1/abs(x)", 1.11072073)}) {
    const auto known = conditioning(oscillator(potential, {1, 0}, 5).request(), always);
    EXPECT_TRUE(known->ends) << potential;
    EXPECT_NEAR(known->reached, end, 0.01 * end) << potential;
  }
  const auto passes = conditioning(oscillator("x^2/2 + abs(x)^0.75", {0.6, 0.96}, 10).request(), always);
  EXPECT_FALSE(passes->ends) << "through an infinite force, of which the energy is finite";
}

TEST(Kink, ErrorsAreMeasuredBeyondIt) {
  texts::Definition forced = texts::of(texts::Definition::Kind::lagrangian, {"x"}, {},
                                       "vx^2/2 - (0.34*x^2/2 + 0.96*sqrt(1+x^2) + 1.39*abs(x)^1.5) - 0.23*s");
  const std::vector<Kinked> all{
      oscillator("x^2/2 + abs(x)^1.5", {0.6, 0.96}, 10),
      {texts::damped(oscillator("abs(x)^1.5", {}, 0).definition, "0.23"), {0.6, 0.96, 0}, 10, 1e-4},
      {forced, {0.6, 0.96, 0}, 3, 1e-9},
      {texts::flow({"x", "y"}, {}, {{"x", "y + 0.21*min(1,abs(x))*x"}, {"y", "-x + 1.15*sqrt(abs(y))"}}),
       {-1.26, -0.66},
       2,
       1e-5},
  };
  for (const Kinked& kinked : all) {
    Request request = kinked.request();
    const Advice advice = advise(request, {kinked.accuracy, 0, {}}, never);
    SCOPED_TRACE(advice.reason.text());
    EXPECT_TRUE(advice.met && advice.known);
    EXPECT_EQ(advice.reason.text().find("motion ends"), std::string::npos);
    request = with(std::move(request), advice.choice.value());
    runs::ask(request, "error");
    const double error = runs::number(runs::go(request).outcome.diagnostics, "error/max");
    EXPECT_LT(error, 1.5 * advice.estimated_error);
    EXPECT_GT(error, advice.estimated_error / 1.5);
  }
}

TEST(Kink, IsNoEndOfAWorkPrecisionStudy) {
  const Request request = oscillator("x^2/2 + abs(x)^1.5", {0.6, 0.96}, 10).request();
  const Study study = work_precision({request, {choice(scene("kepler"), "leapfrog", "none")}}, watch, never);
  EXPECT_EQ(study.end, 10);
  for (const Message& left_out : study.left_out)
    EXPECT_EQ(left_out.text().find("nears its end"), std::string::npos) << left_out.text();
}

}  // namespace
