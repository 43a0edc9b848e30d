#include "core/tape/batches.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "core/tape/tile.hpp"
#include "core/tape/wide.hpp"

namespace least::tape {

namespace {

constexpr std::size_t at_once = 4;  // values of a run that are copied at a time

}  // namespace

/// A run is copied `at_once` values at a time: the few that are written behind its end are overwritten by the next run.
__attribute__((always_inline)) inline void Batches::copy(const Run& run, const double* from, double* to) {
  if (run.moves) {
    for (std::size_t k = 0; k < run.length; k += at_once) std::copy_n(from + k, at_once, to + k);
  } else {
    for (std::size_t k = 0; k < run.length; k += at_once) std::fill_n(to + k, at_once, *from);
  }
}

LEAST_WIDE void Batches::add_up(const Sums& sums, double* r) const noexcept {
  std::array<double, abreast> total;  // NOLINT: written before it is read
  const Place* places = &places_[sums.at];
  const double* signs = signs_.data() + sums.sign;
  for (std::size_t o = 0; o < abreast; ++o) total[o] = r[places[o]];
  places += abreast;
  for (const Span& span : std::span(spans_).subspan(sums.first_span, sums.spans)) {
    if (span.in_order) {
      for (std::uint32_t k = 0; k < span.terms; ++k, signs += abreast) {
        const double* const terms = r + *places++;
        for (std::size_t o = 0; o < abreast; ++o) total[o] = total[o] + signs[o] * terms[o];
      }
    } else {
      for (std::uint32_t k = 0; k < span.terms; ++k, signs += abreast, places += abreast)
        for (std::size_t o = 0; o < abreast; ++o) total[o] = total[o] + signs[o] * r[places[o]];
    }
  }
  std::copy_n(total.data(), abreast, r + sums.out);
}

LEAST_WIDE void Batches::evaluate(const double* x, double t, double* out) const noexcept {
  thread_local std::vector<double> values;
  const std::size_t needed = room_ + tile * tiles_ + at_once;
  if (values.size() < needed) values.resize(needed);
  double *const r = values.data(), *const tiles = r + room_;
  r[zero] = 0;
  std::array<double, tile + at_once> first, second, third;  // NOLINT: written before they are read
  const auto compute = [&](const Batch& batch, std::size_t begin, std::size_t count) __attribute__((always_inline)) {
    const double* const from = batch.code == Code::variable ? x : r;
    const auto operand = [&](const Operand& which, std::array<double, tile + at_once>& gathered) {
      if (which.kind == Operand::Kind::in_order) return from + which.at + begin;
      if (which.kind == Operand::Kind::in_tile) return static_cast<const double*>(tiles + tile * which.at);
      if (which.kind == Operand::Kind::in_runs) {
        const Run* run = &runs_[places_[which.at + begin / tile]];
        for (std::size_t k = 0; k < count; k += run->length, ++run) copy(*run, from + run->from, gathered.data() + k);
        return static_cast<const double*>(gathered.data());
      }
      const Place* const places = &places_[which.at + begin];
      for (std::size_t k = 0; k < count; ++k) gathered[k] = from[places[k]];
      return static_cast<const double*>(gathered.data());
    };
    double* const o = batch.out.kind == Operand::Kind::in_tile ? tiles + tile * batch.out.at : r + batch.out.at + begin;
    const double* const a = operand(batch.a, first);
    const double* const v = values_.data() + batch.value + begin;
    compute_tile(batch.code, count, o, a, operand(batch.b, second), operand(batch.c, third), t, v);
  };
  for (const Stage& stage : stages_) {
    if (stage.sums)
      for (std::uint32_t i = 0; i < stage.number; ++i) add_up(sums_[stage.first + i], r);
    for (std::size_t begin = 0; begin < stage.count; begin += tile)
      for (std::uint32_t i = 0; i < stage.number; ++i)
        compute(batches_[stage.first + i], begin, std::min<std::size_t>(tile, stage.count - begin));
  }
  for (std::size_t i = 0; i < ends_.size(); ++i) out[i] = r[ends_[i]];
}

}  // namespace least::tape
