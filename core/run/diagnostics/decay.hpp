// The law of decay of a contact Hamiltonian, Ḣ = −H H_s + H_t, along the states a scheme took. With A = ∫H_s dt and
// G = ∫H_t eᴬ dt the exact motion keeps H eᴬ − G. So over a step from x to y, from which the exact flow leads from x to
// z, H eᴬ − G changes by eᴬ (H(y) − H(z)): nothing has to be integrated but the motion itself, and that to round-off. A
// constant damping without a drive is simpler still: G = 0 and A = αt. Source: Bravetti, Cruz, Tapias, Ann. Phys. 376,
// 17 (2017), eq. 22.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/extrapolation.hpp"
#include "core/run/diagnostics/diagnostic.hpp"

namespace least {

template <Contact P>
class DecayLaw {
 public:
  using X = FullStateOf<P>;

  void start(const P& problem, const X& x) {
    initial_ = energy(problem, x);
    before_ = x;
    initial_terms_ = see_rounding(problem, x);
  }

  void see(const P& problem, const X& x) {
    if (std::isnan(residual_))
      return;  // nothing more can be learnt, and where a flow is not followed it is dear to try
    exponent_ += damping_between(problem, before_, x);
    if constexpr (closed) {
      change_ = energy(problem, x) * std::exp(exponent_) - initial_;
    } else {
      change_ += std::exp(exponent_) * (energy(problem, x) - energy_of_exact_step(problem, x.t));
    }
    const double wrong = std::abs(change_);
    if (!(wrong <= residual_)) residual_ = wrong;  // NaN comes in and stays
    see_rounding(problem, x);
    before_ = x;
  }

  /// max_residual: the largest change of H eᴬ − G; floor: what rounding alone makes of it. Both relative to |H| at the
  /// start, absolute where H begins at zero.
  Report report(const RunEnd<P, X>&) const {
    const double scale = std::abs(initial_) > 1e-9 * initial_terms_ ? std::abs(initial_) : 1;
    return numbers("decay", {{"max_residual", residual_ / scale}, {"floor", floor() / scale}});
  }

 private:
  static constexpr bool closed = ConstantDamping<P> && Autonomous<P>;

  /// ∫H_s dt: exact for a constant damping; else it only weighs what a step did wrong, and Simpson's rule will do.
  static double damping_between(const P& problem, const X& a, const X& b) {
    const double h = b.t - a.t;
    if constexpr (ConstantDamping<P>) {
      return h * problem.damping();
    } else {
      const auto slope = [&](double s, double t) { return double(action_slope(problem, s, phase(problem, t))); };
      const double middle = slope((a.action.s + b.action.s) / 2, a.t + h / 2);
      return h / 6 * (slope(a.action.s, a.t) + 4 * middle + slope(b.action.s, b.t));
    }
  }
  /// H where the exact flow leads from the last state; not a number where it cannot be followed.
  double energy_of_exact_step(const P& problem, double t) const {
    Extrapolation<P, X> flow(problem, before_, 1e-14, t - before_.t);
    int patience = 20;
    return flow.advance(t, [&] { return --patience > 0; }) ? energy(problem, flow.state()) : unknown;
  }

  /// Each step rounds its state by a unit of the terms of H, at worst always the same way (the weights of a composition
  /// do: 1.5e-12 after 2,000 steps of order 10), and the law is read off to some units more. The sum of the terms.
  double see_rounding(const P& problem, const X& x) {
    const auto f = phase(problem, x.t);
    const double kinetic = 0.5 * dot(x.p, velocity(problem, x.q, x.p));
    const double terms =
        kinetic + std::abs(problem.potential(x.q, f)) + std::abs(action_slope(problem, x.action.s, f) * x.action.s);
    const double unit = std::numeric_limits<double>::epsilon() * std::exp(exponent_) * terms;
    of_steps_ += unit;
    of_reading_ = std::max(of_reading_, 4 * unit);
    return terms;
  }
  double floor() const { return of_steps_ + of_reading_; }

  double initial_ = 0, initial_terms_ = 0, exponent_ = 0, change_ = 0, residual_ = 0, of_steps_ = 0, of_reading_ = 0;
  X before_{};
};

struct DecayRow {
  static constexpr DiagnosticCard info{"decay", "residual of Ḣ = −H H_s + H_t along the run", false, true};
  static constexpr Sees sees = Sees::every_step;
  template <class P>
  static constexpr bool applies = Contact<P>;
  template <class P, class X>
  using Seen = DecayLaw<P>;
};

}  // namespace least
