// Steepest descent in a tilted double well, ẋ = −∇U with U = a(x²−1)²/4 + b y²/2 + c x y.
#pragma once

#include <tuple>

#include "core/describe.hpp"
#include "core/problem.hpp"

namespace least::problems {

template <class R = double>
struct GradientFlow {
  R a{1}, b{1}, c{0.3};

  static constexpr int dim = 2;
  static constexpr int pieces = 3;

  template <class T>
  constexpr T potential(const Vec<2, T>& y) const {
    const T w = y[0] * y[0] - 1.0;
    return 0.25 * a * (w * w) + 0.5 * b * (y[1] * y[1]) + c * (y[0] * y[1]);
  }
  template <class T, class S>
  constexpr Vec<2, T> field(const Vec<2, T>& y, const S&) const {
    return {a * (y[0] - y[0] * (y[0] * y[0])) - c * y[1], -(b * y[1]) - c * y[0]};
  }
  /// The double well: ẋ = ax − ax³.
  template <class T, class H, class S>
  constexpr Vec<2, T> flow(Piece<0>, const Vec<2, T>& y, const H& h, const S&) const {
    using least::exp;
    using least::phi1;
    using least::sqrt;
    const auto z = -2.0 * (a * h);
    return {y[0] / sqrt(exp(z) - z * phi1(z) * (y[0] * y[0])), y[1]};
  }
  template <class T, class H, class S>
  constexpr Vec<2, T> flow(Piece<1>, const Vec<2, T>& y, const H& h, const S&) const {
    return {y[0] - c * h * y[1], y[1]};
  }
  template <class T, class H, class S>
  constexpr Vec<2, T> flow(Piece<2>, const Vec<2, T>& y, const H& h, const S&) const {
    using least::phi1;
    return {y[0], y[1] - h * phi1(-(b * h)) * (b * y[1] + c * y[0])};
  }
  template <class T, class S>
  constexpr Vec<1, T> quantities(const Vec<2, T>& y, const S&) const {
    return {potential(y)};
  }
};

}  // namespace least::problems

namespace least {

template <>
struct About<problems::GradientFlow> {
  using P = problems::GradientFlow<>;
  static constexpr std::tuple fields{
      Field<P>{"a", "a", "1", "height of the wall between the wells, times 4", &P::a, {0, 1e3}},
      Field<P>{"b", "b", "1", "steepness across the wells", &P::b, {0, 1e3}},
      Field<P>{"c", "c", "1", "coupling of x and y: turns the wells", &P::c, {-1e3, 1e3}},
  };
  static ProblemCard card() {
    return {
        .id = "gradient_flow",
        .title = "Gradient flow in a double well",
        .summary =
            "A point that always moves straight downhill, without inertia, into one of two wells. The height U "
            "must fall along every orbit.",
        .formula =
            "<math><mover><mi>x</mi><mo>˙</mo></mover><mo>=</mo><mo>−</mo><mo>∇</mo><mi>U</mi><mo>,</mo>"
            "<mi>U</mi><mo>=</mo><mfrac><mrow><mi>a</mi><msup><mrow><mo>(</mo><msup><mi>x</mi><mn>2</mn>"
            "</msup><mo>−</mo><mn>1</mn><mo>)</mo></mrow><mn>2</mn></msup></mrow><mn>4</mn></mfrac><mo>+</mo>"
            "<mfrac><mrow><mi>b</mi><msup><mi>y</mi><mn>2</mn></msup></mrow><mn>2</mn></mfrac><mo>+</mo>"
            "<mi>c</mi><mi>x</mi><mi>y</mi></math>",
        .variables = {{"x", "x", "1", "position along the line of the wells", 0.1},
                      {"y", "y", "1", "position across it", 1}},
        .span = 10,
        .suggested = {{"step", 0.05}},
        .quantities = {{"potential", "U", "height: never rises"}},
        .references = {"Hairer, Lubich, Wanner, Geometric Numerical Integration, 2006"},
    };
  }
};

}  // namespace least
