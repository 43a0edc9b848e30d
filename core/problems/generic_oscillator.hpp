// A damped oscillator that heats its brake (GENERIC): ẋ = L∇E + M∇S with E = p²/2 + q²/2 + U and S = c ln U.
#pragma once

#include <tuple>

#include "core/describe.hpp"
#include "core/problem.hpp"

namespace least::problems {

template <class R = double>
struct GenericOscillator {
  R gamma{0.1}, heat_capacity{1};

  static constexpr int dim = 3;
  static constexpr int pieces = 2;
  static constexpr bool keeps_energy = true;

  template <class T, class S>
  constexpr Vec<3, T> field(const Vec<3, T>& y, const S&) const {
    return {y[1], -y[0] - gamma * y[1], gamma * (y[1] * y[1])};
  }
  /// Friction: the kinetic energy that p loses goes into U.
  template <class T, class H, class S>
  constexpr Vec<3, T> flow(Piece<0>, const Vec<3, T>& y, const H& h, const S&) const {
    using least::exp;
    using least::phi1;
    const auto x = gamma * h;
    return {y[0], exp(-x) * y[1], y[2] + x * phi1(-2.0 * x) * (y[1] * y[1])};
  }
  /// The oscillation: an exact rotation.
  template <class T, class H, class S>
  constexpr Vec<3, T> flow(Piece<1>, const Vec<3, T>& y, const H& h, const S&) const {
    using least::sincos;
    const auto [s, c] = sincos(h);
    return {c * y[0] + s * y[1], c * y[1] - s * y[0], y[2]};
  }
  template <class T, class S>
  constexpr T energy(const Vec<3, T>& y, const S&) const {
    return 0.5 * (y[1] * y[1] + y[0] * y[0]) + y[2];
  }
  /// c ln U: never falls.
  template <class T>
  constexpr T entropy(const Vec<3, T>& y) const {
    using least::log;
    return heat_capacity * log(y[2]);
  }
  template <class T, class S>
  constexpr Vec<2, T> quantities(const Vec<3, T>& y, const S&) const {
    return {entropy(y), y[2] / heat_capacity};
  }
};

}  // namespace least::problems

namespace least {

template <>
struct About<problems::GenericOscillator> {
  using P = problems::GenericOscillator<>;
  static constexpr std::tuple fields{
      Field<P>{"gamma", "γ", "1/time", "friction per momentum", &P::gamma, {0, 1e3}},
      Field<P>{"heat_capacity", "c", "1", "internal energy per temperature", &P::heat_capacity, {1e-6, 1e6}},
  };
  static ProblemCard card() {
    return {
        .id = "generic_oscillator",
        .title = "Oscillator with heat",
        .summary =
            "A mass on a spring whose friction warms its surroundings. The total energy stays and the entropy "
            "never falls; watch whether a scheme respects both.",
        .formula =
            "<math><mi>E</mi><mo>=</mo><mfrac><msup><mi>p</mi><mn>2</mn></msup><mn>2</mn></mfrac><mo>+</mo>"
            "<mfrac><msup><mi>q</mi><mn>2</mn></msup><mn>2</mn></mfrac><mo>+</mo><mi>U</mi><mo>,</mo><mover>"
            "<mi>p</mi><mo>˙</mo></mover><mo>=</mo><mo>−</mo><mi>q</mi><mo>−</mo><mi>γ</mi><mi>p</mi>"
            "<mo>,</mo><mover><mi>U</mi><mo>˙</mo></mover><mo>=</mo><mi>γ</mi><msup><mi>p</mi><mn>2</mn>"
            "</msup></math>",
        .variables = {{"q", "q", "1", "displacement", 1},
                      {"p", "p", "1", "momentum", 0},
                      {"U", "U", "1", "internal energy", 1, false, {0, anywhere.high, true, true}}},
        .span = 50,
        .suggested = {{"step", 0.1}},
        .quantities = {{"entropy", "S", "entropy c ln U: never falls"}, {"temperature", "T", "temperature U/c"}},
        .references =
            {"Grmela, Öttinger, Dynamics and thermodynamics of complex fluids I, Phys. Rev. E 56, 6620 (1997)"},
    };
  }
};

}  // namespace least
