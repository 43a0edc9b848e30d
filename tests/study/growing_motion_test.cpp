// The longest stable step where the true motion itself grows: its growth does not count against the step.
#include <cmath>
#include <numbers>
#include <random>

#include "tests/study/studies.hpp"
#include "tests/support/texts.hpp"

namespace {

using namespace studies;
using texts::Definition;

constexpr auto typed_v = Definition::Kind::potential;

StabilityLimit limit(const Definition& definition, std::string_view scheme, const std::vector<double>& start) {
  const auto mechanics = texts::mechanics_of(definition);
  Request request = texts::typed_as(runs::defaults("kepler", "runge_kutta_4"), mechanics);
  texts::begin_at(request, start);
  request.end = mechanics->card().span;
  SchemeConfig choice{find_scheme(scheme).value(), {}};
  for (const auto& setting : schemes()[choice.scheme].parameters) choice.settings.push_back(setting.value);
  return longest_stable_step_of(request, choice, never);
}

/// ẍ = −(a − q cos t) x
struct Mathieu {
  double a, q;

  Definition definition() const { return texts::of(typed_v, {"x"}, {{"a", a}, {"q", q}}, "(a - q*cos(t))*x^2/2"); }
  double force(double t, double x) const { return -(a - q * std::cos(t)) * x; }
  void kick_drift_kick(double& x, double& v, double t, double h) const {
    v += h / 2 * force(t, x);
    x += h * v;
    v += h / 2 * force(t + h, x);
  }
  void runge_kutta(double& x, double& v, double t, double h) const {
    const double a1 = v, b1 = force(t, x), a2 = v + h / 2 * b1, b2 = force(t + h / 2, x + h / 2 * a1),
                 a3 = v + h / 2 * b2, b3 = force(t + h / 2, x + h / 2 * a2), a4 = v + h * b3,
                 b4 = force(t + h, x + h * a3);
    x += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    v += h / 6 * (b1 + 2 * b2 + 2 * b3 + b4);
  }
  /// exponent() returns Floquet's exponent, from the map over a period.
  double exponent() const {
    constexpr int steps = 4000;
    constexpr double h = 2 * std::numbers::pi / steps;
    double x1 = 1, v1 = 0, x2 = 0, v2 = 1;
    for (int k = 0; k < steps; ++k) {
      runge_kutta(x1, v1, k * h, h);
      runge_kutta(x2, v2, k * h, h);
    }
    const double half_trace = std::abs(x1 + v2) / 2;
    return half_trace > 1 ? std::acosh(half_trace) / (2 * std::numbers::pi) : 0;
  }
  /// rate_of_run() returns how fast a run of 2,000 steps grows: the logarithm of the size of its second half relative
  /// to its first, per time.
  double rate_of_run(bool leapfrog, double h) const {
    // The study follows the motion until it is 1e30 times as large.
    const double followed = std::log(1e30) / (exponent() * h);
    const int steps = followed < 2000 ? static_cast<int>(followed) / 2 * 2 : 2000;
    double x = 1, v = 0, log_size = 0, halves[2] = {-1e9, -1e9};
    for (int k = 0; k < steps; ++k) {
      leapfrog ? kick_drift_kick(x, v, k * h, h) : runge_kutta(x, v, k * h, h);
      const double size = std::max({std::abs(x), std::abs(v), 1e-300});
      double& half = halves[k < steps / 2 ? 0 : 1];
      half = std::max(half, log_size + std::log(size));
      if (size < 1e50) continue;
      x /= size;
      v /= size;
      log_size += std::log(size);
    }
    return (halves[1] - halves[0]) / (0.5 * steps * h);
  }
};

// In the middle of the first tongue the motion grows at a rate of about q/2, over 2,000 steps by a hundred orders of
// magnitude.
TEST(StabilityLimitOfAGrowingMotion, InMathieusTongueIsThatOfTheStep) {
  std::vector<Mathieu> rows{{0.25, 0.1}};
  std::mt19937 random(36);
  for (int k = 0; k < 4; ++k)
    rows.push_back(
        {std::uniform_real_distribution(0.24, 0.26)(random), std::uniform_real_distribution(0.06, 0.12)(random)});
  for (const Mathieu& mathieu : rows) {
    SCOPED_TRACE(std::to_string(mathieu.a) + " " + std::to_string(mathieu.q));
    const double slowest = 1 / std::sqrt(mathieu.a), fastest = 1 / std::sqrt(mathieu.a + mathieu.q);
    ASSERT_GT(mathieu.exponent(), 0.02);
    const StabilityLimit leapfrog = limit(mathieu.definition(), "leapfrog", {1, 0});
    EXPECT_GT(leapfrog.step, 0.7 * 2 * fastest);
    EXPECT_LT(leapfrog.step, 1.1 * 2 * slowest);
    const StabilityLimit runge_kutta = limit(mathieu.definition(), "runge_kutta_4", {1, 0});
    EXPECT_GT(runge_kutta.step, 0.9 * 2 * std::numbers::sqrt2 * fastest);
    EXPECT_LT(runge_kutta.step, 1.25 * 2 * std::numbers::sqrt2 * slowest);
    for (const auto& [found, by_leapfrog] : {std::pair(&leapfrog, true), std::pair(&runge_kutta, false)}) {
      EXPECT_EQ(found->failure, "energy_growth");
      for (const double part : {0.1, 0.3, 0.5, 0.7, 0.9})
        EXPECT_LT(mathieu.rate_of_run(by_leapfrog, part * found->step), 1.6 * mathieu.exponent()) << part;
      // Runge–Kutta steps about as long as a period of the tongue see a force that stands still: whether a run grows
      // then depends on where it ends.
      if (by_leapfrog) {
        EXPECT_GT(mathieu.rate_of_run(true, found->failing), 1.4 * mathieu.exponent());
      }
    }
  }
}

// Outside the tongue the motion does not grow, so that all growth is that of the step, a shifted resonance included.
TEST(StabilityLimitOfAGrowingMotion, BesideTheTongueIsWhereARunGrows) {
  std::vector<Mathieu> rows{{0.5, 0.1}};
  std::mt19937 random(37);
  for (int k = 0; k < 4; ++k)
    rows.push_back(
        {std::uniform_real_distribution(0.36, 0.7)(random), std::uniform_real_distribution(0.02, 0.09)(random)});
  for (const Mathieu& mathieu : rows) {
    SCOPED_TRACE(std::to_string(mathieu.a) + " " + std::to_string(mathieu.q));
    ASSERT_EQ(mathieu.exponent(), 0);
    const StabilityLimit leapfrog = limit(mathieu.definition(), "leapfrog", {1, 0}),
                         runge_kutta = limit(mathieu.definition(), "runge_kutta_4", {1, 0});
    EXPECT_LT(leapfrog.step, 2.05 / std::sqrt(mathieu.a));
    EXPECT_LT(runge_kutta.step, 2.05 * std::numbers::sqrt2 / std::sqrt(mathieu.a));
    for (const auto& [found, by_leapfrog] : {std::pair(&leapfrog, true), std::pair(&runge_kutta, false)}) {
      EXPECT_GT(found->step, 1);
      const auto grows_by = [&](double h) { return mathieu.rate_of_run(by_leapfrog, h) * 1000 * h; };
      EXPECT_GT(grows_by(found->failing), 0.99 * std::log(2));
      for (const double part : {0.3, 0.6, 0.9}) EXPECT_LT(grows_by(part * found->step), std::log(2)) << part;
    }
  }
}

// q̈ − αq̇ + q = 0: whether steps are stable depends on the oscillation, although the motion grows.
TEST(StabilityLimitOfAGrowingMotion, OfAnAntiDampedOscillator) {
  for (const char* damping : {"-0.02", "-0.1", "-0.4"}) {
    SCOPED_TRACE(damping);
    const Definition driven = texts::damped(texts::of(typed_v, {"x"}, {}, "x^2/2"), damping);
    EXPECT_NEAR(limit(driven, "contact_leapfrog", {1, 0}).step, 2, 0.1);
    EXPECT_NEAR(limit(driven, "runge_kutta_4", {1, 0}).step, 2 * std::numbers::sqrt2, 0.25);
  }
}

// From near an unstable equilibrium to the limit cycle: the motion grows by four orders of magnitude, and then no more.
TEST(StabilityLimitOfAGrowingMotion, OfAStartNearAnUnstableRest) {
  const Definition cycle = texts::flow({"x", "v"}, {}, {{"x", "v"}, {"v", "(1 - x^2)*v/10 - x"}});
  const double on_the_cycle = limit(cycle, "runge_kutta_4", {2, 0}).step;
  EXPECT_GT(on_the_cycle, 1.5);
  EXPECT_NEAR(limit(cycle, "runge_kutta_4", {1e-4, 0}).step, on_the_cycle, 0.2 * on_the_cycle);
}

// Down a hill, V = −x²/2, energy errors grow with the kinetic and potential energies themselves: with a symplectic
// scheme they stay in proportion.
TEST(StabilityLimitOfAGrowingMotion, DownAHillIsRelativeToTheSpeed) {
  const StabilityLimit found = limit(texts::of(typed_v, {"x"}, {}, "-x^2/2"), "leapfrog", {1, 0});
  EXPECT_TRUE(found.failure.empty() || found.step > 1) << found.step;
}

}  // namespace
