// The van der Pol oscillator, ẍ = −x + ε(1−x²)ẋ + A cos(Ωt): limit cycle, relaxation and, when driven, chaos.
// Lift to a contact Hamiltonian: H = p s − ε(1−q²)s + q − A cos(Ωt) with q = x, s = v and p the slope dv/dx of the
// orbit.
#pragma once

#include <limits>
#include <tuple>

#include "core/describe.hpp"
#include "core/problem.hpp"

namespace least::problems {

template <class R = double>
struct VanDerPol {
  R epsilon{1}, amplitude{0}, frequency{1};

  static constexpr int dim = 2;
  static constexpr int pieces = 2;
  static constexpr bool carries_slope = true;
  static constexpr bool oscillates = true;

  /// The rate of the fast motion, |f| at x = 0: steps should be short compared with its inverse.
  constexpr R stiffness_rate() const { return epsilon; }

  template <class S>
  constexpr auto force(const S& t) const {
    using least::cos;
    return amplitude * cos(frequency * t);
  }
  template <class T, class S>
  constexpr Vec<2, T> field(const Vec<2, T>& y, const S& t) const {
    return {y[1], epsilon * (1.0 - y[0] * y[0]) * y[1] - y[0] + force(t)};
  }
  template <class T, class H, class S>
  constexpr Vec<2, T> flow(Piece<0>, const Vec<2, T>& y, const H& h, const S&) const {
    return {y[0] + h * y[1], y[1]};
  }
  /// v̇ = −f v − F at fixed x, with f = −ε(1−x²) and F = x − A cos(Ωt).
  template <class T, class H, class S>
  constexpr Vec<2, T> flow(Piece<1>, const Vec<2, T>& y, const H& h, const S& t) const {
    using least::exp;
    using least::phi1;
    const T z = epsilon * h * (1.0 - y[0] * y[0]);
    return {y[0], exp(z) * y[1] - h * phi1(z) * (y[0] - force(t))};
  }
};

}  // namespace least::problems

namespace least {

template <>
struct About<problems::VanDerPol> {
  using P = problems::VanDerPol<>;
  static constexpr std::tuple fields{
      Field<P>{"epsilon", "ε", "1", "strength of the friction, which drives where |x| < 1", &P::epsilon, {0, 1e4}},
      Field<P>{"amplitude", "A", "1", "amplitude of the driving force", &P::amplitude, {-1e3, 1e3}},
      Field<P>{"frequency", "Ω", "1", "angular frequency of the driving force", &P::frequency, {0, 1e3}},
  };
  static ProblemCard card() {
    return {
        .id = "van_der_pol",
        .title = "van der Pol oscillator",
        .summary =
            "An oscillator that feeds small swings and brakes large ones, so that every start ends on one cycle. "
            "For large ε it creeps and jumps: keep the step below 0.2/ε.",
        .formula =
            "<math><mover><mi>x</mi><mo>¨</mo></mover><mo>=</mo><mo>−</mo><mi>x</mi><mo>+</mo><mi>ε</mi>"
            "<mrow><mo>(</mo><mn>1</mn><mo>−</mo><msup><mi>x</mi><mn>2</mn></msup><mo>)</mo></mrow><mover>"
            "<mi>x</mi><mo>˙</mo></mover><mo>+</mo><mi>A</mi><mi>cos</mi><mrow><mo>(</mo><mi>Ω</mi><mi>t</mi>"
            "<mo>)</mo></mrow></math>",
        .variables = {{"x", "x", "1", "displacement", 2},
                      {"v", "v", "1", "velocity", 0},
                      {"slope", "dv/dx", "1", "slope of the orbit; not given: that of the flow",
                       std::numeric_limits<double>::quiet_NaN(), true}},
        .span = 30,
        .suggested = {{"step", 0.01}},
        .presets = {{"relaxation_5", "period 11.612", {{"epsilon", 5}}, {}},
                    {"relaxation_10", "period 19.078", {{"epsilon", 10}}, {}},
                    {"relaxation_100", "period 162.84", {{"epsilon", 100}}, {}, {{"step", 0.001}}, 350},
                    {"relaxation_1000", "period 1614.4", {{"epsilon", 1000}}, {}, {{"step", 0.0002}}, 3500},
                    {"forced",
                     "driven into chaos: compare statistics, not states",
                     {{"epsilon", 5}, {"amplitude", 5}, {"frequency", 2.463}},
                     {{"x", 2}, {"v", 2}}}},
        .references = {"Zadra, Bravetti, García-Chung, Seri, Geometric numerical integration of Liénard systems via a "
                       "contact Hamiltonian approach, Mathematics 9, 1960 (2021)"},
    };
  }
};

}  // namespace least
