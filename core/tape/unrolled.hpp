// Unrolled computes series of programs whose structure is known at compile time: an order is straight-line code, its
// values stay in registers, and the processor sees all dependences at once. Constant factors come from the program that
// a run has recorded, so any program of the structure can use the code. It gives the bits of the interpreter where
// nothing overflows.
#pragma once

#include <algorithm>
#include <span>
#include <utility>

#include "core/tape/lowered.hpp"
#include "core/tape/series_rules.hpp"
#include "core/tape/steep.hpp"

namespace least::tape {

/// Calls visit(n) with every number of the structure of a program, that is, of everything but its constant factors;
/// stops and returns false as soon as visit does.
template <class Visit>
constexpr bool read_structure(const Program& p, Visit&& visit) {
  const auto all = [&](const auto&... n) { return (visit(static_cast<Index>(n)) && ...); };
  const auto each = [&](const auto& list, auto&& one) {
    if (!all(list.size())) return false;
    for (const auto& item : list)
      if (!one(item)) return false;
    return true;
  };
  const auto step = [&](const Step& s) {
    return all(s.rule, s.function, s.out, s.weighted, s.a, s.b, s.w, s.lane, s.first_value, s.values, s.first_product,
               s.products);
  };
  const auto place = [&](Index i) { return all(i); };
  return all(p.variables, p.moving, p.rows) && each(p.steps, step) && each(p.linear, step) &&
         each(p.values, [&](const auto& v) { return all(v.value); }) &&
         each(p.products, [&](const auto& v) { return all(v.a, v.b, v.lane); }) && each(p.lane_a, place) &&
         each(p.lane_b, place) && each(p.rate, place) && each(p.weighted, place) && each(p.switches, place) &&
         each(p.poles, place);
}

/// Fixed is a program in lists of fixed size, so that it can be a constexpr constant.
template <std::size_t Steps, std::size_t Linear, std::size_t Values, std::size_t Products, std::size_t Lanes,
          std::size_t Slots, std::size_t Variables, std::size_t Kept, std::size_t Numbers>
struct Fixed {
  std::array<Step, Steps> steps;
  std::array<Step, Linear> linear;
  std::array<Program::Value, Values> values;
  std::array<Program::Product, Products> products;
  std::array<Index, Lanes> slot;
  std::array<Index, Slots> low, high;
  std::array<Index, Variables> rate;
  std::array<Index, Variables + 1> weighted;
  std::array<Index, Kept> kept;  ///< values whose coefficients callers read
  std::array<Index, Numbers> structure;
  std::size_t rows = 0;
};

/// Measured is a Fixed that is large enough for every program that is unrolled, with the used lengths of its lists.
struct Measured {
  static constexpr std::size_t most = 64;
  Fixed<most, 8, 4 * most, 2 * most, most, 2 * most, 24, 16, 16 * most> lists{};
  std::array<std::size_t, 9> used{};
};
template <class From, class To>
constexpr void copy_first(std::size_t count, const From& from, To& to) {
  for (std::size_t i = 0; i < count; ++i) to[i] = from[i];
}
constexpr Measured measured(const Program& p) {
  Measured made;
  auto& to = made.lists;
  std::size_t kept = 0, numbers = 0;
  for (const auto* list : {&p.switches, &p.poles})
    for (const Index value : *list) to.kept[kept++] = value;
  for (const Step& step : p.steps)
    if (steepness(step.function)) to.kept[kept++] = step.a;
  read_structure(p, [&](Index n) {
    to.structure[numbers++] = n;
    return true;
  });
  made.used = {p.steps.size(),  p.linear.size(), p.values.size(), p.products.size(),
               p.lane_a.size(), p.low.size(),    p.variables,     kept,
               numbers};
  copy_first(p.steps.size(), p.steps, to.steps);
  copy_first(p.linear.size(), p.linear, to.linear);
  copy_first(p.values.size(), p.values, to.values);
  copy_first(p.products.size(), p.products, to.products);
  copy_first(p.slot.size(), p.slot, to.slot);
  copy_first(p.low.size(), p.low, to.low);
  copy_first(p.high.size(), p.high, to.high);
  copy_first(p.rate.size(), p.rate, to.rate);
  copy_first(p.weighted.size(), p.weighted, to.weighted);
  to.rows = at(p.rows);
  return made;
}
/// Returns the lists of M shortened to their used lengths.
template <const Measured& M>
constexpr auto shrunk() {
  constexpr auto& n = M.used;
  Fixed<n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7], n[8]> made{};
  const auto take = [](const auto& from, auto& to) { copy_first(to.size(), from, to); };
  take(M.lists.steps, made.steps);
  take(M.lists.linear, made.linear);
  take(M.lists.values, made.values);
  take(M.lists.products, made.products);
  take(M.lists.slot, made.slot);
  take(M.lists.low, made.low);
  take(M.lists.high, made.high);
  take(M.lists.rate, made.rate);
  take(M.lists.weighted, made.weighted);
  take(M.lists.kept, made.kept);
  take(M.lists.structure, made.structure);
  made.rows = M.lists.rows;
  return made;
}

/// Unrolled expands the series of programs with the structure S, without loops over steps.
template <const auto& S>
class Unrolled {
 public:
  static bool fits(const Program& program) {
    std::size_t next = 0;
    return read_structure(program, [&](Index n) { return next < S.structure.size() && S.structure[next++] == n; }) &&
           next == S.structure.size();
  }

  [[gnu::always_inline]] static inline void expand(const Program& p, const Workspace& of) {
    const Rules<true> rules{{S.values.data(), S.products.data()}, {p.values.data(), p.products.data()}};
    Row row{}, second{}, half{}, last{};
    if (of.begun) {
      each<S.rows - first>([&](auto i) LEAST_INLINE { row[first + i] = of.begun[first + i]; });
    } else {
      each<variables>([&](auto i) LEAST_INLINE { row[first + i] = of.x[i]; });
      row[time] = of.t;
      begin(p, rules, row);
    }
    each<variables>([&](auto i) LEAST_INLINE { of.rows[first + i] = row[first + i]; });
    std::array<StepFactors, steps> gains;
    std::array<ProductEnds, S.products.size()> ends;
    each<steps>([&](auto i) LEAST_INLINE { gains[i] = Rules<true>::gain_of(S.steps[i], p.steps[i], row.data()); });
    each<S.products.size()>([&](auto i) LEAST_INLINE {
      const Program::Product& term = S.products[i];
      ends[i] = ends_of(term, p.products[i].factor, row.data());
    });
    // Order 1 of the steps linear in time; their higher orders are zero.
    second[time] = second[at(S.weighted.back())] = 1;
    each<linear>([&](auto i) LEAST_INLINE {
      const Known known{1, 1, second.data(), half.data(), row.data(), nullptr, nullptr, nullptr};
      rules.advance(S.linear[i], p.linear[i], known, StepFactors{}, second.data());
    });
    Fours high, before, share{};  // the higher factors of the last order and of the one before it
    auto next = finish(of, 0, row, high);
    double order = 0;
    const auto take = [&](std::size_t k, bool early, const Fours& slots) LEAST_INLINE {
      order += 1;
      std::array<double, lanes + 1> older, sums;
      Fours all;  // slots with the terms of the last order added
      if constexpr (!alone)
        each<groups>([&](auto g) LEAST_INLINE { all[g].lane = slots[g].lane + share[g].lane * high[g].lane; });
      each<lanes>([&](auto i) LEAST_INLINE {
        constexpr std::size_t slot = at(S.slot[i]), a = at(S.low[slot]), b = at(S.high[slot]);
        if constexpr (alone) {
          sums[i] = slots[slot / 4].lane[slot % 4] + half[a] * row[b];
          if constexpr (a != b) sums[i] += slots[(slot + 1) / 4].lane[(slot + 1) % 4] + half[b] * row[a];
        } else {
          sums[i] = sum_of(all[0].begin() + slot, a == b);
        }
        older[i] = slots[slot / 4].lane[slot % 4];
        if constexpr (a != b) older[i] += slots[(slot + 1) / 4].lane[(slot + 1) % 4];
      });
      last = row;
      each<variables>([&](auto i) LEAST_INLINE {
        row[first + i] = next[i];
        row[at(S.weighted[i])] = last[at(S.rate[i])];
      });
      const double once = early && k == 1 ? 1 : 0;
      row[time] = row[at(S.weighted.back())] = once;
      each<linear>([&](auto i) LEAST_INLINE {
        row[at(S.linear[i].out)] = once * second[at(S.linear[i].out)];
        row[at(S.linear[i].weighted)] = once * second[at(S.linear[i].weighted)];
      });
      const Known known{order,       inverses[k],  second.data(), half.data(),
                        last.data(), older.data(), sums.data(),   ends.data()};
      each<steps>([&](auto i) LEAST_INLINE { rules.advance(S.steps[i], p.steps[i], known, gains[i], row.data()); });
      next = finish(of, k, row, high);
      if (!early) return;
      if (k == 1) second = row;
      const double part = k == 1 ? 0.5 : 1.0;
      each<S.rows>([&](auto i) LEAST_INLINE { half[i] = second[i] * part; });
      each<groups>([&](auto g) LEAST_INLINE { share[g].lane = of.lanes[2 * groups + g].lane * part; });
    };
    for (std::size_t k = 1; k < of.orders; k += 2) {
      Fours odd{}, even{};
      sum_two<groups>(of.lanes, groups, k / 2, before.data(), high.data(), odd.data(), even.data());
      take(k, k == 1, odd);
      before = high;
      if (k + 1 == of.orders) break;
      take(k + 1, k == 1, even);
    }
  }

  /// Computes order 0 of all values from the variables and the time in `values`.
  [[gnu::always_inline]] static inline void begin(const Program& p, double* values) {
    const Rules<true> rules{{S.values.data(), S.products.data()}, {p.values.data(), p.products.data()}};
    Row row{};
    each<variables + 1>([&](auto i) LEAST_INLINE { row[first + i] = values[first + i]; });
    begin(p, rules, row);
    each<S.rows - first>([&](auto i) LEAST_INLINE { values[first + i] = row[first + i]; });
  }

 private:
  static constexpr std::size_t steps = S.steps.size(), linear = S.linear.size(), variables = S.rate.size(),
                               lanes = S.slot.size(), groups = S.low.size() / 4, first = at(Program::first_variable),
                               time = first + variables;
  /// Whether some sum that is no rate has a product of two computed values: orders then have long chains of
  /// dependences.
  static constexpr bool chained = std::ranges::any_of(S.steps, [](const Step& s) {
    const auto products = std::span(S.products).subspan(at(s.first_product), at(s.products));
    const auto computed = [](Index value) { return at(value) > time; };
    return s.rule == Rule::sum && !std::ranges::count(S.rate, s.out) &&
           std::ranges::any_of(products, [=](const auto& term) { return computed(term.a) && computed(term.b); });
  });
  /// Whether the terms of the last order are added lane by lane instead of by fours: more operations, but done sooner.
  static constexpr bool alone = lanes <= (chained ? 8 : 6);
  using Row = std::array<double, S.rows>;
  using Fours = std::array<Four, groups + 1>;

  template <std::size_t N, class F>
  [[gnu::always_inline]] static inline void each(F&& f) {
    [&]<std::size_t... I>(std::index_sequence<I...>) LEAST_INLINE {
      (f(std::integral_constant<std::size_t, I>{}), ...);
    }
    (std::make_index_sequence<N>{});
  }

  [[gnu::always_inline]] static inline void begin(const Program& p, const Rules<true>& rules, Row& row) {
    each<linear>([&](auto i) LEAST_INLINE { rules.begin(S.linear[i], p.linear[i], row.data()); });
    each<steps>([&](auto i) LEAST_INLINE {
      if constexpr (i > 0 && is_pair(i - 1)) return;
      if constexpr (is_pair(i)) {  // sine and cosine of one argument cost little more than one of them
        const double x = p.steps[i].p * row[at(S.steps[i].a)];
        row[at(S.steps[i].out)] = std::sin(x);
        row[at(S.steps[i + 1].out)] = std::cos(x);
      } else {
        rules.begin(S.steps[i], p.steps[i], row.data());
      }
    });
  }

  /// Whether step i and the next are sine and cosine of the same argument.
  static constexpr bool is_pair(std::size_t i) {
    return i + 1 < steps && S.steps[i].products == 0 && S.steps[i].function == Op::sin &&
           S.steps[i + 1].function == Op::cos && S.steps[i].w == S.steps[i + 1].out &&
           S.steps[i + 1].w == S.steps[i].out;
  }

  /// Writes a four with one store, because it is read soon after: a processor cannot forward four stores to one load.
  [[gnu::always_inline]] static inline void together(Four& out, double a, double b, double c, double d) {
    Four four{{a, b, c, d}};
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
    asm("" : "+x"(four.lane));
#endif
    out.lane = four.lane;
  }

  /// Returns order k + 1 of the variables, and stores what is read of order k: `kept` values and the factors of slots.
  [[gnu::always_inline]] static inline std::array<double, variables> finish(const Workspace& of, std::size_t k,
                                                                            const Row& row, Fours& high) {
    double* const here = of.rows + k * S.rows;
    std::array<double, variables> next;
    each<variables>([&](auto i)
                        LEAST_INLINE { here[S.rows + first + i] = next[i] = row[at(S.rate[i])] * inverses[k + 1]; });
    each<S.kept.size()>([&](auto i) LEAST_INLINE { here[at(S.kept[i])] = row[at(S.kept[i])]; });
    Four* const fours = of.lanes + k * 2 * groups;
    each<groups>([&](auto g) LEAST_INLINE {
      constexpr std::size_t f = 4 * g;
      together(fours[g], row[at(S.low[f])], row[at(S.low[f + 1])], row[at(S.low[f + 2])], row[at(S.low[f + 3])]);
      constexpr auto place = [](int i) { return S.high[f + at(i)] == S.low[f + at(i)] ? i : i ^ 1; };
#if defined(__GNUC__) && !defined(__clang__)  // one instruction, which the compiler does not find in the code below
      constexpr std::int64_t places __attribute__((vector_size(32))) = {place(0), place(1), place(2), place(3)};
      high[g].lane = __builtin_shuffle(fours[g].lane, places);
#else
      const auto& low = fours[g].lane;
      high[g].lane = Four{{low[place(0)], low[place(1)], low[place(2)], low[place(3)]}}.lane;
#endif
      fours[groups + g].lane = high[g].lane;
    });
    return next;
  }
};

/// UnrolledSeries is an Unrolled<S> as an entry of a table.
struct UnrolledSeries {
  bool (*fits)(const Program&);
  void (*expand)(const Program&, const Workspace&);
  void (*begin)(const Program&, double*);
};
/// Returns all unrolled series, those of the problems of the catalogue (core/catalogue/unrolled_series.cpp); none where
/// the machine has no registers of four doubles.
std::span<const UnrolledSeries> unrolled_series();

}  // namespace least::tape
