// The Hénon–Heiles system, H = (p_x² + p_y²)/2 + (x² + y²)/2 + λ(x²y − y³/3): regular and chaotic motion side by side.
#pragma once

#include <tuple>

#include "core/describe.hpp"
#include "core/problem.hpp"

namespace least::problems {

template <class R = double>
struct HenonHeiles {
  R lambda{1};

  static constexpr int dof = 2;

  template <class T, class S>
  constexpr T potential(const Vec<2, T>& q, const S&) const {
    const T xx = q[0] * q[0], yy = q[1] * q[1];
    return 0.5 * (xx + yy) + lambda * q[1] * (xx - yy / 3.0);
  }
  template <class T, class S>
  constexpr Vec<2, T> gradient(const Vec<2, T>& q, const S&) const {
    return {q[0] + 2.0 * lambda * (q[0] * q[1]), q[1] + lambda * (q[0] * q[0] - q[1] * q[1])};
  }
  /// The larger eigenvalue of the Hessian of V: 1 + 2 |λ| r.
  template <class T>
  constexpr T frequency_squared(const Vec<2, T>& q) const {
    using least::sqrt;
    return 1.0 + 2.0 * sqrt(lambda * lambda * (q[0] * q[0] + q[1] * q[1]));
  }
};

}  // namespace least::problems

namespace least {

template <>
struct About<problems::HenonHeiles> {
  using P = problems::HenonHeiles<>;
  static constexpr std::tuple fields{
      Field<P>{"lambda", "λ", "1/length", "strength of the cubic coupling", &P::lambda, any_signed_strength},
  };
  static ProblemCard card() {
    return {
        .id = "henon_heiles",
        .title = "Hénon–Heiles",
        .summary =
            "A star in the meridian plane of a galaxy: regular orbits and chaotic seas at the same energy. Bound "
            "below H = 1/(6λ²).",
        .formula =
            "<math><mi>H</mi><mo>=</mo><mfrac><msup><mi>p</mi><mn>2</mn></msup><mn>2</mn></mfrac><mo>+</mo>"
            "<mfrac><mrow><msup><mi>x</mi><mn>2</mn></msup><mo>+</mo><msup><mi>y</mi><mn>2</mn></msup></mrow>"
            "<mn>2</mn></mfrac><mo>+</mo><mi>λ</mi><mrow><mo>(</mo><msup><mi>x</mi><mn>2</mn></msup><mi>y</mi>"
            "<mo>−</mo><mfrac><msup><mi>y</mi><mn>3</mn></msup><mn>3</mn></mfrac><mo>)</mo></mrow></math>",
        .variables = {{"x", "x", "length", "first coordinate", 0},
                      {"y", "y", "length", "second coordinate", 0.1},
                      {"px", "pₓ", "length/time", "momentum along x", 0.49},
                      {"py", "p_y", "length/time", "momentum along y", 0}},
        .span = 100,
        .suggested = {{"step", 0.02}, {"theta", 0.008}, {"critical_kinetic_energy", 0.06}},
        .references = {"Hénon, Heiles, Astronomical Journal 69, 73 (1964)"},
    };
  }
};

}  // namespace least
