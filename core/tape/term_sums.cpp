#include "core/tape/term_sums.hpp"

#include <algorithm>
#include <array>

#include "core/tape/terms.hpp"
#include "core/tape/tile.hpp"
#include "core/tape/wide.hpp"

namespace least::tape {

[[gnu::always_inline]] inline void TermSums::gather(std::size_t k, const Tile& some, std::size_t begin,
                                                    std::size_t count, const double* from, double* to) const noexcept {
  if (!in_segments_) {
    const std::uint32_t* const places = places_.data() + columns_[k].first + begin;
    for (std::size_t i = 0; i < count; ++i) to[i] = from[places[i]];
    return;
  }
  for (std::uint32_t s = some.first_segment; s < some.first_segment + some.segments; to += lengths_[s++]) {
    const Reach& reach = reach_[s * reaches() + k];
    const std::size_t length = lengths_[s];
    const double* const values = from + reach.from;
    if (reach.moves) {
      for (std::size_t i = 0; i < length; ++i) to[i] = values[i];
    } else {
      for (std::size_t i = 0; i < length; ++i) to[i] = *values;
    }
  }
}

[[gnu::always_inline]] inline void TermSums::subtract(const Step& step, const Tile& some, const double* x,
                                                      const double* r, double* out) const noexcept {
  const double* const from_a = columns_[step.a].source == Source::variable ? x : r;
  const double* const from_b = columns_[step.b].source == Source::variable ? x : r;
  for (std::uint32_t s = some.first_segment; s < some.first_segment + some.segments; out += lengths_[s++]) {
    const Reach *const reach = &reach_[s * reaches()], &a = reach[step.a], &b = reach[step.b];
    const std::size_t length = lengths_[s];
    const double *const p = from_a + a.from, *const q = from_b + b.from;
    double* __restrict const to = out;
    if (a.moves && b.moves) {
      for (std::size_t i = 0; i < length; ++i) to[i] = p[i] - q[i];
    } else if (a.moves) {
      for (std::size_t i = 0; i < length; ++i) to[i] = p[i] - *q;
    } else {
      for (std::size_t i = 0; i < length; ++i) to[i] = *p - q[b.moves ? i : 0];
    }
  }
}

/// Adds all results of a segment before those of the next one, so that the store of a sum is complete before the sum is
/// read again.
[[gnu::always_inline]] inline void TermSums::add_segments(const Tile& some, const double* const* operand,
                                                          double* sums) const noexcept {
  std::size_t begin = 0;
  for (std::uint32_t s = some.first_segment; s < some.first_segment + some.segments; begin += lengths_[s++]) {
    const Reach* const reach = &reach_[s * reaches() + columns_.size()];
    const std::size_t length = lengths_[s];
    for (std::size_t k = 0; k < results_.size(); ++k) {
      if (reach[k].from == dropped) continue;
      const double sign = results_[k].negated ? -1 : 1;
      const double* const values = operand[results_[k].operand] + begin;
      double* __restrict const into = sums + reach[k].from;
      if (reach[k].moves) {
        for (std::size_t i = 0; i < length; ++i) into[i] += sign * values[i];
        continue;
      }
      std::array<double, parts> sum{};
      std::size_t i = 0;
      for (; i + parts <= length; i += parts)
        for (std::size_t part = 0; part < parts; ++part) sum[part] += values[i + part];
      for (std::size_t part = 0; i < length; ++i, ++part) sum[part] += values[i];
      *into += sign * (((sum[0] + sum[4]) + (sum[2] + sum[6])) + ((sum[1] + sum[5]) + (sum[3] + sum[7])));
    }
  }
}

[[gnu::always_inline]] inline void TermSums::add_each(std::size_t begin, std::size_t count,
                                                      const double* const* operand, double* sums) const noexcept {
  for (const Result& result : results_) {
    const double sign = result.negated ? -1 : 1;
    const double* const values = operand[result.operand];
    const std::uint32_t* const places = places_.data() + result.first + begin;
    for (std::size_t i = 0; i < count; ++i)
      if (places[i] != dropped) sums[places[i]] += sign * values[i];
  }
}

LEAST_WIDEST void TermSums::evaluate(const double* x, const double* r, double* sums) const noexcept {
  thread_local std::vector<double> room;
  thread_local std::vector<const double*> operand;
  if (room.size() < operands_ * tile) room.resize(operands_ * tile);
  if (operand.size() < operands_) operand.resize(operands_);
  double* const tiles = room.data();
  std::fill_n(sums, count_of_sums_, 0.0);
  std::size_t begin = 0;
  for (const Tile& some : tiles_) {
    const std::size_t count = std::min(tile, count_ - begin);
    std::size_t all = count;
    if (in_segments_) {
      all = 0;
      for (std::uint32_t s = 0; s < some.segments; ++s) all += lengths_[some.first_segment + s];
    }
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      const Column& column = columns_[k];
      operand[k] = column.source == Source::number ? numbers_.data() + column.first + begin : tiles + k * tile;
      if (column.gathered) gather(k, some, begin, all, column.source == Source::variable ? x : r, tiles + k * tile);
    }
    for (const Step& step : steps_) {
      double* const out = tiles + step.out * tile;
      const double *const a = operand[step.a], *const b = operand[step.b], *const c = operand[step.c];
      operand[step.out] = out;
      const double value = step.value;
      if (step.difference) {
        subtract(step, some, x, r, out);
      } else if (step.fused == Fused::two_squares) {
        for_each_value([=](double p, double q) { return p * p + q * q + value; }, all, out, a, b);
      } else if (step.fused == Fused::three_squares) {
        for_each_value([=](double p, double q, double s) { return p * p + q * q + s * s + value; }, all, out, a, b, c);
      } else if (step.fused == Fused::over_three_halves) {
        for_each_value([=](double p) { return value / (p * least::sqrt(p)); }, all, out, a);
      } else {
        compute_tile(step.code, all, out, a, b, c, 0.0, SameForAll{value});
      }
    }
    if (in_segments_)
      add_segments(some, operand.data(), sums);
    else
      add_each(begin, all, operand.data(), sums);
    begin += all;
  }
}

}  // namespace least::tape
