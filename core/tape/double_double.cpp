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

DoubleDouble elementary(tape::Op function, const DoubleDouble& argument) {
  using tape::Op;
  const Quad x = wide(argument);
  switch (function) {
    case Op::sqrt:
      return narrow(sqrt(x));
    case Op::exp:
      return narrow(exp(x));
    case Op::log:
      return narrow(log(x));
    case Op::sin:
      return narrow(sin(x));
    case Op::cos:
      return narrow(cos(x));
    case Op::tan:
      return narrow(tan(x));
    case Op::sinh:
      return narrow(sinh(x));
    case Op::cosh:
      return narrow(cosh(x));
    case Op::tanh:
      return narrow(tanh(x));
    case Op::atan:
      return narrow(atan(x));
    case Op::asin:
      return narrow(asin(x));
    default:
      return narrow(acos(x));
  }
}

DoubleDouble power(const DoubleDouble& x, double p) { return narrow(pow(wide(x), Quad(p))); }

}  // namespace least
