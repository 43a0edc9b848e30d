// The planar double pendulum in absolute angles: the kinetic metric depends on the configuration.
//   g = ((m₁+m₂)l₁²  m₂l₁l₂c; m₂l₁l₂c  m₂l₂²), c = cos(θ₁−θ₂);  V = −(m₁+m₂)γl₁ cos θ₁ − m₂γl₂ cos θ₂
#pragma once

#include <tuple>

#include "core/describe.hpp"
#include "core/problem.hpp"

namespace least::problems {

template <class R = double>
struct DoublePendulum {
  R m1{1}, m2{1}, l1{1}, l2{1}, gravity{1};

  static constexpr int dof = 2;

  template <class T>
  constexpr Mat<2, T> metric(const Vec<2, T>& q) const {
    using least::cos;
    const T coupling = m2 * l1 * l2 * cos(q[0] - q[1]);
    return {{{T((m1 + m2) * l1 * l1), coupling}, {coupling, T(m2 * l2 * l2)}}};
  }
  template <class T, class S>
  constexpr T potential(const Vec<2, T>& q, const S&) const {
    using least::cos;
    return -((m1 + m2) * gravity * l1) * cos(q[0]) - (m2 * gravity * l2) * cos(q[1]);
  }
};

}  // namespace least::problems

namespace least {

template <>
struct About<problems::DoublePendulum> {
  using P = problems::DoublePendulum<>;
  static constexpr Range positive{1e-50, 1e50};
  static constexpr std::tuple fields{
      Field<P>{"m1", "m₁", "mass", "upper mass", &P::m1, positive},
      Field<P>{"m2", "m₂", "mass", "lower mass", &P::m2, positive},
      Field<P>{"l1", "l₁", "length", "upper rod", &P::l1, positive},
      Field<P>{"l2", "l₂", "length", "lower rod", &P::l2, positive},
      Field<P>{"gravity",
               "γ",
               "length/time²",
               "gravitational acceleration; 0 leaves a free linkage",
               &P::gravity,
               {0, 1e150}},
  };
  static ProblemCard card() {
    return {
        .id = "double_pendulum",
        .title = "Double pendulum",
        .summary =
            "Two rods, one hung from the other. Its kinetic metric depends on the configuration, so explicit "
            "leapfrog does not apply; from larger angles it is chaotic.",
        .formula =
            "<math><mi>L</mi><mo>=</mo><mfrac><mn>1</mn><mn>2</mn></mfrac><msub><mi>g</mi><mi>ij</mi></msub>"
            "<mrow><mo>(</mo><mi>θ</mi><mo>)</mo></mrow><msup><mover><mi>θ</mi><mo>˙</mo></mover><mi>i</mi>"
            "</msup><msup><mover><mi>θ</mi><mo>˙</mo></mover><mi>j</mi></msup><mo>+</mo><mrow><mo>(</mo><msub>"
            "<mi>m</mi><mn>1</mn></msub><mo>+</mo><msub><mi>m</mi><mn>2</mn></msub><mo>)</mo></mrow><mi>γ</mi>"
            "<msub><mi>l</mi><mn>1</mn></msub><mi>cos</mi><msub><mi>θ</mi><mn>1</mn></msub><mo>+</mo><msub>"
            "<mi>m</mi><mn>2</mn></msub><mi>γ</mi><msub><mi>l</mi><mn>2</mn></msub><mi>cos</mi><msub><mi>θ</mi>"
            "<mn>2</mn></msub></math>",
        .variables = {angle("theta1", "θ₁", "angle of the upper rod from the vertical", 1),
                      angle("theta2", "θ₂", "angle of the lower rod from the vertical", 0.5),
                      {"p1", "p₁", "mass·length²/time", "momentum conjugate to θ₁", 0},
                      {"p2", "p₂", "mass·length²/time", "momentum conjugate to θ₂", 0}},
        .span = 50,
        .suggested = {{"step", 0.02}, {"theta", 0.01}, {"critical_kinetic_energy", 0.5}},
        .references = {"Marsden, West, Acta Numerica 10, 357 (2001)",
                       "Shinbrot, Grebogi, Wisdom, Yorke, American Journal of Physics 60, 491 (1992)"},
    };
  }
};

}  // namespace least
