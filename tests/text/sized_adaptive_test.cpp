// adaptive_verlet on scenes of many coordinates.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>

#include "core/from_values.hpp"
#include "core/schemes/adaptive_verlet.hpp"
#include "tests/support/rings.hpp"

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

template <int N, bool Coupled>
void is_as_compiled() {
  using P = Ring<N, Friction::none, Coupled>;
  const P problem;
  for (const char* monitor : monitors) {
    Request request =
        adaptive(ring(N, Friction::none, {.coupled = Coupled}), start(N, Friction::none), monitor, 1, 0.05);
    request.until_steps = true;
    request.steps = 60;
    const auto found = runs::go(request).outcome;
    auto x = state_of<StateOf<P>>(start(N, Friction::none));
    const auto scheme = from_values<AdaptiveVerlet>(AdaptiveVerlet::fields, request.settings);
    auto stepper = scheme.bind(problem, x, energy(problem, x));
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

// What is the same everywhere leaves steps as they are; so does what is not there.
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

TEST(SizedAdaptive, StopsWhereTheDensityIsLost) {
  const auto outcome =
      runs::go(adaptive(ring(9, Friction::none), start(9, Friction::none), "frequency", 50, 0.7)).outcome;
  EXPECT_EQ(outcome.stop.reason, ReturnCode::singular) << outcome.stop.detail.text();
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
