// Interval arithmetic. An Enclosure contains every value that an expression takes while its variables run through their
// enclosures, and says whether the expression is defined there. Bounds are moved outwards by more than rounding can be
// off, so the enclosure of a single point is as wide as its round-off. A RateEnclosure contains the derivative, too,
// from which follows how often the graph of an expression can turn.
// Source: Moore, Kearfott & Cloud, Introduction to Interval Analysis, 2009, chapters 2, 5 and 6.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace least::interval {

struct Enclosure {
  /// Whether the expression is a number for all values of its variables, for some, or for none.
  enum class Defined : std::uint8_t { everywhere, partly, nowhere };

  double low = 0, high = 0;
  Defined defined = Defined::everywhere;

  constexpr Enclosure() = default;
  constexpr Enclosure(double point) : low(point), high(point) {}  // NOLINT: a number like any other
  /// Exactly these bounds.
  constexpr Enclosure(double from, double to, Defined where = Defined::everywhere)
      : low(from), high(to), defined(where) {}
  /// These bounds, moved outwards by more than their rounding errors.
  static Enclosure rounded(double low, double high, Defined where) {
    constexpr double unit = 0x1p-51, most = std::numeric_limits<double>::max();
    // A lower bound may have overflowed to +∞ and an upper one to −∞: the largest finite number of that sign is a safe
    // bound. NaN bounds nothing.
    low = low <= most ? low - unit * std::abs(low) : std::isnan(low) ? -infinite : most;
    high = high >= -most ? high + unit * std::abs(high) : std::isnan(high) ? infinite : -most;
    return {low, high, where};
  }
  static Enclosure line(Defined where) { return {-infinite, infinite, where}; }
  static Enclosure undefined() { return {0, 0, Defined::nowhere}; }

  bool contains(double x) const { return low <= x && x <= high; }
  bool everywhere() const { return defined == Defined::everywhere; }
  double magnitude() const { return std::max(std::abs(low), std::abs(high)); }
  double width() const { return high - low; }

  static constexpr double infinite = std::numeric_limits<double>::infinity();
};

using Defined = Enclosure::Defined;

constexpr Defined both(Defined a, Defined b) { return a < b ? b : a; }
/// Returns an enclosure of the values of both.
inline Enclosure hull(const Enclosure& a, const Enclosure& b) {
  if (a.defined == Defined::nowhere) return {b.low, b.high, both(b.defined, Defined::partly)};
  if (b.defined == Defined::nowhere) return {a.low, a.high, Defined::partly};
  return {std::min(a.low, b.low), std::max(a.high, b.high), both(a.defined, b.defined)};
}

inline Enclosure operator+(const Enclosure& a, const Enclosure& b) {
  return Enclosure::rounded(a.low + b.low, a.high + b.high, both(a.defined, b.defined));
}
inline Enclosure operator-(const Enclosure& a, const Enclosure& b) {
  return Enclosure::rounded(a.low - b.high, a.high - b.low, both(a.defined, b.defined));
}
inline Enclosure operator-(const Enclosure& a) { return {-a.high, -a.low, a.defined}; }
inline Enclosure square(const Enclosure& a) {
  const double low = a.low * a.low, high = a.high * a.high;
  return Enclosure::rounded(a.contains(0) ? 0 : std::min(low, high), std::max(low, high), a.defined);
}
inline Enclosure operator*(const Enclosure& a, const Enclosure& b) {
  if (&a == &b) return square(a);  // the two factors are the same number: their signs agree
  double ends[] = {a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high};
  if (std::isnan(ends[0] + ends[1] + ends[2] + ends[3])) {
    // An infinite bound stands for arbitrarily large numbers, and zero times any of these is zero.
    const auto times = [](double x, double y) { return x == 0 || y == 0 ? 0 : x * y; };
    ends[0] = times(a.low, b.low), ends[1] = times(a.low, b.high);
    ends[2] = times(a.high, b.low), ends[3] = times(a.high, b.high);
  }
  return Enclosure::rounded(std::min(std::min(ends[0], ends[1]), std::min(ends[2], ends[3])),
                            std::max(std::max(ends[0], ends[1]), std::max(ends[2], ends[3])),
                            both(a.defined, b.defined));
}
inline Enclosure operator*(const Enclosure& a, double c) {
  return c < 0 ? Enclosure::rounded(a.high * c, a.low * c, a.defined)
               : Enclosure::rounded(a.low * c, a.high * c, a.defined);
}
inline Enclosure operator+(const Enclosure& a, double c) {
  return Enclosure::rounded(a.low + c, a.high + c, a.defined);
}
inline Enclosure operator-(double c, const Enclosure& a) {
  return Enclosure::rounded(c - a.high, c - a.low, a.defined);
}
inline Enclosure inverse(const Enclosure& a) {
  if (!a.contains(0)) return Enclosure::rounded(1 / a.high, 1 / a.low, a.defined);
  if (a.low == 0 && a.high == 0) return Enclosure::undefined();
  const Defined where = both(a.defined, Defined::partly);
  if (a.low == 0) return {1 / a.high, Enclosure::infinite, where};
  if (a.high == 0) return {-Enclosure::infinite, 1 / a.low, where};
  return Enclosure::line(where);
}
inline Enclosure operator/(const Enclosure& a, const Enclosure& b) { return a * inverse(b); }

/// Returns the part of an enclosure in the domain [low, high] of a function.
inline Enclosure within(const Enclosure& a, double low, double high) {
  if (a.low >= low && a.high <= high) return a;
  if (a.high < low || a.low > high) return Enclosure::undefined();
  return {std::max(a.low, low), std::min(a.high, high), both(a.defined, Defined::partly)};
}
/// Encloses an increasing function f of a.
template <class F>
Enclosure rising(const Enclosure& a, F&& f) {
  return Enclosure::rounded(f(a.low), f(a.high), a.defined);
}

inline Enclosure sqrt(const Enclosure& a) {
  return rising(within(a, 0, Enclosure::infinite), [](double x) { return std::sqrt(x); });
}
inline Enclosure exp(const Enclosure& a) {
  return rising(a, [](double x) { return std::exp(x); });
}
inline Enclosure log(const Enclosure& a) {
  Enclosure above = within(a, 0, Enclosure::infinite);
  if (above.low == 0) above.defined = both(above.defined, above.high == 0 ? Defined::nowhere : Defined::partly);
  return rising(above, [](double x) { return std::log(x); });
}
inline Enclosure sinh(const Enclosure& a) {
  return rising(a, [](double x) { return std::sinh(x); });
}
inline Enclosure tanh(const Enclosure& a) {
  return rising(a, [](double x) { return std::tanh(x); });
}
inline Enclosure atan(const Enclosure& a) {
  return rising(a, [](double x) { return std::atan(x); });
}
inline Enclosure asin(const Enclosure& a) {
  return rising(within(a, -1, 1), [](double x) { return std::asin(x); });
}
inline Enclosure acos(const Enclosure& a) {
  return -rising(within(a, -1, 1), [](double x) { return -std::acos(x); });
}
inline Enclosure cosh(const Enclosure& a) {
  const double low = std::cosh(a.low), high = std::cosh(a.high);
  return Enclosure::rounded(a.contains(0) ? 1 : std::min(low, high), std::max(low, high), a.defined);
}

/// Whether the enclosure contains a point first + n·period, n whole, or may contain one by rounding.
inline bool contains_one(const Enclosure& a, double first, double period) {
  const double from = (a.low - first) / period, to = (a.high - first) / period;
  const double near = 0x1p-50 * std::max(std::abs(from), std::abs(to));
  return !(std::floor(to + near) < std::ceil(from - near));
}
inline constexpr double half_turn = 3.14159265358979323846;
/// Encloses a cosine wave of a that has its maximum, 1, at `top` and these values at the ends of a.
inline Enclosure wave(const Enclosure& a, double top, double at_low, double at_high) {
  if (!(a.width() < 2 * half_turn)) return {-1, 1, a.defined};
  const double low = contains_one(a, top - half_turn, 2 * half_turn) ? -1 : std::min(at_low, at_high);
  const double high = contains_one(a, top, 2 * half_turn) ? 1 : std::max(at_low, at_high);
  return Enclosure::rounded(low, high, a.defined);
}
inline Enclosure sin(const Enclosure& a) { return wave(a, half_turn / 2, std::sin(a.low), std::sin(a.high)); }
inline Enclosure cos(const Enclosure& a) { return wave(a, 0, std::cos(a.low), std::cos(a.high)); }
inline Enclosure tan(const Enclosure& a) {
  if (!(a.width() < half_turn) || contains_one(a, half_turn / 2, half_turn))
    return Enclosure::line(both(a.defined, Defined::partly));
  return rising(a, [](double x) { return std::tan(x); });
}

inline Enclosure pow(const Enclosure& a, double exponent) {
  if (exponent < 0) return inverse(pow(a, -exponent));
  const bool whole = exponent == std::floor(exponent), even = std::fmod(exponent, 2) == 0;
  const Enclosure base = whole ? a : within(a, 0, Enclosure::infinite);
  const double low = std::pow(base.low, exponent), high = std::pow(base.high, exponent);
  if (!whole || !even) return Enclosure::rounded(low, high, base.defined);
  return Enclosure::rounded(base.contains(0) ? 0 : std::min(low, high), std::max(low, high), base.defined);
}

/// Whether a comparison may hold for some values, and whether it may fail for some.
struct EnclosureMask {
  bool may_hold, may_fail;
};
inline EnclosureMask operator<(const Enclosure& a, const Enclosure& b) {
  // A comparison with NaN is false.
  const bool known = a.defined != Defined::nowhere;
  return {known && a.low < b.high, a.high >= b.low || !a.everywhere()};
}
inline Enclosure select(const EnclosureMask& mask, const Enclosure& yes, const Enclosure& no) {
  return mask.may_hold && mask.may_fail ? hull(yes, no) : mask.may_hold ? yes : no;
}

/// RateEnclosure encloses a value and its derivative with respect to time.
struct RateEnclosure {
  Enclosure value, rate;

  RateEnclosure() = default;
  RateEnclosure(double constant) : value(constant) {}  // NOLINT: a number like any other
  RateEnclosure(const Enclosure& of_value, const Enclosure& of_rate) : value(of_value), rate(of_rate) {}
  /// Whether the derivative keeps one sign, so that the value passes zero at most once.
  bool monotone() const { return value.everywhere() && (rate.low >= 0 || rate.high <= 0); }
};

inline RateEnclosure operator+(const RateEnclosure& a, const RateEnclosure& b) {
  return {a.value + b.value, a.rate + b.rate};
}
inline RateEnclosure operator-(const RateEnclosure& a, const RateEnclosure& b) {
  return {a.value - b.value, a.rate - b.rate};
}
inline RateEnclosure operator*(const RateEnclosure& a, const RateEnclosure& b) {
  if (&a == &b) return {square(a.value), a.value * a.rate * 2.0};
  return {a.value * b.value, a.value * b.rate + a.rate * b.value};
}
inline RateEnclosure operator/(const RateEnclosure& a, const RateEnclosure& b) {
  const Enclosure inverted = inverse(b.value), quotient = a.value * inverted;
  return {quotient, (a.rate - quotient * b.rate) * inverted};
}
inline RateEnclosure operator*(const RateEnclosure& a, double c) { return {a.value * c, a.rate * c}; }
inline RateEnclosure operator+(const RateEnclosure& a, double c) { return {a.value + c, a.rate}; }
inline RateEnclosure operator-(double c, const RateEnclosure& a) { return {c - a.value, -a.rate}; }

inline RateEnclosure sqrt(const RateEnclosure& a) {
  const Enclosure root = sqrt(a.value);
  return {root, a.rate * 0.5 / root};
}
inline RateEnclosure exp(const RateEnclosure& a) {
  const Enclosure value = exp(a.value);
  return {value, value * a.rate};
}
inline RateEnclosure log(const RateEnclosure& a) {
  return {log(a.value), a.rate / within(a.value, 0, Enclosure::infinite)};
}
inline RateEnclosure sin(const RateEnclosure& a) { return {sin(a.value), cos(a.value) * a.rate}; }
inline RateEnclosure cos(const RateEnclosure& a) { return {cos(a.value), -(sin(a.value) * a.rate)}; }
inline RateEnclosure tan(const RateEnclosure& a) { return {tan(a.value), a.rate / square(cos(a.value))}; }
inline RateEnclosure sinh(const RateEnclosure& a) { return {sinh(a.value), cosh(a.value) * a.rate}; }
inline RateEnclosure cosh(const RateEnclosure& a) { return {cosh(a.value), sinh(a.value) * a.rate}; }
inline RateEnclosure tanh(const RateEnclosure& a) { return {tanh(a.value), a.rate / square(cosh(a.value))}; }
inline RateEnclosure atan(const RateEnclosure& a) { return {atan(a.value), a.rate / (square(a.value) + 1.0)}; }
inline RateEnclosure asin(const RateEnclosure& a) {
  return {asin(a.value), a.rate / sqrt(1.0 - square(within(a.value, -1, 1)))};
}
inline RateEnclosure acos(const RateEnclosure& a) {
  return {acos(a.value), -(a.rate / sqrt(1.0 - square(within(a.value, -1, 1))))};
}
inline RateEnclosure pow(const RateEnclosure& a, double exponent) {
  return {pow(a.value, exponent), pow(a.value, exponent - 1) * a.rate * exponent};
}
inline EnclosureMask operator<(const RateEnclosure& a, const RateEnclosure& b) { return a.value < b.value; }
inline RateEnclosure select(const EnclosureMask& mask, const RateEnclosure& yes, const RateEnclosure& no) {
  return {select(mask, yes.value, no.value), select(mask, yes.rate, no.rate)};
}

}  // namespace least::interval
