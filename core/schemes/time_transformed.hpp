// time_transformed: symplectic steps of constant length σ in a parameter τ that runs with the motion, dt = dτ/(K + κ):
// short in time where the kinetic energy exceeds the threshold κ. On the energy level E₀ of the run's start K + κ
// equals D := E₀ − V + κ, and
//   constant metric: leapfrog for Γ = ln(K + κ) − ln D, explicit, one force evaluation a stage:
//     q += ½σ g⁻¹p/(K + κ), t += ½σ/(K + κ);  p −= σ∇V/D;  the first again with the new p
//   metric g(q): the variational midpoint rule at h = σ/D(m) with the action S = L_d(q₀, q₁; h) + E₀h, implicit. As h
//     varies with the midpoint m, p₀ = −D₁L_d − c and p₁ = D₂L_d + c with c = (E₀ − E_d)·½h∇V/D.
// Order 2, symmetric. At fixed E₀ a symplectic map of (q, p); not so if E₀ is taken anew from each state. Momenta of
// symmetries are kept. κ = −E₀ makes Kepler orbits exact but for time: a step advances the eccentric anomaly of an
// ellipse by 2 arctan(σ√(−2E₀)/2μ); a hyperbola has tanh instead of tan, and no such step from σ√(2E₀) = 2μ on.
// It needs a potential that does not depend on time; where there is damping see time_transformed_contact.hpp. It checks
// K + κ > 0 and D > 0, that a step goes forward in time, and at each kick D²/((K₀ + κ)(K₁ + κ)), which is 1 on the
// energy level. Look-alike: leapfrog with steps chosen from the state is neither symplectic nor symmetric.
// Sources: Mikkola & Tanikawa, Celest. Mech. Dyn. Astron. 74, 287 (1999); Preto & Tremaine, Astron. J. 118, 2532
// (1999); for any metric Poincaré's transformation, Hairer, Lubich, Wanner 2006, VIII.2.1.
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <tuple>

#include "core/problem_traits.hpp"
#include "core/schemes/discrete_lagrangian.hpp"
#include "core/schemes/time_transformed_contact.hpp"
#include "core/schemes/transformed_stepper.hpp"

namespace least {

/// The transformed time of a run: what both kernels read.
template <Conservative P, class X>
struct TransformedTime {
  using T = typename X::Number;
  using Constant = typename Underlying<T>::type;
  /// The number type of weights: doubles where numbers have lanes.
  using S = std::conditional_t<std::numeric_limits<Constant>::is_specialized, Constant, double>;

  P problem;
  T level, kappa;         ///< E₀ + κ and κ
  bool gap_is_potential;  ///< D = −V, as κ = −E₀
  const Weights<S>* weights;

  /// 2(K + κ)
  T speed(const X& x) const { return dot(x.p, velocity(problem, x.q, x.p)) + 2.0 * kappa; }
  /// dt/dτ = 1/(K + κ)
  T pace(const X& x) const { return 2.0 / speed(x); }
};

/// Drift, kick, drift; drifts that meet in a composition are one.
template <Separable P, class X>
class TransformedLeapfrog {
 public:
  using T = typename X::Number;
  using Time = TransformedTime<P, X>;

  using Memory = NoMemory;
  static constexpr bool reads_time = false;

  TransformedLeapfrog(const Time& time, const X& x) : time_(time) { settle(x, {}); }
  /// Takes x for the state that the next move begins at.
  void settle(const X& x, NoMemory) { speed_ = time_.speed(x); }
  static NoMemory memory() { return {}; }
  T pace(const X&) const { return 2.0 / speed_; }
  /// The largest |(D/(K + κ))² − 1| of a kick.
  T strain() const { return strain_ / strain_level_; }
  int stages() const { return time_.weights->stages; }

  /// Moves q and p by the parameter σ, forward or back, and sets `time` to the time that takes.
  StepStatus move(X& state, const T& sigma, T& time, Work& work) {
    using least::abs;
    using least::all;
    using least::select;
    X x = state;  // locals, which stay in registers from stage to stage
    T speed = speed_, elapsed(0);
    typename Time::S before(0);
    auto sound = speed > T(0);
    for (std::size_t i = 0; i < static_cast<std::size_t>(time_.weights->stages); ++i) {
      const auto& gamma = time_.weights->gamma[i];
      drift(x, sigma * (before + gamma) / speed, elapsed);
      before = gamma;
      const auto here = potential_at(time_.problem, x.q, phase(time_.problem, 0.0));
      ++work.forces;
      const T gap = time_.level - here.potential;
      const auto by = kick(x.q, here.slope, gap, T(sigma * gamma));
      for (std::size_t k = 0; k < x.p.size(); ++k) x.p[k] = x.p[k] + by[k];
      const T square = 4.0 * (gap * gap);
      T level = speed;
      speed = time_.speed(x);
      level = level * speed;
      const T off = abs(square - level);
      const auto more = off * strain_level_ > strain_ * level;  // kept as a fraction, to spare a division
      strain_ = select(more, off, strain_);
      strain_level_ = select(more, level, strain_level_);
      sound = sound & (gap > T(0)) & near_level(square, level);  // keeps the speed positive
    }
    drift(x, sigma * before / speed, elapsed);
    if (!all(sound & (elapsed * sigma > T(0)))) return StepStatus::singular;
    state = x;
    speed_ = speed;
    time = elapsed;
    return StepStatus::ok;
  }

 private:
  /// −σ∇V/D
  template <class V>
  V kick([[maybe_unused]] const V& q, V by, const T& gap, const T& sigma) const {
    if constexpr (HasLogGradient<P, T>)
      if (time_.gap_is_potential) return time_.problem.log_gradient(q, sigma);
    const T factor = -sigma / gap;
    for (T& c : by) c = factor * c;
    return by;
  }
  void drift(X& x, const T& dt, T& elapsed) const {
    const auto v = velocity(time_.problem, x.q, x.p);
    for (std::size_t i = 0; i < x.q.size(); ++i) x.q[i] = x.q[i] + dt * v[i];
    elapsed = elapsed + dt;
  }

  Time time_;
  T strain_ = T(0), strain_level_ = T(1);
  T speed_{};  ///< at the present p: drifts leave it as it is, so the next step begins with it
};

/// The midpoint rule, solved for the displacement by parameter u = (q₁ − q₀)/σ.
template <ConfigurationMetric P, class X>
class TransformedMidpoint {
 public:
  using T = typename X::Number;
  using Time = TransformedTime<P, X>;
  using Memory = NoMemory;
  static constexpr bool reads_time = false;
  static constexpr int n = P::dof;

  TransformedMidpoint(const Time& time, const X&) : time_(time) {}
  void settle(const X&, NoMemory) {}
  static NoMemory memory() { return {}; }
  T pace(const X& x) const { return time_.pace(x); }
  const T& strain() const { return strain_; }
  int stages() const { return time_.weights->stages; }

  StepStatus move(X& state, const T& sigma, T& time, Work& work) {
    using least::all;
    X x = state;
    T elapsed(0);
    for (std::size_t i = 0; i < static_cast<std::size_t>(time_.weights->stages); ++i)
      if (const StepStatus status = stage(x, sigma * time_.weights->gamma[i], elapsed, work); status != StepStatus::ok)
        return status;
    if (!all(elapsed * sigma > T(0))) return StepStatus::singular;
    state = x;
    time = elapsed;
    return StepStatus::ok;
  }

 private:
  template <class U>
  struct Middle {
    U gap, ratio;              ///< D, D/(K + κ)
    Vec<n, U> momentum, kick;  ///< gv; (h/2)F + c, by which it exceeds p₀ and p₁ exceeds it
  };
  template <class U>
  Middle<U> middle(const X& x, const T& half, const Vec<n, U>& u) const {
    Vec<n, U> m, v;
    for (std::size_t i = 0; i < n; ++i) m[i] = x.q[i] + half * u[i];
    const Slopes<P, U> here(time_.problem, m);
    const U gap = time_.level - here.potential;
    for (std::size_t i = 0; i < n; ++i) v[i] = gap * u[i];
    Middle<U> at{gap, {}, here.lower(time_.problem, v), here.force(v)};
    const U slow = 0.5 * dot(v, at.momentum) + time_.kappa;  // D − slow = E₀ − E_d
    const U correction = (gap - slow) / gap, half_step = half / gap;
    at.ratio = gap / slow;
    for (std::size_t i = 0; i < n; ++i) at.kick[i] = half_step * (at.kick[i] + correction * here.gradient[i]);
    return at;
  }

  StepStatus stage(X& x, const T& sigma, T& elapsed, Work& work) {
    using least::abs;
    using least::all;
    using least::select;
    const T half = 0.5 * sigma;
    const auto residual = [&](const auto& u) {
      const auto at = middle(x, half, u);
      auto r = at.momentum;
      for (std::size_t i = 0; i < n; ++i) r[i] = r[i] - at.kick[i] - x.p[i];
      return r;
    };
    // The guess: as the motion begins, then with half a kick.
    const T pace = time_.pace(x);
    Vec<n, T> u = velocity(time_.problem, x.q, x.p), p = x.p;
    T scale(0);
    for (T& c : u) c = c * pace;
    for (const T& c : u) scale = scale + abs(c);
    const auto begin = middle(x, half, u);
    ++work.forces;
    for (std::size_t i = 0; i < n; ++i) p[i] = p[i] + begin.kick[i];
    u = velocity(time_.problem, x.q, p);
    for (T& c : u) c = c / begin.gap;
    for (const T& c : u) scale = scale + abs(c);
    if (const StepStatus status =
            newton<n>(u, unknowns_of<n, n>(time_.problem), scale, grain_of(x.q, sigma), residual, 1, work);
        status != StepStatus::ok)
      return status;

    const auto at = middle(x, half, u);
    ++work.forces;
    for (std::size_t i = 0; i < n; ++i) {
      x.q[i] = x.q[i] + sigma * u[i];
      x.p[i] = x.p[i] + 2.0 * at.kick[i];
    }
    elapsed = elapsed + sigma / at.gap;
    const T square = at.ratio * at.ratio, off = abs(square - 1.0);
    strain_ = select(off > strain_, off, strain_);
    return all((at.gap > T(0)) & (at.ratio > T(0)) & near_level(square, T(1))) ? StepStatus::ok : StepStatus::singular;
  }

  Time time_;
  T strain_ = T(0);
};

/// Returns in words why κ = −E₀ forbids σ on a Kepler orbit of this energy; empty if it does not. There a stage of
/// weight γ has (D/(K + κ))² = 1/(1 − z²), z = γσ√(2E₀)/2μ, at every kick, on ellipses with imaginary z: outside [¼, 4]
/// σ is refused before the run, in which the steps would fail. (From |z| = 1 on the stage of a hyperbola leads to its
/// other branch.)
std::string kepler_objection(const Composition& composition, double sigma, double mu, double energy);

struct TimeTransformed {
  double sigma = 0.02, kappa = 1;  ///< κ: NaN for −E₀
  Composition composition = Composition::none;
  double exponent = -0.5;  ///< read where there is damping

  static constexpr bool own_clock = true;
  using Self = TimeTransformed;
  static constexpr std::tuple fields{
      Field<Self>{"sigma",
                  "σ",
                  "energy·time",
                  "length of a step in the parameter; in time it is σ/(K + κ), with damping σ(K + κ)ᵏ⁻¹",
                  &Self::sigma,
                  any_strength,
                  {},
                  "sigma"},
      Field<Self>{"kappa",
                  "κ",
                  "energy",
                  "kinetic energy from which steps become shorter; `energy` stands for −E₀",
                  &Self::kappa,
                  any_signed_strength,
                  {},
                  "critical_kinetic_energy",
                  "energy"},
      composition_field<Self>(),
      Field<Self>{
          "exponent",
          "k",
          "1",
          "with damping: how steps follow the motion, dt = (K + κ)ᵏ⁻¹ dτ. Without damping it is not read: steps "
          "follow the logarithm, its limit 0",
          &Self::exponent,
          {-2, -0.01}},
  };
  static SchemeCard card() {
    return {
        .id = "time_transformed",
        .title = "Time-transformed leapfrog",
        .summary =
            "Leapfrog at constant steps of a parameter that runs with the motion, so that steps of time are short "
            "where it is fast. Symplectic at the energy level of the run's start; with damping, a contact map of the "
            "space that has the time and its momentum, too. Explicit; implicit (the midpoint rule) where the kinetic "
            "metric depends on the configuration, and in one unknown where the damping changes in time.",
        .orders = orders_from(2),
        .symmetric = true,
        .structure = "symplectic",
        .recommended = "kahan_li_6",
        .presets = {{"kepler",
                     "κ = −E₀, where V < 0: Kepler orbits without drag are exact but for time",
                     {{"kappa", std::numeric_limits<double>::quiet_NaN()}}}},
        .good_for =
            "eccentric orbits and other motions that are fast for a short time only, damped or not, over long runs",
        .fails_when =
            "E₀ − V + κ does not stay positive, or a step is too long for its curvature: it stops as singular; what "
            "is fast and has little kinetic energy gets no shorter steps",
        .needs =
            "a Lagrangian without s and a potential that does not depend on time; or, with a constant kinetic "
            "metric, a damping α(t) s and any potential",
        .references = {"Mikkola, Tanikawa, Celestial Mechanics and Dynamical Astronomy 74, 287 (1999)",
                       "Preto, Tremaine, Astronomical Journal 118, 2532 (1999)",
                       "Hairer, Lubich, Wanner 2006, VIII.2.1",
                       "with damping derived here, from Bravetti, Entropy 19, 535 (2017), and Preto, Tremaine 1999"}};
  }

  template <Conservative P, class X>
  requires Autonomous<P>
  auto bind(const P& problem, const X& x, const typename X::Number& energy) const {
    using T = typename X::Number;
    using Time = TransformedTime<P, X>;
    const bool kepler = std::isnan(kappa);
    const Time time{problem, kepler ? T(0) : energy + kappa, kepler ? -energy : T(kappa), kepler,
                    &Weights<typename Time::S>::of(composition)};
    if constexpr (ConfigurationMetric<P>) {
      using Kernel = TransformedMidpoint<P, X>;
      return TransformedStepper<Kernel, X>(Kernel(time, x), sigma);
    } else {
      using Kernel = TransformedLeapfrog<P, X>;
      return TransformedStepper<Kernel, X>(Kernel(time, x), sigma);
    }
  }
  template <LinearContact P, class X>
  requires SeparableContact<P>
  auto bind(const P& problem, const X& x, const typename X::Number& energy) const {
    using T = typename X::Number;
    using Kernel = TransformedContact<P, X>;
    const T level = std::isnan(kappa) ? T(0) : energy + kappa;
    const auto& weights = Weights<typename Kernel::S>::of(composition);
    const T threshold = std::isnan(kappa) ? T(-energy) : T(kappa);
    return TransformedStepper<Kernel, X>(Kernel(problem, x, level, threshold, exponent, weights), sigma);
  }
  /// The same step, of a run at this level, on the extended space (q, t; p, p_t; s), where it is a contact map.
  template <LinearContact P, class Z>
  requires SeparableContact<P> StepStatus step_extended(const P& problem, Z& z, const typename Z::Number& energy)
  const {
    using T = typename Z::Number;
    State<P::dof, T, T, Action<T>> x;
    constexpr std::size_t n = P::dof;
    x.t = z.q[n];
    for (std::size_t i = 0; i < n; ++i) {
      x.q[i] = z.q[i];
      x.p[i] = z.p[i];
    }
    x.action = z.action;
    // p_t + H, and from it A.
    const auto off = [&] { return z.p[n] + least::energy(problem, x); };
    const T level = std::isnan(kappa) ? T(0) : energy + kappa;
    const auto gap = [&] { return level - problem.potential(x.q, phase(problem, x.t)); };
    auto stepper = bind(problem, x, energy);
    stepper.resume(x, stepper.kernel().at(gap() + off()));
    const StepStatus status = stepper.step(x);
    for (std::size_t i = 0; i < n; ++i) {
      z.q[i] = x.q[i];
      z.p[i] = x.p[i];
    }
    z.q[n] = x.t;
    z.action = x.action;
    z.p[n] = T(0);
    z.p[n] = stepper.memory().a - gap() - off();
    return status;
  }

  template <class P>
  std::string unsupported_reason(const P& problem, double energy) const {
    if constexpr (TwoBody<P> && Conservative<P>)
      if (std::isnan(kappa) || kappa == -energy)
        return kepler_objection(composition, sigma, problem.gravitational_parameter(), energy);
    return {};
  }
};

}  // namespace least
