// The derivatives of the recurrences (core/tape/series_rules.hpp), for all that follow derivatives along series. The
// derivative of order k of a step consists of terms with x′ₖ, whose factors are known from order 0, and of sums over
// lower orders.
#pragma once

#include <algorithm>
#include <vector>

#include "core/tape/series_rules.hpp"

namespace least::tape {

/// By value: `moves` is whether it depends on the variables, and `reach` how many orders may be nonzero.
struct Kinds {
  static constexpr std::size_t everything = Series::most_orders + 1;
  std::vector<bool> moves;
  std::vector<std::size_t> reach;

  explicit Kinds(const Program& p);
};

/// Lists for `to` the summands of out′ₖ of a step: derive calls to.add(x, factor) for factor x′ₖ, and to.add_sum(x, y,
/// factor, a, b) for factor Σ (a + b j/k) x′ⱼ y_{k−j} over j < k. to.value(x) has to return x₀. Apart from
/// Rule::select, the calls and their order do not depend on the values.
template <class To>
void derive(const Program& p, const Step& s, To&& to) {
  const auto value = [&](Index x) { return to.value(x); };
  switch (s.rule) {
    case Rule::sum:
      for (Index i = 0; i < s.values; ++i) {
        const Program::Value& term = p.values[at(s.first_value + i)];
        to.add(term.value, term.factor);
      }
      for (Index i = 0; i < s.products; ++i) {  // factor (x y)′
        const Program::Product& term = p.products[at(s.first_product + i)];
        if (term.a == term.b) {
          to.add(term.a, 2 * term.factor * value(term.a));
          to.add_sum(term.a, term.a, 2 * term.factor, 1, 0);
          continue;
        }
        to.add(term.a, term.factor * value(term.b));
        to.add(term.b, term.factor * value(term.a));
        to.add_sum(term.a, term.b, term.factor, 1, 0);
        to.add_sum(term.b, term.a, term.factor, 1, 0);
      }
      break;
    case Rule::quotient:
    case Rule::linear_quotient: {  // out b = c a
      const double by = 1 / value(s.b);
      to.add(s.a, s.c * by);
      to.add(s.b, -by * value(s.out));
      to.add_sum(s.b, s.out, -by, 1, 0);
      to.add_sum(s.out, s.b, -by, 1, 0);
      break;
    }
    case Rule::root: {  // out² = a
      const double by = 1 / value(s.out);
      to.add(s.a, 0.5 * by);
      to.add_sum(s.out, s.out, -by, 1, 0);
      break;
    }
    case Rule::power: {  // a ȯut = p ȧ out
      const double by = 1 / value(s.a);
      to.add(s.a, s.p * value(s.out) * by);
      to.add_sum(s.a, s.out, by, -1, 1 + s.p);
      to.add_sum(s.out, s.a, by, s.p, -1 - s.p);
      break;
    }
    case Rule::integral:  // ȯut = c w ȧ
      to.add(s.a, s.c * value(s.w));
      to.add_sum(s.a, s.w, s.c, 0, 1);
      to.add_sum(s.w, s.a, s.c, 1, -1);
      break;
    case Rule::log_like: {  // w ȯut = c ȧ
      const double by = 1 / value(s.w);
      to.add(s.a, s.c * by);
      to.add_sum(s.w, s.out, -by, 1, -1);
      to.add_sum(s.out, s.w, -by, 0, 1);
      break;
    }
    case Rule::select:
      to.add(value(s.w) < 0 ? s.a : s.b, 1);
      break;
    case Rule::linear_product:  // a depends on the time alone
      to.add(s.w, s.c * value(s.a));
      to.add_sum(s.w, s.a, s.c, 1, 0);
      break;
    default:
      break;
  }
}

}  // namespace least::tape
