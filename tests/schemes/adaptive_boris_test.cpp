// adaptive_boris on scenes as text: its orders, reversal, the volume, the speed, and close passages.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "core/number/linear.hpp"
#include "core/schemes/adaptive_boris_stepper.hpp"
#include "tests/support/magnetic.hpp"

namespace magnetic {
namespace {

/// The scenes that do not depend on time, and Arenstorf's orbit.
Scene arenstorf() {
  return {"arenstorf",
          of(lagrangian, {"x", "y"}, {{"mu", 0.012277471}},
             "((vx - y)^2 + (vy + x)^2)/2 + (1-mu)/sqrt((x+mu)^2 + y^2) + mu/sqrt((x-1+mu)^2 + y^2)"),
          {0.994, 0, 0, 0.994 - 2.00158510637908252240537862224},
          1e-3};
}
constexpr double arenstorf_period = 17.0652165601579625588917206249;
std::vector<Scene> paced_scenes() {
  std::vector<Scene> all = scenes();
  all.pop_back();
  return all;
}
std::shared_ptr<const text::Magnetic> paced(const Definition& definition) {
  const auto mechanics = mechanics_of(definition);
  auto found =
      text::magnetic(*mechanics->text()->form, parameters_of(definition), definition.variables, text::Pace::yes);
  return std::make_shared<const text::Magnetic>(std::get<text::Magnetic>(std::move(found)));
}

class AdaptiveBorisOf : public testing::TestWithParam<Scene> {
 protected:
  const Scene& scene() const { return GetParam(); }
  std::size_t n = GetParam().definition.variables.size();
  std::shared_ptr<const text::Magnetic> field = paced(GetParam().definition);
};

// U, which sets the pace of the steps, is positive, and the other outputs are ∇U/(U√m).
TEST_P(AdaptiveBorisOf, TheSlopesOfThePaceAreItsOwn) {
  std::vector<double> looked(field->paced.outputs()), beside(looked);
  field->paced.evaluate(scene().start.data(), 0.0, looked.data());
  EXPECT_GT(looked[0], 0);
  constexpr double aside = 1e-6;
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<double> x = scene().start;
    double slope = 0;
    for (const double sign : {-1.0, 1.0}) {
      x[i] = scene().start[i] + sign * aside;
      field->paced.evaluate(x.data(), 0.0, beside.data());
      slope += sign * beside[0] / (2 * aside);
    }
    EXPECT_NEAR(looked[1 + i], slope * field->inverse_root[i] / looked[0], 1e-8);
  }
}

TEST_P(AdaptiveBorisOf, HasTheOrderOfTheComposition) {
  const auto truth = true_end(scene());
  for (const auto& [composition, order] :
       {std::pair{"none", 2}, {"suzuki_4", 4}, {"kahan_li_6", 6}, {"kahan_li_8", 8}}) {
    const double seen = observed_order(scene(), truth, "adaptive_boris", composition, {0.4, 5e-4});
    if (std::isnan(seen)) {
      EXPECT_GE(order, 8) << "no two steps between 1e-3 and round-off: " << composition;
      continue;
    }
    EXPECT_NEAR(seen, order, order < 8 ? 0.6 : 1.5) << composition;
  }
}

TEST_P(AdaptiveBorisOf, ComesBackByTheStepsItCameBy) {
  for (const Composition::Name composition : {Composition::none, Composition::kahan_li_6}) {
    std::vector<double> x = scene().start;
    AdaptiveBorisStepper stepper(field, {0.05, composition}, n, x.data());
    const double density = stepper.memory().density;
    double elapsed = 0, time = 0;
    for (int i = 0; i < 100; ++i) {
      ASSERT_EQ(stepper.advance(x.data(), elapsed), StepStatus::ok);
      time += elapsed;
    }
    EXPECT_GT(distance(x, scene().start), 1e-2);
    for (int i = 0; i < 100; ++i) {
      ASSERT_EQ(stepper.advance(x.data(), elapsed, true), StepStatus::ok);
      time += elapsed;
    }
    EXPECT_LT(distance(x, scene().start), scene().name == std::string("three") ? 1e-9 : 2e-12);
    EXPECT_LT(std::abs(time), 1e-11);
    EXPECT_NEAR(stepper.memory().density / density, 1, 1e-10);
  }
}

// The map of (q, p, ρ, t) keeps the volume, by differences of whole steps.
TEST_P(AdaptiveBorisOf, KeepsTheVolume) {
  const std::size_t size = 2 * n + 2;
  const auto go = [&](const std::vector<double>& from) {
    std::vector<double> x(from.begin(), from.begin() + static_cast<std::ptrdiff_t>(2 * n));
    const AdaptiveBoris scheme{0.1, Composition::suzuki_4};
    const AdaptiveBorisStepper start(field, scheme, n, scene().start.data());
    AdaptiveBorisStepper stepper(field, scheme, n, x.data());
    stepper.resume({from[2 * n], start.memory().whole, stepper.memory().change});
    double elapsed = 0;
    EXPECT_EQ(stepper.advance(x.data(), elapsed), StepStatus::ok);
    x.push_back(stepper.memory().density);
    x.push_back(from.back() + elapsed);
    return x;
  };
  std::vector<double> start = scene().start, jacobian(size * size);
  start.push_back(AdaptiveBorisStepper(field, {0.1, Composition::none}, n, start.data()).memory().density);
  start.push_back(0);
  constexpr double aside = 1e-4;
  for (std::size_t j = 0; j < size; ++j) {
    const auto moved = [&](double by) {
      std::vector<double> x = start;
      x[j] += by * aside;
      return go(x);
    };
    const auto a = moved(-2), b = moved(-1), c = moved(1), d = moved(2);
    for (std::size_t i = 0; i < size; ++i) jacobian[i * size + j] = (a[i] - 8 * b[i] + 8 * c[i] - d[i]) / (12 * aside);
  }
  EXPECT_NEAR(detail::determinant_by_lu(size, jacobian.data()), 1, 1e-8);
}

TEST_P(AdaptiveBorisOf, IsTheSameHoweverItIsRecorded) {
  expect_the_same_however_recorded(request_of(scene(), "adaptive_boris", 0.05, 5.02));
}

INSTANTIATE_TEST_SUITE_P(, AdaptiveBorisOf, testing::ValuesIn(paced_scenes()),
                         [](const auto& tested) { return tested.param.name; });

// Two close passages by the moon and one by the earth: the orbit closes.
TEST(AdaptiveBoris, FollowsArenstorfsOrbit) {
  const auto missed = [](double step, const char* composition) {
    Request request = request_of(arenstorf(), "adaptive_boris", step, arenstorf_period);
    runs::set(request, "composition", composition);
    return distance(final_of(request), arenstorf().start);
  };
  EXPECT_LT(missed(1e-3, "kahan_li_8"), 1e-3);
  EXPECT_LT(missed(4e-4, "kahan_li_8"), 1e-6);
  // Steps of equal length do not follow it at ten times the cost.
  Request equal = request_of(arenstorf(), "boris", arenstorf_period / 2000, arenstorf_period);
  runs::set(equal, "composition", "kahan_li_8");
  EXPECT_GT(distance(final_of(equal), arenstorf().start), 0.1);
}

TEST(AdaptiveBoris, KeepsTheSpeedWithoutAPotential) {
  EXPECT_LT(energy_error(request_of(scenes().front(), "adaptive_boris", 0.2, 2000)), 1e-11);
}

TEST(AdaptiveBoris, SaysWhereThereIsNothingToFollow) {
  const Scene still{"still",
                    of(hamiltonian, {"x", "y"}, {}, "((px + x^2*y^2)^2 + (py - x^2*y^2)^2)/2 + x^4 + y^4"),
                    {0, 0, 1, 0.5},
                    0.1};
  EXPECT_NE(
      runs::go(request_of(still, "adaptive_boris", 0.1, 1)).outcome.stop.detail.text().find("nothing at the start"),
      std::string::npos);
  const auto driven = mechanics_of(driven_frame());
  EXPECT_FALSE(runs::fits(driven->card(), find_scheme("adaptive_boris").value())) << "V depends on time";
}

}  // namespace
}  // namespace magnetic
