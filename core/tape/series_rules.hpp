// Rules says how the coefficients of order k of a step follow from known ones, rule by rule (core/tape/program.hpp). It
// is written once for both the interpreter, which runs steps in batches or one by one (core/tape/batch_passes.hpp), and
// programs that are unrolled at compile time (core/tape/unrolled.hpp). Both compute the same bits.
#pragma once

#include <array>
#include <cmath>
#include <type_traits>

#include "core/tape/program.hpp"
#include "core/tape/series.hpp"

// For lambdas that must be inlined: one that the compiler leaves out of line passes all its captures through memory.
#define LEAST_INLINE __attribute__((always_inline))

namespace least::tape {

constexpr std::size_t at(Index i) { return static_cast<std::size_t>(i); }

inline constexpr auto inverses = [] {
  std::array<double, Series::most_orders + 1> all{};
  for (std::size_t k = 1; k < all.size(); ++k) all[k] = 1 / static_cast<double>(k);
  return all;
}();

/// The lists of values and products of a program.
struct Lists {
  const Program::Value* values;
  const Program::Product* products;
};

/// NumberOf<Row> is what a row holds for each value: one number, or a register of numbers of the steps of a batch
/// (core/tape/batch_passes.hpp).
template <class Row>
struct NumberIn {
  using Type = typename Row::Number;
};
template <class T>
struct NumberIn<T*> {
  using Type = double;
};
template <class Row>
using NumberOf = typename NumberIn<std::remove_cvref_t<Row>>::Type;
/// Writes the value at a place of a row.
inline void put(double* row, Index place, const double& value) { row[place] = value; }

/// Sums lowⱼ high_{k−j} of a four of slots over 1 < j < k/2, plus half of the term with j = k/2. These terms do not
/// need order k − 1. They go from the middle outwards, so that those known last come last. `orders` has, for every
/// order, `all` fours of the lower factors, then `all` fours of the higher ones.
[[gnu::always_inline]] inline void sum_slots(const Four* orders, std::size_t all, std::size_t k, Four& sum) {
  const std::size_t stride = 2 * all;
  sum.lane = Four{}.lane;
  if (k < 4) return;
  const Four *low = orders + k / 2 * stride, *high = orders + (k - k / 2) * stride + all, *const end = orders + stride;
  if (k % 2 == 0) {
    sum.lane = 0.5 * (low->lane * high->lane);
    low -= stride;
    high += stride;
  }
  if ((k - 1) / 2 % 2 == 0) {
    sum.lane += low->lane * high->lane;
    low -= stride;
    high += stride;
  }
  for (; low != end; low -= 2 * stride, high += 2 * stride) {
    sum.lane += low->lane * high->lane;
    sum.lane += (low - stride)->lane * (high + stride)->lane;
  }
}
/// The same sums of several fours for the orders k = 2 m + 1 (`odd`) and 2 m + 2 (`even`) at once, which need orders up
/// to 2 m only. Where there are few fours, the higher factors of the newest orders, 2 m − 1 (`before`) and 2 m
/// (`newest`), come from registers, because their stores have hardly been completed.
template <std::size_t Groups>
[[gnu::always_inline]] inline void sum_two(const Four* orders, std::size_t all, std::size_t m, const Four* before,
                                           const Four* newest, Four* odd, Four* even) {
  constexpr bool few = Groups <= 2;
  const std::size_t stride = 2 * all;
#pragma GCC unroll 16
  for (std::size_t g = 0; g < Groups; ++g) odd[g].lane = even[g].lane = Four{}.lane;
  if (Groups == 0 || m == 0) return;
  const Four *low = orders + m * stride, *high = low + stride + all, *const end = orders + (few ? 2 : 1) * stride;
#pragma GCC unroll 16
  for (std::size_t g = 0; g < Groups; ++g) even[g].lane = 0.5 * (low[g + stride].lane * high[g].lane);
  if (few && m == 1) return;
  for (; low != end; low -= stride, high += stride) {
#pragma GCC unroll 16
    for (std::size_t g = 0; g < Groups; ++g) odd[g].lane += low[g].lane * high[g].lane;
#pragma GCC unroll 16
    for (std::size_t g = 0; g < Groups; ++g) even[g].lane += low[g].lane * high[g + stride].lane;
  }
  if (!few) return;
#pragma GCC unroll 16
  for (std::size_t g = 0; g < Groups; ++g) odd[g].lane += low[g].lane * before[g].lane;
#pragma GCC unroll 16
  for (std::size_t g = 0; g < Groups; ++g) even[g].lane += low[g].lane * newest[g].lane;
}
/// The sum of the two slots of a lane; for a square, which has one slot, that is half of its convolution.
inline double sum_of(const double* slots, bool square) { return square ? slots[0] : slots[0] + slots[1]; }

double value_of(Op function, double x);

/// What a product `term` of a sum needs in every order: order 0 of its two factors, a and b, times its constant factor,
/// and the factor of its lane, which is doubled for a square.
template <class T>
struct EndsOf {
  T a, b, sums;
};
using ProductEnds = EndsOf<double>;
template <class Product, class T, class Row>
[[gnu::always_inline]] inline EndsOf<T> ends_of(const Product& term, const T& factor, const Row& row) {
  return {factor * row[term.a], factor * row[term.b], term.a == term.b ? T(2 * factor) : factor};
}

/// KnownOf is what is known when order k is computed.
template <class Row, class Ends>
struct KnownOf {
  double order, part;  ///< k, 1/k
  Row second;          ///< order 1
  Row half;            ///< the factor of order k − 1 in convolutions: order 1, half of it for k = 2, zero for k = 1
  Row last;            ///< order k − 1
  Row older;           ///< by lane: its convolution without the terms with order k − 1
  Row sums;            ///< by lane: the same with these terms
  Ends ends;
};
using Known = KnownOf<const double*, const ProductEnds*>;

/// The factors of the terms with order k of a step. They follow from order 0.
template <class T>
struct FactorsOf {
  T inverse{}, a{}, b{};
};
using StepFactors = FactorsOf<double>;

/// x^p; the exponents −3/2, −1/2 and 3/2, frequent in forces between points, are faster by roots.
inline double power_of(double x, double p) {
  if (p == -1.5) return 1 / (x * std::sqrt(x));
  if (p == -0.5) return 1 / std::sqrt(x);
  if (p == 1.5) return x * std::sqrt(x);
  return std::pow(x, p);
}

/// out = f(x, y) for numbers, or lane by lane for vectors.
template <class T, class F>
[[gnu::always_inline]] inline void of_each(F f, const T& x, const T& y, T& out) {
  if constexpr (std::is_same_v<T, double>) {
    out = f(x, y);
  } else {
    for (std::size_t i = 0; i < sizeof(T) / sizeof(double); ++i) out[i] = f(x[i], y[i]);
  }
}

/// Rules computes steps. The places of operands come from `structure` and a step s, the constant factors from `numbers`
/// and a step n. An interpreted program passes the same lists and step twice; an unrolled one passes its constexpr
/// structure and the program. In a batch of like steps, a place stands for a column of places, and a number for one
/// number per step.
template <bool unrolled, class Structure = Lists, class Numbers = Lists>
struct Rules {
  static constexpr Index many = 8;
  Structure structure;
  Numbers numbers;

  template <class F>
  [[gnu::always_inline]] static inline void each(Index count, F&& f) {
    if constexpr (unrolled) {
#pragma GCC unroll 64
      for (Index i = 0; i < count; ++i) f(at(i));
    } else {
      for (Index i = 0; i < count; ++i) f(at(i));
    }
  }

  /// The sum of the products of a step at order 0.
  template <class S, class Row>
  [[gnu::always_inline]] inline void add_products(const S& s, const Row& row, NumberOf<Row>& sum) const {
    const auto products = structure.products + s.first_product;
    const auto by = numbers.products + s.first_product;
    sum = NumberOf<Row>{};
    each(s.products,
         [&](std::size_t i) LEAST_INLINE { sum += by[i].factor * (row[products[i].a] * row[products[i].b]); });
  }

  /// Computes order 0 of a step, that is, the value itself.
  template <class S, class N, class Row>
  [[gnu::always_inline]] inline void begin(const S& s, const N& n, const Row& row) const {
    using T = NumberOf<Row>;
    T a = T{} + 1, out{};
    if (!(s.a == none)) a = row[s.a];
    switch (s.rule) {
      case Rule::sum: {
        T sum = n.c;
        const auto values = structure.values + s.first_value;
        const auto factors = numbers.values + s.first_value;
        each(s.values, [&](std::size_t i) LEAST_INLINE { sum += factors[i].factor * row[values[i].value]; });
        if (s.products > 0) add_products(s, row, out);
        out = s.products > 0 ? T(sum + out) : sum;
        break;
      }
      case Rule::quotient:
      case Rule::linear_quotient:
        out = n.c * a / row[s.b];
        break;
      case Rule::root:
        of_each([](double x, double) { return std::sqrt(x); }, a, a, out);
        break;
      case Rule::power:
      case Rule::linear_power:
        of_each(power_of, a, T(n.p), out);
        break;
      case Rule::integral:
      case Rule::linear_integral:
        if (s.products > 0) {
          add_products(s, row, out);
        } else {
          of_each([&](double p, double x) { return value_of(s.function, p * x); }, T(n.p), a, out);
        }
        break;
      case Rule::log_like:
        of_each([&](double x, double) { return value_of(s.function, x); }, a, a, out);
        break;
      case Rule::select:
        out = row[s.w] < 0 ? a : row[s.b];
        break;
      case Rule::linear_product:
        out = n.c * (a * row[s.w]);
        break;
    }
    put(row, s.out, out);
  }

  /// Returns the factors, known from order 0, of the terms with order k in every order k.
  template <class S, class N, class Row>
  [[gnu::always_inline]] static inline FactorsOf<NumberOf<Row>> gain_of(const S& s, const N& n, const Row& row) {
    using T = NumberOf<Row>;
    switch (s.rule) {
      case Rule::quotient:
      case Rule::linear_quotient: {
        const T inverse = 1 / row[s.b];
        T a{};
        if (!(s.a == none)) a = n.c * inverse;
        return {inverse, a, row[s.out] * inverse};
      }
      case Rule::root:
        return {0.5 / row[s.out], 1 / row[s.out], T{}};
      case Rule::power:
      case Rule::linear_power: {
        const T inverse = 1 / row[s.a];
        return {inverse, n.p * row[s.out] * inverse, T{}};
      }
      case Rule::integral:
        return {T{}, n.c * row[s.w], T{}};
      case Rule::log_like:
        return {1 / row[s.w], n.c / row[s.w], T{}};
      case Rule::select:
        return {row[s.w] < 0 ? T{} + 1 : T{}, T{}, T{}};
      case Rule::linear_product:
        return {T{}, row[s.a], T{}};
      default:
        return {};
    }
  }

  /// Computes order k of a step. The chain of dependences from one order to the next goes through the terms with order
  /// k, so these are multiplied only once and come last.
  template <class S, class N, class AllKnown, class Row>
  [[gnu::always_inline]] inline void advance(const S& s, const N& n, const AllKnown& of,
                                             const FactorsOf<NumberOf<Row>>& gain, const Row& row) const {
    using T = NumberOf<Row>;
    T out{};
    const auto &half = of.half, &last = of.last;
    const double part = of.part;
    switch (s.rule) {
      case Rule::sum: {  // what is known early comes first; the second factor of a product is known last
        const auto products = structure.products + s.first_product;
        const auto values = structure.values + s.first_value;
        const auto factors = numbers.values + s.first_value;
        const auto end = of.ends + s.first_product;
        each(s.products, [&](std::size_t i) LEAST_INLINE {
          const T known = end[i].sums * of.sums[products[i].lane];
          out = i > 0 ? T(out + known) : known;
        });
        each(s.products, [&](std::size_t i) LEAST_INLINE {
          if (products[i].a != products[i].b) out += row[products[i].a] * end[i].b;
        });
        if (s.values > many) {  // four partial sums, which do not wait for each other
          std::array<T, 4> fours{};
          each(s.values, [&](std::size_t i) LEAST_INLINE { fours[i % 4] += factors[i].factor * row[values[i].value]; });
          out += (fours[0] + fours[1]) + (fours[2] + fours[3]);
        } else {
          each(s.values, [&](std::size_t i) LEAST_INLINE {
            const T term = factors[i].factor * row[values[i].value];
            out = i > 0 || s.products > 0 ? T(out + term) : term;
          });
        }
        each(s.products, [&](std::size_t i) LEAST_INLINE {
          out += row[products[i].b] * (products[i].a != products[i].b ? end[i].a : T(end[i].a + end[i].b));
        });
        break;
      }
      case Rule::quotient: {
        const T known = of.older[s.lane] * gain.inverse + last[s.b] * (half[s.out] * gain.inverse);
        T above{};
        if (!(s.a == none)) above = row[s.a];
        out = gain.a * above - (known + last[s.out] * (half[s.b] * gain.inverse)) - row[s.b] * gain.b;
        break;
      }
      case Rule::root:
        out = row[s.a] * gain.inverse - (of.older[s.lane] * gain.a + last[s.out] * (half[s.out] * gain.a));
        break;
      case Rule::power: {
        const double before = of.order - 1;
        const T by = part * gain.inverse;
        const T known =
            (n.p * of.older[s.lane] - of.older[s.w]) * by + last[s.a] * ((n.p * before - 1) * (half[s.out] * by));
        out = known + last[s.out] * ((n.p - before) * (half[s.a] * by)) + row[s.a] * gain.a;
        break;
      }
      case Rule::integral: {
        const T by = n.c * part;
        const T known = by * of.older[s.lane] + last[s.b] * (half[s.w] * by);
        out = known + last[s.w] * (half[s.b] * by) + row[s.a] * gain.a;
        break;
      }
      case Rule::log_like: {
        const T by = part * gain.inverse;
        const T known = of.older[s.lane] * by + last[s.w] * (half[s.weighted] * by);
        out = row[s.a] * gain.a - (known + last[s.weighted] * (half[s.w] * by));
        break;
      }
      case Rule::select:
        out = gain.inverse != 0 ? row[s.a] : row[s.b];
        break;
      case Rule::linear_product:
        out = n.c * (row[s.w] * gain.a + of.second[s.a] * last[s.w]);
        break;
      case Rule::linear_quotient: {
        T above{};
        if (!(s.a == none)) above = row[s.a];
        out = gain.a * above - of.second[s.b] * last[s.out] * gain.inverse;
        break;
      }
      case Rule::linear_power:
        out = of.second[s.a] * last[s.out] * (n.p - of.order + 1) * (part * gain.inverse);
        break;
      case Rule::linear_integral:
        out = n.c * part * (of.second[s.a] * last[s.w]);
        break;
    }
    put(row, s.out, out);
    put(row, s.weighted, T(of.order * out));
  }
};

}  // namespace least::tape
