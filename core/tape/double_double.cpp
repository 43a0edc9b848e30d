#include "core/tape/double_double.hpp"

#include "core/number/quad.hpp"

namespace least {
namespace {

Quad wide(const DoubleDouble& x) { return Quad(x.high()) + Quad(x.low()); }
DoubleDouble narrow(const Quad& x) {
  const auto high = static_cast<double>(x);
  return {high, static_cast<double>(x - Quad(high))};
}

}  // namespace

// What rounding leaves is summed apart.
DoubleDouble convolve(const DoubleDouble* a, const DoubleDouble* b, std::size_t k, std::size_t first,
                      std::size_t last) {
  double sum = 0, rest = 0;
  for (std::size_t j = first; j <= last; ++j) {
    const DoubleDouble &x = a[j], &y = b[k - j];
    const DoubleDouble product = DoubleDouble::exact_product(x.high(), y.high());
    const DoubleDouble next = DoubleDouble::exact_sum(sum, product.high());
    sum = next.high();
    rest += next.low() + (product.low() + (x.high() * y.low() + x.low() * y.high()));
  }
  return DoubleDouble::exact_sum(sum, rest);
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
