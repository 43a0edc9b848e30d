// The Lorenz system, split into three affine flows: chaos without mechanics.
#pragma once

#include <tuple>

#include "core/describe.hpp"
#include "core/problem.hpp"

namespace least::problems {

template <class R = double>
struct Lorenz {
  R sigma{10}, rho{28}, beta{2.6666666666666665};

  static constexpr int dim = 3;
  static constexpr int pieces = 3;

  template <class T, class S>
  constexpr Vec<3, T> field(const Vec<3, T>& y, const S&) const {
    return {sigma * (y[1] - y[0]), y[0] * (rho - y[2]) - y[1], y[0] * y[1] - beta * y[2]};
  }
  template <class T, class H, class S>
  constexpr Vec<3, T> flow(Piece<0>, const Vec<3, T>& y, const H& h, const S&) const {
    using least::phi1;
    const auto x = sigma * h;
    return {y[0] + x * phi1(-x) * (y[1] - y[0]), y[1], y[2]};
  }
  template <class T, class H, class S>
  constexpr Vec<3, T> flow(Piece<1>, const Vec<3, T>& y, const H& h, const S&) const {
    using least::phi1;
    return {y[0], y[1] + h * phi1(-h) * (y[0] * (rho - y[2]) - y[1]), y[2]};
  }
  template <class T, class H, class S>
  constexpr Vec<3, T> flow(Piece<2>, const Vec<3, T>& y, const H& h, const S&) const {
    using least::phi1;
    return {y[0], y[1], y[2] + h * phi1(-(beta * h)) * (y[0] * y[1] - beta * y[2])};
  }
};

}  // namespace least::problems

namespace least {

template <>
struct About<problems::Lorenz> {
  using P = problems::Lorenz<>;
  static constexpr std::tuple fields{
      Field<P>{"sigma", "σ", "1", "Prandtl number: viscosity against conduction of heat", &P::sigma, {0, 1e3}},
      Field<P>{"rho", "ρ", "1", "Rayleigh number over its critical value: the heating", &P::rho, {-1e3, 1e3}},
      Field<P>{"beta", "β", "1", "shape of the convection rolls", &P::beta, {0, 1e3}},
  };
  static ProblemCard card() {
    return {
        .id = "lorenz",
        .title = "Lorenz system",
        .summary =
            "A layer of air heated from below, in three numbers. Orbits circle two points by turns; neighbours "
            "part tenfold every 2.5 time units, so only statistics can be compared for long.",
        .formula =
            "<math><mover><mi>x</mi><mo>˙</mo></mover><mo>=</mo><mi>σ</mi><mrow><mo>(</mo><mi>y</mi>"
            "<mo>−</mo><mi>x</mi><mo>)</mo></mrow><mo>,</mo><mover><mi>y</mi><mo>˙</mo></mover><mo>=</mo>"
            "<mi>x</mi><mrow><mo>(</mo><mi>ρ</mi><mo>−</mo><mi>z</mi><mo>)</mo></mrow><mo>−</mo><mi>y</mi>"
            "<mo>,</mo><mover><mi>z</mi><mo>˙</mo></mover><mo>=</mo><mi>x</mi><mi>y</mi><mo>−</mo><mi>β</mi>"
            "<mi>z</mi></math>",
        .variables = {{"x", "x", "1", "strength of the convection", 1},
                      {"y", "y", "1", "difference of temperature between rising and sinking air", 1},
                      {"z", "z", "1", "bend of the temperature profile", 1}},
        .span = 10,
        .suggested = {{"step", 0.005}},
        .presets = {{"convection", "steady rolls: spirals into a fixed point", {{"rho", 10}}, {}},
                    {"rest", "heating too weak: everything comes to rest", {{"rho", 0.5}}, {}}},
        .references = {"Lorenz, Deterministic nonperiodic flow, J. Atmos. Sci. 20, 130 (1963)"},
    };
  }
};

}  // namespace least
