// The passes of SeriesReading over an order, for registers of any width. An operand of a batch is a column of values,
// of which a register holds `Wide` at a time. Everything is inlined into functions that are compiled for registers of
// that width.
#pragma once

#include <algorithm>
#include <array>
#include <cstring>

#include "core/tape/series_reading.hpp"
#include "core/tape/steep.hpp"

namespace least::tape {

/// Pack reads and writes registers of `Wide` numbers.
template <std::size_t Wide>
struct Pack {
  typedef double Numbers __attribute__((vector_size(8 * Wide)));

  [[gnu::always_inline]] static inline Numbers read(const double* from) {
    Numbers numbers{};
    std::memcpy(&numbers, from, sizeof(numbers));
    return numbers;
  }
  [[gnu::always_inline]] static inline void write(const Numbers& numbers, double* to) {
    std::memcpy(to, &numbers, sizeof(numbers));
  }
};

/// PackRow is a row of values as the steps of a batch from number `offset` on read it, a register at a time.
template <std::size_t Wide>
struct PackRow {
  using Number = typename Pack<Wide>::Numbers;

  double* row;
  const Index* places;
  std::size_t offset;

  [[gnu::always_inline]] inline Number operator[](const Column& column) const {
    if (!column.gathered) return Pack<Wide>::read(row + at(column.first) + offset);
    const Index* const from = places + at(column.first) + offset;
    if constexpr (Wide == 8) {  // as one initializer: filled number by number, the register would wait for itself
      return Number{row[from[0]], row[from[1]], row[from[2]], row[from[3]],
                    row[from[4]], row[from[5]], row[from[6]], row[from[7]]};
    } else if constexpr (Wide == 4) {
      return Number{row[from[0]], row[from[1]], row[from[2]], row[from[3]]};
    } else {
      return Number{row[from[0]], row[from[1]]};
    }
  }
};
template <std::size_t Wide>
[[gnu::always_inline]] inline void put(const PackRow<Wide>& row, const Column& column,
                                       const typename PackRow<Wide>::Number& value) {
  if (column.first != none) Pack<Wide>::write(value, row.row + at(column.first) + row.offset);
}

/// The constant factors of the steps of a batch, from an offset on, by term; terms are `room` numbers apart.
template <std::size_t Wide>
struct PackFactors {
  struct Term {
    typename Pack<Wide>::Numbers factor;
  };
  const double* first;
  std::size_t room;

  [[gnu::always_inline]] inline PackFactors operator+(Index) const { return *this; }  // they are of this batch
  [[gnu::always_inline]] inline Term operator[](std::size_t i) const { return {Pack<Wide>::read(first + i * room)}; }
};
template <std::size_t Wide>
struct PackEnds {
  using Ends = EndsOf<typename Pack<Wide>::Numbers>;
  double* first;
  std::size_t room;

  [[gnu::always_inline]] inline PackEnds operator+(Index) const { return *this; }
  [[gnu::always_inline]] inline Ends operator[](std::size_t i) const {
    const double* const from = first + 3 * i * room;
    return {Pack<Wide>::read(from), Pack<Wide>::read(from + room), Pack<Wide>::read(from + 2 * room)};
  }
  [[gnu::always_inline]] inline void set(std::size_t i, const Ends& ends) const {
    double* const to = first + 3 * i * room;
    Pack<Wide>::write(ends.a, to);
    Pack<Wide>::write(ends.b, to + room);
    Pack<Wide>::write(ends.sums, to + 2 * room);
  }
};

template <std::size_t Wide>
class SeriesReading::Pass {
 public:
  [[gnu::always_inline]] inline Pass(SeriesReading& of, const Program& program)
      : of_(of),
        p_(program),
        one_by_one_{{p_.values.data(), p_.products.data()}, {p_.values.data(), p_.products.data()}},
        lists_{of.batches_.values.data(), of.batches_.products.data()},
        places_(of.batches_.places.data()),
        numbers_(of.batches_.numbers.data()),
        half_(of.half_.data()),
        older_(of.older_.data()),
        sums_(of.sums_.data()),
        scratch_(of.scratch_.data()) {}

  /// Computes order 0. `bounded`: as in Series::expand.
  [[gnu::always_inline]] inline void begin(double* row, bool bounded) const {
    constexpr double bound = 1e50;
    const auto clamp = [&](Index first, std::size_t count) {
      for (double* value = row + first; value != row + at(first) + count; ++value)
        *value = std::clamp(*value, -bound, bound);
    };
    for (const Step& s : p_.linear) one_by_one_.begin(s, s, row);
    for (const StepBatches::Piece& piece : of_.batches_.pieces) {
      if (!piece.is_batch) {
        for_each_step(piece, [&](std::size_t i) LEAST_INLINE {
          const Step& s = p_.steps[i];
          one_by_one_.begin(s, s, row);
          if (bounded && steepness(s.function)) clamp(s.out, 1);
        });
        continue;
      }
      const StepBatch& batch = of_.batches_.batches[piece.first];
      for (std::size_t offset = 0; offset < batch.count; offset += Wide)
        rules_of(batch, offset).begin(batch, numbers_of(batch, offset), row_of(row, offset));
      if (bounded && steepness(batch.function)) clamp(batch.out.first, batch.count);
    }
  }

  [[gnu::always_inline]] inline void expand(const Workspace& in) {
    find_factors(in.rows);
    double* const second = in.rows + in.stride;
    for (std::size_t k = 0; k < in.orders; ++k) {
      double* const row = in.rows + k * in.stride;
      if (k > 0) {
        const double share = k == 2 ? 0.5 : 1;
        if (k <= 3)
          for (std::size_t i = 0; i < in.stride; ++i) half_[i] = k == 1 ? 0 : share * second[i];
        sum_lanes<false>(in, k);
        sum_lanes<true>(in, k);
        advance(k, second, row - in.stride, row);
      }
      double* const next = row + in.stride;
      for (const Rates& some : of_.rates_)
        for (std::size_t i = 0; i < some.count; ++i)
          next[at(some.variable) + i] = row[at(some.rate) + i] * inverses[k + 1];
      for (const std::size_t i : of_.weighted_) next[p_.weighted[i]] = row[p_.rate[i]];
      double* copy = row + p_.rows;
      for (const Index value : of_.batches_.copied) *copy++ = row[value];
    }
  }

 private:
  using Numbers = typename Pack<Wide>::Numbers;
  using Row = PackRow<Wide>;
  struct Lists {
    const StepBatches::Value* values;
    const StepBatches::Product* products;
  };
  struct Factors {
    PackFactors<Wide> values, products;
  };
  using BatchRules = Rules<false, Lists, Factors>;
  struct StepNumbers {
    Numbers c, p;
  };
  using BatchKnown = KnownOf<Row, PackEnds<Wide>>;

  [[gnu::always_inline]] inline Row row_of(double* row, std::size_t offset) const { return {row, places_, offset}; }
  [[gnu::always_inline]] inline StepNumbers numbers_of(const StepBatch& batch, std::size_t offset) const {
    const double* const from = numbers_ + batch.numbers + offset;
    return {Pack<Wide>::read(from), Pack<Wide>::read(from + batch.room)};
  }
  [[gnu::always_inline]] inline BatchRules rules_of(const StepBatch& batch, std::size_t offset) const {
    const double* const factors = numbers_ + batch.numbers + 2 * batch.room + offset;
    return {lists_, {{factors, batch.room}, {factors + at(batch.values) * batch.room, batch.room}}};
  }
  [[gnu::always_inline]] inline double* gains_of(const StepBatch& batch, std::size_t offset) const {
    return scratch_ + batch.scratch + offset;
  }
  [[gnu::always_inline]] inline PackEnds<Wide> ends_of_batch(const StepBatch& batch, std::size_t offset) const {
    return {gains_of(batch, offset) + 3 * batch.room, batch.room};
  }
  template <class F>
  [[gnu::always_inline]] static inline void for_each_step(const StepBatches::Piece& piece, F&& f) {
    for (std::size_t i = piece.first; i < piece.first + piece.count; ++i) f(i);
  }

  /// Computes the factors of the terms with order k from order 0.
  [[gnu::always_inline]] inline void find_factors(double* row) {
    for (const StepBatches::Piece& piece : of_.batches_.pieces) {
      if (!piece.is_batch) {
        for_each_step(piece, [&](std::size_t i) LEAST_INLINE {
          const Step& s = p_.steps[i];
          of_.gains_[i] = Rules<false>::gain_of(s, s, row);
          for (std::size_t k = at(s.first_product); k < at(s.first_product + s.products); ++k)
            of_.ends_[k] = ends_of(p_.products[k], p_.products[k].factor, row);
        });
        continue;
      }
      const StepBatch& batch = of_.batches_.batches[piece.first];
      for (std::size_t offset = 0; offset < batch.count; offset += Wide) {
        const FactorsOf<Numbers> gain = BatchRules::gain_of(batch, numbers_of(batch, offset), row_of(row, offset));
        double* const to = gains_of(batch, offset);
        Pack<Wide>::write(gain.inverse, to);
        Pack<Wide>::write(gain.a, to + batch.room);
        Pack<Wide>::write(gain.b, to + 2 * batch.room);
        const PackFactors<Wide> factors = rules_of(batch, offset).numbers.products;
        const StepBatches::Product* const products = lists_.products + batch.first_product;
        for (std::size_t i = 0; i < at(batch.products); ++i)
          ends_of_batch(batch, offset).set(i, ends_of(products[i], factors[i].factor, row_of(row, offset)));
      }
    }
  }

  [[gnu::always_inline]] inline void advance(std::size_t k, double* second, double* last, double* row) {
    const double order = static_cast<double>(k), part = inverses[k];
    const Known known{order, part, second, half_, last, older_, sums_, of_.ends_.data()};
    if (k == 1)
      for (const Step& s : p_.linear) one_by_one_.advance(s, s, known, StepFactors{}, row);
    for (const StepBatches::Piece& piece : of_.batches_.pieces) {
      if (!piece.is_batch) {
        for_each_step(piece, [&](std::size_t i) LEAST_INLINE {
          one_by_one_.advance(p_.steps[i], p_.steps[i], known, of_.gains_[i], row);
        });
        continue;
      }
      const StepBatch& batch = of_.batches_.batches[piece.first];
      switch (batch.rule) {
        case Rule::sum:
          advance_batch<Rule::sum>(batch, k, second, last, row);
          break;
        case Rule::quotient:
          advance_batch<Rule::quotient>(batch, k, second, last, row);
          break;
        case Rule::root:
          advance_batch<Rule::root>(batch, k, second, last, row);
          break;
        case Rule::power:
          advance_batch<Rule::power>(batch, k, second, last, row);
          break;
        case Rule::integral:
          advance_batch<Rule::integral>(batch, k, second, last, row);
          break;
        default:
          advance_batch<Rule::log_like>(batch, k, second, last, row);
      }
    }
  }
  /// Computes order k of a batch. The rule is a template argument, so that the switch over rules is decided once per
  /// batch.
  template <Rule rule>
  [[gnu::always_inline]] inline void advance_batch(const StepBatch& batch, std::size_t k, double* second, double* last,
                                                   double* row) const {
    StepBatch like = batch;
    like.rule = rule;
    for (std::size_t offset = 0; offset < like.count; offset += Wide) {
      const BatchKnown known{static_cast<double>(k), inverses[k],
                             row_of(second, offset), row_of(half_, offset),
                             row_of(last, offset),   row_of(older_, offset),
                             row_of(sums_, offset),  ends_of_batch(like, offset)};
      const double* const gains = gains_of(like, offset);
      const FactorsOf<Numbers> gain{Pack<Wide>::read(gains), Pack<Wide>::read(gains + like.room),
                                    Pack<Wide>::read(gains + 2 * like.room)};
      rules_of(like, offset).advance(like, numbers_of(like, offset), known, gain, row_of(row, offset));
    }
  }

  /// Computes Σ aⱼ b_{k−j} over 0 < j < k of all lanes of products of two, or of squares. Terms go from the middle
  /// outwards, so that those known last come last. One loop sums several registers, because a single sum would wait for
  /// itself.
  template <bool squares>
  [[gnu::always_inline]] inline void sum_lanes(const Workspace& in, std::size_t k) {
    constexpr std::size_t parts = StepBatches::width / Wide;
    const std::size_t mixed = of_.batches_.mixed_lanes, all = of_.batches_.lanes.size();
    std::size_t r = parts * (squares ? mixed : 0);
    const std::size_t end = parts * (squares ? all : mixed);
    for (; r + 4 <= end; r += 4) sum_registers<squares, 4>(in, k, r);
    if (r + 2 <= end) sum_registers<squares, 2>(in, k, r), r += 2;
    if (r < end) sum_registers<squares, 1>(in, k, r);
  }
  template <bool squares, std::size_t Count>
  [[gnu::always_inline]] inline void sum_registers(const Workspace& in, std::size_t k, std::size_t first) {
    constexpr std::size_t parts = StepBatches::width / Wide;
    std::array<std::size_t, Count> a, b;
    Numbers forth[Count], back[Count];  // NOLINT: vectors
#pragma GCC unroll 4
    for (std::size_t n = 0; n < Count; ++n) {
      const StepBatches::Lanes& lanes = of_.batches_.lanes[(first + n) / parts];
      a[n] = at(lanes.a) + (first + n) % parts * Wide;
      b[n] = at(lanes.b) + (first + n) % parts * Wide;
      forth[n] = back[n] = Numbers{};
    }
    const auto add = [&](const double* low, const double* high, double share) LEAST_INLINE {
#pragma GCC unroll 4
      for (std::size_t n = 0; n < Count; ++n) {
        forth[n] += share * (Pack<Wide>::read(low + a[n]) * Pack<Wide>::read(high + b[n]));
        if constexpr (!squares) back[n] += share * (Pack<Wide>::read(low + b[n]) * Pack<Wide>::read(high + a[n]));
      }
    };
    const auto write = [&](double* to) LEAST_INLINE {
#pragma GCC unroll 4
      for (std::size_t n = 0; n < Count; ++n)
        Pack<Wide>::write(squares ? forth[n] : Numbers(forth[n] + back[n]), to + (first + n) * Wide);
    };
    if (k >= 4) {
      const double *low = in.rows + k / 2 * in.stride, *high = in.rows + (k - k / 2) * in.stride;
      if (k % 2 == 0) {
        add(low, high, 0.5);
        low -= in.stride;
        high += in.stride;
      }
      for (const double* const end = in.rows + in.stride; low != end; low -= in.stride, high += in.stride)
        add(low, high, 1);
    }
    write(older_);
    if (k > 1) add(half_, in.rows + (k - 1) * in.stride, 1);
    write(sums_);
  }

  SeriesReading& of_;
  const Program& p_;
  Rules<false> one_by_one_;
  // Copies of pointers: the compiler would reload the originals after every write to a row, which it takes to alias
  // them.
  Lists lists_;
  const Index* places_;
  const double* numbers_;
  double *half_, *older_, *sums_, *scratch_;
};

}  // namespace least::tape
