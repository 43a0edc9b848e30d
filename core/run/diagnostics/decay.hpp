// The law of decay of a contact Hamiltonian, Ḣ = −H H_s + H_t, along the states a scheme took. With A = ∫H_s dt and
// G = ∫H_t eᴬ dt the exact motion keeps H eᴬ − G. The integrals are taken over each step by the two-point rule that
// quintic Hermite interpolation gives (order 6), from derivatives along the equations of motion by dual numbers; a
// constant damping is integrated exactly. Source: Bravetti, Cruz, Tapias, Ann. Phys. 376, 17 (2017), eq. 22.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/run/diagnostics/diagnostic.hpp"

namespace least {

template <Contact P>
class DecayLaw {
 public:
  using X = FullStateOf<P>;

  void start(const P& problem, const X& x) {
    initial_ = energy(problem, x);
    before_ = rates(problem, x);
    time_ = x.t;
  }

  void see(const P& problem, const X& x) {
    const Rates now = rates(problem, x);
    const double h = x.t - time_;
    const Jet g0 = weighted(before_, exponent_);
    exponent_ += integral(h, before_.slope, now.slope);
    gain_ += integral(h, g0, weighted(now, exponent_));
    const double kept = energy(problem, x) * std::exp(exponent_) - gain_;
    const double wrong = std::abs(kept - initial_);
    if (!(wrong <= residual_)) residual_ = wrong;  // NaN comes in and stays
    before_ = now;
    time_ = x.t;
  }

  /// Of H eᴬ − G from its start, relative to |H| there; absolute where H begins at zero.
  double max_residual() const { return std::abs(initial_) > 1e-9 ? residual_ / std::abs(initial_) : residual_; }
  Report report(const RunEnd<P, X>&) const { return numbers("decay", {{"max_residual", max_residual()}}); }

 private:
  /// A quantity and its first two derivatives in time.
  struct Jet {
    double f, f1, f2;
  };
  struct Rates {
    Jet slope, drift;  ///< H_s and H_t
  };
  template <class U>
  using In = typename X::template in<U, U>;

  static double integral(double h, const Jet& a, const Jet& b) {
    return h * ((a.f + b.f) / 2 + h * ((a.f1 - b.f1) / 10 + h * (a.f2 + b.f2) / 120));
  }
  /// H_t eᴬ, whose derivatives follow from A′ = H_s.
  static Jet weighted(const Rates& r, double exponent) {
    const double e = std::exp(exponent);
    const auto& [a, d] = r;
    return {d.f * e, (d.f1 + d.f * a.f) * e, (d.f2 + 2 * d.f1 * a.f + d.f * (a.f1 + a.f * a.f)) * e};
  }

  /// x with the equations of motion as its tangent.
  template <class U>
  static In<Dual<U, 1>> along(const P& problem, const In<U>& x) {
    const In<U> rate = derivative(problem, x);
    In<Dual<U, 1>> y;
    y.t = Dual<U, 1>(x.t, {U(1)});
    for (std::size_t i = 0; i < X::size; ++i) y[i] = Dual<U, 1>(x[i], {rate[i]});
    return y;
  }
  template <class F>
  static Jet jet(const P& problem, const X& x, F&& f) {
    const auto first = [&](const auto& y) {
      return f(along<typename std::remove_cvref_t<decltype(y)>::Number>(problem, y)).slope[0];
    };
    const auto lifted = along<double>(problem, x);
    const auto second = first(lifted);
    return {f(x), second.value, second.slope[0]};
  }
  static Rates rates(const P& problem, const X& x) {
    Rates r{};
    const auto slope = [&](const auto& y) {
      using U = typename std::remove_cvref_t<decltype(y)>::Number;
      return U(action_slope(problem, y.action.s, phase(problem, y.t)));
    };
    if constexpr (ConstantDamping<P>) {
      r.slope.f = slope(x);
    } else {
      r.slope = jet(problem, x, slope);
    }
    if constexpr (!QuadraticContact<P>)  // those are autonomous
      r.drift = jet(problem, x, [&](const auto& y) {
        using U = typename std::remove_cvref_t<decltype(y)>::Number;
        auto z = convert<Dual<U, 1>, Dual<U, 1>>(y);
        z.t = Dual<U, 1>(y.t, {U(1)});
        return energy(problem, z).slope[0];
      });
    return r;
  }

  double initial_ = 0, exponent_ = 0, gain_ = 0, residual_ = 0, time_ = 0;
  Rates before_{};
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
