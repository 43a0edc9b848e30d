// The pendulum with linear friction, H = p²/2 − (g/l) cos q + α s.
#pragma once

#include <tuple>

#include "core/describe.hpp"
#include "core/problem.hpp"

namespace least::problems {

template <class R = double>
struct DampedPendulum {
  R gravity{1}, length{1}, alpha{0.1};

  static constexpr int dof = 1;

  template <class T, class S>
  constexpr T potential(const Vec<1, T>& q, const S&) const {
    using least::cos;
    return -(gravity / length) * cos(q[0]);
  }
  template <class T, class S>
  constexpr Vec<1, T> gradient(const Vec<1, T>& q, const S&) const {
    using least::sin;
    return {(gravity / length) * sin(q[0])};
  }
  constexpr R damping() const { return alpha; }
  /// The value at the bottom, where it is largest.
  template <class T>
  constexpr T frequency_squared(const Vec<1, T>&) const {
    return T(gravity / length);
  }
};

}  // namespace least::problems

namespace least {

template <>
struct About<problems::DampedPendulum> {
  using P = problems::DampedPendulum<>;
  static constexpr std::tuple fields{
      Field<P>{"gravity", "g", "length/time²", "gravitational acceleration", &P::gravity, {0, 1e150, true}},
      Field<P>{"length", "l", "length", "length of the rod", &P::length, any_strength},
      Field<P>{"damping", "α", "1/time", "friction per momentum; below 0 it drives", &P::alpha, any_signed_strength},
  };
  static ProblemCard card() {
    return {
        .id = "damped_pendulum",
        .title = "Damped pendulum",
        .summary = "A pendulum with friction, let go near the top. Its swings shrink and quicken until it hangs still.",
        .formula =
            "<math><mi>H</mi><mo>=</mo><mfrac><msup><mi>p</mi><mn>2</mn></msup><mn>2</mn></mfrac><mo>−</mo>"
            "<mfrac><mi>g</mi><mi>l</mi></mfrac><mi>cos</mi><mi>q</mi><mo>+</mo><mi>α</mi><mi>s</mi></math>",
        .variables = {angle("q", "q", "angle from the vertical", 2.5),
                      {"p", "p", "rad/time", "angular velocity", 0},
                      {"s", "s", "rad²/time", "action", 0, true}},
        .span = 60,
        .suggested = {{"step", 0.1}, {"sigma", 0.2}},
        .presets = {{"over_the_top", "starts fast enough to turn over several times", {}, {{"q", 0}, {"p", 5}}}},
        .references = {"Vermeeren, Bravetti, Seri, Contact variational integrators, J. Phys. A 52, 445206 (2019)"},
    };
  }
};

}  // namespace least
