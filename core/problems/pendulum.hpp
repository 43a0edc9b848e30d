// The mathematical pendulum, H = p²/2 − (g/l) cos q, with its exact motion by Jacobi's elliptic functions.
#pragma once

#include <tuple>

#include "core/describe.hpp"
#include "core/exact/jacobi.hpp"
#include "core/problem.hpp"

namespace least::problems {

template <class R = double>
struct Pendulum {
  R gravity{1}, length{1};

  static constexpr int dof = 1;

  template <class T, class S>
  constexpr T potential(const Vec<1, T>& q, const S&) const {
    using least::cos;
    return -(gravity / length) * cos(q[0]);
  }
  template <class T, class S>
  constexpr Vec<1, T> gradient(const Vec<1, T>& q, const S&) const {
    using least::sin;
    return {(gravity / length) * sin(q[0])};
  }
  /// The value at the bottom, where it is largest.
  template <class T>
  constexpr T frequency_squared(const Vec<1, T>&) const {
    return T(gravity / length);
  }

  template <class T, class S>
  State<1, T, S> exact(const State<1, T, S>& x0, const S& t) const;
};

/// T is a scalar. With half angle φ = q/2 and ω² = g/l: k² = sin²φ + (p/2ω)². Libration (k < 1): sin φ = k sn, p = 2ωk
/// cn, cos φ = dn of argument ωt and modulus k; rotation (k > 1): sin φ = sn, p = ±2ωk dn, cos φ = cn of argument ωkt
/// and modulus 1/k. The phase at the start enters by the addition theorems, so no incomplete integral is needed.
/// (Abramowitz & Stegun, 16.17; Lawden, Elliptic Functions and Applications, 5.1)
template <class R>
template <class T, class S>
State<1, T, S> Pendulum<R>::exact(const State<1, T, S>& x0, const S& t) const {
  using least::atan2;
  using least::cos;
  using least::floor;
  using least::sin;
  using least::sqrt;
  const T omega = sqrt(T(gravity) / T(length));
  const T half = x0.q[0] / 2, rate = x0.p[0] / (2 * omega), tau = omega * (t - x0.t);
  const T k2 = sin(half) * sin(half) + rate * rate, k = sqrt(k2);
  if (k2 == 0) return {t, x0.q, x0.p, {}};

  const bool rotates = k2 > 1;
  const T modulus = rotates ? 1 / k : k, sign = rotates && rate < 0 ? T(-1) : T(1);
  const T s0 = rotates ? sin(half) : sin(half) / k, c0 = rotates ? cos(half) : rate / k,
          d0 = rotates ? sign * rate / k : cos(half);
  const T u = rotates ? sign * k * tau : tau;
  const auto [s1, c1, d1, quarter] = jacobi(u, modulus);
  const T m = modulus * modulus, w = 1 - m * s0 * s0 * s1 * s1;
  const T s = (s0 * c1 * d1 + s1 * c0 * d0) / w, c = (c0 * c1 - s0 * d0 * s1 * d1) / w,
          d = (d0 * d1 - m * s0 * c0 * s1 * c1) / w;

  const T pi = 4 * atan2(T(1), T(1));
  const T angle = rotates ? atan2(s, c) : atan2(k * s, d);
  // Whole turns: in libration φ stays on the branch of the start; in rotation it follows πu/2K.
  const T expected = rotates && modulus < 1 ? half + pi * u / (2 * quarter) : half;
  const T turns = floor((expected - angle) / (2 * pi) + T(0.5));
  return {t, {2 * (angle + 2 * pi * turns)}, {2 * omega * k * (rotates ? sign * d : c)}, {}};
}

}  // namespace least::problems

namespace least {

template <>
struct About<problems::Pendulum> {
  using P = problems::Pendulum<>;
  static constexpr std::tuple fields{
      Field<P>{"gravity", "g", "length/time²", "gravitational acceleration", &P::gravity, any_strength},
      Field<P>{"length", "l", "length", "length of the rod", &P::length, any_strength},
  };
  static ProblemCard card() {
    return {
        .id = "pendulum",
        .title = "Pendulum",
        .summary = "A point mass on a rigid rod: libration inside the separatrix H = g/l, rotation outside it.",
        .formula =
            "<math><mi>H</mi><mo>=</mo><mfrac><msup><mi>p</mi><mn>2</mn></msup><mn>2</mn></mfrac><mo>−</mo>"
            "<mfrac><mi>g</mi><mi>l</mi></mfrac><mi>cos</mi><mi>q</mi></math>",
        .variables = {angle("q", "q", "angle from the vertical", 1.5), {"p", "p", "rad/time", "angular velocity", 0}},
        .span = 30,
        .suggested = {{"step", 0.1}, {"theta", 0.02}, {"critical_kinetic_energy", 0.3}},
        .references = {"Abramowitz, Stegun, Handbook of Mathematical Functions, 1964, chapter 16"},
    };
  }
};

}  // namespace least
