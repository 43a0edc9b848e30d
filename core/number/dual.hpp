// Forward-mode dual numbers: a value and its derivatives along K directions. Nested (Dual<Dual<T, K>, K>) they carry
// second derivatives. Comparisons look at the value alone.
// Source: Griewank & Walther, Evaluating Derivatives, 2008, chapter 3.
#pragma once

#include <cmath>
#include <type_traits>

#include "core/number/math.hpp"

namespace least {

template <class T, int K>
struct Dual {
  T value{};
  Vec<K, T> slope{};

  constexpr Dual() = default;
  /// A constant: its derivatives are zero. Takes what T takes (an int, a double, a T).
  template <class U>
  requires std::is_convertible_v<U, T>
  constexpr Dual(const U& constant) : value(constant) {}
  constexpr Dual(const T& v, const Vec<K, T>& d) : value(v), slope(d) {}

  /// The k-th independent variable.
  static constexpr Dual variable(const T& v, int k) {
    Dual x(v);
    x.slope[static_cast<std::size_t>(k)] = T(1);
    return x;
  }

  constexpr Dual operator-() const {
    return chain(-value, [](const T& d) { return -d; });
  }
  constexpr Dual& operator+=(const Dual& b) { return *this = *this + b; }
  constexpr Dual& operator-=(const Dual& b) { return *this = *this - b; }
  constexpr Dual& operator*=(const Dual& b) { return *this = *this * b; }
  constexpr Dual& operator/=(const Dual& b) { return *this = *this / b; }

  /// A number with this value whose k-th derivative is f(own k-th derivative).
  template <class F>
  constexpr Dual chain(const T& v, F&& f) const {
    Dual r(v);
    for (std::size_t k = 0; k < slope.size(); ++k) r.slope[k] = f(slope[k]);
    return r;
  }

  friend constexpr Dual operator+(const Dual& a, const Dual& b) {
    Dual r(a.value + b.value);
    for (std::size_t k = 0; k < r.slope.size(); ++k) r.slope[k] = a.slope[k] + b.slope[k];
    return r;
  }
  friend constexpr Dual operator-(const Dual& a, const Dual& b) {
    Dual r(a.value - b.value);
    for (std::size_t k = 0; k < r.slope.size(); ++k) r.slope[k] = a.slope[k] - b.slope[k];
    return r;
  }
  friend constexpr Dual operator*(const Dual& a, const Dual& b) {
    Dual r(a.value * b.value);
    for (std::size_t k = 0; k < r.slope.size(); ++k) r.slope[k] = a.slope[k] * b.value + a.value * b.slope[k];
    return r;
  }
  friend constexpr Dual operator/(const Dual& a, const Dual& b) {
    Dual r(a.value / b.value);
    for (std::size_t k = 0; k < r.slope.size(); ++k) r.slope[k] = (a.slope[k] - r.value * b.slope[k]) / b.value;
    return r;
  }
  // Operations with a plain number or a T treat it as a constant and spend nothing on its derivatives.
  template <class U>
  static constexpr bool plain = std::is_arithmetic_v<U> || std::is_same_v<U, T>;
  template <class U>
  requires plain<U>
  friend constexpr Dual operator+(const Dual& a, const U& b) { return Dual(a.value + b, a.slope); }
  template <class U>
  requires plain<U>
  friend constexpr Dual operator+(const U& a, const Dual& b) { return Dual(a + b.value, b.slope); }
  template <class U>
  requires plain<U>
  friend constexpr Dual operator-(const Dual& a, const U& b) { return Dual(a.value - b, a.slope); }
  template <class U>
  requires plain<U>
  friend constexpr Dual operator-(const U& a, const Dual& b) {
    return b.chain(a - b.value, [](const T& d) { return -d; });
  }
  template <class U>
  requires plain<U>
  friend constexpr Dual operator*(const Dual& a, const U& b) {
    return a.chain(a.value * b, [&](const T& d) { return d * b; });
  }
  template <class U>
  requires plain<U>
  friend constexpr Dual operator*(const U& a, const Dual& b) {
    return b.chain(a * b.value, [&](const T& d) { return a * d; });
  }
  template <class U>
  requires plain<U>
  friend constexpr Dual operator/(const Dual& a, const U& b) {
    return a.chain(a.value / b, [&](const T& d) { return d / b; });
  }
  friend constexpr auto operator<(const Dual& a, const Dual& b) { return a.value < b.value; }
  friend constexpr auto operator<=(const Dual& a, const Dual& b) { return a.value <= b.value; }
  friend constexpr auto operator>(const Dual& a, const Dual& b) { return a.value > b.value; }
  friend constexpr auto operator>=(const Dual& a, const Dual& b) { return a.value >= b.value; }
};

template <class T, int K>
constexpr std::pair<Dual<T, K>, Dual<T, K>> sincos(const Dual<T, K>& x) {
  using least::sincos;
  const auto [s, c] = sincos(x.value);
  return {x.chain(s, [c = c](const T& d) { return c * d; }), x.chain(c, [s = s](const T& d) { return -(s * d); })};
}
template <class T, int K>
constexpr Dual<T, K> sin(const Dual<T, K>& x) {
  return sincos(x).first;
}
template <class T, int K>
constexpr Dual<T, K> cos(const Dual<T, K>& x) {
  return sincos(x).second;
}
template <class T, int K>
constexpr Dual<T, K> exp(const Dual<T, K>& x) {
  using least::exp;
  const T e = exp(x.value);
  return x.chain(e, [&](const T& d) { return e * d; });
}
template <class T, int K>
constexpr Dual<T, K> log(const Dual<T, K>& x) {
  using least::log;
  return x.chain(log(x.value), [&](const T& d) { return d / x.value; });
}
template <class T, int K>
Dual<T, K> log1m(const Dual<T, K>& x) {
  using least::log1m;
  return x.chain(log1m(x.value), [&](const T& d) { return -(d / (1 - x.value)); });
}
template <class T, int K>
constexpr Dual<T, K> sqrt(const Dual<T, K>& x) {
  using least::sqrt;
  const T r = sqrt(x.value);
  const T w = T(0.5) / r;
  return x.chain(r, [&](const T& d) { return w * d; });
}
template <class T, int K>
constexpr Dual<T, K> tanh(const Dual<T, K>& x) {
  using least::tanh;
  const T y = tanh(x.value), w = 1 - y * y;
  return x.chain(y, [&](const T& d) { return w * d; });
}
template <class T, int K>
Dual<T, K> tan(const Dual<T, K>& x) {
  using least::tan;
  const T y = tan(x.value), w = 1 + y * y;
  return x.chain(y, [&](const T& d) { return w * d; });
}
template <class T, int K>
Dual<T, K> sinh(const Dual<T, K>& x) {
  using least::cosh;
  using least::sinh;
  const T w = cosh(x.value);
  return x.chain(sinh(x.value), [&](const T& d) { return w * d; });
}
template <class T, int K>
Dual<T, K> cosh(const Dual<T, K>& x) {
  using least::cosh;
  using least::sinh;
  const T w = sinh(x.value);
  return x.chain(cosh(x.value), [&](const T& d) { return w * d; });
}
template <class T, int K>
Dual<T, K> atan(const Dual<T, K>& x) {
  using least::atan;
  const T w = 1 / (1 + x.value * x.value);
  return x.chain(atan(x.value), [&](const T& d) { return w * d; });
}
template <class T, int K>
Dual<T, K> asin(const Dual<T, K>& x) {
  using least::asin;
  using least::sqrt;
  const T w = 1 / sqrt(1 - x.value * x.value);
  return x.chain(asin(x.value), [&](const T& d) { return w * d; });
}
template <class T, int K>
Dual<T, K> acos(const Dual<T, K>& x) {
  using least::acos;
  using least::sqrt;
  const T w = -1 / sqrt(1 - x.value * x.value);
  return x.chain(acos(x.value), [&](const T& d) { return w * d; });
}
template <class T, int K>
Dual<T, K> phi1(const Dual<T, K>& x) {
  using least::phi1;
  const T w = phi1_slope(x.value);
  return x.chain(phi1(x.value), [&](const T& d) { return w * d; });
}
/// x^y where both vary, for an exponent that is a parameter under study. Requires x > 0.
template <class T, int K>
Dual<T, K> pow(const Dual<T, K>& x, const Dual<T, K>& y) {
  using least::exp;
  using least::log;
  using least::pow;
  const T p = pow(x.value, y.value), l = log(x.value);
  Dual<T, K> r(p);
  for (std::size_t k = 0; k < r.slope.size(); ++k) r.slope[k] = p * (y.value * x.slope[k] / x.value + l * y.slope[k]);
  return r;
}
/// x^y with a constant exponent of the inner number type.
template <class T, int K>
requires(!std::is_arithmetic_v<T>) constexpr Dual<T, K> pow(const Dual<T, K>& x, const T& y) {
  using least::pow;
  const T w = y * pow(x.value, T(y - 1.0));
  return x.chain(pow(x.value, y), [&](const T& d) { return w * d; });
}
template <class T, int K>
constexpr Dual<T, K> pow(const Dual<T, K>& x, double y) {
  using least::pow;
  const T w = y * pow(x.value, y - 1);
  return x.chain(pow(x.value, y), [&](const T& d) { return w * d; });
}
template <class T, int K>
constexpr Dual<T, K> abs(const Dual<T, K>& x) {
  using least::select;
  return select(x.value < T(0), -x, x);
}
template <class T, int K>
constexpr Dual<T, K> floor(const Dual<T, K>& x) {
  using least::floor;
  return Dual<T, K>(floor(x.value));
}
template <class T, int K>
auto isfinite(const Dual<T, K>& x) {
  using least::isfinite;
  return isfinite(x.value);
}
/// For masks of a number with lanes; a plain bool takes the general form in math.hpp.
template <class M, class T, int K>
requires(!std::is_same_v<M, bool>) constexpr Dual<T, K> select(const M& mask, const Dual<T, K>& yes,
                                                               const Dual<T, K>& no) {
  using least::select;
  Dual<T, K> r(select(mask, yes.value, no.value));
  for (std::size_t k = 0; k < r.slope.size(); ++k) r.slope[k] = select(mask, yes.slope[k], no.slope[k]);
  return r;
}

template <class T, int K>
struct Precision<Dual<T, K>> : Precision<T> {};

/// Underlying<T>::type is the number type below all levels of dual numbers.
template <class T>
struct Underlying {
  using type = T;
};
template <class T, int K>
struct Underlying<Dual<T, K>> : Underlying<T> {};

/// Returns the value below all levels of dual numbers, as a double.
template <class T>
double plain_number(const T& x) {
  if constexpr (requires { x.value; }) {
    return plain_number(x.value);
  } else {
    return static_cast<double>(x);
  }
}
/// Returns the sum of the absolute values of a number and of all its derivatives.
template <class T>
double size_with_slopes(const T& x) {
  if constexpr (requires { x.value; }) {
    double sum = size_with_slopes(x.value);
    for (const auto& slope : x.slope) sum += size_with_slopes(slope);
    return sum;
  } else {
    return std::abs(static_cast<double>(x));
  }
}

}  // namespace least
