// Quad is a number with 113 bits, for reference solutions: long double where the platform gives it that many, else the
// compiler's __float128 as a class, so that its functions are found by argument-dependent lookup. Boost.Multiprecision
// has the same class, but its headers take two seconds to compile in every unit that knows a problem, longer than all
// other headers together.
#pragma once

#include <cfloat>
#include <concepts>
#include <limits>
#include <string_view>

#include "core/number/math.hpp"

namespace least {

#if LDBL_MANT_DIG >= 113
using Quad = long double;
#else

/// Operations round to nearest; functions are those of libquadmath, to their last digit or two.
class Quad {
 public:
  __extension__ typedef __float128 Bits;

  constexpr Quad() = default;
  template <class Number>
  requires std::integral<Number> || std::floating_point<Number>
  constexpr Quad(Number x) : bits_(x) {}  // NOLINT: a number like any other
  /// The number nearest to a decimal text.
  explicit Quad(std::string_view text);
  static constexpr Quad from(Bits bits) {
    Quad x;
    x.bits_ = bits;
    return x;
  }

  constexpr Bits bits() const { return bits_; }
  explicit constexpr operator double() const { return static_cast<double>(bits_); }
  explicit constexpr operator long double() const { return static_cast<long double>(bits_); }
  explicit constexpr operator int() const { return static_cast<int>(bits_); }

  friend constexpr Quad operator-(const Quad& a) { return from(-a.bits_); }
  friend constexpr Quad operator+(const Quad& a, const Quad& b) { return from(a.bits_ + b.bits_); }
  friend constexpr Quad operator-(const Quad& a, const Quad& b) { return from(a.bits_ - b.bits_); }
  friend constexpr Quad operator*(const Quad& a, const Quad& b) { return from(a.bits_ * b.bits_); }
  friend constexpr Quad operator/(const Quad& a, const Quad& b) { return from(a.bits_ / b.bits_); }
  constexpr Quad& operator+=(const Quad& b) { return *this = *this + b; }
  constexpr Quad& operator-=(const Quad& b) { return *this = *this - b; }
  constexpr Quad& operator*=(const Quad& b) { return *this = *this * b; }
  constexpr Quad& operator/=(const Quad& b) { return *this = *this / b; }
  friend constexpr bool operator==(const Quad& a, const Quad& b) { return a.bits_ == b.bits_; }
  friend constexpr bool operator<(const Quad& a, const Quad& b) { return a.bits_ < b.bits_; }
  friend constexpr bool operator>(const Quad& a, const Quad& b) { return a.bits_ > b.bits_; }
  friend constexpr bool operator<=(const Quad& a, const Quad& b) { return a.bits_ <= b.bits_; }
  friend constexpr bool operator>=(const Quad& a, const Quad& b) { return a.bits_ >= b.bits_; }

 private:
  Bits bits_ = 0;
};

Quad sqrt(const Quad& x);
Quad exp(const Quad& x);
Quad log(const Quad& x);
Quad sin(const Quad& x);
Quad cos(const Quad& x);
Quad tan(const Quad& x);
Quad asin(const Quad& x);
Quad acos(const Quad& x);
Quad atan(const Quad& x);
Quad sinh(const Quad& x);
Quad cosh(const Quad& x);
Quad tanh(const Quad& x);
Quad floor(const Quad& x);
Quad atan2(const Quad& y, const Quad& x);
Quad pow(const Quad& x, const Quad& y);
constexpr Quad abs(const Quad& x) { return x < 0 ? -x : x; }
constexpr bool isfinite(const Quad& x) { return x - x == 0; }

template <>
struct Precision<Quad> {
  static constexpr double epsilon = 0x1p-112;
};
#endif

}  // namespace least

#if LDBL_MANT_DIG < 113
template <>
class std::numeric_limits<least::Quad> {
 public:
  static constexpr bool is_specialized = true;
  static constexpr int digits = 113;
  static constexpr least::Quad epsilon() { return least::Precision<least::Quad>::epsilon; }
  static constexpr least::Quad infinity() { return std::numeric_limits<double>::infinity(); }
  static constexpr least::Quad quiet_NaN() { return std::numeric_limits<double>::quiet_NaN(); }
};
#endif
