// A number together with its square as a fraction, which products, quotients and roots update by multiplications alone.
// With it a problem's ω² is compared with a limit in every step without roots and divisions, which are most of the cost
// of a force.
#pragma once

namespace least {

/// Square is x and x² = over/under.
template <class T>
struct Square {
  T value{};           ///< x; the compiler drops its computation where it is not used
  T over{}, under{1};  ///< to a few roundings
  bool plain = true;   ///< neither product, quotient nor root: only `value` is meaningful

  Square() = default;
  [[gnu::always_inline]] Square(const T& x) : value(x), over(x * x) {}  // NOLINT(google-explicit-constructor)
  [[gnu::always_inline]] Square(double x) : Square(T(x)) {}             // NOLINT
  [[gnu::always_inline]] Square(const T& x, const T& numerator, const T& denominator)
      : value(x), over(numerator), under(denominator), plain(false) {}

  [[gnu::always_inline]] friend Square operator-(const Square& a) { return {-a.value, a.over, a.under}; }
  [[gnu::always_inline]] friend Square operator+(const Square& a, const Square& b) { return a.value + b.value; }
  [[gnu::always_inline]] friend Square operator-(const Square& a, const Square& b) { return a.value - b.value; }
  [[gnu::always_inline]] friend Square operator*(const Square& a, const Square& b) {
    return {a.value * b.value, a.over * b.over, a.under * b.under};
  }
  [[gnu::always_inline]] friend Square operator/(const Square& a, const Square& b) {
    return {a.value / b.value, a.over * b.under, a.under * b.over};
  }
  [[gnu::always_inline]] friend Square sqrt(const Square& a) { return {sqrt(a.value), a.value, T(1)}; }
  [[gnu::always_inline]] friend Square abs(const Square& a) { return {abs(a.value), a.over, a.under}; }
};

}  // namespace least
