// How the coefficients of a series follow from those before them, rule by rule (core/tape/program.hpp). Written once
// for both that run programs: the interpreter, which reads them step by step (core/tape/series.cpp), and what the
// compiler makes of one whose structure it knows (core/tape/unrolled.hpp). What they compute is the same to the bit.
#pragma once

#include <array>
#include <cmath>

#include "core/tape/program.hpp"
#include "core/tape/series.hpp"

// Of lambdas that are straight code: one that a compiler leaves out of line takes all through memory.
#define LEAST_INLINE __attribute__((always_inline))

namespace least::tape {

constexpr std::size_t at(Index i) { return static_cast<std::size_t>(i); }

inline constexpr auto inverses = [] {
  std::array<double, Series::most_orders + 1> all{};
  for (std::size_t k = 1; k < all.size(); ++k) all[k] = 1 / static_cast<double>(k);
  return all;
}();

/// The lists of a program, wherever they are.
struct Lists {
  const Program::Value* values;
  const Program::Product* products;
};

/// Σ lowⱼ high_{k−j} of a group of slots over 1 < j < k/2, and half of it where j = k/2: what is older than the last
/// order, from the middle outwards, so that the newest come last. Of every order there stand the groups of the factors
/// that are of the lower order, then those of the higher, `all` of each.
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
/// The same of groups, of the orders 2 m + 1 and 2 m + 2 at once: what the second needs is known before the first. Few
/// groups have the higher factors of the newest two orders, 2 m − 1 and 2 m, from registers: they have hardly been
/// written.
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
/// Of a lane that has two slots; of a square, which has one, half of it.
inline double sum_of(const double* slots, bool square) { return square ? slots[0] : slots[0] + slots[1]; }
inline ProductEnds ends_of(const Program::Product& term, double factor, const double* row) {
  return {factor * row[term.a], factor * row[term.b], term.a == term.b ? 2 * factor : factor};
}

double value_of(Op function, double x);

/// What is known when order k is computed.
struct Known {
  double order, part;    ///< k, 1/k
  const double* second;  ///< order 1
  const double* half;  ///< what the terms of order k − 1 are multiplied with in sums: order 1, half of it where k = 2
  const double* last;  ///< order k − 1
  const double* older;  ///< sums of lanes without these terms
  const double* sums;   ///< with them
  const ProductEnds* ends;
};

/// Powers of distances are halves.
inline double power_of(double x, double p) {
  if (p == -1.5) return 1 / (x * std::sqrt(x));
  if (p == -0.5) return 1 / std::sqrt(x);
  if (p == 1.5) return x * std::sqrt(x);
  return std::pow(x, p);
}

/// Rules as a pass takes them. Places stand in `structure` and in a step s, numbers in `numbers` and in the step n: the
/// same lists and step twice where a program is read, constants and the program where it is known to the compiler.
template <bool unrolled>
struct Rules {
  static constexpr Index many = 8;
  Lists structure, numbers;

  template <class F>
  [[gnu::always_inline]] static inline void each(Index count, F&& f) {
    if constexpr (unrolled) {
#pragma GCC unroll 64
      for (Index i = 0; i < count; ++i) f(at(i));
    } else {
      for (Index i = 0; i < count; ++i) f(at(i));
    }
  }

  /// Of order 0.
  [[gnu::always_inline]] inline double products_of(const Step& s, const double* row) const {
    const auto *products = structure.products + s.first_product, *by = numbers.products + s.first_product;
    double sum = 0;
    each(s.products,
         [&](std::size_t i) LEAST_INLINE { sum += by[i].factor * (row[products[i].a] * row[products[i].b]); });
    return sum;
  }

  /// Order 0: the value itself.
  [[gnu::always_inline]] inline void begin(const Step& s, const Step& n, double* row) const {
    double& out = row[s.out];
    const double a = s.a == none ? 1 : row[s.a];
    switch (s.rule) {
      case Rule::sum: {
        double sum = n.c;
        const auto *values = structure.values + s.first_value, *factors = numbers.values + s.first_value;
        each(s.values, [&](std::size_t i) LEAST_INLINE { sum += factors[i].factor * row[values[i].value]; });
        out = s.products > 0 ? sum + products_of(s, row) : sum;
        break;
      }
      case Rule::quotient:
      case Rule::linear_quotient:
        out = n.c * a / row[s.b];
        break;
      case Rule::root:
        out = std::sqrt(a);
        break;
      case Rule::power:
      case Rule::linear_power:
        out = power_of(a, n.p);
        break;
      case Rule::integral:
      case Rule::linear_integral:
        out = s.products > 0 ? products_of(s, row) : value_of(s.function, n.p * a);
        break;
      case Rule::log_like:
        out = value_of(s.function, a);
        break;
      case Rule::select:
        out = row[s.w] < 0 ? a : row[s.b];
        break;
      case Rule::linear_product:
        out = n.c * (a * row[s.w]);
        break;
    }
  }

  /// What the terms of order 0 are multiplied with in every order.
  [[gnu::always_inline]] static inline StepFactors gain_of(const Step& s, const Step& n, const double* row) {
    switch (s.rule) {
      case Rule::quotient:
      case Rule::linear_quotient: {
        const double inverse = 1 / row[s.b];
        return {inverse, s.a == none ? 0 : n.c * inverse, row[s.out] * inverse};
      }
      case Rule::root:
        return {0.5 / row[s.out], 1 / row[s.out], 0};
      case Rule::power:
      case Rule::linear_power: {
        const double inverse = 1 / row[s.a];
        return {inverse, n.p * row[s.out] * inverse, 0};
      }
      case Rule::integral:
        return {0, n.c * row[s.w], 0};
      case Rule::log_like:
        return {1 / row[s.w], n.c / row[s.w], 0};
      case Rule::select:
        return {row[s.w] < 0 ? 1.0 : 0.0, 0, 0};
      case Rule::linear_product:
        return {0, row[s.a], 0};
      default:
        return {};
    }
  }

  /// Order k of a step. From one order to the next the way leads through the terms that are new: they are multiplied
  /// once and come last.
  [[gnu::always_inline]] inline void advance(const Step& s, const Step& n, const Known& of, const StepFactors& gain,
                                             double* row) const {
    double out = 0;
    const double *half = of.half, *last = of.last, part = of.part;
    switch (s.rule) {
      case Rule::sum: {  // what is known early comes first; of the factors of a product it is the second that is late
        const auto* products = structure.products + s.first_product;
        const auto *values = structure.values + s.first_value, *factors = numbers.values + s.first_value;
        const ProductEnds* const end = of.ends + s.first_product;
        each(s.products, [&](std::size_t i) LEAST_INLINE {
          const double known = end[i].sums * of.sums[products[i].lane];
          out = i > 0 ? out + known : known;
        });
        each(s.products, [&](std::size_t i) LEAST_INLINE {
          if (products[i].a != products[i].b) out += row[products[i].a] * end[i].b;
        });
        const auto term = [&](std::size_t i) LEAST_INLINE { return factors[i].factor * row[values[i].value]; };
        if (s.values > many) {  // four sums, which do not wait for each other
          std::array<double, 4> fours{};
          each(s.values, [&](std::size_t i) LEAST_INLINE { fours[i % 4] += term(i); });
          out += (fours[0] + fours[1]) + (fours[2] + fours[3]);
        } else {
          each(s.values, [&](std::size_t i) LEAST_INLINE { out = i > 0 || s.products > 0 ? out + term(i) : term(i); });
        }
        each(s.products, [&](std::size_t i) LEAST_INLINE {
          out += row[products[i].b] * (products[i].a != products[i].b ? end[i].a : end[i].a + end[i].b);
        });
        break;
      }
      case Rule::quotient: {
        const double known = of.older[s.lane] * gain.inverse + last[s.b] * (half[s.out] * gain.inverse);
        out = gain.a * (s.a == none ? 0 : row[s.a]) - (known + last[s.out] * (half[s.b] * gain.inverse)) -
              row[s.b] * gain.b;
        break;
      }
      case Rule::root:
        out = row[s.a] * gain.inverse - (of.older[s.lane] * gain.a + last[s.out] * (half[s.out] * gain.a));
        break;
      case Rule::power: {
        const double before = of.order - 1, by = part * gain.inverse;
        const double known =
            (n.p * of.older[s.lane] - of.older[s.w]) * by + last[s.a] * ((n.p * before - 1) * (half[s.out] * by));
        out = known + last[s.out] * ((n.p - before) * (half[s.a] * by)) + row[s.a] * gain.a;
        break;
      }
      case Rule::integral: {
        const double by = n.c * part;
        const double known = by * of.older[s.lane] + last[s.b] * (half[s.w] * by);
        out = known + last[s.w] * (half[s.b] * by) + row[s.a] * gain.a;
        break;
      }
      case Rule::log_like: {
        const double by = part * gain.inverse;
        const double known = of.older[s.lane] * by + last[s.w] * (half[s.weighted] * by);
        out = row[s.a] * gain.a - (known + last[s.weighted] * (half[s.w] * by));
        break;
      }
      case Rule::select:
        out = gain.inverse != 0 ? row[s.a] : row[s.b];
        break;
      case Rule::linear_product:
        out = n.c * (row[s.w] * gain.a + of.second[s.a] * last[s.w]);
        break;
      case Rule::linear_quotient:
        out = gain.a * (s.a == none ? 0 : row[s.a]) - of.second[s.b] * last[s.out] * gain.inverse;
        break;
      case Rule::linear_power:
        out = of.second[s.a] * last[s.out] * (n.p - of.order + 1) * (part * gain.inverse);
        break;
      case Rule::linear_integral:
        out = n.c * part * (of.second[s.a] * last[s.w]);
        break;
    }
    row[s.out] = out;
    row[s.weighted] = of.order * out;
  }
};

}  // namespace least::tape
