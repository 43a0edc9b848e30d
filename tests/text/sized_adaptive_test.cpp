// adaptive_verlet on scenes of many coordinates.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>

#include "core/catalogue/frequency_floor.hpp"
#include "core/from_values.hpp"
#include "core/schemes/adaptive_verlet.hpp"
#include "tests/support/rings.hpp"
#include "tests/support/texts.hpp"

namespace sized_adaptive {
namespace {

using namespace rings;
constexpr const char* monitors[] = {"arclength", "frequency"};

Request adaptive(const std::shared_ptr<const Mechanics>& mechanics, const std::vector<double>& from,
                 std::string_view monitor, double end, double step) {
  Request request = stepped("adaptive_verlet", mechanics, from, end, step);
  runs::set(request, "monitor", monitor);
  return request;
}

TEST(SizedAdaptive, IsOfOrder2) {
  for (const int n : {9, 100})
    for (const bool coupled : {false, true})
      for (const char* monitor : monitors) {
        const auto mechanics = ring(n, Friction::none, {.coupled = coupled});
        const auto truth = final_of(request_by("taylor", mechanics, start(n, Friction::none), 4));
        const auto error = [&](double step) {
          return distance(final_of(adaptive(mechanics, start(n, Friction::none), monitor, 4, step)), truth);
        };
        EXPECT_NEAR(std::log2(error(0.05) / error(0.025)), 2, 0.2) << n << monitor << coupled;
      }
}

/// Followed is a ring with the local frequency that scenes as text have, along a motion from x.
template <int N, bool Coupled>
struct Followed : Ring<N, Friction::none, Coupled> {
  using P = Ring<N, Friction::none, Coupled>;

  FrequencyFloor floor{};

  void follow_from(const StateOf<P>& x, double unit) {
    const P& problem = *this;
    const auto slope = gradient(problem, x.q);
    const double level = energy(problem, x), potential = problem.potential(x.q, 0.0);
    floor = {local_frequency_squared(problem, x.q), dot(slope, velocity(problem, x.q, slope)), level - potential, unit,
             level};
  }
  double frequency_squared(const Vec<N>& q) const {
    const P& problem = *this;
    return floor(local_frequency_squared(problem, q), problem.potential(q, 0.0));
  }
};

template <int N, bool Coupled>
void is_as_compiled() {
  using P = Ring<N, Friction::none, Coupled>;
  for (const char* monitor : monitors) {
    Request request =
        adaptive(ring(N, Friction::none, {.coupled = Coupled}), start(N, Friction::none), monitor, 1, 0.05);
    request.until_steps = true;
    request.steps = 60;
    const auto found = runs::go(request).outcome;
    auto x = state_of<StateOf<P>>(start(N, Friction::none));
    const auto scheme = from_values<AdaptiveVerlet>(AdaptiveVerlet::fields, request.settings);
    Followed<N, Coupled> problem;
    problem.follow_from(x, scheme.unit_energy);
    auto stepper = scheme.bind(problem, x, energy(static_cast<const P&>(problem), x));
    for (int k = 0; k < request.steps; ++k) ASSERT_EQ(stepper.step(x), StepStatus::ok);
    EXPECT_GT(std::abs(stepper.density() - 1), 1e-4);
    EXPECT_NEAR(found.t, x.t, 1e-13) << N << monitor;
    for (std::size_t i = 0; i < 2 * N; ++i) EXPECT_NEAR(found.final[i], x[i], 1e-12) << N << monitor << i;
    EXPECT_EQ(found.cost.force_evaluations, stepper.work().forces);
  }
}
TEST(SizedAdaptive, StatesAreThoseOfTheProblemThatIsCompiled) {
  is_as_compiled<1, false>();
  is_as_compiled<2, false>();
  is_as_compiled<2, true>();
  is_as_compiled<3, true>();
  is_as_compiled<4, false>();
  is_as_compiled<4, true>();
  is_as_compiled<5, false>();
  is_as_compiled<8, false>();
  is_as_compiled<9, false>();
  is_as_compiled<9, true>();
}

// A frequency that is constant leaves steps unchanged; so does a vanishing one.
TEST(SizedAdaptive, IsLeapfrogWhereTheFrequencyDoesNotChange) {
  constexpr int n = 50;
  for (const char* potential : {"sum(i=1..50, i*q[i]^2/20)", "sum(i=1..50, q[i]/i)"}) {
    text::TypedScene typed;
    typed.scene = of(Definition::Kind::potential, {"q[50]"}, {}, potential);
    const auto mechanics = made(typed);
    const auto by_leapfrog = final_of(stepped("leapfrog", mechanics, start(n, Friction::none), 5, 0.125));
    EXPECT_LT(distance(final_of(adaptive(mechanics, start(n, Friction::none), "frequency", 5, 0.125)), by_leapfrog),
              1e-12);
  }
}

TEST(SizedAdaptive, TheMomentumOfTheWholeIsKept) {
  constexpr int n = 40;
  for (const char* monitor : monitors) {
    Request request = adaptive(ring(n, Friction::none, {.held = 0}), start(n, Friction::none), monitor, 20, 0.1);
    request.until_steps = true;
    request.steps = 200;
    const auto x = final_of(request);
    double before = 0, after = 0;
    for (std::size_t i = n; i < 2 * n; ++i) {
      before += start(n, Friction::none)[i];
      after += x[i];
    }
    EXPECT_GT(std::abs(before), 0.05);
    EXPECT_NEAR(after, before, 1e-12) << monitor;
  }
}

// A local frequency from V″ alone vanishes at an inflection of V: steps pass it.
TEST(SizedAdaptive, GoesThroughInflections) {
  struct Case {
    const char* potential;
    std::vector<double> start;
    double step;
  };
  for (const auto& [potential, start, step] :
       {Case{"-cos(x)", {2, 0}, 0.01}, Case{"-cos(x)", {std::acos(-1.0) / 2, 0}, 0.01}, Case{"-cos(x)", {0, 2.5}, 0.01},
        Case{"x^4/4", {1, 0}, 0.03}, Case{"(x^2 - 1)^2/4", {1.5, 0}, 0.03}, Case{"(x^2 - 1)^2/4", {0.3, 0}, 0.03},
        Case{"x^2/2 - x^3/3", {-0.4, 0}, 0.01}, Case{"(x^4 + y^4)/4", {1, 0.3, 0, 0.2}, 0.03}}) {
    const std::vector<std::string> names =
        start.size() == 2 ? std::vector<std::string>{"x"} : std::vector<std::string>{"x", "y"};
    const auto mechanics = texts::mechanics_of(texts::of(Definition::Kind::potential, names, {}, potential));
    Request request = adaptive(mechanics, start, "frequency", 50, step);
    request.diagnostics.clear();
    runs::ask(request, "energy");
    const auto outcome = runs::go(request).outcome;
    EXPECT_EQ(outcome.stop.reason, ReturnCode::completed) << potential << ' ' << outcome.t;
    EXPECT_LT(runs::number(outcome.diagnostics, "energy/max_abs_error"), 1e-3) << potential;
  }
}

TEST(SizedAdaptive, StopsWhereTheDensityIsLost) {
  const auto outcome =
      runs::go(adaptive(ring(9, Friction::none), start(9, Friction::none), "frequency", 50, 0.7)).outcome;
  EXPECT_EQ(outcome.stop.reason, ReturnCode::singular);
  EXPECT_NE(outcome.stop.detail.text().find("V″ vanishes"), std::string::npos) << outcome.stop.detail;
}

TEST(SizedAdaptive, IsOfferedWhereNothingDependsOnTime) {
  const auto offered = [](const std::string& more, std::optional<std::string> damping = {}) {
    text::TypedScene typed;
    typed.scene = of(Definition::Kind::potential, {"q[100]"}, {}, "sum(i=1..100, q[i]^4)" + more);
    typed.scene.damping = damping;
    return runs::fits(made(typed)->card(), find_scheme("adaptive_verlet").value());
  };
  EXPECT_TRUE(offered(""));
  EXPECT_FALSE(offered(" + sin(t)*q[1]"));
  EXPECT_FALSE(offered("", "0.1"));
}

}  // namespace
}  // namespace sized_adaptive
