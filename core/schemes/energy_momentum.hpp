// energy_momentum: the time-adaptive variational midpoint rule. Beside the end of a step its length h is unknown, and
// beside the discrete momentum equation the discrete energy has to be that of the run,
//   p₀ = −D₁L_d(q₀, q₁; h),  E_d(q₀, q₁; h) = −∂L_d/∂h = E₀;  p₁ = D₂L_d,
// L_d = h L((q₀+q₁)/2, (q₁−q₀)/h), for any kinetic metric. E₀ is the discrete energy of a first step of the nominal
// length: with H of the start for E₀ that first step would have no length but 0. It keeps E_d to round-off and momenta
// of symmetries exactly. Order 2. E_d = H + 3h²H₂ + … with H₂ = −(V″(v, v) + |∇V|²)/24 (unit masses), so that h² goes
// as 1/H₂: where H₂ changes its sign or vanishes, as at equilibria, there is no such h, and a step whose solution
// leaves [¼, 4] nominal lengths goes at the nominal one and is counted. L_d + E₀h generates the steps that are solved:
// at fixed E₀ they are symplectic maps, but ill-conditioned ones, whose derivatives grow as 1/h, and a run that goes at
// the nominal length here and there keeps no form as a whole. Look-alike: steps chosen for the energy H without the
// momentum equation of a variational step keep neither momenta nor form. Source: Kane, Marsden, Ortiz, J. Math. Phys.
// 40, 3353 (1999), sections 3 and 4.
#pragma once

#include <cmath>
#include <tuple>

#include "core/schemes/discrete_lagrangian.hpp"

namespace least {

template <Conservative P, class X>
class EnergyMomentumStepper {
 public:
  using T = typename X::Number;
  static constexpr std::size_t n = P::dof;

  EnergyMomentumStepper(const P& problem, const T& level, double step)
      : problem_(problem), level_(level), step_(step) {}

  StepStatus step(X& x) noexcept {
    if (solve(x)) return StepStatus::ok;
    const StepStatus status = nominal_step(x);
    if (status == StepStatus::ok) ++fallbacks_;
    return status;
  }
  const Work& work() const { return work_; }
  /// The discrete energy of the step from a to b.
  T discrete_energy(const X& a, const X& b) const { return midpoint_energy(problem_, a, b, b.t - a.t); }
  /// The number of steps of the nominal length, taken where no step keeps the discrete energy.
  std::int64_t fallback_steps() const { return fallbacks_; }

 private:
  static constexpr int unknowns = P::dof + 1;
  static constexpr double most = 16;  ///< bound of (h/h₀)² and of its inverse

  /// The variational step of the velocity v and the length h, seen from its middle.
  template <class U>
  struct Middle {
    U h, energy;               ///< h, E_d
    Vec<P::dof, U> pi, force;  ///< gv, F
    U size;                    ///< K + |V|
  };
  template <std::size_t M, class U>
  Middle<U> middle(const X& x, const std::array<U, M>& z) const {
    using least::abs;
    using least::sqrt;
    const U h = step_ * sqrt(z[n]);
    Vec<P::dof, U> v, m;
    for (std::size_t i = 0; i < n; ++i) {
      v[i] = z[i];
      m[i] = x.q[i] + 0.5 * h * v[i];
    }
    const Slopes<P, U> at(problem_, m);
    const auto pi = at.lower(problem_, v);
    const U kinetic = 0.5 * dot(v, pi);
    return {h, kinetic + at.potential, pi, at.force(v), kinetic + abs(at.potential)};
  }

  /// Newton's method for (v, (h/h₀)²) from h₀: E_d is nearly linear in h². Returns false where it finds no solution
  /// within bounds.
  bool solve(X& x) {
    using least::abs;
    constexpr int most_iterations = 20;
    const double small = std::pow(Precision<T>::epsilon, 0.75);
    Vec<unknowns, T> z;
    z[n] = T(1);
    const T scale = guess(x, z);
    const T grain = grain_of(x.q, T(step_));
    T excess(0), size(0);  // of the discrete energy over the level; of its terms
    const auto residual = [&](const auto& trial) {
      const auto at = middle(x, trial);
      auto r = trial;
      for (std::size_t i = 0; i < n; ++i) r[i] = at.pi[i] - 0.5 * at.h * at.force[i] - x.p[i];
      r[n] = at.energy - level_;
      excess = r[n].value;
      size = at.size.value;
      return r;
    };
    const auto asked = unknowns_of<unknowns, unknowns>(problem_);
    bool slopes_lag = detail::carries_slopes<T>;  // by a round
    for (int k = 0; k < most_iterations; ++k) {
      ++work_.forces;
      ++work_.iterations;
      const auto update = detail::newton_update<unknowns>(z, asked, residual);
      T change(0);
      for (std::size_t i = 0; i < n; ++i) change = change + abs(update[i]);
      for (std::size_t i = 0; i < unknowns; ++i) z[i] = z[i] - update[i];
      if (!(z[n] > T(0) && z[n] < T(64 * most))) return false;  // also where it is NaN
      // An energy that is right to its last digits says no more about h.
      const bool kept = abs(excess) <= 4 * Precision<T>::epsilon * (size + abs(level_));
      if (!(change <= small * scale + grain && (kept || abs(update[n]) <= small * z[n]))) continue;
      if (!slopes_lag) return arrive(x, z);
      slopes_lag = false;
    }
    return false;
  }
  bool arrive(X& x, const Vec<unknowns, T>& z) {
    if (!(z[n] >= T(1 / most) && z[n] <= T(most))) return false;
    const auto at = middle(x, z);
    ++work_.forces;
    for (std::size_t i = 0; i < n; ++i) {
      x.q[i] = x.q[i] + at.h * z[i];
      x.p[i] = x.p[i] + at.h * at.force[i];
    }
    x.t = x.t + at.h;
    return true;
  }
  /// Sets the velocity in z to v after half a kick. Returns the size of velocities.
  T guess(const X& x, Vec<unknowns, T>& z) {
    using least::abs;
    const auto v = velocity(problem_, x.q, x.p);
    T scale(0);
    for (std::size_t i = 0; i < n; ++i) {
      z[i] = v[i];
      scale = scale + abs(v[i]);
    }
    const auto at = middle(x, z);
    ++work_.forces;
    Vec<P::dof, T> p = x.p;
    for (std::size_t i = 0; i < n; ++i) p[i] = p[i] + 0.5 * at.h * at.force[i];
    const auto mean = velocity(problem_, x.q, p);
    for (std::size_t i = 0; i < n; ++i) {
      z[i] = mean[i];
      scale = scale + abs(mean[i]);
    }
    return scale;
  }
  StepStatus nominal_step(X& x) {
    MidpointStepper<P, X> stepper(problem_);
    const StepStatus status = stepper.step(x, T(step_));
    if (status == StepStatus::ok) x.t = x.t + step_;
    work_.forces += stepper.work().forces;
    work_.iterations += stepper.work().iterations;
    return status;
  }

  P problem_;
  T level_;
  double step_;
  Work work_;
  std::int64_t fallbacks_ = 0;
};

struct EnergyMomentum {
  double step = 0.01;

  static constexpr bool own_clock = true;
  static constexpr std::tuple fields{step_field<EnergyMomentum>()};
  static SchemeCard card() {
    return {.id = "energy_momentum",
            .title = "Energy–momentum, time-adaptive",
            .summary =
                "The variational midpoint rule with an extra equation for the step: each step is as long as keeps the "
                "discrete energy. `step` is the nominal length.",
            .orders = {{"", 2}},
            .implicit = true,
            .structure = "none",
            .keeps_momenta = true,
            .good_for = "comparison: discrete energy and momenta kept at once",
            .fails_when =
                "the motion turns or rests: there no step keeps the discrete energy, and steps go at the nominal "
                "length, counted; a step that is too long has other solutions",
            .needs = "a Lagrangian without s: a kinetic metric and a potential that does not depend on time",
            .references = {"Kane, Marsden, Ortiz, Journal of Mathematical Physics 40, 3353 (1999)"}};
  }
  /// E₀ of a run from x: the discrete energy of a step of the nominal length; H where that step fails.
  template <class P, class X>
  typename X::Number level(const P& problem, const X& x) const {
    X y = x;
    if (MidpointStepper<P, X> stepper(problem); stepper.step(y, typename X::Time(step)) != StepStatus::ok)
      return energy(problem, x);
    return midpoint_energy(problem, x, y, typename X::Time(step));
  }
  template <Conservative P, class X>
  requires Autonomous<P>
  auto bind(const P& problem, const X&, const typename X::Number& level) const {
    return EnergyMomentumStepper<P, X>(problem, level, step);
  }
};

}  // namespace least
