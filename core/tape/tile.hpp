// One operation on consecutive values, in a loop that the compiler vectorizes.
#pragma once

#include <algorithm>
#include <cstddef>

#include "core/number/math.hpp"
#include "core/tape/operation.hpp"

namespace least::tape {

/// A number that is the same for all values.
struct SameForAll {
  double value;
  double operator[](std::size_t) const { return value; }
};

/// out[k] = f(of every operand's k-th value).
template <class F, class... Values>
[[gnu::always_inline]] inline void for_each_value(F f, std::size_t count, double* __restrict out, Values... of) {
  for (std::size_t k = 0; k < count; ++k) out[k] = f(of[k]...);
}

/// Sets out[k] to the result of the operation on a[k], b[k], c[k], as far as it reads them, number[k] and the time t.
template <class Number>
[[gnu::always_inline]] inline void compute_tile(Code code, std::size_t count, double* out, const double* a,
                                                const double* b, const double* c, double t, Number number) {
  const auto unary = [&](auto f) __attribute__((always_inline)) { for_each_value(f, count, out, a); };
  const auto binary = [&](auto f) __attribute__((always_inline)) { for_each_value(f, count, out, a, b); };
  const auto with = [&](auto f) __attribute__((always_inline)) { for_each_value(f, count, out, a, number); };
  switch (code) {
    case Code::constant:
      for (std::size_t k = 0; k < count; ++k) out[k] = number[k];
      break;
    case Code::variable:
      std::copy_n(a, count, out);
      break;
    case Code::time:
      std::fill_n(out, count, t);
      break;
    case Code::add:
      binary([](double p, double q) { return p + q; });
      break;
    case Code::subtract:
      binary([](double p, double q) { return p - q; });
      break;
    case Code::multiply:
      binary([](double p, double q) { return p * q; });
      break;
    case Code::divide:
      binary([](double p, double q) { return p / q; });
      break;
    case Code::add_constant:
      with([](double p, double value) { return p + value; });
      break;
    case Code::from_constant:
      with([](double p, double value) { return value - p; });
      break;
    case Code::scale:
      with([](double p, double value) { return p * value; });
      break;
    case Code::over:
      with([](double p, double value) { return value / p; });
      break;
    case Code::power:
      with([](double p, double value) { return least::pow(p, value); });
      break;
    case Code::sqrt:
      unary([](double p) { return least::sqrt(p); });
      break;
    case Code::exp:
      unary([](double p) { return least::exp(p); });
      break;
    case Code::log:
      unary([](double p) { return least::log(p); });
      break;
    case Code::sin:
      unary([](double p) { return least::sin(p); });
      break;
    case Code::cos:
      unary([](double p) { return least::cos(p); });
      break;
    case Code::tan:
      unary([](double p) { return least::tan(p); });
      break;
    case Code::sinh:
      unary([](double p) { return least::sinh(p); });
      break;
    case Code::cosh:
      unary([](double p) { return least::cosh(p); });
      break;
    case Code::tanh:
      unary([](double p) { return least::tanh(p); });
      break;
    case Code::atan:
      unary([](double p) { return least::atan(p); });
      break;
    case Code::asin:
      unary([](double p) { return least::asin(p); });
      break;
    case Code::acos:
      unary([](double p) { return least::acos(p); });
      break;
    case Code::select:
      for_each_value([](double p, double q, double s) { return p < 0 ? q : s; }, count, out, a, b, c);
      break;
    case Code::add_up:
    case Code::total:
      break;
  }
}

}  // namespace least::tape
