// Boost.Odeint's schemes: errors follow the tolerance; dense output; what ends them.
#include "core/schemes/odeint.hpp"

#include <cstring>
#include <memory>
#include <optional>

#include "core/problems/cosmological_oscillator.hpp"
#include "core/problems/damped_oscillator.hpp"
#include "core/problems/driven_oscillator.hpp"
#include "core/problems/kepler_3d.hpp"
#include "core/problems/lorenz.hpp"
#include "core/problems/van_der_pol.hpp"
#include "core/reference/reference.hpp"
#include "core/schemes/runge_kutta.hpp"
#include "tests/support/clocks.hpp"

namespace {

using namespace least;
using namespace least::problems;
using clocks::larger, clocks::past, clocks::steps;

template <class Scheme>
constexpr bool runs_everything =
    SelfTimedSchemeFor<Scheme, Kepler<>>&& SelfTimedSchemeFor<Scheme, Kepler3d<>>&&
        SelfTimedSchemeFor<Scheme, DampedOscillator<>>&&
            SelfTimedSchemeFor<Scheme, DampedOscillator<>, State<1, double, double, Action<double>>>&&
                SelfTimedSchemeFor<Scheme, CosmologicalOscillator<>>&& SelfTimedSchemeFor<Scheme, Lorenz<>>&&
                    SelfTimedSchemeFor<Scheme, VanDerPol<>, Point<2, Slope>> &&
    !FixedStepSchemeFor<Scheme, Kepler<>> && Scheme::reads_time;
static_assert(runs_everything<DormandPrince5> && runs_everything<Fehlberg78> && runs_everything<BulirschStoer>);
// These schemes work in doubles: no derivatives of a step, no other number types.
static_assert(!SelfTimedSchemeFor<DormandPrince5, Kepler<>, State<2, Dual<double, 4>, Dual<double, 4>>>);

template <class F>
void for_each_scheme(double tolerance, F&& f) {
  f(DormandPrince5{tolerance});
  f(Fehlberg78{tolerance});
  f(BulirschStoer{tolerance});
}

/// same() compares the bits, so that a NaN equals itself.
template <class X>
bool same(const X& a, const X& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

const State<2> ellipse{0, {0.4, 0}, {0, 2}, {}};  // e = .6 from its periapsis

// ---- errors

/// Errors has the largest errors of a run: at the ends of its steps, between them, and at the time it was to reach.
struct Errors {
  double steps = 0, reached = 0, between = 0;
  int count = 0;
};
template <class Scheme, class P, class X, class Truth>
Errors errors_of(const Scheme& scheme, const P& problem, const X& start, double span, Truth&& truth) {
  auto x = start, before = start;
  auto stepper = scheme.bind(problem, x);
  Errors errors;
  EXPECT_TRUE(past(stepper, x, start.t + span, [&](const X& y) {
    if (++errors.count < 100 || errors.count % 16 == 0) {
      if constexpr (stepper.has_dense)
        for (const double part : {0.2, 0.5, 0.9}) {
          auto z = y;
          const double t = before.t + part * (y.t - before.t);
          EXPECT_TRUE(stepper.interpolate(z, t));
          errors.between = larger(errors.between, state_error(z, truth(t)));
        }
      errors.steps = larger(errors.steps, state_error(y, truth(y.t)));
    }
    if (y.t < start.t + span) before = y;
  }));
  auto last = scheme.bind(problem, before);
  EXPECT_EQ(last.reach(before, start.t + span), StepStatus::ok);
  EXPECT_EQ(before.t, start.t + span);
  errors.reached = state_error(before, truth(before.t));
  return errors;
}
/// The errors fall with the tolerance, and are at most `loss` times it.
template <class P, class X, class Truth>
void error_follows_tolerance(const P& problem, const X& start, double span, double loss, Truth&& truth) {
  std::array<double, 3> before{1e9, 1e9, 1e9};
  for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10, 1e-12}) {
    std::size_t k = 0;
    for_each_scheme(tolerance, [&](const auto& scheme) {
      const auto errors = errors_of(scheme, problem, start, span, truth);
      const auto what = testing::Message() << scheme.card().id << ' ' << tolerance;
      EXPECT_LT(errors.steps, loss * tolerance + 1e-13 * loss) << what;
      EXPECT_LT(errors.steps, 0.3 * before[k]) << what;
      EXPECT_LT(errors.reached, 1.5 * errors.steps + tolerance) << what;
      EXPECT_LT(errors.between, 2 * errors.steps + 50 * tolerance) << what;
      before[k++] = errors.steps;
    });
  }
}

/// by_extrapolation() returns a function that gives the true state by a run in quad precision; the run begins anew
/// where a time is earlier than the one before it.
template <class P>
auto by_extrapolation(const P& problem, const StateOf<P>& start) {
  const auto begin = [&problem, start] { return Extrapolation<P>(problem, convert<Quad, Quad>(start), 1e-18); };
  return [begin, run = std::optional(begin())](double t) mutable {
    if (Quad(t) < run->state().t) run.emplace(begin());
    EXPECT_TRUE(run->advance(Quad(t), [] { return true; }));
    return convert<double, double>(run->state());
  };
}

TEST(Odeint, KeplerErrorFollowsTheTolerance) {
  const Kepler<> kepler;
  error_follows_tolerance(kepler, ellipse, 20, 2e4, [&](double t) { return kepler.exact(ellipse, t); });
}
TEST(Odeint, DampedOscillatorErrorFollowsTheTolerance) {
  const DampedOscillator<> problem;
  const State<1> start{0, {-0.25}, {0.75}, {}};
  error_follows_tolerance(problem, start, 20, 50, [&](double t) { return problem.exact(start, t); });
}
TEST(Odeint, TimeIsAbsolute) {
  const DrivenOscillator<> problem;
  const State<1> start{5, {1}, {0}, {}};
  error_follows_tolerance(problem, start, 20, 500, [&](double t) { return problem.exact(start, t); });
}
TEST(Odeint, LorenzErrorFollowsTheTolerance) {
  const Lorenz<> problem;
  const Point<3> start{0, {1, 1, 1}};
  error_follows_tolerance(problem, start, 2, 5e3, by_extrapolation(problem, start));
}
TEST(Odeint, CosmologicalOscillatorErrorFollowsTheTolerance) {
  const CosmologicalOscillator<> problem;
  const StateOf<CosmologicalOscillator<>> start{0, {0.5}, {0.3}, {-1}};
  error_follows_tolerance(problem, start, 5, 500, by_extrapolation(problem, start));
}

// A tangent vector that begins as the flow's own field stays the field; a transversal one is compared with Runge–Kutta.
TEST(Odeint, CarriesATangentDirection) {
  const VanDerPol<> problem;
  const Point<2> start{0, {2, 0.5}};
  Point<2, Slope> along, across;
  for (std::size_t i = 0; i < 2; ++i) {
    along[i] = {start[i], {derivative(problem, start)[i]}};
    across[i] = {start[i], {i == 0 ? 1.0 : -0.5}};
  }
  auto truth = across;
  auto fine = RungeKutta4{}.bind(problem, truth);
  for (int k = 0; k < 30'000; ++k) fine.step(truth, 1e-4);
  for_each_scheme(1e-10, [&](const auto& scheme) {
    auto x = along, y = across;
    auto stepper = scheme.bind(problem, x), other = scheme.bind(problem, y);
    ASSERT_TRUE(past(other, y, 2.0, [](const auto&) {}));
    EXPECT_TRUE(stepper.reach(x, 3) == StepStatus::ok && other.reach(y, 3) == StepStatus::ok);
    const auto rate = derivative(problem, plain(x));
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(x[i].slope[0], rate[i], 1e-7) << scheme.card().id;
      EXPECT_NEAR(y[i].value, truth[i].value, 1e-7) << scheme.card().id;
      EXPECT_NEAR(y[i].slope[0], truth[i].slope[0], 1e-7) << scheme.card().id;
    }
    auto z = across;
    auto again = scheme.bind(problem, z);
    ASSERT_TRUE(past(again, z, 2.0, [&](const auto&) { normalise(z); }));  // as drivers do
    EXPECT_EQ(again.reach(z, 3), StepStatus::ok);
    EXPECT_NEAR(z[1].slope[0] / z[0].slope[0], truth[1].slope[0] / truth[0].slope[0], 1e-6) << scheme.card().id;
  });
}

// ---- what it costs, and copies

/// Counted is a flow that counts its evaluations, and may return NaN once.
struct Counted {
  static constexpr int dim = 1;
  static inline std::int64_t calls = 0, fails_at = 0;
  template <class T, class S>
  Vec<1, T> field(const Vec<1, T>& y, const S& t) const {
    return {++calls == fails_at ? T(unknown) : -y[0] * (1.0 + t)};
  }
};
TEST(Odeint, CountsEveryEvaluation) {
  for_each_scheme(1e-9, [](const auto& scheme) {
    Point<1> x{0, {1}};
    auto stepper = scheme.bind(Counted{}, x);
    Counted::calls = 0;
    const auto agrees = [&] { EXPECT_EQ(stepper.work().forces, Counted::calls) << scheme.card().id; };
    ASSERT_EQ(steps(stepper, x, 20, [&](const auto&) { agrees(); }), 20);
    EXPECT_GT(Counted::calls, 20 * 5);
    const auto copy = stepper;
    x.y[0] *= 2;  // not where the last step ended
    ASSERT_EQ(stepper.step(x), StepStatus::ok);
    agrees();
    ASSERT_EQ(stepper.reach(x, x.t + 0.5), StepStatus::ok);
    agrees();
    const double t = x.t + 1e-9;
    ASSERT_TRUE(stepper.reach(x, t) == StepStatus::ok && stepper.step(x) == StepStatus::ok);
    EXPECT_GT(x.t, t + 1e-4);  // the short way does not shorten the next step
    EXPECT_LT(copy.work().forces, stepper.work().forces);
    x.y[0] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(stepper.step(x), StepStatus::singular);
    agrees();
  });
  // First same as last: six evaluations a trial, after one for the start and two for the length of the first step.
  Point<1> x{0, {1}};
  auto stepper = DormandPrince5{1e-3}.bind(Counted{}, x);
  ASSERT_EQ(steps(stepper, x, 5), 5);
  EXPECT_EQ(stepper.work().forces % 6, 3);
  x.y[0] *= 0.5;  // a state that was changed costs one more
  ASSERT_EQ(stepper.step(x), StepStatus::ok);
  EXPECT_EQ(stepper.work().forces % 6, 4);
}

// Odeint takes NaN for no error at all, and nothing else in a step uses its last evaluation.
TEST(Odeint, StepsEndWhereTheFieldIsKnown) {
  for_each_scheme(1e-6, [](const auto& scheme) {
    Point<1> x{0, {1}}, y = x;
    auto one = scheme.bind(Counted{}, x), other = scheme.bind(Counted{}, y);  // both evaluate the field
    Counted::calls = 0;
    ASSERT_EQ(one.step(x), StepStatus::ok);
    Counted::fails_at = Counted::calls;
    Counted::calls = 0;
    ASSERT_EQ(other.step(y), StepStatus::ok);
    EXPECT_LT(y.t, 0.5 * x.t) << scheme.card().id;
    Counted::fails_at = 0;
  });
}

TEST(Odeint, CopiesGoOnWithTheSameBits) {
  for_each_scheme(1e-9, [](const auto& scheme) {
    State<2> x{0, {0.5, 0}, {0, 2}, {}};
    using Stepper = SelfTimedStepperOf<std::remove_cvref_t<decltype(scheme)>, Kepler<>, State<2>>;
    auto stepper = std::make_unique<Stepper>(scheme.bind(Kepler<>{1.5}, x));
    ASSERT_EQ(steps(*stepper, x, 9), 9);
    auto copy = *stepper;
    auto assigned = scheme.bind(Kepler<>{7}, x);
    assigned = copy;
    std::vector<State<2>> orbit;
    auto y = x, z = x;
    if constexpr (Stepper::has_dense) {
      ASSERT_TRUE(copy.interpolate(y, x.t - 1e-3) && assigned.interpolate(z, x.t - 1e-3));
      EXPECT_TRUE(same(y, z));
      y = z = x;
    }
    ASSERT_EQ(steps(*stepper, x, 30, [&](const auto& now) { orbit.push_back(now); }), 30);
    stepper.reset();  // a copy does not depend on the original
    for (const auto& now : orbit) {
      ASSERT_TRUE(copy.step(y) == StepStatus::ok && assigned.step(z) == StepStatus::ok);
      ASSERT_TRUE(same(y, now) && same(z, now)) << scheme.card().id;
    }
  });
}

TEST(Odeint, InterpolatesWithinTheLastStepOnly) {
  State<1> x{0, {1}, {0}, {}}, y;
  auto stepper = DormandPrince5{}.bind(DampedOscillator<>{}, x);
  EXPECT_FALSE(stepper.interpolate(y, 0));
  ASSERT_EQ(steps(stepper, x, 3), 3);
  const double start = x.t;
  ASSERT_EQ(stepper.step(x), StepStatus::ok);
  EXPECT_FALSE(stepper.interpolate(y, start - 1e-9) || stepper.interpolate(y, x.t + 1e-9));
  ASSERT_TRUE(stepper.interpolate(y, x.t));
  EXPECT_LT(clocks::distance(x, y), 1e-14);
  auto bad = x;
  bad.p[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(stepper.step(bad), StepStatus::singular);
  EXPECT_FALSE(stepper.interpolate(y, x.t));   // its memory of the good step is gone
  EXPECT_EQ(stepper.step(x), StepStatus::ok);  // and it goes on
  EXPECT_TRUE(stepper.interpolate(y, x.t));
}

// ---- where there is no going on

/// end_of() makes steps until one fails. It returns that status and the state before the step, which has to be
/// unchanged.
template <class Scheme, class P, class X>
std::pair<StepStatus, X> end_of(const Scheme& scheme, const P& problem, X x, std::int64_t most_forces = 200'000) {
  auto stepper = scheme.bind(problem, x);
  for (;;) {
    const auto before = x;
    if (const StepStatus status = stepper.step(x); status != StepStatus::ok) {
      EXPECT_TRUE(same(x, before)) << scheme.card().id;
      EXPECT_LT(stepper.work().forces, most_forces) << scheme.card().id;
      return {status, x};
    }
    for (std::size_t i = 0; i < X::size; ++i) EXPECT_TRUE(std::isfinite(x[i])) << scheme.card().id;
    EXPECT_GT(x.t, before.t);
    if (!(stepper.work().forces < most_forces)) return {StepStatus::ok, x};
  }
}

TEST(Odeint, StopsAtOnceWhereThereIsNoForce) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for_each_scheme(1e-8, [&](const auto& scheme) {
    for (const State<2>& x : {State<2>{0, {0, 0}, {0, 1}, {}}, State<2>{0, {1, 0}, {nan, 1}, {}},
                              State<2>{0, {infinity, 0}, {0, 1}, {}}, State<2>{nan, {1, 0}, {0, 1}, {}}})
      EXPECT_EQ(end_of(scheme, Kepler<>{}, x, 100).first, StepStatus::singular);
  });
}
TEST(Odeint, BlowUpEndsWithItsTime) {
  for (const double tolerance : {1e-3, 1e-8, 1e-13})
    for_each_scheme(tolerance, [&](const auto& scheme) {
      const StateOf<CosmologicalOscillator<>> start{0, {0}, {0}, {-2}};
      const auto [status, x] = end_of(scheme, CosmologicalOscillator<>{}, start);
      EXPECT_NE(status, StepStatus::ok) << scheme.card().id;
      EXPECT_NEAR(x.t, 1.24645048028, 1e-9 + 10 * tolerance) << scheme.card().id << ' ' << tolerance;
    });
}
TEST(Odeint, CollisionEnds) {
  for_each_scheme(1e-8, [&](const auto& scheme) {
    const auto [status, x] = end_of(scheme, Kepler<>{}, State<2>{0, {1, 0}, {0, 0}, {}}, 1'000'000);
    EXPECT_NE(status, StepStatus::ok) << scheme.card().id;
    EXPECT_NEAR(x.t, std::acos(-1.0) / std::sqrt(8.0), 1e-7) << scheme.card().id;
  });
}

/// Edge falls through y = 0, where the field ends.
struct Edge {
  static constexpr int dim = 1;
  template <class T, class S>
  Vec<1, T> field(const Vec<1, T>& y, const S&) const {
    using least::sqrt;
    return {-1.0 - sqrt(y[0])};
  }
};
TEST(Odeint, EndsAtTheEdgeOfTheField) {
  for (const double tolerance : {1e-2, 1e-5, 1e-10})
    for_each_scheme(tolerance, [&](const auto& scheme) {
      const auto [status, x] = end_of(scheme, Edge{}, Point<1>{0, {1}});
      EXPECT_EQ(status, StepStatus::singular) << scheme.card().id;
      EXPECT_GE(x.y[0], 0);
      EXPECT_LT(x.y[0], 1e-12) << scheme.card().id << ' ' << tolerance;
      EXPECT_NEAR(x.t, 2 - 2 * std::log(2.0), 100 * tolerance) << scheme.card().id << ' ' << tolerance;
    });
}

TEST(Odeint, RestIsNoTrouble) {
  for_each_scheme(1e-8, [](const auto& scheme) {
    State<1> x{0, {0}, {0}, {}};
    auto stepper = scheme.bind(DampedOscillator<>{}, x);
    EXPECT_TRUE(past(stepper, x, 1e3, [](const auto& y) { EXPECT_EQ(y.q[0], 0); }));
  });
}

}  // namespace
