#include "core/tape/double_double.hpp"

#include "core/number/quad.hpp"

namespace least {
namespace {

typedef double FourTerms __attribute__((vector_size(32)));
typedef double TwoNumbers __attribute__((vector_size(32), aligned(8), may_alias));
/// The numbers *x and x[1].
[[gnu::always_inline]] inline const TwoNumbers& two_from(const DoubleDouble* x) {
  static_assert(2 * sizeof(DoubleDouble) == sizeof(TwoNumbers));
  return *reinterpret_cast<const TwoNumbers*>(x);
}

/// Sets `low` to the rounding errors x y − product, by fused multiplications or by splitting the factors in halves;
/// both give the same bits.
template <bool fused>
[[gnu::always_inline]] inline void low_of(const FourTerms& x, const FourTerms& y, const FourTerms& product,
                                          FourTerms& low) {
  if constexpr (fused) {
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)  // the compiler does not find the instruction
    low = product;
    asm("vfmsub231pd %2, %1, %0" : "+x"(low) : "x"(x), "x"(y));
#else
    for (int lane = 0; lane < 4; ++lane) low[lane] = DoubleDouble::exact_product(x[lane], y[lane]).low();
#endif
  } else {
    constexpr double splitter = 0x1p27 + 1;
    const FourTerms wide_x = splitter * x, wide_y = splitter * y;
    const FourTerms upper_x = wide_x - (wide_x - x), upper_y = wide_y - (wide_y - y), lower_x = x - upper_x,
                    lower_y = y - upper_y;
    low = ((upper_x * upper_y - product) + upper_x * lower_y + lower_x * upper_y) + lower_x * lower_y;
  }
}

/// Rounding errors are summed separately. Four partial sums run side by side on every machine; the last terms are added
/// one by one.
template <bool fused>
[[gnu::always_inline]] inline DoubleDouble convolve_by(const DoubleDouble* a, const DoubleDouble* b, std::size_t k,
                                                       std::size_t first, std::size_t last) {
  FourTerms sums{}, rests{};
  std::size_t j = first;
  for (; j + 4 <= last + 1; j += 4) {
    const FourTerms a0 = two_from(a + j), a2 = two_from(a + j + 2);
    const FourTerms b3 = two_from(b + (k - j - 3)), b1 = two_from(b + (k - j - 1));
    const FourTerms x = __builtin_shufflevector(a0, a2, 0, 4, 2, 6);
    const FourTerms dx = __builtin_shufflevector(a0, a2, 1, 5, 3, 7);
    const FourTerms y = __builtin_shufflevector(b1, b3, 2, 6, 0, 4);
    const FourTerms dy = __builtin_shufflevector(b1, b3, 3, 7, 1, 5);
    const FourTerms product = x * y, next = sums + product, part = next - sums;
    FourTerms low;
    low_of<fused>(x, y, product, low);
    rests += ((sums - (next - part)) + (product - part)) + (low + (x * dy + dx * y));
    sums = next;
  }
  double sum = 0, rest = (rests[0] + rests[1]) + (rests[2] + rests[3]);
  const auto add = [&](double x, double low) __attribute__((always_inline)) {
    const DoubleDouble next = DoubleDouble::exact_sum(sum, x);
    sum = next.high();
    rest += next.low() + low;
  };
  for (int lane = 0; lane < 4; ++lane) add(sums[lane], 0);
  for (; j <= last; ++j) {
    const DoubleDouble &x = a[j], &y = b[k - j];
    const DoubleDouble product = DoubleDouble::exact_product(x.high(), y.high());
    add(product.high(), product.low() + (x.high() * y.low() + x.low() * y.high()));
  }
  return DoubleDouble::exact_sum(sum, rest);
}

using Convolution = DoubleDouble (*)(const DoubleDouble*, const DoubleDouble*, std::size_t, std::size_t, std::size_t);
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
[[gnu::target("avx2,fma")]] DoubleDouble convolve_fused(const DoubleDouble* a, const DoubleDouble* b, std::size_t k,
                                                        std::size_t first, std::size_t last) {
  return convolve_by<true>(a, b, k, first, last);
}
const Convolution convolve_here =
    __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? &convolve_fused : &convolve_by<false>;
#elif defined(__FMA__) || defined(__ARM_FEATURE_FMA)
constexpr Convolution convolve_here = &convolve_by<true>;
#else
constexpr Convolution convolve_here = &convolve_by<false>;
#endif

Quad wide(const DoubleDouble& x) { return Quad(x.high()) + Quad(x.low()); }
DoubleDouble narrow(const Quad& x) {
  const auto high = static_cast<double>(x);
  return {high, static_cast<double>(x - Quad(high))};
}

}  // namespace

DoubleDouble convolve(const DoubleDouble* a, const DoubleDouble* b, std::size_t k, std::size_t first,
                      std::size_t last) {
  return convolve_here(a, b, k, first, last);
}
DoubleDouble square(const DoubleDouble* a, std::size_t k, std::size_t first) {
  DoubleDouble sum = 2.0 * convolve(a, a, k, first, (k - 1) / 2);
  if (k % 2 == 0) sum += a[k / 2] * a[k / 2];
  return sum;
}

DoubleDouble elementary(tape::Op function, const DoubleDouble& x) {
  using tape::Op;
  const Quad wide_x = wide(x);
  switch (function) {
    case Op::sqrt:
      return narrow(sqrt(wide_x));
    case Op::exp:
      return narrow(exp(wide_x));
    case Op::log:
      return narrow(log(wide_x));
    case Op::sin:
      return narrow(sin(wide_x));
    case Op::cos:
      return narrow(cos(wide_x));
    case Op::tan:
      return narrow(tan(wide_x));
    case Op::sinh:
      return narrow(sinh(wide_x));
    case Op::cosh:
      return narrow(cosh(wide_x));
    case Op::tanh:
      return narrow(tanh(wide_x));
    case Op::atan:
      return narrow(atan(wide_x));
    case Op::asin:
      return narrow(asin(wide_x));
    default:
      return narrow(acos(wide_x));
  }
}

DoubleDouble power(const DoubleDouble& x, double p) { return narrow(pow(wide(x), Quad(p))); }

}  // namespace least
