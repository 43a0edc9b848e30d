// The turn of velocities by a magnetic field over a time, exact at a fixed place.
#pragma once

#include <utility>

#include "core/number/math.hpp"
#include "core/text/magnetic.hpp"

namespace least {

namespace detail {
/// Returns sin(hβ/2)/β and cos(hβ/2) for `square` = β²; near zero, where β has no derivative, by their series in x =
/// (hβ/2)².
template <class T>
std::pair<T, T> half_rotation(const T& square, double h) {
  using least::cos;
  using least::sin;
  using least::sqrt;
  constexpr double near = 1e-2;  // terms that are left out: x⁷/15!, x⁷/14!
  const double half = 0.5 * h;
  const T x = (half * half) * square;
  if (plain_number(x) < near) {
    const T sine =
        1.0 - (1.0 / 6) * x *
                  (1.0 - (1.0 / 20) * x *
                             (1.0 - (1.0 / 42) * x *
                                        (1.0 - (1.0 / 72) * x * (1.0 - (1.0 / 110) * x * (1.0 - (1.0 / 156) * x)))));
    const T cosine =
        1.0 - (1.0 / 2) * x *
                  (1.0 - (1.0 / 12) * x *
                             (1.0 - (1.0 / 30) * x *
                                        (1.0 - (1.0 / 56) * x * (1.0 - (1.0 / 90) * x * (1.0 - (1.0 / 132) * x)))));
    return {half * sine, cosine};
  }
  const T strength = sqrt(square), angle = half * strength;
  return {sin(angle) / strength, cos(angle)};
}
}  // namespace detail

/// ẇ = w × β over the time h for each group of velocities, by Rodrigues' formula: w + 2cσ w×β + 2σ² (w×β)×β, with
/// σ = sin(hβ/2)/β, c = cos(hβ/2). `field`: the numbers of the groups, one after the other.
template <class T>
void turn_velocities(const text::Magnetic& scene, const T* field, double h, T* w) noexcept {
  for (const text::Magnetic::Group& group : scene.groups) {
    T &a = w[group.of[0]], &b = w[group.of[1]];
    if (group.size == 2) {
      const T square = field[0] * field[0];
      const auto [sine, cosine] = detail::half_rotation(square, h);
      const T along = (2.0 * (sine * cosine)) * field[0], back = (2.0 * (sine * sine)) * square;
      const T old = a;
      a = a + (along * b - back * a);
      b = b - (along * old + back * b);
      field += 1;
      continue;
    }
    T& c = w[group.of[2]];
    const T square = field[0] * field[0] + field[1] * field[1] + field[2] * field[2];
    const auto [sine, cosine] = detail::half_rotation(square, h);
    const T along = 2.0 * (sine * cosine), back = 2.0 * (sine * sine);
    const T u0 = b * field[2] - c * field[1], u1 = c * field[0] - a * field[2], u2 = a * field[1] - b * field[0];
    a = a + (along * u0 + back * (u1 * field[2] - u2 * field[1]));
    b = b + (along * u1 + back * (u2 * field[0] - u0 * field[2]));
    c = c + (along * u2 + back * (u0 * field[1] - u1 * field[0]));
    field += 3;
  }
}

}  // namespace least
