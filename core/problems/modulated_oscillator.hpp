// An oscillator whose friction changes its sign in time, H = p²/2 + k q²/2 + a sin(Ωt) s.
#pragma once

#include <tuple>

#include "core/describe.hpp"
#include "core/problem.hpp"

namespace least::problems {

template <class R = double>
struct ModulatedOscillator {
  R stiffness{1}, alpha{0.5}, frequency{3.141592653589793};

  static constexpr int dof = 1;

  template <class T, class S>
  constexpr T potential(const Vec<1, T>& q, const S&) const {
    return 0.5 * stiffness * (q[0] * q[0]);
  }
  template <class T, class S>
  constexpr Vec<1, T> gradient(const Vec<1, T>& q, const S&) const {
    return {stiffness * q[0]};
  }
  template <class S>
  constexpr auto damping(const S& t) const {
    using least::sin;
    return alpha * sin(frequency * t);
  }
  /// (2α/Ω) sin² Ωt/2; 0 where Ω = 0.
  template <class S>
  constexpr auto damping_integral(const S& t) const {
    using least::either;
    using least::sin;
    const auto sine = sin(0.5 * frequency * t);
    const auto twice = 2.0 * alpha * (sine * sine);
    using N = std::remove_const_t<decltype(twice)>;
    return either(
        frequency > 0, [&] { return N(twice / frequency); }, [&] { return twice; });
  }
  template <class T>
  constexpr T frequency_squared(const Vec<1, T>&) const {
    return T(stiffness);
  }
};

}  // namespace least::problems

namespace least {

template <>
struct About<problems::ModulatedOscillator> {
  using P = problems::ModulatedOscillator<>;
  static constexpr std::tuple fields{
      Field<P>{"stiffness", "k", "1/time²", "force per displacement and mass", &P::stiffness, {0, 1e150, true}},
      Field<P>{"alpha", "a", "1/time", "amplitude of the friction", &P::alpha, any_signed_strength},
      Field<P>{"frequency", "Ω", "1/time", "angular frequency of the friction", &P::frequency, {0, 1e150}},
  };
  static ProblemCard card() {
    return {
        .id = "modulated_oscillator",
        .title = "Oscillator with modulated damping",
        .summary =
            "A mass on a spring that is braked and pushed by turns. A scheme that reads the damping at the wrong "
            "time of a step shows it here by a lower order.",
        .formula =
            "<math><mi>H</mi><mo>=</mo><mfrac><msup><mi>p</mi><mn>2</mn></msup><mn>2</mn></mfrac><mo>+</mo>"
            "<mfrac><mrow><mi>k</mi><msup><mi>q</mi><mn>2</mn></msup></mrow><mn>2</mn></mfrac><mo>+</mo>"
            "<mi>a</mi><mi>sin</mi><mrow><mo>(</mo><mi>Ω</mi><mi>t</mi><mo>)</mo></mrow><mi>s</mi></math>",
        .variables = {{"q", "q", "length", "displacement from rest", 1},
                      {"p", "p", "length/time", "momentum per mass", 0},
                      {"s", "s", "length²/time", "action", 0.2, true}},
        .span = 10,
        .suggested = {{"step", 0.05}, {"sigma", 0.1}},
        .references = {"Vermeeren, Bravetti, Seri, Contact variational integrators, J. Phys. A 52, 445206 (2019)"},
    };
  }
};

}  // namespace least
