// A number with its square as a fraction, which products, quotients and roots of it make by multiplications
// alone. So a problem's ω² is compared with a limit at every step without the roots and divisions of its value, which
// are most of what a force costs. Only units of lanes include this header.
#pragma once

#include <limits>

#include "core/number/lanes.hpp"

namespace least {

struct LaneSquare {
  Lanes value{};           ///< not computed where nobody asks for it
  Lanes over{}, under{1};  ///< value², to a few roundings
  bool plain = true;       ///< neither product, quotient nor root: its value is all there is to it

  LaneSquare() = default;
  LEAST_INLINE LaneSquare(const Lanes& x) : value(x), over(x * x) {}  // NOLINT(google-explicit-constructor)
  LEAST_INLINE LaneSquare(double x) : LaneSquare(Lanes(x)) {}         // NOLINT(google-explicit-constructor)
  LEAST_INLINE LaneSquare(const Lanes& x, const Lanes& numerator, const Lanes& denominator)
      : value(x), over(numerator), under(denominator), plain(false) {}

  LEAST_INLINE friend LaneSquare operator-(const LaneSquare& a) { return {-a.value, a.over, a.under}; }
  LEAST_INLINE friend LaneSquare operator+(const LaneSquare& a, const LaneSquare& b) { return a.value + b.value; }
  LEAST_INLINE friend LaneSquare operator-(const LaneSquare& a, const LaneSquare& b) { return a.value - b.value; }
  LEAST_INLINE friend LaneSquare operator*(const LaneSquare& a, const LaneSquare& b) {
    return {a.value * b.value, a.over * b.over, a.under * b.under};
  }
  LEAST_INLINE friend LaneSquare operator/(const LaneSquare& a, const LaneSquare& b) {
    return {a.value / b.value, a.over * b.under, a.under * b.over};
  }
};
LEAST_INLINE LaneSquare sqrt(const LaneSquare& a) { return {sqrt(a.value), a.value, Lanes(1)}; }
LEAST_INLINE LaneSquare abs(const LaneSquare& a) { return {abs(a.value), a.over, a.under}; }

/// What stands for a limit when it is compared with such numbers: its square, a little less, so that nothing above the
/// limit is missed. What follows from it is to be looked at again.
LEAST_INLINE Lanes screen_of(const Lanes& limit) {
  constexpr double most = 1e300, room = 1 - 1e-9;
  const Lanes square = limit * limit * Lanes(room);
  return select((square > Lanes(most)) & (limit < Lanes(std::numeric_limits<double>::infinity())), Lanes(most), square);
}
/// Whether it is below the limit for sure: not where its square is, nor where numbers are too small to tell.
LEAST_INLINE LaneMask is_below(const LaneSquare& a, const Lanes& limit, const Lanes& screen) {
  if (a.plain) return a.value <= limit;
  const Lanes least(1e-300);
  return select(least > a.over, least, a.over) <= screen * a.under;
}

}  // namespace least
