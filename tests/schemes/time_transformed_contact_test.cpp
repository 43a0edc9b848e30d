// Time-transformed steps with damping: the maps against their formulas, the contact form on the extended space,
// symmetry, order by composition, and equality with and without s.
#include <cstring>

#include "core/number/linear.hpp"
#include "core/problems/damped_kepler.hpp"
#include "core/problems/damped_oscillator.hpp"
#include "core/problems/driven_oscillator.hpp"
#include "core/problems/lane_emden.hpp"
#include "core/problems/modulated_oscillator.hpp"
#include "core/problems/perturbed_kepler.hpp"
#include "core/problems/spin_orbit.hpp"
#include "core/reference/reference.hpp"
#include "core/schemes/time_transformed.hpp"
#include "tests/support/clocks.hpp"
#include "tests/support/tangents.hpp"

namespace {

using namespace least;
using namespace least::problems;
using namespace clocks;

constexpr std::array all_compositions{
    Composition::none,           Composition::yoshida_4,  Composition::suzuki_4,
    Composition::yoshida_6,      Composition::kahan_li_6, Composition::yoshida_8,
    Composition::suzuki_umeno_8, Composition::kahan_li_8, Composition::sofroniou_spaletta_10};
const char* called(const Composition& c) { return compositions::names[std::size_t(c)].data(); }

/// Swept has a damping α(t) without a closed integral, and a force that changes in time.
template <class R = double>
struct Swept {
  R strength{0.4};
  static constexpr int dof = 2;
  template <class T, class S>
  constexpr T potential(const Vec<2, T>& q, const S& t) const {
    using least::sin;
    return 0.5 * dot(q, q) + 0.2 * sin(1.3 * t) * q[0] * q[1];
  }
  template <class S>
  constexpr auto damping(const S& t) const {
    using least::sin;
    return strength * sin(2.0 * t) + 0.1 * t;
  }
  Vec<2> inverse_mass() const { return {0.5, 2}; }
};
static_assert(SelfTimedSchemeFor<TimeTransformed, DampedKepler<>> && SelfTimedSchemeFor<TimeTransformed, Swept<>>);
static_assert(!HasDampingIntegral<Swept<>> && HasDampingIntegral<PerturbedKepler<>> && PotentialReadsTime<Swept<>> &&
              !PotentialReadsTime<PerturbedKepler<>>);

template <class P>
using Acting = FullStateOf<P>;

const Acting<DampedKepler<>> ellipse{0, {0.9, 0.2}, {-0.3, 1.1}, {0.4}};
/// for_each_scene() calls f(problem, start, name) for scenes of each kind: constant damping and not, V that changes in
/// time, α < 0, no damping.
template <class F>
void for_each_scene(F&& f) {
  f(DampedKepler<>{1, 0.03}, ellipse, "damped_kepler");
  f(DampedKepler<>{1, -0.03}, ellipse, "driven");
  f(DampedKepler<>{1, 0}, ellipse, "free");
  f(DampedOscillator<>{1, 2}, Acting<DampedOscillator<>>{0, {0.4}, {0.7}, {0.2}}, "damped_oscillator");
  f(DrivenOscillator<>{}, Acting<DrivenOscillator<>>{0.3, {0.4}, {0.7}, {0.2}}, "driven_oscillator");
  f(PerturbedKepler<>{-1, 0.2}, Acting<PerturbedKepler<>>{0.3, {0.9, 0.2}, {-0.3, 1.1}, {0.4}}, "perturbed_kepler");
  f(PerturbedKepler<>{-1, 0.2, 0}, Acting<PerturbedKepler<>>{0.3, {0.9, 0.2}, {-0.3, 1.1}, {0.4}}, "no frequency");
  f(ModulatedOscillator<>{}, Acting<ModulatedOscillator<>>{0.3, {0.4}, {0.7}, {7}}, "modulated_oscillator");
  f(LaneEmden<>{}, Acting<LaneEmden<>>{2, {0.6}, {-0.25}, {0.1}}, "lane_emden");
  f(SpinOrbit<>{0.06, 0.045, 0.2, 1.4, 0.01, 0.02}, Acting<SpinOrbit<>>{0.3, {0.4}, {1.1}, {0.4}}, "spin_orbit");
  f(Swept<>{}, Acting<Swept<>>{0.3, {0.9, 0.2}, {-0.3, 0.6}, {0.4}}, "swept");
}

// ---- the maps

// The formulas in the head of time_transformed_contact.hpp, here by logarithms and powers.
TEST(TimeTransformedContact, ConstantDampingIsTheExactFlowsOfBothParts) {
  for (const double alpha : {0.3, -0.2, 1e-3})
    for (const double k : {-0.5, -0.7, -2.0, -0.1}) {
      const DampedOscillator<> m{3, alpha};
      const double sigma = 0.4, kappa = 1.2;
      Acting<DampedOscillator<>> x{0, {0.5}, {0.8}, {0.3}};
      double q = x.q[0], p = x.p[0], s = x.action.s, t = 0;
      const double c = 0.5 * p * p + 1.5 * q * q + kappa;
      double pt = -(0.5 * p * p + 1.5 * q * q + alpha * s);
      auto stepper = bound(TimeTransformed{sigma, kappa, Composition::none, k}, m, x);
      for (int n = 0; n < 3; ++n) {
        const auto first = [&] {
          const double a0 = 0.5 * p * p + pt + alpha * s + c;
          const double a1 = a0 * std::pow(1 - alpha * (1 - k) * sigma / 2 / (k * std::pow(a0, 1 - k)), 1 / (1 - k));
          const double h = -k / alpha * std::log(a1 / a0), e = std::exp(-alpha * h), w = (1 - e) / alpha;
          s += p * p * (1 - e * e) / (2 * alpha) + pt * w - (a0 - a1) / alpha - 0;
          q += w * p;
          p *= e;
          pt *= e;
          t += h;
        };
        first();
        const double b = c - 1.5 * q * q, f = std::pow(b, k - 1);
        p -= sigma * f * 3 * q;
        s += sigma * f * b / k;
        first();
        ASSERT_EQ(stepper.step(x), StepStatus::ok);
        EXPECT_NEAR(x.q[0], q, 1e-12);
        EXPECT_NEAR(x.p[0], p, 1e-12);
        EXPECT_NEAR(x.t, t, 1e-12);
        EXPECT_NEAR(x.action.s, s, 1e-11) << alpha << ' ' << k;
      }
    }
}

// The series and the closed form agree where one takes over from the other.
TEST(TimeTransformedContact, SeriesMeetsTheClosedForm) {
  for (const double m : {0.0, -1.0 / 3, -2.0 / 3, 2.0 / 3, 0.5})
    for (const double z : {1.0 / 512, -1.0 / 512, 1e-4, -1e-9}) {
      const double closed = m == 0 ? -std::log1p(-z) / z : -std::expm1(m * std::log1p(-z)) / (m * z);
      EXPECT_NEAR((Series<double, 6>::power(m)(z, 1.0)), closed, 4e-16) << m << ' ' << z;
      const Quad wide = m == 0 ? -log(1 - Quad(z)) / z : (1 - pow(1 - Quad(z), Quad(m))) / (m * Quad(z));
      EXPECT_LT(abs((Series<Quad, 14>::power(Quad(m))(Quad(z), Quad(1))) - wide), Quad(1e-23)) << m << ' ' << z;
      EXPECT_NEAR((Series<double, 6>::exponential()(z, 1.0)), std::expm1(z) / z, 4e-16) << z;
      EXPECT_LT(abs((Series<Quad, 14>::exponential()(Quad(z), Quad(1))) - phi1(Quad(z))), Quad(1e-32)) << z;
    }
}

// The initial guess is of third order: a force has two parts, and each part takes little more than one iteration.
TEST(TimeTransformedContact, SolvesInFewIterations) {
  const auto iterations = [](const auto& problem, auto x, const TimeTransformed& scheme) {
    auto stepper = bound(scheme, problem, x);
    EXPECT_EQ(steps(stepper, x, 1000), 1000);
    return double(stepper.work().iterations) / double(stepper.work().forces);
  };
  const State<2> eccentric{0, {0.1, 0}, {0, std::sqrt(19.0)}, {}};
  EXPECT_LT(iterations(PerturbedKepler<>{}, eccentric, {0.015, 0.5}), 2.3);
  EXPECT_LT(iterations(LaneEmden<>{}, StateOf<LaneEmden<>>{0.5, {0.96}, {-0.16}, {}}, {0.002, 0.5}), 2.5);
}

// Without damping there is no logarithm: dt/dτ = (K + κ)ᵏ⁻¹, and the level is kept as by leapfrog for the power.
TEST(TimeTransformedContact, ZeroDampingIsLeapfrogForThePower) {
  const DampedOscillator<> m{1, 0};
  const double sigma = 0.3, kappa = 0.7;
  double q = 0.8, p = 0.5, t = 0;
  const double level = 0.5 * p * p + 0.5 * q * q;
  State<1> x{0, {q}, {p}, {}};
  auto stepper = bound(TimeTransformed{sigma, kappa}, m, x);
  for (int n = 0; n < 3; ++n) {
    const auto drift = [&] {
      const double h = sigma / 2 * std::pow(0.5 * p * p + kappa, -1.5);
      q += h * p;
      t += h;
    };
    drift();
    p -= sigma * std::pow(level - 0.5 * q * q + kappa, -1.5) * q;
    drift();
    ASSERT_EQ(stepper.step(x), StepStatus::ok);
    EXPECT_NEAR(x.q[0], q, 1e-15);
    EXPECT_NEAR(x.p[0], p, 1e-15);
    EXPECT_NEAR(x.t, t, 1e-15);
  }
}

// ---- structure

/// form() returns the contact defect, λ and det Dφ of a step on the extended space that begins with p_t = −H + off.
struct Form {
  double defect, factor, determinant;
};
template <class P, class X>
Form form(const P& problem, const X& x, const TimeTransformed& scheme, double off) {
  constexpr std::size_t n = P::dof;
  Extended<P> z;
  for (std::size_t i = 0; i < n; ++i) z.q[i] = x.q[i], z.p[i] = x.p[i];
  z.q[n] = x.t;
  z.p[n] = off - energy(problem, x);
  z.action = x.action;
  const double level = level_of(problem, x);
  const auto tangent = tangent_of(
      z, [] { return true; },
      [&](auto& y) {
        using D = typename std::remove_cvref_t<decltype(y)>::Number;
        return scheme.step_extended(problem, y, D(level));
      });
  EXPECT_TRUE(tangent);
  if (!tangent) return {NAN, NAN, NAN};
  const auto [defect, factor] = contact_defect(z, *tangent);
  return {defect, factor, determinant(tangent->m)};
}
TEST(TimeTransformedContact, IsAContactMapOfTheExtendedSpace) {
  for_each_scene([](const auto& problem, const auto& start, const char* name) {
    for (const auto composition : {Composition::none, Composition::suzuki_4, Composition::kahan_li_8})
      for (const double k : {-0.5, -1.3})
        for (const double off : {0.0, 0.05}) {
          const TimeTransformed scheme{0.2, 0.6, composition, k};
          const Form found = form(problem, start, scheme, off);
          const bool exact = std::strcmp(name, "swept") != 0;  // there ∫α is a quadrature
          EXPECT_LT(found.defect, exact ? 1e-12 : 1e-10) << name << ' ' << called(composition);
          EXPECT_NEAR(found.determinant, std::pow(found.factor, start.dof + 2), exact ? 1e-12 : 1e-10) << name;
        }
  });
}
// λ = e^{−∫α}.
TEST(TimeTransformedContact, FactorIsTheDecayOfTheAction) {
  const TimeTransformed scheme{0.2, 0.6, Composition::suzuki_4};
  auto x = ellipse;
  const DampedKepler<> damped{1, 0.03};
  const double factor = form(damped, x, scheme, 0).factor;
  ASSERT_EQ(bound(scheme, damped, x).step(x), StepStatus::ok);
  EXPECT_NEAR(factor, std::exp(-0.03 * x.t), 1e-14);
  const PerturbedKepler<> swept{-1, 0.2};
  Acting<PerturbedKepler<>> y{0.3, {0.9, 0.2}, {-0.3, 1.1}, {0.4}};
  const double there = swept.damping_integral(y.t), change = form(swept, y, scheme, 0).factor;
  ASSERT_EQ(bound(scheme, swept, y).step(y), StepStatus::ok);
  EXPECT_NEAR(change, std::exp(there - swept.damping_integral(y.t)), 1e-13);
}

TEST(TimeTransformedContact, GoesAndReturns) {
  for_each_scene([](const auto& problem, const auto& start, const char* name) {
    for (const auto composition : all_compositions) {
      auto x = start;
      auto kernel = bound(TimeTransformed{0.2, 0.6, composition}, problem, x).kernel();
      const double a = kernel.memory().a;
      Work work;
      for (const double sigma : {0.1, 0.1, 0.1, -0.1, -0.1, -0.1}) {
        double elapsed = 0;
        ASSERT_EQ(kernel.move(x, sigma, elapsed, work), StepStatus::ok) << name;
        x.t += elapsed;
      }
      EXPECT_LT(distance(x, start), 1e-13) << name << ' ' << called(composition);
      EXPECT_NEAR(x.t, start.t, 1e-13) << name;
      EXPECT_NEAR(kernel.memory().a, a, 1e-13) << name;
    }
  });
}

/// A run ends within a step, and the error of that part of a step is not proportional to a power of σ: over many σ with
/// errors down to round-off of T, this changes the slope by up to 0.1. Order 10, whose errors are small already with
/// few steps, needs a longer span (slopes 10.16 over 3, 9.98 over 6).
template <class T, class P, class X>
void has_order_with_damping(const P& problem, const X& start, double span, TimeTransformed scheme, double floor) {
  Extrapolation<P, typename X::template in<Quad, Quad>> truth(problem, convert<Quad, Quad>(start), 1e-28);
  ASSERT_TRUE(truth.advance(Quad(start.t + span), [] { return true; }));
  const int order = compositions::orders[std::size_t(scheme.composition)];
  std::vector<std::pair<double, double>> points;
  const double first = order < 6 ? 1e-5 : order < 10 ? 1e-8 : 1e-11;
  for (int n = 0; n < 40 && points.size() < 11; ++n, scheme.sigma /= 1.3) {
    auto x = convert<T, T>(start);
    auto stepper = bound(scheme, problem, x);
    ASSERT_EQ(until(stepper, x, T(start.t + span)), StepStatus::ok);
    const double error = distance(x, convert<T, T>(truth.state()));
    if (error < floor) break;
    if (error < first * std::pow(10, -0.5 * order)) points.emplace_back(scheme.sigma, error);
  }
  ASSERT_GE(points.size(), 8U) << called(scheme.composition);
  EXPECT_NEAR(slope(points), order, 0.1) << called(scheme.composition) << " to " << points.back().second;
}
TEST(TimeTransformedContact, OrdersAreTheCompositions) {
  const DampedKepler<> damped{1, 0.05};
  const Acting<DampedKepler<>> orbit{0, {1, 0}, {0, 1.1}, {0.1}};
  const PerturbedKepler<> perturbed{-1, 0.3, 2};
  const Acting<PerturbedKepler<>> later{0.4, {1, 0}, {0, 1.1}, {0.1}};
  using C = Composition;
  for (const auto c : {C::none, C::suzuki_4}) {
    has_order_with_damping<long double>(damped, orbit, 3, {0.2, 0.4, c}, 1e-15);
    has_order_with_damping<long double>(perturbed, later, 3, {0.2, 0.4, c}, 1e-15);
    has_order_with_damping<long double>(Swept<>{}, Acting<Swept<>>{0.3, {0.9, 0.2}, {-0.3, 0.6}, {0.4}}, 2,
                                        {0.3, 0.6, c}, 1e-15);
  }
  for (const auto c : {C::kahan_li_6, C::kahan_li_8}) {
    has_order_with_damping<Quad>(damped, orbit, 3, {0.6, 0.4, c}, 1e-26);
    has_order_with_damping<Quad>(perturbed, later, 3, {0.6, 0.4, c}, 1e-26);
  }
  has_order_with_damping<Quad>(damped, orbit, 6, {1.2, 0.4, C::sofroniou_spaletta_10}, 1e-26);
  has_order_with_damping<Quad>(perturbed, later, 6, {1.2, 0.4, C::sofroniou_spaletta_10}, 1e-26);
}

// ---- what is kept

TEST(TimeTransformedContact, MovesTheSameWithAndWithoutTheAction) {
  for_each_scene([](const auto& problem, const auto& start, const char* name) {
    using P = std::remove_cvref_t<decltype(problem)>;
    StateOf<P> lean;
    assign(lean, start);
    auto full = start;
    const TimeTransformed scheme{0.2, 0.6, Composition::kahan_li_6};
    auto with = bound(scheme, problem, full);
    auto without = bound(scheme, problem, lean);
    ASSERT_EQ(steps(with, full, 20), 20) << name;
    ASSERT_EQ(steps(without, lean, 20), 20) << name;
    for (std::size_t i = 0; i < lean.size; ++i) EXPECT_EQ(full[i], lean[i]) << name;
    EXPECT_EQ(full.t, lean.t) << name;
  });
}
// A copy goes on with the same bits, and so does a new stepper that is given the state and the stepper's memory.
TEST(TimeTransformedContact, GoesOnFromTheStateAndItsMemory) {
  for_each_scene([](const auto& problem, const auto& start, const char* name) {
    const TimeTransformed scheme{0.2, 0.6, Composition::suzuki_4};
    auto x = start;
    auto stepper = bound(scheme, problem, x);
    ASSERT_EQ(steps(stepper, x, 7), 7) << name;
    auto y = x, z = x;
    auto copy = stepper, fresh = scheme.bind(problem, z, level_of(problem, start));
    fresh.resume(z, stepper.memory());
    steps(stepper, x, 7);
    steps(copy, y, 7);
    steps(fresh, z, 7);
    EXPECT_EQ(x, y) << name;
    if constexpr (std::remove_cvref_t<decltype(fresh.kernel())>::constant) {
      EXPECT_EQ(x, z) << name;
    } else {
      EXPECT_LT(distance(x, z), 1e-13) << name;  // ∫α is recomputed, from a time that is rounded
    }
  });
}
TEST(TimeTransformedContact, ReachesAnyTimeWithinAStep) {
  for_each_scene([](const auto& problem, const auto& start, const char* name) {
    const TimeTransformed scheme{0.2, 0.6, Composition::kahan_li_6};
    auto x = start;
    auto stepper = bound(scheme, problem, x);
    ASSERT_EQ(steps(stepper, x, 3), 3) << name;
    auto end = x;
    auto ahead = stepper;
    ASSERT_EQ(ahead.step(end), StepStatus::ok) << name;
    for (const double part : {1e-6, 0.3, 0.99, 1.0}) {
      auto y = x, z = x;
      auto there = stepper, missed = stepper;
      const double t = x.t + part * (end.t - x.t);
      ASSERT_EQ(there.reach(y, t), StepStatus::ok) << name << ' ' << part;
      EXPECT_EQ(y.t, t);
      if (part == 1) {
        EXPECT_LT(distance(y, end), 1e-12) << name;
      }
      EXPECT_EQ(missed.reach(z, end.t + 1e-3 * (end.t - x.t)), StepStatus::solver_failed);
      ASSERT_EQ(missed.step(z), StepStatus::ok) << name;
      EXPECT_LT(distance(z, end), 1e-14) << name;  // a failed attempt changes nothing
    }
  });
}

}  // namespace
