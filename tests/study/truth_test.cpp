// True states, their cache, and how accurately states can be known.
#include <cmath>
#include <numbers>
#include <thread>

#include "core/state_error.hpp"
#include "core/study/error_study.hpp"
#include "tests/study/studies.hpp"

namespace {

using namespace studies;

TEST(Truth, IsTheClosedFormWhereThereIsOne) {
  const Request oscillator = scene("harmonic_oscillator");
  const auto known = truth(oscillator, {1, 2.5, 20}, always);
  ASSERT_TRUE(known->complete);
  EXPECT_EQ(known->how, "closed form");
  for (const auto& [state, t] : {std::pair(known->states[0], 1.0), std::pair(known->states[1], 2.5)}) {
    EXPECT_NEAR(state[0], std::cos(t), 1e-15);
    EXPECT_NEAR(state[1], -std::sin(t), 1e-15);
  }
  Request star = scene("lane_emden", 3);
  runs::set(star, "n", 1);
  const double q = truth(star, {3}, always)->states[0][0];
  EXPECT_NEAR(q, std::sin(3.0) / 3, 1e-15);
}

// The quad-precision run against a closed form that it does not use: n = 1 from a start that is not the closed form's
// own.
TEST(Truth, IsARunInQuadPrecisionElsewhere) {
  Request star = scene("lane_emden", 3);
  runs::set(star, "n", 1);
  runs::scene(star).start = 1;
  runs::scene(star).initial[0] = std::sin(1.0);
  runs::scene(star).initial[1] = std::cos(1.0) - std::sin(1.0);
  const auto known = truth(star, {2, 3}, always);
  ASSERT_TRUE(known->complete);
  EXPECT_EQ(known->how, "quad precision run");
  EXPECT_NEAR(known->states[1][0], std::sin(3.0) / 3, 1e-15);
  EXPECT_LT(known->uncertainty, 1e-15);
}

// A run of the star that names a start time but no state begins on the regular solution: the closed forms, with s = t⁻²
// ∫₀ᵗ τ² (p²/2 − V) dτ.
TEST(Truth, KnowsTheStateOfAStarWhereARunBegins) {
  struct Star {
    double q, p;
  };
  const auto star = [](double n, double t) -> Star {
    if (n == 0) return {1 - t * t / 6, -t / 3};
    if (n == 1) return {std::sin(t) / t, (std::cos(t) - std::sin(t) / t) / t};
    return {1 / std::sqrt(1 + t * t / 3), -t / 3 * std::pow(1 + t * t / 3, -1.5)};
  };
  for (const double n : {0.0, 1.0, 5.0})
    for (const double t : {0.05, 0.1, 0.1000001, 0.5, 2.0, 3.1, 40.0}) {
      if (t > (n == 0 ? std::sqrt(6.0) : n == 1 ? std::numbers::pi : 1e9)) continue;
      Request request = scene("lane_emden", 50);
      runs::set(request, "n", n);
      const auto state = runs::regular_start(request, t);
      ASSERT_TRUE(state.has_value()) << n << ' ' << t;
      const auto [q, p] = star(n, t);
      EXPECT_NEAR((*state)[0], q, 1e-15) << n << ' ' << t;
      EXPECT_NEAR((*state)[1], p, 1e-15) << n << ' ' << t;
      double sum = 0;  // Simpson's rule; the integrand vanishes at τ = 0
      constexpr int parts = 4000;
      for (int k = 1; k <= parts; ++k) {
        const double tau = t * k / parts;
        const auto [a, b] = star(n, tau);
        sum += (k == parts ? 1 : k % 2 == 1 ? 4 : 2) * tau * tau * (b * b / 2 - std::pow(a, n + 1) / (n + 1));
      }
      EXPECT_NEAR((*state)[2], sum * t / (3 * parts) / (t * t), 1e-9 * (1 + t)) << n << ' ' << t;
    }
  Request request = scene("lane_emden", 50);
  EXPECT_FALSE(runs::regular_start(request, 6.9).has_value()) << "n = 3: its surface is at 6.8968";
  EXPECT_TRUE(runs::regular_start(request, 6.89).has_value());
  EXPECT_FALSE(runs::regular_start(request, -1).has_value());
  EXPECT_FALSE(runs::problem_called("kepler")->regular_start({}, 1).has_value()) << "nothing is singular there";
}

TEST(Truth, IsKeptAndGivenUpAndForgotten) {
  const Request heiles = scene("henon_heiles", 5);
  const auto once = truth(heiles, {5}, always);
  EXPECT_EQ(once, truth(heiles, {5}, always)) << "computed twice";
  EXPECT_NE(once, truth(heiles, {4}, always));
  Request moved = heiles;
  runs::scene(moved).initial[0] = -0.0;
  EXPECT_NE(once, truth(moved, {5}, always)) << "−0 is another start";
  moved = heiles;
  moved.scheme = runs::defaults("henon_heiles", "leapfrog").scheme;
  moved.limits.steps = 7;
  EXPECT_EQ(once, truth(moved, {5}, always)) << "the truth does not depend on the scheme";

  const auto no_time = [] { return false; };
  EXPECT_FALSE(truth(heiles, {4.5}, no_time)->complete);
  EXPECT_TRUE(truth(heiles, {4.5}, always)->complete) << "what was given up was kept";

  const Request oscillator = scene("harmonic_oscillator");
  const std::weak_ptr first = truth(oscillator, {0.5}, always);
  for (int k = 1; k <= 63; ++k) truth(oscillator, {0.5 + k}, always);
  EXPECT_FALSE(first.expired());
  truth(oscillator, {100.5}, always);
  EXPECT_TRUE(first.expired()) << "more than 64 are kept";
  // Four of 5 MiB do not fit into 16 MiB.
  std::vector<std::weak_ptr<const Truth>> large;
  for (int k = 0; k < 4; ++k) {
    std::vector<double> times;
    for (int i = 1; i <= 100'000; ++i) times.push_back(i * 1e-4 + k);
    large.push_back(truth(oscillator, times, always));
  }
  EXPECT_TRUE(large.front().expired());
  EXPECT_FALSE(large.back().expired());
}

TEST(Truth, CanBeAskedForByManyAtOnce) {
  std::vector<std::jthread> clients;
  std::atomic<int> wrong{0};
  for (int client = 0; client < 4; ++client)
    clients.emplace_back([&, client] {
      for (int k = 0; k < 40; ++k) {
        const double t = 1 + (k * 7 + client) % 90;
        const auto known = truth(scene("harmonic_oscillator"), {t}, always);
        if (std::abs(known->states[0][0] - std::cos(t)) > 1e-14) ++wrong;
      }
    });
  clients.clear();
  EXPECT_EQ(wrong, 0);
}

/// spread() returns the largest distance between the true end and the ends from starts that are off by `delta` of the
/// state in one variable, divided by `delta`.
double spread(const Request& scene, double delta) {
  const std::vector<double> end{scene.end};
  const auto here = truth(scene, end, always);
  double most = 0, size = 0;
  for (const double x : scene.scene->initial) size = std::max(size, std::abs(x));
  for (std::size_t i = 0; i < here->states[0].size(); ++i) {
    Request moved = scene;
    runs::scene(moved).initial[i] += delta * size;
    most = std::max(most, state_error(truth(moved, end, always)->states[0], here->states[0], here->states[0].size()));
  }
  return most / delta;
}

TEST(Conditioning, IsTheGrowthOfDifferences) {
  for (const auto& [problem, end] :
       {std::pair("kepler", 40.0), std::pair("lorenz", 20.0), std::pair("henon_heiles", 100.0),
        std::pair("van_der_pol", 3.0), std::pair("perturbed_kepler", 50.0), std::pair("lane_emden", 5.0)}) {
    SCOPED_TRACE(problem);
    Request request = scene(problem, end);
    if (std::string_view(problem) == "lane_emden") {  // its regular start has no neighbouring regular starts
      runs::scene(request).start = 0.5;
      runs::scene(request).initial = {0.96, -0.16, 0};
    }
    const double measured = std::max(spread(request, 1e-9), 1.0);
    EXPECT_NEAR(conditioning(request, always)->growth, measured, 0.02 * measured);
  }
}

// An oscillator whose momentum is any number of times its position.
TEST(Conditioning, InTheRelativeNormDoesNotDependOnUnits) {
  for (const double unit : {1.0, 1e-16, 1e12}) {
    Request request = scene("harmonic_oscillator", 20);
    runs::set(request, "mass", unit);
    runs::set(request, "stiffness", unit);
    const auto known = conditioning(request, always);
    EXPECT_NEAR(known->growth_in(Norm::relative, false), 1, 0.01) << unit;
    EXPECT_NEAR(known->sizes[1] / (unit * known->sizes[0]), 1, 0.01) << unit;
    EXPECT_GT(known->growth_in(Norm::absolute, false), unit < 1 ? 1e15 : 0.9) << unit;
  }
}

// Differences grow so far that the motion itself has to be followed to all its digits.
TEST(Conditioning, IsThatOfTheTrueMotionWhereItIsChaotic) {
  const Request request = scene("thermostat", 100);
  const double measured = spread(request, 0x1p-50);
  EXPECT_GT(measured, 1e12);
  EXPECT_NEAR(conditioning(request, always)->growth, measured, 0.02 * measured);
}

TEST(Conditioning, TellsChaosFromTheRest) {
  const auto chaotic = [](const Request& request) { return conditioning(request, always)->chaotic(); };
  EXPECT_TRUE(chaotic(scene("lorenz", 40)));
  EXPECT_TRUE(chaotic(scene("thermostat", 100)));
  Request pendulum = scene("double_pendulum", 100);
  runs::begin(pendulum, "theta1", 2.5);
  runs::begin(pendulum, "theta2", 2);
  EXPECT_TRUE(chaotic(pendulum));

  EXPECT_FALSE(chaotic(scene("lorenz", 25))) << "too short for it to matter";
  EXPECT_FALSE(chaotic(scene("kepler", 189))) << "eccentric, and nothing else";
  EXPECT_FALSE(chaotic(scene("kepler", 18900)));
  EXPECT_FALSE(chaotic(scene("harmonic_oscillator", 1000)));
  EXPECT_FALSE(chaotic(scene("van_der_pol", 100)));
  EXPECT_FALSE(chaotic(scene("double_pendulum")));
  Request grazing = scene("kepler", 25);
  runs::begin(grazing, "px", -0.001);  // a close passage of the centre
  runs::begin(grazing, "py", 0);
  EXPECT_GT(conditioning(grazing, always)->most_growth, 1e6);
  EXPECT_FALSE(chaotic(grazing));
}

TEST(Conditioning, FindsWhereAMotionEnds) {
  const auto star = conditioning(scene("lane_emden"), always);
  EXPECT_TRUE(star->ends);
  EXPECT_NEAR(star->reached, 6.89684861937696, 0.01 * 6.9);
  EXPECT_LT(star->reached, 6.89684861937696);
  Request cosmos = scene("cosmological_oscillator");
  runs::scene(cosmos).initial = {0, 0, -2};
  EXPECT_NEAR(conditioning(cosmos, always)->reached, 1.24645048028, 0.01 * 1.25);
  EXPECT_FALSE(conditioning(scene("pendulum"), always)->ends);
}

// No run has errors below the floor: the best runs come near it and not far below.
TEST(Conditioning, FloorIsWhereErrorsEnd) {
  const auto check = [](const Request& request, const SchemeConfig& scheme) {
    const ErrorStudy subject(request, false, 20, never);
    const ResolutionParameter dial = dial_of(scheme);
    double best = 1;
    for (double value = dial.value(scheme); value > dial.value(scheme) / 100; value /= 1.5)
      best = std::fmin(best, subject.run(dial.at(scheme, value), 5, 1'000'000).error);
    EXPECT_GT(best, 0.02 * subject.floor());
    EXPECT_LT(best, 1000 * subject.floor());
  };
  check(scene("lorenz", 30), choice(scene("lorenz"), "contact_splitting", "kahan_li_8"));
  check(scene("pendulum"), choice(scene("pendulum"), "leapfrog", "kahan_li_8"));
  SchemeConfig exact = choice(scene("kepler"), "time_transformed", "kahan_li_8");
  exact.settings[1] = std::numeric_limits<double>::quiet_NaN();  // κ = −E₀
  exact.settings[0] = 1;
  check(scene("kepler", 189), exact);
}

}  // namespace
