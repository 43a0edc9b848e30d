// A number of several doubles that move together, by GCC's vector extension: as many as fit a register of the
// instruction set that a unit is compiled for (LEAST_LANE_BYTES). Elementary functions are SLEEF's of the family whose
// bits are the same in every instruction set and alone (`cinz`, without fused operations): sin and cos to 3.5 ulp, the
// others to 1. Only units of lanes include this header.
#pragma once

#ifndef LEAST_LANE_BYTES
#error "LEAST_LANE_BYTES says how wide the registers are: 16, 32 or 64"
#endif

#include <sleef.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "core/number/linear.hpp"
#include "core/number/math.hpp"

#define LEAST_INLINE [[gnu::always_inline]] inline

namespace least {

inline constexpr std::size_t lane_count = LEAST_LANE_BYTES / sizeof(double);

struct LaneMask {
  typedef std::int64_t Vector __attribute__((vector_size(LEAST_LANE_BYTES)));
  Vector on{};  ///< −1 where it is set

  LEAST_INLINE friend LaneMask operator!(const LaneMask& a) { return {~a.on}; }
  LEAST_INLINE friend LaneMask operator&(const LaneMask& a, const LaneMask& b) { return {a.on & b.on}; }
  LEAST_INLINE friend LaneMask operator|(const LaneMask& a, const LaneMask& b) { return {a.on | b.on}; }
};

struct Lanes {
  typedef double Vector __attribute__((vector_size(LEAST_LANE_BYTES)));
  Vector v{};

  Lanes() = default;
  LEAST_INLINE Lanes(double x) : v(x - Vector{}) {}  // NOLINT(google-explicit-constructor): in every lane
  LEAST_INLINE explicit Lanes(Vector x) : v(x) {}

  LEAST_INLINE friend Lanes operator-(const Lanes& a) { return Lanes(-a.v); }
  LEAST_INLINE friend Lanes operator+(const Lanes& a, const Lanes& b) { return Lanes(a.v + b.v); }
  LEAST_INLINE friend Lanes operator-(const Lanes& a, const Lanes& b) { return Lanes(a.v - b.v); }
  LEAST_INLINE friend Lanes operator*(const Lanes& a, const Lanes& b) { return Lanes(a.v * b.v); }
  LEAST_INLINE friend Lanes operator/(const Lanes& a, const Lanes& b) { return Lanes(a.v / b.v); }
  LEAST_INLINE Lanes& operator+=(const Lanes& b) { return *this = *this + b; }
  LEAST_INLINE Lanes& operator-=(const Lanes& b) { return *this = *this - b; }
  LEAST_INLINE Lanes& operator*=(const Lanes& b) { return *this = *this * b; }
  LEAST_INLINE Lanes& operator/=(const Lanes& b) { return *this = *this / b; }
  LEAST_INLINE friend LaneMask operator<(const Lanes& a, const Lanes& b) { return {a.v < b.v}; }
  LEAST_INLINE friend LaneMask operator>(const Lanes& a, const Lanes& b) { return {a.v > b.v}; }
  LEAST_INLINE friend LaneMask operator<=(const Lanes& a, const Lanes& b) { return {a.v <= b.v}; }
  LEAST_INLINE friend LaneMask operator>=(const Lanes& a, const Lanes& b) { return {a.v >= b.v}; }
};

LEAST_INLINE bool any(const LaneMask& m) {
  std::int64_t all = 0;
  for (std::size_t i = 0; i < lane_count; ++i) all |= m.on[i];
  return all != 0;
}
LEAST_INLINE bool all(const LaneMask& m) { return !any(!m); }
LEAST_INLINE Lanes select(const LaneMask& m, const Lanes& yes, const Lanes& no) { return Lanes(m.on ? yes.v : no.v); }

LEAST_INLINE Lanes abs(const Lanes& a) {
  const LaneMask::Vector sign = {};
  return Lanes(reinterpret_cast<Lanes::Vector>(reinterpret_cast<LaneMask::Vector>(a.v) & ~(sign - sign + INT64_MIN)));
}

namespace detail {
template <class F>
LEAST_INLINE Lanes each(const Lanes& a, F&& f) {
  Lanes r;
  for (std::size_t i = 0; i < lane_count; ++i) r.v[i] = f(a.v[i]);
  return r;
}
}  // namespace detail

#if defined(__AVX512F__)
#define LEAST_SLEEF(name, ulp) Sleef_cinz_##name##d8_##ulp##avx512fnofma
LEAST_INLINE Lanes sqrt(const Lanes& a) { return Lanes(_mm512_sqrt_pd(a.v)); }
LEAST_INLINE Lanes floor(const Lanes& a) { return Lanes(_mm512_floor_pd(a.v)); }
#elif defined(__AVX2__)
#define LEAST_SLEEF(name, ulp) Sleef_cinz_##name##d4_##ulp##avx
LEAST_INLINE Lanes sqrt(const Lanes& a) { return Lanes(_mm256_sqrt_pd(a.v)); }
LEAST_INLINE Lanes floor(const Lanes& a) { return Lanes(_mm256_floor_pd(a.v)); }
#elif defined(__SSE2__)
#define LEAST_SLEEF(name, ulp) Sleef_cinz_##name##d2_##ulp##sse2
LEAST_INLINE Lanes sqrt(const Lanes& a) { return Lanes(_mm_sqrt_pd(a.v)); }
LEAST_INLINE Lanes floor(const Lanes& a) {
  return detail::each(a, [](double x) { return __builtin_floor(x); });
}
#else
LEAST_INLINE Lanes sqrt(const Lanes& a) {
  return detail::each(a, [](double x) { return __builtin_sqrt(x); });
}
LEAST_INLINE Lanes floor(const Lanes& a) {
  return detail::each(a, [](double x) { return __builtin_floor(x); });
}
#endif

#ifdef LEAST_SLEEF
LEAST_INLINE Lanes sin(const Lanes& a) { return Lanes(LEAST_SLEEF(sin, u35)(a.v)); }
LEAST_INLINE Lanes cos(const Lanes& a) { return Lanes(LEAST_SLEEF(cos, u35)(a.v)); }
LEAST_INLINE Lanes exp(const Lanes& a) { return Lanes(LEAST_SLEEF(exp, u10)(a.v)); }
LEAST_INLINE Lanes log(const Lanes& a) { return Lanes(LEAST_SLEEF(log, u10)(a.v)); }
LEAST_INLINE Lanes tanh(const Lanes& a) { return Lanes(LEAST_SLEEF(tanh, u10)(a.v)); }
LEAST_INLINE Lanes pow(const Lanes& a, const Lanes& y) { return Lanes(LEAST_SLEEF(pow, u10)(a.v, y.v)); }
LEAST_INLINE Lanes expm1(const Lanes& a) { return Lanes(LEAST_SLEEF(expm1, u10)(a.v)); }
LEAST_INLINE Lanes log1p(const Lanes& a) { return Lanes(LEAST_SLEEF(log1p, u10)(a.v)); }
#else  // one by one
LEAST_INLINE Lanes sin(const Lanes& a) { return detail::each(a, Sleef_cinz_sind1_u35purec); }
LEAST_INLINE Lanes cos(const Lanes& a) { return detail::each(a, Sleef_cinz_cosd1_u35purec); }
LEAST_INLINE Lanes exp(const Lanes& a) { return detail::each(a, Sleef_cinz_expd1_u10purec); }
LEAST_INLINE Lanes log(const Lanes& a) { return detail::each(a, Sleef_cinz_logd1_u10purec); }
LEAST_INLINE Lanes tanh(const Lanes& a) { return detail::each(a, Sleef_cinz_tanhd1_u10purec); }
LEAST_INLINE Lanes expm1(const Lanes& a) { return detail::each(a, Sleef_cinz_expm1d1_u10purec); }
LEAST_INLINE Lanes log1p(const Lanes& a) { return detail::each(a, Sleef_cinz_log1pd1_u10purec); }
LEAST_INLINE Lanes pow(const Lanes& a, const Lanes& y) {
  Lanes r;
  for (std::size_t i = 0; i < lane_count; ++i) r.v[i] = Sleef_cinz_powd1_u10purec(a.v[i], y.v[i]);
  return r;
}
#endif
LEAST_INLINE Lanes pow(const Lanes& a, double y) { return pow(a, Lanes(y)); }
LEAST_INLINE std::pair<Lanes, Lanes> sincos(const Lanes& a) {
#ifdef LEAST_SLEEF
  const auto both = LEAST_SLEEF(sincos, u35)(a.v);
  return {Lanes(both.x), Lanes(both.y)};
#else
  std::pair<Lanes, Lanes> r;
  for (std::size_t i = 0; i < lane_count; ++i) {
    const auto both = Sleef_cinz_sincosd1_u35purec(a.v[i]);
    r.first.v[i] = both.x;
    r.second.v[i] = both.y;
  }
  return r;
#endif
}
/// Here and not with the other functions of a double: at one stroke it has other bits than sin and cos.
inline std::pair<double, double> sincos(double x) {
  const auto both = Sleef_cinz_sincosd1_u35purec(x);
  return {both.x, both.y};
}
/// As those of a double: core/number/math.hpp.
LEAST_INLINE Lanes log1m(const Lanes& z) { return log1p(-z); }
LEAST_INLINE Lanes phi1(const Lanes& z) {
  const LaneMask some = abs(z) > Lanes(0);
  return select(some, expm1(z) / select(some, z, Lanes(1)), Lanes(1));
}

template <>
struct Precision<Lanes> : Precision<double> {};

}  // namespace least
