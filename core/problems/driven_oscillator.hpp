// The driven and damped oscillator, H = p²/2 + k q²/2 − q f(t) + α s with f = A cos(Ωt + φ), with its exact motion.
#pragma once

#include <tuple>

#include "core/describe.hpp"
#include "core/problem.hpp"
#include "core/problems/damped_oscillator.hpp"

namespace least::problems {

template <class R = double>
struct DrivenOscillator {
  R stiffness{1}, alpha{0.1}, amplitude{0.3}, frequency{1.0471975511965976}, phase{-1.5707963267948966};

  static constexpr int dof = 1;

  template <class S>
  constexpr auto force(const S& t) const {
    using least::cos;
    return amplitude * cos(frequency * t + phase);
  }
  template <class T, class S>
  constexpr T potential(const Vec<1, T>& q, const S& t) const {
    return 0.5 * stiffness * (q[0] * q[0]) - force(t) * q[0];
  }
  template <class T, class S>
  constexpr Vec<1, T> gradient(const Vec<1, T>& q, const S& t) const {
    return {stiffness * q[0] - force(t)};
  }
  constexpr R damping() const { return alpha; }
  template <class T>
  constexpr T frequency_squared(const Vec<1, T>&) const {
    return T(stiffness);
  }

  /// Not with weak friction close to resonance: the difference of steady and free motion would lose too many digits.
  template <class X>
  bool exact_applies(const X&) const {
    const double detuning = double(stiffness - frequency * frequency), loss = double(alpha * frequency);
    return alpha == 0 || detuning * detuning + loss * loss > 1e-8 * double(stiffness * stiffness);
  }
  /// Steady motion plus the free motion from the difference of the start. Without friction, the response from rest in
  /// terms of m = (ω+Ω)/2 and d = (ω−Ω)/2, which is smooth through the resonance d = 0.
  template <class T, class S>
  State<1, T, S> exact(const State<1, T, S>& x0, const S& t) const {
    using least::sincos;
    using least::sqrt;
    const DampedOscillator<R> free{stiffness, alpha};
    const T a(amplitude), w(frequency), tau(t - x0.t);
    if (alpha == 0) {
      const T omega = sqrt(T(stiffness)), m = (omega + w) / 2, d = (omega - w) / 2;
      const auto [sine, cosine] = sincos(T(w * x0.t + phase));
      const auto [sm, cm] = sincos(m * tau);
      const auto [sd, cd] = sincos(d * tau);
      const T beat = d == 0 ? tau : sd / d;
      const T f = sm * beat / (2 * m), g = (sm * cd / m - cm * beat) / (2 * omega), df = (cm * beat + sm * cd / m) / 2;
      State<1, T, S> x = free.exact(x0, t);
      x.q[0] += a * (cosine * f - sine * g);
      x.p[0] += a * (cosine * df - sine * w * f);
      return x;
    }
    const T detuning = T(stiffness) - w * w, loss = T(alpha) * w, scale = a / (detuning * detuning + loss * loss);
    const auto steady = [&](const S& time) -> State<1, T, S> {
      const auto [sine, cosine] = sincos(T(w * time + phase));
      return {time, {scale * (detuning * cosine + loss * sine)}, {scale * w * (loss * cosine - detuning * sine)}, {}};
    };
    const auto from = steady(x0.t), to = steady(t);
    State<1, T, S> x = free.exact(State<1, T, S>{x0.t, {x0.q[0] - from.q[0]}, {x0.p[0] - from.p[0]}, {}}, t);
    x.q[0] += to.q[0];
    x.p[0] += to.p[0];
    return x;
  }
};

}  // namespace least::problems

namespace least {

template <>
struct About<problems::DrivenOscillator> {
  using P = problems::DrivenOscillator<>;
  static constexpr std::tuple fields{
      Field<P>{"stiffness", "k", "1/time²", "force per displacement and mass", &P::stiffness, {0, 1e150, true}},
      Field<P>{"damping", "α", "1/time", "friction per momentum", &P::alpha, any_signed_strength},
      Field<P>{"amplitude", "A", "length/time²", "largest driving force per mass", &P::amplitude, any_signed_strength},
      Field<P>{"frequency", "Ω", "1/time", "angular frequency of the drive", &P::frequency, {0, 1e150}},
      Field<P>{"phase", "φ", "rad", "phase of the drive at t = 0", &P::phase, {-1e3, 1e3}},
  };
  static ProblemCard card() {
    return {
        .id = "driven_oscillator",
        .title = "Driven damped oscillator",
        .summary =
            "A mass on a spring with friction, pushed in a steady rhythm. The start dies away and the rhythm of "
            "the drive remains.",
        .formula =
            "<math><mi>H</mi><mo>=</mo><mfrac><msup><mi>p</mi><mn>2</mn></msup><mn>2</mn></mfrac><mo>+</mo>"
            "<mfrac><mrow><mi>k</mi><msup><mi>q</mi><mn>2</mn></msup></mrow><mn>2</mn></mfrac><mo>−</mo>"
            "<mi>q</mi><mi>A</mi><mi>cos</mi><mrow><mo>(</mo><mi>Ω</mi><mi>t</mi><mo>+</mo><mi>φ</mi>"
            "<mo>)</mo></mrow><mo>+</mo><mi>α</mi><mi>s</mi></math>",
        .variables = {{"q", "q", "length", "displacement from rest", 1},
                      {"p", "p", "length/time", "momentum per mass", 0},
                      {"s", "s", "length²/time", "action", 0, true}},
        .span = 50,
        .suggested = {{"step", 0.1}, {"sigma", 1}, {"critical_kinetic_energy", 5}},
        .presets =
            {{"resonance", "no friction, driven at its own frequency: grows", {{"damping", 0}, {"frequency", 1}}, {}}},
        .references = {"Vermeeren, Bravetti, Seri, Contact variational integrators, J. Phys. A 52, 445206 (2019)"},
    };
  }
};

}  // namespace least
