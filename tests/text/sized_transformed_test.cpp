// time_transformed on scenes of many coordinates, without friction and with it.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/from_values.hpp"
#include "core/run/backend.hpp"
#include "core/run/tangent.hpp"
#include "core/schemes/time_transformed.hpp"
#include "tests/support/rings.hpp"

namespace sized_transformed {
namespace {

using namespace rings;

/// transformed() requests steps in the parameter that are about `step` long in time.
Request transformed(const std::shared_ptr<const Mechanics>& mechanics, const std::vector<double>& from, double end,
                    double step, const char* composition = "none") {
  Request request = request_by("time_transformed", mechanics, from, end);
  const std::size_t n = from.size() / 2;
  const auto kappa = double(2 * n + 3);  // above the potential, about n
  const bool damped = from.size() > 2 * n;
  runs::set(request, "kappa", kappa);
  runs::set(request, "sigma", step * std::pow(kappa, damped ? 1.5 : 1));
  runs::set(request, "composition", composition);
  runs::show_all(request);
  return request;
}

TEST(SizedTransformed, OrdersAreThoseOfTheCompositions) {
  for (const int n : {9, 100})
    for (const Friction friction : frictions) {
      const auto mechanics = ring(n, friction);
      const auto from = start(n, friction);
      if (friction == Friction::none || n == 9) {
        Request exact = request_by("taylor", mechanics, from, 3);
        runs::show_all(exact);
        const auto truth = final_of(exact);
        for (const auto& [composition, order, step] :
             {std::tuple{"none", 2, 0.05}, std::tuple{"suzuki_4", 4, 0.2}, std::tuple{"kahan_li_6", 6, 0.3}}) {
          const auto error = [&, composition = composition](double h) {
            return distance(final_of(transformed(mechanics, from, 3, h, composition)), truth);
          };
          const double coarse = error(step), fine = error(step / 2);
          EXPECT_NEAR(std::log2(coarse / fine), order, 0.4) << composition << n << int(friction);
          EXPECT_GT(fine, 1e-12) << composition << " is at round-off";
        }
      }
    }
}

template <int N, Friction friction, bool Coupled = false>
void is_as_compiled() {
  using P = Ring<N, friction, Coupled>;
  const P problem;
  const auto from = start(N, friction);
  for (const char* composition : {"none", "kahan_li_6"}) {
    const std::string what = std::to_string(N) + composition + std::to_string(int(friction));
    Request request = transformed(ring(N, friction, {.coupled = Coupled}), from, 1, 0.1, composition);
    request.until_steps = true;
    request.steps = 30;
    const auto found = runs::go(request).outcome;
    auto x = state_of<FullStateOf<P>>(from);
    const auto scheme = from_values<TimeTransformed>(TimeTransformed::fields, request.settings);
    auto stepper = scheme.bind(problem, x, energy_level(scheme, problem, x));
    for (int k = 0; k < request.steps; ++k) ASSERT_EQ(stepper.step(x), StepStatus::ok) << what;
    EXPECT_NEAR(found.t, x.t, 1e-13) << what;
    for (std::size_t i = 0; i < from.size(); ++i) EXPECT_NEAR(found.final[i], x[i], 1e-12) << what << " " << i;
    EXPECT_EQ(found.cost.force_evaluations, stepper.work().forces) << what;
    EXPECT_EQ(found.cost.iterations, stepper.work().iterations) << what;
    // The same without s.
    request.columns = {0};
    const auto motion = runs::go(request).outcome;
    EXPECT_EQ(motion.t, found.t) << what;
    for (std::size_t i = 0; i < 2 * N; ++i) EXPECT_EQ(motion.final[i], found.final[i]) << what;
    // And to a time within a step.
    request.until_steps = false;
    request.end = found.t - 0.03;
    auto y = state_of<FullStateOf<P>>(from);
    auto again = scheme.bind(problem, y, energy_level(scheme, problem, y));
    for (int k = 0; k + 1 < request.steps; ++k) ASSERT_EQ(again.step(y), StepStatus::ok);
    ASSERT_LT(y.t, request.end);
    ASSERT_EQ(again.reach(y, request.end), StepStatus::ok);
    const auto within = runs::go(request).outcome;
    for (std::size_t i = 0; i < 2 * N; ++i) EXPECT_NEAR(within.final[i], y[i], 1e-12) << what;
  }
}
TEST(SizedTransformed, StatesAreThoseOfTheProblemThatIsCompiled) {
  is_as_compiled<1, Friction::none>();
  is_as_compiled<1, Friction::timed>();
  is_as_compiled<2, Friction::none, true>();
  is_as_compiled<2, Friction::constant>();
  is_as_compiled<3, Friction::timed, true>();
  is_as_compiled<8, Friction::none>();
  is_as_compiled<9, Friction::none, true>();
  is_as_compiled<9, Friction::constant>();
  is_as_compiled<9, Friction::timed>();
}

/// The tangents of a step from a state that is not the start of the run, against those of the compiled problem.
template <int N, Friction friction>
void has_the_same_tangents() {
  using P = Ring<N, friction>;
  const P problem;
  const auto from = start(N, friction);
  const auto mechanics = ring(N, friction);
  const Request request = transformed(mechanics, from, 1, 0.1, "suzuki_4");
  const auto scheme = from_values<TimeTransformed>(TimeTransformed::fields, request.settings);
  const auto backend = mechanics->backend(request);
  const auto tangents = backend->tangents(request);
  auto begun = state_of<FullStateOf<P>>(from), x = begun;
  for (std::size_t i = 0; i < from.size(); ++i) x[i] = 0.9 * x[i] + 0.02;
  x.t = 0.3;
  const RunState at = run_state(x);
  const auto always = [] { return true; };
  TangentMap found, known;
  if constexpr (friction == Friction::none) {
    ASSERT_TRUE(tangents.plain && !tangents.extended);
    ASSERT_TRUE(tangents.plain(at, always, found));
    const auto tangent = step_tangent(scheme, problem, begun, x, always);
    ASSERT_TRUE(tangent);
    known = tangent_map(x, *tangent);
    // Along a direction in which the time and the level change, too.
    StateNumbers u(2 * N);
    Vec<2 * N> v;
    for (std::size_t i = 0; i < 2 * N; ++i) u[i] = v[i] = std::sin(double(i) + 1);
    ChangeOfStep change;
    ASSERT_TRUE(tangents.along(at, {}, u, 0.4, 0.7, change));
    const auto moved = step_change(scheme, problem, begun, x, {}, v, 0.4, 0.7);
    ASSERT_TRUE(moved);
    EXPECT_NEAR(change.longer, moved->longer, 1e-13);
    EXPECT_NEAR(change.to.t, moved->image.t, 1e-14);
    for (std::size_t i = 0; i < 2 * N; ++i) EXPECT_NEAR(change.change[i], moved->change[i], 1e-13);
    const auto level = level_slopes(scheme, problem, begun);
    for (std::size_t i = 0; i < 2 * N; ++i) EXPECT_NEAR(tangents.level[i], level[i], 1e-13);
  } else {
    ASSERT_TRUE(tangents.extended && !tangents.plain && !tangents.along);
    ASSERT_TRUE(tangents.extended(at, always, found));
    const auto step = extended_step_tangent(scheme, problem, begun, x, always);
    ASSERT_TRUE(step);
    known = tangent_map(step->start, step->tangent);
    EXPECT_TRUE(found.extended);
    // For a run that does not carry s the same, except for the change of s itself.
    TangentMap without;
    ASSERT_TRUE(
        tangents.extended({at.t, StateNumbers(at.numbers.begin(), at.numbers.begin() + 2 * N)}, always, without));
    EXPECT_EQ(without.from[2 * N + 2], 0);
    for (std::size_t i = 0; i < 2 * N + 1; ++i) EXPECT_NEAR(without.to[i], found.to[i], 1e-13);
  }
  ASSERT_EQ(found.size(), known.size());
  EXPECT_EQ(found.dof, known.dof);
  for (std::size_t i = 0; i < known.size(); ++i) {
    EXPECT_NEAR(found.from[i], known.from[i], 1e-13) << i;
    EXPECT_NEAR(found.to[i], known.to[i], 1e-13) << i;
    for (std::size_t j = 0; j < known.size(); ++j)
      EXPECT_NEAR(found.slope(i, j), known.slope(i, j), 1e-12) << i << " " << j;
  }
}
TEST(SizedTransformed, TangentsAreThoseOfTheProblemThatIsCompiled) {
  has_the_same_tangents<1, Friction::constant>();
  has_the_same_tangents<3, Friction::none>();
  has_the_same_tangents<9, Friction::none>();
  has_the_same_tangents<9, Friction::constant>();
  has_the_same_tangents<9, Friction::timed>();
}

// Symplectic at the energy level of the run's start; with friction a contact map of the space extended by time, with λ
// = e^(−∫α).
TEST(SizedTransformed, TheFormIsKept) {
  for (const int n : {9, 100})
    for (const Friction friction : frictions) {
      Request request = transformed(ring(n, friction), start(n, friction), 0.4, 0.15);
      for (const char* asked : {"structure", "lyapunov"}) runs::ask(request, asked);
      if (friction != Friction::none) runs::ask(request, "volume");
      const auto result = runs::go(request).outcome;
      const auto& found = result.diagnostics;
      EXPECT_LT(runs::number(found, "structure/max_defect"), 1e-11) << n << int(friction);
      EXPECT_TRUE(std::isfinite(runs::number(found, "lyapunov/exponent"))) << n << int(friction);
      if (friction == Friction::none) continue;
      EXPECT_NEAR(runs::number(found, "structure/factor"), std::exp(-0.15 * alpha), 0.1) << n << int(friction);
      EXPECT_LT(runs::number(found, "volume/max_defect"), 1e-10) << n << int(friction);
    }
}

// p is only scaled and pushed along ∇V: without the springs Σp decays by e^(−∫α) at every step.
TEST(SizedTransformed, TheMomentumOfTheWholeDecays) {
  constexpr int n = 40;
  for (const Friction friction : {Friction::none, Friction::constant}) {
    const auto from = start(n, friction);
    const auto x = final_of(transformed(ring(n, friction, {.held = 0}), from, 10, 0.1));
    double before = 0, after = 0;
    for (std::size_t i = n; i < 2 * n; ++i) {
      before += from[i];
      after += x[i];
    }
    EXPECT_NEAR(after / before, friction == Friction::none ? 1 : std::exp(-10 * alpha), 1e-11) << int(friction);
  }
}

TEST(SizedTransformed, SaysWhichThresholdWouldDo) {
  for (const Friction friction : frictions) {
    Request request = transformed(ring(20, friction), start(20, friction), 10, 0.1);
    runs::set(request, "kappa", -5);
    runs::set(request, "sigma", 0.02);
    const auto stop = runs::go(request).outcome.stop;
    EXPECT_EQ(stop.reason, ReturnCode::singular) << int(friction);
    if (friction == Friction::none) continue;
    EXPECT_NE(std::string(stop.detail.text()).find("has to be more than"), std::string::npos) << stop.detail.text();
  }
}

TEST(SizedTransformed, IsOfferedWhereItHasSteps) {
  const auto offered = [](const std::shared_ptr<const Mechanics>& mechanics) {
    return runs::fits(mechanics->card(), find_scheme("time_transformed").value());
  };
  for (const Friction friction : frictions) EXPECT_TRUE(offered(ring(100, friction))) << int(friction);
  text::TypedScene typed;
  typed.scene = of(Definition::Kind::potential, {"q[100]"}, {}, "sum(i=1..100, q[i]^4) + sin(t)*q[1]");
  EXPECT_FALSE(offered(made(typed)));
}

}  // namespace
}  // namespace sized_transformed
