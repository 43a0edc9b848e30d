// A homogeneous scalar field in an expanding universe, H = p²/2 + m²q²/2 + λq⁴/4 + γ s²/2.
#pragma once

#include <tuple>

#include "core/describe.hpp"
#include "core/problem.hpp"

namespace least::problems {

template <class R = double>
struct ScalarFieldCosmology {
  R mass{1}, lambda{0}, gamma{0.1};

  static constexpr int dof = 1;

  template <class T, class S>
  constexpr T potential(const Vec<1, T>& q, const S&) const {
    const T q2 = q[0] * q[0];
    return q2 * (0.5 * (mass * mass) + 0.25 * lambda * q2);
  }
  template <class T, class S>
  constexpr Vec<1, T> gradient(const Vec<1, T>& q, const S&) const {
    return {q[0] * (mass * mass + lambda * (q[0] * q[0]))};
  }
  constexpr R action_curvature() const { return gamma; }
  constexpr R offset() const { return R(0); }
  /// V″
  template <class T>
  constexpr T frequency_squared(const Vec<1, T>& q) const {
    return mass * mass + 3.0 * lambda * (q[0] * q[0]);
  }
};

}  // namespace least::problems

namespace least {

template <>
struct About<problems::ScalarFieldCosmology> {
  using P = problems::ScalarFieldCosmology<>;
  static constexpr std::tuple fields{
      Field<P>{"mass", "m", "1", "mass of the field", &P::mass, {0, 1e3}},
      Field<P>{"lambda", "λ", "1", "strength of its interaction with itself", &P::lambda, {0, 1e3}},
      Field<P>{"gamma", "γ", "1", "how strongly s brakes", &P::gamma, {0, 1e3}},
  };
  static ProblemCard card() {
    return {
        .id = "scalar_field_cosmology",
        .title = "Scalar field in an expanding universe",
        .summary =
            "A field that fills space and swings about zero while the expansion brakes it. Watch the swings die "
            "as the rate of expansion, γs, slows down with them.",
        .formula =
            "<math><mi>H</mi><mo>=</mo><mfrac><msup><mi>p</mi><mn>2</mn></msup><mn>2</mn></mfrac><mo>+</mo>"
            "<mfrac><mrow><msup><mi>m</mi><mn>2</mn></msup><msup><mi>q</mi><mn>2</mn></msup></mrow><mn>2</mn>"
            "</mfrac><mo>+</mo><mfrac><mrow><mi>λ</mi><msup><mi>q</mi><mn>4</mn></msup></mrow><mn>4</mn>"
            "</mfrac><mo>+</mo><mfrac><mrow><mi>γ</mi><msup><mi>s</mi><mn>2</mn></msup></mrow><mn>2</mn>"
            "</mfrac></math>",
        .variables = {{"q", "q", "1", "value of the field", 0.5},
                      {"p", "p", "1", "its rate of change", 0.5},
                      {"s", "s", "1", "action, here the rate of expansion", 1}},
        .span = 50,
        .suggested = {{"step", 0.05}},
        .references = {"Sloan, New action for cosmology, Phys. Rev. D 103, 043524 (2021)"},
    };
  }
};

}  // namespace least
