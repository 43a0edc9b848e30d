// An oscillator in an expanding universe, H = p²/2 + γ s²/2 + q²/2 − R: the friction coefficient is γ s.
#pragma once

#include <tuple>

#include "core/describe.hpp"
#include "core/problem.hpp"

namespace least::problems {

template <class R = double>
struct CosmologicalOscillator {
  R gamma{1}, source{1};

  static constexpr int dof = 1;

  template <class T, class S>
  constexpr T potential(const Vec<1, T>& q, const S&) const {
    return 0.5 * (q[0] * q[0]);
  }
  template <class T, class S>
  constexpr Vec<1, T> gradient(const Vec<1, T>& q, const S&) const {
    return q;
  }
  constexpr R action_curvature() const { return gamma; }
  constexpr R offset() const { return source; }
  template <class T>
  constexpr T frequency_squared(const Vec<1, T>&) const {
    return T(1);
  }
};

}  // namespace least::problems

namespace least {

template <>
struct About<problems::CosmologicalOscillator> {
  using P = problems::CosmologicalOscillator<>;
  static constexpr std::tuple fields{
      Field<P>{"gamma", "γ", "1", "how strongly s brakes", &P::gamma, {0, 1e3}},
      Field<P>{"R", "R", "1", "what feeds s: a constant energy density", &P::source, {-1e3, 1e3}},
  };
  static ProblemCard card() {
    return {
        .id = "cosmological_oscillator",
        .title = "Cosmological oscillator",
        .summary =
            "An oscillator in an expanding or shrinking universe: friction γs, and s moves too. Orbits leave the "
            "repelling point s = −√(2R/γ) and end in the attracting one at +√(2R/γ), or fall below and blow up.",
        .formula =
            "<math><mi>H</mi><mo>=</mo><mfrac><msup><mi>p</mi><mn>2</mn></msup><mn>2</mn></mfrac><mo>+</mo>"
            "<mfrac><mrow><mi>γ</mi><msup><mi>s</mi><mn>2</mn></msup></mrow><mn>2</mn></mfrac><mo>+</mo>"
            "<mfrac><msup><mi>q</mi><mn>2</mn></msup><mn>2</mn></mfrac><mo>−</mo><mi>R</mi></math>",
        .variables = {{"q", "q", "1", "displacement", 0.5},
                      {"p", "p", "1", "momentum", 0.3},
                      {"s", "s", "1", "action, here the rate of expansion", -1}},
        .span = 20,
        .suggested = {{"step", 0.05}},
        .presets = {{"zero_energy",
                     "starts on the ellipsoid H = 0, which the motion never leaves",
                     {},
                     {{"q", 0.5}, {"p", 0.3}, {"s", -1.2884098726725126}}},
                    {"blow_up",
                     "starts on the axis below the repelling point: s reaches −∞ at t = 1.24645",
                     {},
                     {{"q", 0}, {"p", 0}, {"s", -2}}}},
        .references = {"Sloan, New action for cosmology, Phys. Rev. D 103, 043524 (2021)",
                       "Bravetti, Contact Hamiltonian dynamics: the concept and its use, Entropy 19, 535 (2017)"},
    };
  }
};

}  // namespace least
