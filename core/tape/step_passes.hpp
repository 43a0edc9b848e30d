// The recurrences of StepTangents (core/tape/step_tangents.hpp) for registers of any width. Steps are independent of
// each other, so registers that hold fewer numbers than there are steps take these part by part. Everything is inlined
// into functions that are compiled for registers of that width.
#pragma once

#include <algorithm>
#include <cstddef>

#include "core/tape/series_rules.hpp"
#include "core/tape/step_tangents.hpp"

namespace least::tape {

/// Part is a register with the numbers of `Wide` of the steps.
template <std::size_t Wide>
struct [[gnu::may_alias]] Part {
  double lane __attribute__((vector_size(8 * Wide)));
};
/// The number of parts that all steps make up.
template <std::size_t Wide>
constexpr std::ptrdiff_t parts = StepTangents::steps / Wide;
template <std::size_t Wide>
const Part<Wide>* part_of(const StepTangents::Side* all, std::ptrdiff_t part) {
  return reinterpret_cast<const Part<Wide>*>(all) + part;
}
template <std::size_t Wide>
Part<Wide>* part_of(StepTangents::Side* all, std::ptrdiff_t part) {
  return reinterpret_cast<Part<Wide>*>(all) + part;
}

/// Σ aⱼ b_{k−j} over begin ≤ j < end
template <std::size_t Wide>
[[gnu::always_inline]] inline void convolve(const Part<Wide>* a, const Part<Wide>* b, std::size_t k, std::size_t begin,
                                            std::size_t end, Part<Wide>& sum) {
  constexpr auto next = parts<Wide>;
  sum.lane = Part<Wide>{}.lane;
  a += next * static_cast<std::ptrdiff_t>(begin);
  b += next * static_cast<std::ptrdiff_t>(k - begin);
  for (std::size_t j = begin; j < end; ++j, a += next, b -= next) sum.lane += a->lane * b->lane;
}
/// Σ aⱼ a_{k−j} over begin ≤ j ≤ k − begin
template <std::size_t Wide>
[[gnu::always_inline]] inline void square(const Part<Wide>* a, std::size_t k, std::size_t begin, Part<Wide>& sum) {
  convolve<Wide>(a, a, k, begin, (k + 1) / 2, sum);
  sum.lane *= 2;
  const Part<Wide>* const middle = a + parts<Wide> * static_cast<std::ptrdiff_t>(k / 2);
  if (k % 2 == 0 && k / 2 >= begin) sum.lane += middle->lane * middle->lane;
}

/// Motion computes the series of the motion itself for the steps of one part.
template <std::size_t Wide>
class StepTangents::Motion {
 public:
  [[gnu::always_inline]] inline Motion(StepTangents& of, std::ptrdiff_t part)
      : of_(of), p_(of.program_), part_(part), stride_(static_cast<std::ptrdiff_t>(of.order_ + 1)) {}

  [[gnu::always_inline]] inline void go() {
    for (std::size_t k = 0; k < of_.order_; ++k) {
      if (k == 1)
        for (const Step& s : p_.linear) sum_up(s, 1);
      if (k > 0)
        for (std::size_t i = 0; i < p_.steps.size(); ++i)
          if (of_.reach_[tape::at(p_.steps[i].out)] > 1) advance(p_.steps[i], of_.gains_[i], k);
      for (std::size_t i = 0; i < p_.moving; ++i)
        at(Program::first_variable + static_cast<Index>(i), k + 1).lane = at(p_.rate[i], k).lane * inverses[k + 1];
    }
  }

 private:
  using Numbers = Part<Wide>;
  [[gnu::always_inline]] inline Numbers* row(Index value) const {
    return part_of<Wide>(of_.rows_.data() + value * stride_, part_);
  }
  [[gnu::always_inline]] inline Numbers& at(Index value, std::size_t k) const {
    return row(value)[parts<Wide> * static_cast<std::ptrdiff_t>(k)];
  }
  std::size_t reach(Index value) const { return of_.reach_[tape::at(value)]; }

  [[gnu::always_inline]] inline void sum_up(const Step& s, std::size_t k) {
    Numbers sum{}, part;
    for (Index i = 0; i < s.values; ++i) {
      const Program::Value& term = p_.values[tape::at(s.first_value + i)];
      sum.lane += term.factor * at(term.value, k).lane;
    }
    for (Index i = 0; i < s.products; ++i) {
      const Program::Product& term = p_.products[tape::at(s.first_product + i)];
      if (term.a == term.b) {
        square<Wide>(row(term.a), k, 0, part);
      } else {
        const std::size_t begin = k < reach(term.b) ? 0 : k + 1 - reach(term.b);
        convolve<Wide>(row(term.a), row(term.b), k, begin, std::min(k + 1, reach(term.a)), part);
      }
      sum.lane += term.factor * part.lane;
    }
    at(s.out, k).lane = sum.lane;
  }
  /// Computes order k of a step of the program.
  [[gnu::always_inline]] inline void advance(const Step& s, const Side& gains, std::size_t k) {
    const Numbers& gain = *part_of<Wide>(&gains, part_);
    Numbers sum{};
    switch (s.rule) {
      case Rule::sum:
        return sum_up(s, k);
      case Rule::quotient:
      case Rule::linear_quotient:
        convolve<Wide>(row(s.out), row(s.b), k, k < reach(s.b) ? 0 : k + 1 - reach(s.b), k, sum);
        sum.lane = -sum.lane;
        if (s.a != none) sum.lane += s.c * at(s.a, k).lane;
        at(s.out, k).lane = sum.lane * gain.lane;
        break;
      case Rule::root:
        square<Wide>(row(s.out), k, 1, sum);
        at(s.out, k).lane = (at(s.a, k).lane - sum.lane) * gain.lane;
        break;
      case Rule::power:
      case Rule::linear_power:
        for (std::size_t j = s.rule == Rule::power ? 0 : k - 1; j < k; ++j) {
          const double share = s.p * static_cast<double>(k - j) - static_cast<double>(j);
          sum.lane += (share * at(s.out, j).lane) * at(s.a, k - j).lane;
        }
        at(s.out, k).lane = sum.lane * (inverses[k] * gain.lane);
        break;
      case Rule::integral:
      case Rule::linear_integral:
        for (std::size_t j = 1, end = s.rule == Rule::integral ? k : 1; j <= end; ++j)
          sum.lane += (static_cast<double>(j) * at(s.a, j).lane) * at(s.w, k - j).lane;
        at(s.out, k).lane = (s.c * inverses[k]) * sum.lane;
        break;
      case Rule::log_like:
        for (std::size_t j = 1; j < k; ++j)
          sum.lane += (static_cast<double>(j) * at(s.out, j).lane) * at(s.w, k - j).lane;
        at(s.out, k).lane = (s.c * at(s.a, k).lane - inverses[k] * sum.lane) * gain.lane;
        break;
      case Rule::linear_product:
        at(s.out, k).lane = s.c * (at(s.a, 0).lane * at(s.w, k).lane + at(s.a, 1).lane * at(s.w, k - 1).lane);
        break;
      case Rule::select:  // StepTangents::suits excludes it
        break;
    }
  }

  StepTangents& of_;
  const Program& p_;
  std::ptrdiff_t part_, stride_;
};

/// Columns computes the derivatives of one group of columns for the steps of one part, two orders at a time, so that
/// the operands that the sums of both orders share are read once.
template <std::size_t Wide, std::size_t Count>
class StepTangents::Columns {
 public:
  [[gnu::always_inline]] inline Columns(StepTangents& of, Group& group, std::ptrdiff_t part)
      : of_(of),
        part_(part),
        motion_(part_of<Wide>(of.rows_.data(), part)),
        rows_(part_of<Wide>(group.rows.data(), part)),
        stride_(of.order_ + 1) {
    const Program& p = of.program_;
    for (std::size_t i = 0; i < p.variables; ++i)
      for (std::size_t c = 0; c < Count; ++c) {
        Numbers& start = at(of.slot_[tape::at(Program::first_variable) + i], 0)[c * next];
        const double one = i == group.first + c ? 1 : 0;
        start.lane = of.along_ ? of_part(of.directions_[i]).lane : Numbers{}.lane + one;
      }
  }

  [[gnu::always_inline]] inline void go() {
    for (std::size_t k = 0; k < of_.order_; k += 2) {
      Numbers* found = part_of<Wide>(of_.found_.data(), 0);
      for (const Sum& sum : of_.sums_) {
        find(sum, k, found);
        found += 2 * Count;
      }
      advance_all<false>(k);
      if (k + 1 < of_.order_) advance_all<true>(k + 1);
    }
  }

 private:
  using Numbers = Part<Wide>;
  static constexpr auto next = static_cast<std::size_t>(parts<Wide>);
  [[gnu::always_inline]] inline Numbers* at(Index slot, std::size_t k) const {
    return rows_ + (tape::at(slot) * stride_ + k) * Count * next;
  }
  [[gnu::always_inline]] inline const Numbers* motion(Index value, std::size_t k) const {
    return motion_ + (tape::at(value) * stride_ + k) * next;
  }
  [[gnu::always_inline]] inline const Numbers& of_part(const Side& all) const { return *part_of<Wide>(&all, part_); }

  /// Computes Σ (a + b j/k) x′ⱼ y_{k−j} over j < k, and the sum of order k + 1 over the same j, which lacks its term j
  /// = k.
  [[gnu::always_inline]] inline void find(const Sum& sum, std::size_t k, Numbers* found) {
    const double here = k > 0 ? sum.b * inverses[k] : 0, later = sum.b * inverses[k + 1];
    const Numbers *x = at(sum.x, 0), *y = motion(sum.y, k);
    Numbers of_this[Count], of_next[Count];  // NOLINT: vectors
#pragma GCC unroll 4
    for (std::size_t c = 0; c < Count; ++c) of_this[c].lane = of_next[c].lane = Numbers{}.lane;
    std::size_t begin = 0;
    if (k + 1 >= sum.y_reach) begin = k + 2 - sum.y_reach;
    const std::size_t end = std::min(k, sum.x_reach);
    if (begin > 0 && begin <= k) {  // one term more, of order k alone
      const Numbers* const before = x + (begin - 1) * Count * next;
      if (begin - 1 < end) {
        Numbers factor;
        factor.lane = (sum.a + here * static_cast<double>(begin - 1)) * motion(sum.y, k + 1 - begin)->lane;
#pragma GCC unroll 4
        for (std::size_t c = 0; c < Count; ++c) of_this[c].lane = before[c * next].lane * factor.lane;
      }
    }
    x += begin * Count * next;
    y -= begin * next;
    if (begin < end) {
      Numbers above = y[next];
      if (sum.a == 1 && sum.b == 0) {
        for (std::size_t j = begin; j < end; ++j, x += Count * next, y -= next) {
          const Numbers last = *y;
#pragma GCC unroll 4
          for (std::size_t c = 0; c < Count; ++c) {
            const Numbers tangent = x[c * next];
            of_this[c].lane += tangent.lane * last.lane;
            of_next[c].lane += tangent.lane * above.lane;
          }
          above = last;
        }
      } else {
        auto place = static_cast<double>(begin);
        for (std::size_t j = begin; j < end; ++j, x += Count * next, y -= next, place += 1) {
          const Numbers last = *y;
          Numbers low, high;
          low.lane = (sum.a + here * place) * last.lane;
          high.lane = (sum.a + later * place) * above.lane;
#pragma GCC unroll 4
          for (std::size_t c = 0; c < Count; ++c) {
            const Numbers tangent = x[c * next];
            of_this[c].lane += tangent.lane * low.lane;
            of_next[c].lane += tangent.lane * high.lane;
          }
          above = last;
        }
      }
    }
#pragma GCC unroll 4
    for (std::size_t c = 0; c < Count; ++c) {
      found[c].lane = of_this[c].lane;
      found[Count + c].lane = of_next[c].lane;
    }
  }

  /// Computes order k of all steps from the sums. `second`: k is the second of two orders, whose sums lack a term.
  template <bool second>
  [[gnu::always_inline]] inline void advance_all(std::size_t k) {
    const Program& p = of_.program_;
    for (const Planned& planned : of_.planned_)
      if (k == 0 || planned.lasts) advance<second>(planned, k);
    for (std::size_t i = 0; i < p.moving; ++i) {
      const Index rate = of_.slot_[tape::at(p.rate[i])];
      if (rate == none || k >= of_.reach_[tape::at(p.rate[i])]) continue;
      Numbers* const above = at(of_.slot_[tape::at(Program::first_variable) + i], k + 1);
      const Numbers* const here = at(rate, k);
      for (std::size_t c = 0; c < Count; ++c) above[c * next].lane = here[c * next].lane * inverses[k + 1];
    }
  }
  template <bool second>
  [[gnu::always_inline]] inline void advance(const Planned& planned, std::size_t k) {
    Numbers all[Count];  // NOLINT: vectors
#pragma GCC unroll 4
    for (std::size_t c = 0; c < Count; ++c) all[c].lane = Numbers{}.lane;
    const Numbers* found = part_of<Wide>(of_.found_.data(), 0) + 2 * Count * planned.sums + (second ? Count : 0);
    for (std::size_t i = planned.sums; i < planned.sums_end; ++i, found += 2 * Count) {
      const Sum& sum = of_.sums_[i];
      const Numbers& factor = of_part(sum.factor);
      Numbers part[Count];  // NOLINT: vectors
#pragma GCC unroll 4
      for (std::size_t c = 0; c < Count; ++c) part[c].lane = found[c].lane;
      if (second && k <= sum.x_reach) {
        const Numbers* const x = at(sum.x, k - 1);
        Numbers last;
        last.lane = (sum.a + sum.b * (1 - inverses[k])) * motion(sum.y, 1)->lane;
#pragma GCC unroll 4
        for (std::size_t c = 0; c < Count; ++c) part[c].lane += x[c * next].lane * last.lane;
      }
#pragma GCC unroll 4
      for (std::size_t c = 0; c < Count; ++c) all[c].lane += factor.lane * part[c].lane;
    }
    for (std::size_t i = planned.terms; i < planned.terms_end; ++i) {
      const Term& term = of_.terms_[i];
      if (k >= term.reach) continue;
      const Numbers& factor = of_part(term.factor);
      const Numbers* const x = at(term.x, k);
#pragma GCC unroll 4
      for (std::size_t c = 0; c < Count; ++c) all[c].lane += factor.lane * x[c * next].lane;
    }
    Numbers* const out = at(planned.out, k);
#pragma GCC unroll 4
    for (std::size_t c = 0; c < Count; ++c) out[c * next].lane = all[c].lane;
  }

  StepTangents& of_;
  std::ptrdiff_t part_;
  const Numbers* motion_;
  Numbers* rows_;
  std::size_t stride_;
};

}  // namespace least::tape
