// Lanes is a number of several doubles, by GCC's vector extension: they fill two registers of the instruction set that
// a unit is compiled for (LEAST_LANE_BYTES bytes each), or one register of the narrowest. Of two registers, one is
// computed while the other waits for a root or a quotient, and the work that is common to all lanes is done half as
// often. Elementary functions are those of SLEEF's family `cinz` (without fused operations), accurate to 1 ulp, whose
// bits are the same in every instruction set and for single doubles. Sine and cosine of arguments up to 3e6 are
// computed here: SLEEF's are calls, around which registers are saved and with which nothing overlaps, and cost twice as
// much beyond 15. Only units of lanes include this header.
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

// LEAST_PAIR(a, b) lists a, for the first register, and b, for the second one if there is one.
#if LEAST_LANE_BYTES > 16
#define LEAST_PAIR(a, b) a, b
inline constexpr std::size_t lane_registers = 2;
#else
#define LEAST_PAIR(a, b) a
inline constexpr std::size_t lane_registers = 1;
#endif
inline constexpr std::size_t lane_count = lane_registers * LEAST_LANE_BYTES / sizeof(double);

/// LaneMask tells for which lanes a condition holds.
#if defined(__AVX512F__)
struct LaneMask {
  std::uint16_t bits = 0;  ///< as comparisons give them

  static LaneMask everywhere() { return {0xffff}; }
  LEAST_INLINE static LaneMask of(__mmask8 low, __mmask8 high) { return {static_cast<std::uint16_t>(low | high << 8)}; }
  LEAST_INLINE __mmask8 low() const { return static_cast<__mmask8>(bits); }
  LEAST_INLINE __mmask8 high() const { return static_cast<__mmask8>(bits >> 8); }

  bool operator[](std::size_t lane) const { return (bits >> lane & 1) != 0; }
  void set(std::size_t lane, bool on) {
    bits = static_cast<std::uint16_t>((bits & ~(1U << lane)) | static_cast<unsigned>(on) << lane);
  }
  LEAST_INLINE friend LaneMask operator!(const LaneMask& a) { return {static_cast<std::uint16_t>(~a.bits)}; }
  LEAST_INLINE friend LaneMask operator&(const LaneMask& a, const LaneMask& b) {
    return {static_cast<std::uint16_t>(a.bits & b.bits)};
  }
  LEAST_INLINE friend LaneMask operator|(const LaneMask& a, const LaneMask& b) {
    return {static_cast<std::uint16_t>(a.bits | b.bits)};
  }
};
#define LEAST_COMPARED(a, sign, name, b) \
  LaneMask::of(_mm512_cmp_pd_mask(a.low, b.low, name), _mm512_cmp_pd_mask(a.high, b.high, name))
#else
struct LaneMask {
  typedef std::int64_t Register __attribute__((vector_size(LEAST_LANE_BYTES)));
  Register LEAST_PAIR(low{}, high{});  ///< −1 where it is set

  static LaneMask everywhere() {
    const Register none{};
    return {LEAST_PAIR(none - 1, none - 1)};
  }
  std::int64_t operator[](std::size_t lane) const { return reinterpret_cast<const std::int64_t*>(this)[lane]; }
  void set(std::size_t lane, bool on) { reinterpret_cast<std::int64_t*>(this)[lane] = on ? -1 : 0; }
  LEAST_INLINE friend LaneMask operator!(const LaneMask& a) { return {LEAST_PAIR(~a.low, ~a.high)}; }
  LEAST_INLINE friend LaneMask operator&(const LaneMask& a, const LaneMask& b) {
    return {LEAST_PAIR(a.low & b.low, a.high & b.high)};
  }
  LEAST_INLINE friend LaneMask operator|(const LaneMask& a, const LaneMask& b) {
    return {LEAST_PAIR(a.low | b.low, a.high | b.high)};
  }
};
#define LEAST_COMPARED(a, sign, name, b) \
  { LEAST_PAIR(a.low sign b.low, a.high sign b.high) }
#endif

struct Lanes {
  typedef double Register __attribute__((vector_size(LEAST_LANE_BYTES)));
  Register LEAST_PAIR(low{}, high{});

  Lanes() = default;
  LEAST_INLINE Lanes(double x)  // NOLINT(google-explicit-constructor): in every lane
      : LEAST_PAIR(low(x - Register{}), high(x - Register{})) {}
  LEAST_INLINE explicit Lanes(LEAST_PAIR(Register x, Register y)) : LEAST_PAIR(low(x), high(y)) {}

  double operator[](std::size_t lane) const { return reinterpret_cast<const double*>(this)[lane]; }
  double& operator[](std::size_t lane) { return reinterpret_cast<double*>(this)[lane]; }
  LEAST_INLINE friend Lanes operator-(const Lanes& a) { return Lanes(LEAST_PAIR(-a.low, -a.high)); }
  LEAST_INLINE friend Lanes operator+(const Lanes& a, const Lanes& b) {
    return Lanes(LEAST_PAIR(a.low + b.low, a.high + b.high));
  }
  LEAST_INLINE friend Lanes operator-(const Lanes& a, const Lanes& b) {
    return Lanes(LEAST_PAIR(a.low - b.low, a.high - b.high));
  }
  LEAST_INLINE friend Lanes operator*(const Lanes& a, const Lanes& b) {
    return Lanes(LEAST_PAIR(a.low * b.low, a.high * b.high));
  }
  LEAST_INLINE friend Lanes operator/(const Lanes& a, const Lanes& b) {
    return Lanes(LEAST_PAIR(a.low / b.low, a.high / b.high));
  }
  LEAST_INLINE Lanes& operator+=(const Lanes& b) { return *this = *this + b; }
  LEAST_INLINE Lanes& operator-=(const Lanes& b) { return *this = *this - b; }
  LEAST_INLINE Lanes& operator*=(const Lanes& b) { return *this = *this * b; }
  LEAST_INLINE Lanes& operator/=(const Lanes& b) { return *this = *this / b; }
  LEAST_INLINE friend LaneMask operator<(const Lanes& a, const Lanes& b) { return LEAST_COMPARED(a, <, _CMP_LT_OS, b); }
  LEAST_INLINE friend LaneMask operator>(const Lanes& a, const Lanes& b) { return LEAST_COMPARED(a, >, _CMP_GT_OS, b); }
  LEAST_INLINE friend LaneMask operator<=(const Lanes& a, const Lanes& b) {
    return LEAST_COMPARED(a, <=, _CMP_LE_OS, b);
  }
  LEAST_INLINE friend LaneMask operator>=(const Lanes& a, const Lanes& b) {
    return LEAST_COMPARED(a, >=, _CMP_GE_OS, b);
  }
};

LEAST_INLINE bool any(const LaneMask& m) {
#if defined(__AVX512F__)
  return m.bits != 0;
#else
#if LEAST_LANE_BYTES > 16
  const LaneMask::Register both = m.low | m.high;
#else
  const LaneMask::Register both = m.low;
#endif
  std::int64_t all = 0;
  bool known = true;  // at compile time
  for (std::size_t i = 0; i < LEAST_LANE_BYTES / sizeof(double); ++i) {
    known = known && __builtin_constant_p(both[i]);
    all |= both[i];
  }
#if defined(__AVX2__)
  const auto bits = reinterpret_cast<__m256i>(both);
  if (!known) return _mm256_testz_si256(bits, bits) == 0;
#endif
  return all != 0;
#endif
}
LEAST_INLINE bool all(const LaneMask& m) { return !any(!m); }
LEAST_INLINE Lanes select(const LaneMask& m, const Lanes& yes, const Lanes& no) {
#if defined(__AVX512F__)
  return Lanes(_mm512_mask_blend_pd(m.low(), no.low, yes.low), _mm512_mask_blend_pd(m.high(), no.high, yes.high));
#else
  return Lanes(LEAST_PAIR(m.low ? yes.low : no.low, m.high ? yes.high : no.high));
#endif
}

namespace detail {
typedef std::int64_t Bits __attribute__((vector_size(LEAST_LANE_BYTES)));
LEAST_INLINE Lanes::Register abs(Lanes::Register a) {
  return reinterpret_cast<Lanes::Register>(reinterpret_cast<Bits>(a) & ~(Bits{} + INT64_MIN));
}
template <class F>
LEAST_INLINE Lanes each(const Lanes& a, F&& f) {
  Lanes r;
  for (std::size_t i = 0; i < lane_count; ++i) r[i] = f(a[i]);
  return r;
}
}  // namespace detail
LEAST_INLINE Lanes abs(const Lanes& a) { return Lanes(LEAST_PAIR(detail::abs(a.low), detail::abs(a.high))); }

/// Applies a function of one register to all registers of `a`.
#define LEAST_OF_EACH(function) Lanes(LEAST_PAIR(function(a.low), function(a.high)))

#if defined(__AVX512F__)
#define LEAST_SLEEF(name, ulp) Sleef_cinz_##name##d8_##ulp##avx512fnofma
LEAST_INLINE Lanes sqrt(const Lanes& a) { return LEAST_OF_EACH(_mm512_sqrt_pd); }
#elif defined(__AVX2__)
#define LEAST_SLEEF(name, ulp) Sleef_cinz_##name##d4_##ulp##avx
LEAST_INLINE Lanes sqrt(const Lanes& a) { return LEAST_OF_EACH(_mm256_sqrt_pd); }
#elif defined(__SSE2__)
#define LEAST_SLEEF(name, ulp) Sleef_cinz_##name##d2_##ulp##sse2
LEAST_INLINE Lanes sqrt(const Lanes& a) { return LEAST_OF_EACH(_mm_sqrt_pd); }
#else
LEAST_INLINE Lanes sqrt(const Lanes& a) {
  return detail::each(a, [](double x) { return __builtin_sqrt(x); });
}
#endif

#ifdef LEAST_SLEEF
LEAST_INLINE Lanes exp(const Lanes& a) { return LEAST_OF_EACH(LEAST_SLEEF(exp, u10)); }
LEAST_INLINE Lanes log(const Lanes& a) { return LEAST_OF_EACH(LEAST_SLEEF(log, u10)); }
LEAST_INLINE Lanes tanh(const Lanes& a) { return LEAST_OF_EACH(LEAST_SLEEF(tanh, u10)); }
LEAST_INLINE Lanes pow(const Lanes& a, const Lanes& y) {
  return Lanes(LEAST_PAIR(LEAST_SLEEF(pow, u10)(a.low, y.low), LEAST_SLEEF(pow, u10)(a.high, y.high)));
}
LEAST_INLINE Lanes expm1(const Lanes& a) { return LEAST_OF_EACH(LEAST_SLEEF(expm1, u10)); }
LEAST_INLINE Lanes log1p(const Lanes& a) { return LEAST_OF_EACH(LEAST_SLEEF(log1p, u10)); }
#else  // one by one
LEAST_INLINE Lanes exp(const Lanes& a) { return detail::each(a, Sleef_cinz_expd1_u10purec); }
LEAST_INLINE Lanes log(const Lanes& a) { return detail::each(a, Sleef_cinz_logd1_u10purec); }
LEAST_INLINE Lanes tanh(const Lanes& a) { return detail::each(a, Sleef_cinz_tanhd1_u10purec); }
LEAST_INLINE Lanes expm1(const Lanes& a) { return detail::each(a, Sleef_cinz_expm1d1_u10purec); }
LEAST_INLINE Lanes log1p(const Lanes& a) { return detail::each(a, Sleef_cinz_log1pd1_u10purec); }
LEAST_INLINE Lanes pow(const Lanes& a, const Lanes& y) {
  Lanes r;
  for (std::size_t i = 0; i < lane_count; ++i) r[i] = Sleef_cinz_powd1_u10purec(a[i], y[i]);
  return r;
}
#endif
LEAST_INLINE Lanes pow(const Lanes& a, double y) { return pow(a, Lanes(y)); }

namespace detail {
using SinCos = std::pair<Lanes, Lanes>;
/// SLEEF's sine and cosine, for arguments of any size.
[[gnu::noinline, gnu::cold]] inline SinCos called_sincos(Lanes a) {
  SinCos both;
  for (std::size_t i = 0; i < lane_count; ++i) {
    const auto here = Sleef_cinz_sincosd1_u35purec(a[i]);
    both.first[i] = here.x;
    both.second[i] = here.y;
  }
  return both;
}
/// Clamps a sine to [-1, 1]: rounding could take it beyond, and the root of 1 - s^2 would be NaN.
LEAST_INLINE Lanes::Register within_one(const Lanes::Register& a) {
  const Lanes::Register one = Lanes(1).low;
#if defined(__AVX512F__)
  return _mm512_max_pd(_mm512_min_pd(a, one), -one);
#elif defined(__AVX2__)
  return _mm256_max_pd(_mm256_min_pd(a, one), -one);
#else
  const Lanes::Register below = a > one ? one : a;
  return below < -one ? -one : below;
#endif
}
/// ReducedAngle is a number minus the nearest multiple of π, with an error of at most 2e-20. π is subtracted in two
/// parts, the first of which has 31 bits, so that its products with up to a million half turns are exact.
struct ReducedAngle {
  static constexpr double most = 3e6, whole = 0x1.8p52;
  Lanes turns, r, square;
  LEAST_INLINE explicit ReducedAngle(const Lanes& a) : turns(a * (1 / 3.141592653589793) + whole) {
    constexpr double first = 0x1.921fb544p+1, rest = 0x1.0b4611a626331p-33;
    const Lanes n = turns - whole;
    r = (a - n * first) - n * rest;
    square = r * r;
  }
  /// sin r by a minimax polynomial (Remez) of relative error 4e-18; rounding adds up to 2.5 ulp.
  LEAST_INLINE Lanes sine() const {
    const Lanes &x = square, x2 = x * x, x4 = x2 * x2;
    const Lanes value = r + r * (x * (((x * 0x1.8828f8cc23f69p-49 - 0x1.ae43176a2af7dp-41) * x2 +
                                       (x * 0x1.6123cb11ca283p-33 - 0x1.ae6454cafd18dp-26)) *
                                          x4 +
                                      ((x * 0x1.71de3a5287076p-19 - 0x1.a01a01a0148a1p-13) * x2 +
                                       (x * 0x1.11111111110c1p-7 - 0x1.5555555555555p-3))));
    return Lanes(LEAST_PAIR(within_one(value.low), within_one(value.high)));
  }
  /// cos r by a minimax polynomial of error 6e-18; rounding adds an absolute error of up to 3e-16.
  LEAST_INLINE Lanes cosine() const {
    const Lanes &x = square, x2 = x * x, x4 = x2 * x2;
    return (1 - x * 0.5) +
           x2 * ((x2 * 0x1.9fc815fe717cap-45 + (x * -0x1.9357392443816p-37 + 0x1.1eecfad5fa913p-29)) * x4 +
                 ((x * -0x1.27e4f9f2ef186p-22 + 0x1.a01a019ba61dep-16) * x2 +
                  (x * -0x1.6c16c16c101f7p-10 + 0x1.55555555554ddp-5)));
  }
  /// Returns x, with opposite sign for an odd number of half turns.
  LEAST_INLINE Lanes turned(const Lanes& x) const {
    const auto flip = [](const Lanes::Register& value, const Lanes::Register& by) {
      return reinterpret_cast<Lanes::Register>(reinterpret_cast<Bits>(value) ^ (reinterpret_cast<Bits>(by) << 63));
    };
    return Lanes(LEAST_PAIR(flip(x.low, turns.low), flip(x.high, turns.high)));
  }
};
LEAST_INLINE LaneMask turns_little(const Lanes& a) { return abs(a) < Lanes(ReducedAngle::most); }
}  // namespace detail
LEAST_INLINE Lanes sin(const Lanes& a) {
  const LaneMask little = detail::turns_little(a);
  const detail::ReducedAngle rest(a);
  const Lanes value = rest.turned(rest.sine());
  return all(little) ? value : select(little, value, detail::called_sincos(a).first);
}
LEAST_INLINE Lanes cos(const Lanes& a) {
  const LaneMask little = detail::turns_little(a);
  const detail::ReducedAngle rest(a);
  const Lanes value = rest.turned(rest.cosine());
  return all(little) ? value : select(little, value, detail::called_sincos(a).second);
}
LEAST_INLINE std::pair<Lanes, Lanes> sincos(const Lanes& a) {
  const LaneMask little = detail::turns_little(a);
  const detail::ReducedAngle rest(a);
  Lanes sine = rest.turned(rest.sine()), cosine = rest.turned(rest.cosine());
  if (!all(little)) {
    const auto [s, c] = detail::called_sincos(a);
    sine = select(little, sine, s);
    cosine = select(little, cosine, c);
  }
  return {sine, cosine};
}
/// A double is computed as a lane, to the same bits.
inline double sin(double x) { return sin(Lanes(x))[0]; }
inline double cos(double x) { return cos(Lanes(x))[0]; }
inline std::pair<double, double> sincos(double x) {
  const auto [s, c] = sincos(Lanes(x));
  return {s[0], c[0]};
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
