// Boost.Odeint's schemes take Odeint's own steps, to the bit.
#include <gtest/gtest.h>

#include <boost/numeric/odeint/stepper/bulirsch_stoer.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>

#include "core/problems/kepler.hpp"
#include "core/schemes/odeint.hpp"

namespace {

using namespace least;
using namespace least::problems;
namespace library = boost::numeric::odeint;

const State<2> from_periapsis{0, {0.4, 0}, {0, 2}, {}};  // e = .6

const auto kepler_rate = [](const std::array<double, 4>& y, std::array<double, 4>& rate, double t) {
  const auto d = derivative(Kepler<>{}, State<2>{t, {y[0], y[1]}, {y[2], y[3]}, {}});
  for (std::size_t i = 0; i < 4; ++i) rate[i] = d[i];
};
/// The initial step by Hairer, Nørsett, Wanner I, II.4, in the norm of the largest component.
double first_step(double tolerance, int order) {
  const auto size = [&](const State<2>& v) {
    double most = 0;
    for (std::size_t i = 0; i < 4; ++i)
      most = std::max(most, std::abs(v[i]) / (tolerance * (1 + std::abs(from_periapsis[i]))));
    return most;
  };
  const auto rate = derivative(Kepler<>{}, from_periapsis);
  const double h0 = 0.01 * (size(from_periapsis) / size(rate));
  const auto bend = shifted(derivative(Kepler<>{}, shifted(from_periapsis, h0, rate)), -1, rate);
  return std::min(100 * h0, std::pow(0.01 / std::max(size(rate), size(bend) / h0), 1.0 / (order + 1)));
}
/// steps_are() compares steps of a scheme with those of one of the library's own steppers, from the same start.
template <class Scheme, class Stepper>
void steps_are(const Scheme& scheme, Stepper theirs, int order) {
  auto x = from_periapsis;
  auto stepper = scheme.bind(Kepler<>{}, x);
  std::array<double, 4> y{0.4, 0, 0, 2};
  double t = 0, h = first_step(scheme.tolerance, order);
  if constexpr (stepper.has_dense) theirs.initialize(y, t, h);
  for (int k = 0; k < 200; ++k) {
    ASSERT_EQ(stepper.step(x), StepStatus::ok);
    if constexpr (stepper.has_dense) {
      const auto [from, to] = theirs.do_step(kepler_rate);
      const double between = from + 0.3 * (to - from);
      auto z = x;
      ASSERT_TRUE(stepper.interpolate(z, between));
      EXPECT_EQ(z.t, between);
      theirs.calc_state(between, y);
      for (std::size_t i = 0; i < 4; ++i) ASSERT_EQ(z[i], y[i]) << k;
      y = theirs.current_state();
      t = to;
    } else {
      while (theirs.try_step(kepler_rate, y, t, h) != library::success) {
      }
    }
    ASSERT_EQ(x.t, t) << k;
    for (std::size_t i = 0; i < 4; ++i) ASSERT_EQ(x[i], y[i]) << k;
  }
}
TEST(Odeint, StepsAreTheLibrarysOwn) {
  using Y = std::array<double, 4>;
  for (const double e : {1e-3, 1e-8, 1e-13}) {
    steps_are(DormandPrince5{e}, library::make_dense_output(e, e, library::runge_kutta_dopri5<Y>()), 5);
    steps_are(BulirschStoer{e}, library::bulirsch_stoer<Y>(e, e), 8);
  }
}

// A second error check shortens some of its steps a little: they are the library's steps of those lengths, up to the
// rounding of a length.
TEST(Odeint, StepsOfFehlbergAreTheLibrarysOwnOrALittleShorter) {
  using Y = std::array<double, 4>;
  for (const double e : {1e-3, 1e-8, 1e-13}) {
    auto x = from_periapsis;
    auto stepper = Fehlberg78{e}.bind(Kepler<>{}, x);
    auto controlled = library::make_controlled(e, e, library::runge_kutta_fehlberg78<Y>());
    Y alone{0.4, 0, 0, 2};
    double far = 0, h = first_step(e, 8);
    for (int k = 0; k < 200; ++k) {
      Y y{x[0], x[1], x[2], x[3]};
      const double t = x.t;
      ASSERT_EQ(stepper.step(x), StepStatus::ok);
      library::runge_kutta_fehlberg78<Y>().do_step(kepler_rate, y, t, x.t - t);
      for (std::size_t i = 0; i < 4; ++i) ASSERT_NEAR(x[i], y[i], 1e-13) << k;
      while (controlled.try_step(kepler_rate, alone, far, h) != library::success) {
      }
    }
    EXPECT_LT(x.t, far) << e;
    EXPECT_GT(x.t, 0.7 * far) << e;
  }
}

}  // namespace
