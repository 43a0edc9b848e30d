// Elementary functions generic in the number. Mechanics call them unqualified after `using least::sqrt;` inside the
// function: double is found here, every other number by argument-dependent lookup beside its type.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <utility>

#ifdef LEAST_LANE_BYTES
#include <sleef.h>
#endif

namespace least {

template <int N, class T = double>
using Vec = std::array<T, static_cast<std::size_t>(N)>;

/// A square matrix, row by row.
template <int N, class T = double>
using Mat = Vec<N, Vec<N, T>>;

#ifdef LEAST_LANE_BYTES  // units with lanes (core/number/lanes.hpp): a double gets the same bits as a lane
double sin(double x);
double cos(double x);
inline double exp(double x) { return Sleef_cinz_expd1_u10purec(x); }
inline double log(double x) { return Sleef_cinz_logd1_u10purec(x); }
inline double tanh(double x) { return Sleef_cinz_tanhd1_u10purec(x); }
inline double pow(double x, double y) { return Sleef_cinz_powd1_u10purec(x, y); }
inline double expm1(double x) { return Sleef_cinz_expm1d1_u10purec(x); }
inline double log1p(double x) { return Sleef_cinz_log1pd1_u10purec(x); }
#else
inline double sin(double x) { return std::sin(x); }
inline double cos(double x) { return std::cos(x); }
inline double exp(double x) { return std::exp(x); }
inline double log(double x) { return std::log(x); }
inline double tanh(double x) { return std::tanh(x); }
inline double pow(double x, double y) { return std::pow(x, y); }
inline double expm1(double x) { return std::expm1(x); }
inline double log1p(double x) { return std::log1p(x); }
#endif
inline double tan(double x) { return std::tan(x); }
inline double asin(double x) { return std::asin(x); }
inline double acos(double x) { return std::acos(x); }
inline double atan(double x) { return std::atan(x); }
inline double sinh(double x) { return std::sinh(x); }
inline double cosh(double x) { return std::cosh(x); }
inline double sqrt(double x) { return std::sqrt(x); }
inline double abs(double x) { return std::fabs(x); }
inline double atan2(double y, double x) { return std::atan2(y, x); }
inline double floor(double x) { return std::floor(x); }
inline bool isfinite(double x) { return std::isfinite(x); }
inline long double sin(long double x) { return std::sin(x); }
inline long double cos(long double x) { return std::cos(x); }
inline long double exp(long double x) { return std::exp(x); }
inline long double log(long double x) { return std::log(x); }
inline long double tanh(long double x) { return std::tanh(x); }
inline long double tan(long double x) { return std::tan(x); }
inline long double asin(long double x) { return std::asin(x); }
inline long double acos(long double x) { return std::acos(x); }
inline long double atan(long double x) { return std::atan(x); }
inline long double sinh(long double x) { return std::sinh(x); }
inline long double cosh(long double x) { return std::cosh(x); }
inline long double sqrt(long double x) { return std::sqrt(x); }
inline long double abs(long double x) { return std::fabs(x); }
inline long double pow(long double x, long double y) { return std::pow(x, y); }
inline long double pow(long double x, double y) { return std::pow(x, static_cast<long double>(y)); }
inline long double atan2(long double y, long double x) { return std::atan2(y, x); }
inline long double floor(long double x) { return std::floor(x); }
inline bool isfinite(long double x) { return std::isfinite(x); }

/// {sin x, cos x}
template <class T>
std::pair<T, T> sincos(const T& x) {
  return {sin(x), cos(x)};
}

/// x times a constant factor of a formula. Number types that drop products with 0 elsewhere must not drop this one: a
/// formula contains 0·x on purpose, to be NaN where x is.
template <class T>
T scaled(const T& x, double factor) {
  return x * factor;
}

/// Branch-free choice. For a scalar the mask is bool; a number with lanes brings its own mask, select, any and all.
template <class T>
constexpr T select(bool mask, const T& yes, const T& no) {
  return mask ? yes : no;
}
constexpr bool any(bool mask) { return mask; }
constexpr bool all(bool mask) { return mask; }
/// Chooses between yes() and no() where these are expensive: a bool calls one of them, a mask of lanes both.
template <class M, class F, class G>
constexpr auto either(const M& mask, F&& yes, G&& no) {
  if constexpr (std::is_same_v<M, bool>) {
    return mask ? yes() : no();
  } else {
    return select(mask, yes(), no());
  }
}

/// ln(1 − z). Built-in scalars keep all digits for small z, too.
inline double log1m(double z) { return log1p(-z); }
inline long double log1m(long double z) { return std::log1p(-z); }
template <class T>
T log1m(const T& z) {
  using least::log;
  return log(T(1) - z);
}

/// φ₁(z) = (eᶻ − 1)/z, 1 at 0, for any number type. Built-in scalars have it to the last digit or two.
/// Source: Hochbruck & Ostermann, Acta Numerica 19, 209 (2010), 2.1.
inline double phi1(double z) { return z == 0 ? 1 : expm1(z) / z; }
inline long double phi1(long double z) { return z == 0 ? 1 : std::expm1(z) / z; }
template <class T>
T phi1(const T& z) {
  using least::abs;
  using least::exp;
  T series(1);  // Σ zᵏ/(k + 1)!, to 36 digits for |z| < 1
  for (int k = 33; k > 1; --k) series = 1 + z * series / T(k);
  const T one(1);
  return select(abs(z) < one, series, (exp(z) - 1) / select(abs(z) < one, one, z));
}
/// φ₁′(z), ½ at 0.
template <class T>
T phi1_slope(const T& z) {
  using least::abs;
  using least::exp;
  using least::phi1;
  T series(0), power(1), factorial(2);  // Σ (k + 1) zᵏ/(k + 2)!
  for (int k = 0; k < 34; ++k) {
    series = series + T(k + 1) * power / factorial;
    power = power * z;
    factorial = factorial * T(k + 3);
  }
  const T one(1);
  return select(abs(z) < one, series, (exp(z) - phi1(z)) / select(abs(z) < one, one, z));
}

/// Distance from 1 to the next number; a wider number specialises it.
template <class T>
struct Precision {
  static constexpr double epsilon = std::numeric_limits<T>::epsilon();
};

}  // namespace least
