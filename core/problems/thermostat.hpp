// Contact density dynamics: a thermostat that lets one oscillator sample the canonical distribution.
// H = ρ^{−κ} with ρ ∝ e^{−βh(q,p)} f(s), h = p²/2 + q²/2 and f logistic of scale Q. In the time τ, dt = dτ/H:
// q′ = κβp, p′ = −κβq + κ g(s) p, s′ = κβp² − 1 with g = (ln f)′ = −tanh(s/2Q)/Q. The motion keeps the density ρ^κ: κ =
// ½ is the published flow, whose averages over the physical time t are those of ρ, κ = 1 keeps ρ itself in τ.
#pragma once

#include <array>
#include <string_view>
#include <tuple>

#include "core/describe.hpp"
#include "core/problem.hpp"

namespace least::problems {

template <class R = double>
struct Thermostat {
  R beta{1}, scale{0.1}, kappa{1};

  static constexpr int dim = 3;
  static constexpr int pieces = 3;

  /// (ln f)′
  template <class T>
  constexpr T pull(const T& s) const {
    using least::tanh;
    return tanh(s / (2.0 * scale)) / -scale;
  }
  template <class T, class S>
  constexpr Vec<3, T> field(const Vec<3, T>& y, const S&) const {
    const R w = kappa * beta;
    return {w * y[1], kappa * pull(y[2]) * y[1] - w * y[0], w * (y[1] * y[1]) - 1.0};
  }
  template <class T, class H, class S>
  constexpr Vec<3, T> flow(Piece<0>, const Vec<3, T>& y, const H& h, const S&) const {
    const R w = kappa * beta;
    return {y[0] + h * (w * y[1]), y[1], y[2] + h * (w * (y[1] * y[1]) - 1.0)};
  }
  template <class T, class H, class S>
  constexpr Vec<3, T> flow(Piece<1>, const Vec<3, T>& y, const H& h, const S&) const {
    return {y[0], y[1] - h * (kappa * beta * y[0]), y[2]};
  }
  template <class T, class H, class S>
  constexpr Vec<3, T> flow(Piece<2>, const Vec<3, T>& y, const H& h, const S&) const {
    using least::exp;
    return {y[0], y[1] * exp(h * (kappa * pull(y[2]))), y[2]};
  }

  /// Averages over the run with the weight; their expected values are β⟨q²⟩ = β⟨p²⟩ = 1, β²⟨p⁴⟩ = 3, ⟨s²⟩ = π²Q²/3.
  static constexpr std::array<std::string_view, 4> moment_names{"q2", "p2", "p4", "s2"};
  template <class T>
  constexpr Vec<4, T> moments(const Vec<3, T>& y) const {
    const T p2 = y[1] * y[1];
    return {y[0] * y[0], p2, p2 * p2, y[2] * y[2]};
  }
  /// ln ρ up to a constant.
  template <class T>
  constexpr T log_density(const Vec<3, T>& y) const {
    using least::abs;
    using least::exp;
    using least::log;
    const T u = abs(y[2]) / scale;
    const T log_f = -u - 2.0 * log(0.5 * (1.0 + exp(-u)));
    return log_f - 0.5 * beta * (y[0] * y[0] + y[1] * y[1]);
  }
  /// ln ρ^{1−κ}: the weight that turns averages over τ, whose motion conserves ρ^κ, into averages over ρ.
  template <class T>
  constexpr T log_weight(const Vec<3, T>& y) const {
    return (1.0 - kappa) * log_density(y);
  }
  /// ln dt/dτ = −ln H: the contact flow of H = ρ^{−κ} itself runs in the time t.
  template <class T>
  constexpr T log_rate(const Vec<3, T>& y) const {
    return kappa * log_density(y);
  }
  /// The fastest rate of the bath's damping and of the oscillation.
  constexpr R stiffness_rate() const {
    using least::select;
    const R damping = 1.0 / scale;
    return kappa * select(beta > damping, beta, damping);
  }
};

}  // namespace least::problems

namespace least {

template <>
struct About<problems::Thermostat> {
  using P = problems::Thermostat<>;
  static constexpr std::tuple fields{
      Field<P>{"beta", "β", "1/energy", "inverse temperature", &P::beta, {1e-3, 1e3}},
      Field<P>{"scale", "Q", "1", "width of the density of s; a narrow one mixes better", &P::scale, {1e-3, 1e3}},
      Field<P>{"kappa", "κ", "1", "power of the density that the motion keeps", &P::kappa, {0, 1, true}},
  };
  static ProblemCard card() {
    return {
        .id = "thermostat",
        .title = "Oscillator with a thermostat",
        .summary =
            "An oscillator coupled to one variable s that plays the heat bath. One long orbit should give the "
            "averages of the canonical ensemble; it does for Q = 0.1 and does not for Q = 1.",
        .formula =
            "<math><mi>H</mi><mo>=</mo><msup><mrow><mo>(</mo><mfrac><mrow><msup><mi>e</mi><mrow><mo>−</mo>"
            "<mi>β</mi><mi>h</mi></mrow></msup><mi>f</mi><mrow><mo>(</mo><mi>s</mi><mo>)</mo></mrow></mrow>"
            "<mi>Z</mi></mfrac><mo>)</mo></mrow><mrow><mo>−</mo><mn>1</mn><mo>/</mo><mn>2</mn></mrow></msup>"
            "</math>",
        .variables = {{"q", "q", "1", "displacement", 0.5},
                      {"p", "p", "1", "momentum", 0.5},
                      {"s", "s", "1", "action, here the state of the heat bath", 0}},
        .span = 100,
        .suggested = {{"step", 0.02}},
        .presets = {{"contact", "the contact flow itself: averages need weights", {{"kappa", 0.5}}, {}},
                    {"wide", "a wide density of s: one orbit does not mix", {{"scale", 1}}, {}}},
        .references =
            {"Bravetti, Tapias, Thermostat algorithm for generating target ensembles, Phys. Rev. E 93, 022139 "
             "(2016)"},
    };
  }
};

}  // namespace least
