// boris on scenes as text: its orders, the volume, the speed, reversal, long runs.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "core/number/linear.hpp"
#include "core/schemes/boris_stepper.hpp"
#include "tests/support/magnetic.hpp"

namespace magnetic {
namespace {

constexpr std::pair<const char*, int> compositions_of[] = {{"none", 2},       {"suzuki_4", 4},
                                                           {"yoshida_6", 6},  {"kahan_li_6", 6},
                                                           {"kahan_li_8", 8}, {"sofroniou_spaletta_10", 10}};

text::Magnetic field_of(const Definition& definition) {
  const auto mechanics = mechanics_of(definition);
  return std::get<text::Magnetic>(
      text::magnetic(*mechanics->text()->form, parameters_of(definition), definition.variables));
}

class BorisOf : public testing::TestWithParam<Scene> {
 protected:
  const Scene& scene() const { return GetParam(); }
};

// The order is checked from both sides: errors against the true motion at halved steps, all of them above round-off.
TEST_P(BorisOf, HasTheOrderOfTheComposition) {
  const auto truth = true_end(scene());
  for (const auto& [composition, order] : compositions_of) {
    const Steps steps{order == 2 ? scene().step : 0.75, 1e-3};
    const double seen = observed_order(scene(), truth, "boris", composition, steps);
    if (std::isnan(seen)) {
      EXPECT_GE(order, 8) << "no two steps between 1e-3 and round-off: " << composition;
      continue;
    }
    EXPECT_NEAR(seen, order, order < 8 ? 0.3 : 1.2) << composition;
  }
}

// The volume in positions and momenta, by dual numbers: Boris's rotations keep it in any field, Runge–Kutta's steps do
// not.
TEST_P(BorisOf, KeepsTheVolume) {
  const std::size_t n = scene().definition.variables.size(), size = 2 * n;
  const auto field = std::make_shared<const text::Magnetic>(field_of(scene().definition));
  for (const auto& [composition, order] : compositions_of) {
    Request named = request_of(scene(), "boris", 0.3, 3);
    runs::set(named, "composition", composition);
    std::vector<double> jacobian(size * size);
    for (std::size_t j = 0; j < size; ++j) {
      std::vector<Slope> x(scene().start.begin(), scene().start.end());
      x[j].slope[0] = 1;
      BorisStepper<Slope> stepper(field, {0.3, Composition(named.settings[1])}, n);
      stepper.begin(x.data(), 0.2);
      ASSERT_EQ(stepper.step(x.data(), 0.2, 0.3), StepStatus::ok);
      for (std::size_t i = 0; i < size; ++i) jacobian[i * size + j] = x[i].slope[0];
    }
    EXPECT_NEAR(detail::determinant_by_lu(size, jacobian.data()), 1, 2e-12) << composition;
  }
}

TEST_P(BorisOf, ComesBackByTheStepsItCameBy) {
  const std::size_t n = scene().definition.variables.size();
  const auto field = std::make_shared<const text::Magnetic>(field_of(scene().definition));
  for (const Composition::Name composition : {Composition::none, Composition::kahan_li_6}) {
    const auto went = there_and_back(BorisStepper<double>(field, {0.1, composition}, n), scene().start, 0.3, 0.1, 100);
    EXPECT_GT(went.away, 1e-2);
    EXPECT_LT(went.missed, scene().name == std::string("three") ? 1e-9 : 2e-12);
  }
}

TEST_P(BorisOf, IsTheSameHoweverItIsRecorded) {
  expect_the_same_however_recorded(request_of(scene(), "boris", 0.05, 5.02));
}

INSTANTIATE_TEST_SUITE_P(, BorisOf, testing::ValuesIn(scenes()), [](const auto& tested) { return tested.param.name; });

// A magnetic field does no work: the speed is kept to round-off at any step, in whatever field.
TEST(Boris, KeepsTheSpeedWithoutAPotential) {
  const Scene bottled = scenes().front();
  for (const double step : {0.5, 0.05}) {
    Request request = request_of(bottled, "boris", step, 2000);
    EXPECT_LT(energy_error(request), 1e-13 * std::sqrt(2000 / step)) << step;
    runs::set(request, "composition", "kahan_li_6");
    EXPECT_LT(energy_error(request), 1e-12 * std::sqrt(2000 / step)) << step;
  }
  EXPECT_GT(energy_error(request_of(bottled, "runge_kutta_4", 0.05, 2000)), 1e-7);
}

// The rotation is by the exact angle: a gyration has its true period at any step, with five steps a turn as well as
// with a hundred.
TEST(Boris, OfAUniformFieldHasItsFrequency) {
  const Scene uniform{"uniform",
                      of(lagrangian, {"x", "y", "z"}, {{"b", 2}}, "(vx^2+vy^2+vz^2)/2 + b*(x*vy - y*vx)/2"),
                      {1, 0, 0, 0, 0.5, 0.3},
                      0.1};
  // v = p − a = (0, −0.5, 0.3) at the start, turning by −b t.
  for (const double step : {0.6, 0.03}) {
    const auto end = final_of(request_of(uniform, "boris", step, 60));
    const double x = end[0], y = end[1], vx = end[3] + y, vy = end[4] - x;
    EXPECT_NEAR(vx, -0.5 * std::sin(2 * 60.0), 1e-12) << step;
    EXPECT_NEAR(vy, -0.5 * std::cos(2 * 60.0), 1e-12) << step;
    EXPECT_NEAR(end[2], 0.3 * 60, 1e-12);
  }
}

// A magnetic bottle with a hill in it over ten thousand gyrations: the energy error stays bounded, but grows with
// Runge–Kutta.
TEST(Boris, KeepsTheEnergyNearOverLongRuns) {
  Definition hilly = bottle();
  hilly.formula += " - exp(-((x-1)^2 + y^2 + z^2))/5";
  const Scene scene{"hilly", hilly, {1.5, 0, 0.1, 0, 1.2, 0.2}, 0.1};
  const auto error = [&](std::string_view scheme, double step, double end) {
    return energy_error(request_of(scene, scheme, step, end));
  };
  const double early = error("boris", 0.1, 500), late = error("boris", 0.1, 50'000);
  EXPECT_GT(early, 1e-6);
  EXPECT_LT(late, 3 * early);
  EXPECT_GT(error("runge_kutta_4", 0.2, 50'000), 10 * late) << "with twice the step, of four evaluations";
}

}  // namespace
}  // namespace magnetic
