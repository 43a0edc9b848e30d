// DoubleDouble is a number of 106 bits, the unevaluated sum of two doubles, for reference solutions. It runs on
// hardware, where quad arithmetic is software, but has the range of a double. It must be compiled without contraction
// of sums and products. Sources: Dekker, Numerische Mathematik 18, 224 (1971); Knuth, The Art of Computer Programming
// 2, 4.2.2; Hida, Li, Bailey, 15th IEEE Symposium on Computer Arithmetic, 155 (2001).
#pragma once

#include <cmath>
#include <type_traits>

#include "core/tape/tape.hpp"

namespace least {

class DoubleDouble {
 public:
  constexpr DoubleDouble() = default;
  constexpr DoubleDouble(double x) : high_(x) {}  // NOLINT: a number like any other
  /// |low| is at most half a unit in the last place of `high`.
  constexpr DoubleDouble(double high, double low) : high_(high), low_(low) {}

  constexpr double high() const { return high_; }
  constexpr double low() const { return low_; }

  friend constexpr DoubleDouble operator-(const DoubleDouble& a) { return {-a.high_, -a.low_}; }
  friend constexpr DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
    const DoubleDouble sum = exact_sum(a.high_, b.high_), rest = exact_sum(a.low_, b.low_);
    const DoubleDouble first = ordered_sum(sum.high_, sum.low_ + rest.high_);
    return ordered_sum(first.high_, rest.low_ + first.low_);
  }
  friend constexpr DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + -b; }
  friend constexpr DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
    const DoubleDouble product = exact_product(a.high_, b.high_);
    return ordered_sum(product.high_, product.low_ + (a.high_ * b.low_ + a.low_ * b.high_));
  }
  friend constexpr DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
    const double first = a.high_ / b.high_;
    const DoubleDouble rest = a - b * DoubleDouble(first);
    const double second = rest.high_ / b.high_;
    const double third = (rest - b * DoubleDouble(second)).high_ / b.high_;
    return ordered_sum(first, second) + DoubleDouble(third);
  }
  constexpr DoubleDouble& operator+=(const DoubleDouble& b) { return *this = *this + b; }
  friend constexpr bool operator==(const DoubleDouble&, const DoubleDouble&) = default;

  /// a + b, exactly; ordered_sum requires |a| ≥ |b| or a = 0.
  static constexpr DoubleDouble exact_sum(double a, double b) {
    const double sum = a + b, part = sum - a;
    return {sum, (a - (sum - part)) + (b - part)};
  }
  static constexpr DoubleDouble ordered_sum(double a, double b) {
    const double sum = a + b;
    return {sum, b - (sum - a)};
  }
  /// a b, exactly, where nothing over- or underflows.
  static constexpr DoubleDouble exact_product(double a, double b) {
    if (!std::is_constant_evaluated()) return {a * b, __builtin_fma(a, b, -(a * b))};
    constexpr double splitter = 0x1p27 + 1;
    const double product = a * b, wide_a = splitter * a, wide_b = splitter * b;
    const double upper_a = wide_a - (wide_a - a), upper_b = wide_b - (wide_b - b);
    const double lower_a = a - upper_a, lower_b = b - upper_b;
    return {product, ((upper_a * upper_b - product) + upper_a * lower_b + lower_a * upper_b) + lower_a * lower_b};
  }

 private:
  double high_ = 0, low_ = 0;
};

/// A function of one variable that a tape knows, √ included, computed by the quad precision library.
DoubleDouble elementary(tape::Op function, const DoubleDouble& x);
/// Σ a_j b_{k−j}, first ≤ j ≤ last, of two series. Source: Ogita, Rump, Oishi, SIAM J. Sci. Comput. 26, 1955 (2005).
DoubleDouble convolve(const DoubleDouble* a, const DoubleDouble* b, std::size_t k, std::size_t first, std::size_t last);
/// Σ a_j a_{k−j}, first ≤ j ≤ k − first, for k > 2 first − 1.
DoubleDouble square(const DoubleDouble* a, std::size_t k, std::size_t first);
/// xᵖ, x > 0 or p whole.
DoubleDouble power(const DoubleDouble& x, double p);

}  // namespace least
