// Time-transformed steps on damped orbits: accuracy for a number of forces, laws of decay, long runs, and where they
// end.
#include "core/problems/damped_kepler.hpp"
#include "core/problems/perturbed_kepler.hpp"
#include "core/reference/reference.hpp"
#include "core/schemes/contact_splitting.hpp"
#include "core/schemes/time_transformed.hpp"
#include "core/study/study.hpp"
#include "tests/support/clocks.hpp"
#include "tests/support/runs.hpp"

namespace {

using namespace least;
using namespace least::problems;
using namespace clocks;

const double follows_energy = std::numeric_limits<double>::quiet_NaN();  // κ = −E₀
const State<2> eccentric{0, {0.1, 0}, {0, std::sqrt(19.0)}, {}};         // e = 0.9, a = 1
const State<2> sharp{0, {0.039, 0}, {0, std::sqrt(1.961 / 0.039)}, {}};  // e = 0.961, a = 1
const State<2> moderate{0, {0.5, 0}, {0, std::sqrt(3.0)}, {}};           // e = 0.5, a = 1

struct Bought {
  std::int64_t forces = 0;
  double error = 0;  ///< max |q − q(t)| over steps, every `stride`-th
};
template <class P, class Stepper>
Bought bought(const P& problem, const State<2>& start, double span, Stepper stepper, int stride) {
  Extrapolation<P, State<2, Quad, Quad>> truth(problem, convert<Quad, Quad>(start), 1e-16);
  auto x = start;
  Bought all;
  int n = 0;
  EXPECT_TRUE(past(stepper, x, start.t + span, [&](const State<2>& y) {
    if (++n % stride != 0) return;
    ASSERT_TRUE(truth.advance(Quad(y.t), [] { return true; }));
    const auto& q = truth.state().q;
    all.error = larger(all.error, std::hypot(double(y.q[0] - q[0]), double(y.q[1] - q[1])));
  }));
  all.forces = stepper.work().forces;
  return all;
}

// METHODS, section 3c. The numbers with α(t) and Kahan and Li's weights are our own: see ContactIsWorthItsEquation.
TEST(TimeTransformedDrag, AnEvaluationBuysWhatIsPublished) {
  struct Row {
    Composition composition;
    double sigma;
    std::int64_t forces;
    double error;
  };
  using C = Composition;
  const auto check = [](const auto& problem, const State<2>& start, double span, std::initializer_list<Row> rows) {
    for (const Row& row : rows) {
      const auto found = bought(problem, start, span,
                                bound(TimeTransformed{row.sigma, follows_energy, row.composition}, problem, start),
                                row.composition == C::none ? 11 : 1);
      const std::string what = std::string(compositions::names[std::size_t(row.composition)]) + ' ' +
                               std::to_string(found.forces) + " -> " + std::to_string(found.error * 1e9) + "e-9";
      EXPECT_NEAR(double(found.forces), double(row.forces), 0.01 * double(row.forces)) << what;
      EXPECT_LT(found.error, 1.2 * row.error) << what;
      EXPECT_GT(found.error, 0.6 * row.error) << what;
    }
  };
  check(DampedKepler<>{1, 0.002}, eccentric, 60,
        {{C::none, 0.0075, 12830, 3.7e-4},
         {C::suzuki_4, 0.0375, 12830, 1.4e-7},
         {C::kahan_li_6, 0.135, 6417, 1.2e-7},
         {C::kahan_li_6, 0.0675, 12834, 2.3e-9}});
  check(DampedKepler<>{1, 0.001}, sharp, 60,
        {{C::none, 0.0075, 13413, 4.6e-4},
         {C::suzuki_4, 0.0375, 13415, 2.5e-7},
         {C::kahan_li_6, 0.135, 6714, 2.0e-7},
         {C::kahan_li_6, 0.0675, 13419, 4.8e-9}});
  check(PerturbedKepler<>{}, moderate, 50,
        {{C::none, 0.015, 3693, 1.1e-3},
         {C::suzuki_4, 0.075, 3695, 1.9e-7},
         {C::kahan_li_6, 0.135, 3699, 1.7e-8},
         {C::kahan_li_8, 0.255, 3706, 2.7e-9}});
  check(PerturbedKepler<>{}, eccentric, 50,
        {{C::none, 0.015, 4688, 1.3e-3},
         {C::suzuki_4, 0.075, 4690, 2.0e-6},
         {C::kahan_li_6, 0.135, 4689, 1.5e-7},
         {C::kahan_li_8, 0.255, 4692, 1.9e-7},
         {C::kahan_li_8, 0.1275, 9384, 1.3e-10}});
}

/// HeldDamping is the scheme that METHODS measured there: it takes α(t) for constant over a part, α(t + Δt/2), with Δt
/// by iteration. It is symmetric, but no contact map. k = −½, κ = −E₀.
class HeldDamping {
 public:
  HeldDamping(const PerturbedKepler<>& problem, const State<2>& start, double sigma, Composition composition)
      : problem_(problem),
        sigma_(sigma),
        weights_(Weights<double>::of(composition)),
        a_(-problem.potential(start.q, start.t)) {}
  StepStatus step(State<2>& x) {
    for (int i = 0; i < weights_.stages; ++i) {
      const double tau = sigma_ * weights_.gamma[std::size_t(i)];
      flow(x, tau / 2);
      const double b = -problem_.potential(x.q, x.t), push = tau * std::pow(b, -1.5), before = dot(x.p, x.p);
      const auto gradient = problem_.gradient(x.q, x.t);
      for (std::size_t k = 0; k < 2; ++k) x.p[k] -= push * gradient[k];
      a_ += 0.5 * (dot(x.p, x.p) - before) - 2 * problem_.damping(x.t) * push * b;
      ++work_.forces;
      flow(x, tau / 2);
    }
    return StepStatus::ok;
  }
  const Work& work() const { return work_; }

 private:
  void flow(State<2>& x, double tau) {
    const double r = tau * std::pow(a_, -1.5);
    double wait = r, alpha = 0, z = 0;
    for (int i = 0; i < 30; ++i) {
      alpha = problem_.damping(x.t + wait / 2);
      z = -3 * alpha * r;
      wait = z == 0 ? r : -r * std::log1p(-z) / z;
    }
    for (std::size_t k = 0; k < 2; ++k) {
      x.q[k] += wait * phi1(-alpha * wait) * x.p[k];
      x.p[k] *= std::exp(-alpha * wait);
    }
    x.t += wait;
    a_ *= std::exp(std::log1p(-z) / 1.5);
  }

  PerturbedKepler<> problem_;
  double sigma_;
  const Weights<double>& weights_;
  double a_;
  Work work_;
};
// With α(t) the contact map has the smaller errors wherever both follow their order, and keeps what the other loses.
TEST(TimeTransformedDrag, ContactIsWorthItsEquation) {
  struct Row {
    const State<2>& start;
    Composition composition;
    double sigma, published;  ///< 0: not in METHODS
    double ratio;             ///< upper bound of our error over the other's
  };
  using C = Composition;
  const PerturbedKepler<> problem;
  for (const Row& row : {Row{moderate, C::kahan_li_6, 0.135, 2.1e-8, 0.85},
                         {moderate, C::kahan_li_8, 0.255, 3.1e-9, 0.95},
                         {moderate, C::kahan_li_8, 0.18, 0, 0.92},
                         {eccentric, C::kahan_li_6, 0.135, 1.9e-7, 0.82},
                         {eccentric, C::kahan_li_8, 0.18, 0, 0.92},
                         // Too long for their order: neither error is proportional to σ⁸ any more, and which is smaller
                         // is chance.
                         {eccentric, C::kahan_li_8, 0.255, 6.6e-8, 3.5}}) {
    const auto ours = bought(problem, row.start, 50,
                             bound(TimeTransformed{row.sigma, follows_energy, row.composition}, problem, row.start), 1);
    const auto other = bought(problem, row.start, 50, HeldDamping(problem, row.start, row.sigma, row.composition), 1);
    const std::string what = std::to_string(ours.error * 1e9) + "e-9 for " + std::to_string(other.error * 1e9) + "e-9";
    EXPECT_EQ(ours.forces, other.forces);
    if (row.published > 0) {
      EXPECT_NEAR(other.error / row.published, 1, 0.05) << what;
    }
    EXPECT_LT(ours.error, row.ratio * other.error) << what;
  }
  const auto loss = [&](auto stepper) {
    auto x = eccentric;
    double most = 0;
    EXPECT_TRUE(past(stepper, x, 50, [&](const State<2>& y) {
      const double l = (y.q[0] * y.p[1] - y.q[1] * y.p[0]) * std::exp(problem.damping_integral(y.t));
      most = larger(most, std::abs(l / std::sqrt(0.19) - 1));
    }));
    return most;
  };
  EXPECT_LT(loss(bound(TimeTransformed{0.135, follows_energy, C::kahan_li_6}, problem, eccentric)), 1e-13);
  EXPECT_GT(loss(HeldDamping(problem, eccentric, 0.135, C::kahan_li_6)), 1e-9);
}

// The maps scale p, push it along q, and move q along p: q × p is multiplied by the factor e^{−αΔt} only.
TEST(TimeTransformedDrag, AngularMomentumDecaysAsItShould) {
  for (const double alpha : {0.002, 0.3, -0.005})
    for (const auto composition : {Composition::none, Composition::kahan_li_8}) {
      const DampedKepler<> problem{1, alpha};
      const auto first = problem.invariants(moderate.q, moderate.p, 0.0)[0];
      auto x = moderate;
      auto stepper = bound(TimeTransformed{0.05, follows_energy, composition}, problem, x);
      double most = 0;
      EXPECT_EQ(steps(stepper, x, 300,
                      [&](const State<2>& y) {
                        most = larger(most, std::abs(problem.invariants(y.q, y.p, y.t)[0] / first - 1));
                      }),
                300)
          << alpha;
      EXPECT_LT(most, 1e-13) << alpha;
    }
  // With α(t), as accurately as e^∫α.
  const PerturbedKepler<> swept{-1, 0.3};
  auto x = moderate;
  auto stepper = bound(TimeTransformed{0.05, follows_energy, Composition::kahan_li_6}, swept, x);
  EXPECT_EQ(steps(stepper, x, 300,
                  [&](const State<2>& y) {
                    const double l = (y.q[0] * y.p[1] - y.q[1] * y.p[0]) * std::exp(swept.damping_integral(y.t));
                    EXPECT_NEAR(l / std::sqrt(0.75), 1, 1e-12);
                  }),
            300);
}

// H e^{αt} is constant on the true motion; its error is that of s, which grows with time.
TEST(TimeTransformedDrag, EnergyDecaysAsItShould) {
  const DampedKepler<> problem{1, 0.01};
  FullStateOf<DampedKepler<>> x{0, moderate.q, moderate.p, {0.3}};
  const double first = energy(problem, x);
  double early = 0, late = 0;
  auto stepper = bound(TimeTransformed{0.2, follows_energy, Composition::kahan_li_6}, problem, x);
  EXPECT_TRUE(past(stepper, x, 100, [&](const auto& y) {
    double& most = y.t < 10 ? early : late;
    most = larger(most, std::abs(energy(problem, y) * std::exp(0.01 * y.t) / first - 1));
  }));
  EXPECT_LT(early, 1e-6);
  EXPECT_LT(late, 20 * early);
}

/// Drift has the errors of the revolution after a number of them: in position, and in the elements at its end.
struct Drift {
  double error = 0, axis = 0, eccentricity = 0, periapsis = 0;
};
template <std::size_t N>
std::array<Drift, N> drifts(double alpha, double sigma, const std::array<int, N>& revolutions) {
  const double turn = 2 * std::acos(-1.0);
  const DampedKepler<> problem{1, alpha};
  const auto elements = [](const State<2>& x) {
    const double r = std::hypot(x.q[0], x.q[1]), pp = dot(x.p, x.p), qp = dot(x.q, x.p);
    const double ex = (pp - 1 / r) * x.q[0] - qp * x.p[0], ey = (pp - 1 / r) * x.q[1] - qp * x.p[1];
    return std::array{1 / (2 / r - pp), std::hypot(ex, ey), std::atan2(ey, ex)};
  };
  Extrapolation<DampedKepler<>, State<2, Quad, Quad>> truth(problem, convert<Quad, Quad>(moderate), 1e-16);
  auto x = moderate;
  auto stepper = bound(TimeTransformed{sigma, follows_energy, Composition::kahan_li_8}, problem, x);
  std::array<Drift, N> all;
  for (std::size_t i = 0; i < N; ++i) {
    Drift& now = all[i];
    EXPECT_TRUE(past(stepper, x, revolutions[i] * turn, [](const State<2>&) {}));
    EXPECT_TRUE(past(stepper, x, (revolutions[i] + 1) * turn, [&](const State<2>& y) {
      EXPECT_TRUE(truth.advance(Quad(y.t), [] { return true; }));
      now.error = larger(now.error, distance(y, truth.state()));
    }));
    const auto is = elements(x), should = elements(convert<double, double>(truth.state()));
    now.axis = is[0] - should[0], now.eccentricity = is[1] - should[1], now.periapsis = is[2] - should[2];
  }
  return all;
}
// 300 revolutions under a weak drag (the benchmark prints 1e4). The error along the orbit grows linearly. Axis and
// eccentricity drift by the drag only. The periapsis has a drift that is the scheme's own: the same without drag, the
// same in every revolution, and proportional to σ⁸, 1.8e-10 a revolution at σ = 0.3.
TEST(TimeTransformedDrag, LongRunsDriftByTheDragAlone) {
  constexpr std::array at{75, 150, 300};
  const auto coarse = drifts(1e-6, 0.45, at), fine = drifts(1e-6, 0.3, at), free = drifts(0, 0.3, at);
  for (const auto& run : {coarse, fine, free})
    for (std::size_t i = 0; i < at.size(); ++i) {
      EXPECT_NEAR(run[i].error / run[0].error / (at[i] / 75.0), 1, 0.1) << i;
      EXPECT_NEAR(run[i].periapsis / run[0].periapsis / (at[i] / 75.0), 1, 0.02) << i;
    }
  for (std::size_t i = 0; i < at.size(); ++i) {
    EXPECT_NEAR(std::log(coarse[i].periapsis / fine[i].periapsis) / std::log(1.5), 8, 0.1) << i;
    EXPECT_NEAR(fine[i].periapsis / free[i].periapsis, 1, 0.01) << i;
    EXPECT_NEAR(fine[i].periapsis / at[i], -1.8e-10, 0.1e-10) << i;
    EXPECT_LT(fine[i].error, 3e-10 * at[i]) << i;
    EXPECT_LT(std::abs(fine[i].axis), 1e-10) << i;
    EXPECT_LT(std::abs(fine[i].eccentricity), 1e-10) << i;
  }
}

// ---- runs

Request asked(std::string_view problem, double sigma) {
  Request request = runs::defaults(problem, "time_transformed");
  runs::set(request, "sigma", sigma);
  return request;
}
std::string detail_of(const Request& request, ReturnCode reason) {
  const auto outcome = runs::go(request).outcome;
  EXPECT_EQ(outcome.stop.reason, reason) << outcome.stop.detail;
  return outcome.stop.detail.text();
}
const auto has = [](const std::string& text, std::string_view words) { return text.find(words) != std::string::npos; };

TEST(TimeTransformedDrag, SaysWhichThresholdWouldDo) {
  // V = 2 at the far side of the start: E₀ − V + κ falls to 0 where V = E₀ + κ.
  Request request = asked("driven_oscillator", 0.1);
  runs::set(request, "kappa", 0.2);
  const std::string why = detail_of(request, ReturnCode::singular);
  EXPECT_TRUE(has(why, "E₀ − V + κ") && has(why, "κ = 0.2 has to be more than")) << why;
  runs::set(request, "kappa", 5);
  EXPECT_EQ(detail_of(request, ReturnCode::completed), "");
}
TEST(TimeTransformedDrag, StopsAtThePoleOfStrongDriving) {
  Request request = asked("damped_oscillator", 10);
  runs::set(request, "damping", -3);
  const std::string why = detail_of(request, ReturnCode::singular);
  EXPECT_TRUE(has(why, "pole")) << why;
  runs::set(request, "damping", 3);
  runs::set(request, "sigma", 0.1);
  detail_of(request, ReturnCode::completed);
}
TEST(TimeTransformedDrag, StopsWhereTimeStandsStill) {
  Request request = asked("damped_kepler", 1e-300);
  runs::set(request, "kappa", 1e30);
  const std::string why = detail_of(request, ReturnCode::singular);
  EXPECT_TRUE(has(why, "time does not advance")) << why;
}
TEST(TimeTransformedDrag, LaneEmdenBeginsAtTheEndOfItsSeries) {
  Request request = asked("lane_emden", 0.005);
  runs::set(request, "composition", "kahan_li_6");
  runs::ask(request, "zeros");
  const auto result = runs::go(request);
  EXPECT_EQ(result.outcome.stop.reason, ReturnCode::left_domain);
  EXPECT_NEAR(*result.outcome.stop.singular_at, 6.896848619376960, 1e-8);  // the surface of n = 3
  EXPECT_NEAR(runs::list(result.outcome.diagnostics, "zeros").at(0), 6.896848619376960, 1e-8);
  EXPECT_EQ(result.rows[1][0], 0.1);
  runs::begin(request, "q", 0.7);
  const std::string why = detail_of(request, ReturnCode::singular);
  EXPECT_TRUE(has(why, "not finite at the start")) << why;
}
// `until`, samples and the end of a run lie within steps and are as accurate as the ends of steps.
TEST(TimeTransformedDrag, AnyTimeIsAsAccurateAsSteps) {
  for (const std::string_view problem : {"damped_kepler", "perturbed_kepler", "driven_oscillator"}) {
    Request request = asked(problem, 0.2);
    runs::set(request, "composition", "sofroniou_spaletta_10");
    runs::ask(request, "error");
    runs::at_times(request, {1.1, 3.3, 5.7, 8.01});
    const auto result = runs::go(request);
    ASSERT_EQ(result.outcome.stop.reason, ReturnCode::completed) << problem;
    EXPECT_EQ(result.rows.size(), 4U);
    EXPECT_EQ(result.outcome.t, 8.01);
    EXPECT_LT(runs::number(result.outcome.diagnostics, "error/final"), 1e-11) << problem;
    const auto known = least::truth(*request.scene, {1.1, 3.3, 5.7}, [] { return true; });
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_NEAR(result.rows[i][1], known->states[i][0], 1e-10) << problem << ' ' << i;
    EXPECT_EQ(result.rows[3][1], result.outcome.final[0]);
  }
}
TEST(TimeTransformedDrag, WarnsOffTheLevel) {
  Request request = asked("damped_kepler", 2.5);
  const auto result = runs::go(request);
  EXPECT_TRUE(result.outcome.stop.reason == ReturnCode::singular ||
              std::ranges::any_of(result.outcome.warnings,
                                  [](const Warning& warning) { return warning.code == "off_energy_level"; }));
}

}  // namespace
