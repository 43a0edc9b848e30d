#include <algorithm>
#include <utility>
#include <vector>

#include "core/tape/formula.hpp"
#include "core/tape/tile.hpp"
#include "core/tape/wide.hpp"

namespace least::tape {

/// Each step is taken for a tile of rows before the next one. Its result goes into a spare tile, which then becomes
/// that of its register, because the register may also be an operand.
LEAST_WIDE void Formula::evaluate_rows(const double* rows, std::size_t width, std::size_t count, double* out) const {
  constexpr std::size_t tile = 32;
  const std::size_t values = outputs_.size();
  if (batches_ || !sums_.empty() || count == 1) {
    for (std::size_t i = 0; i < count; ++i, rows += width, out += values) evaluate(rows + 1, rows[0], out);
    return;
  }
  thread_local std::vector<double> room;
  thread_local std::vector<double*> places;
  if (room.size() < (registers_ + 1) * tile) room.resize((registers_ + 1) * tile);
  if (places.size() < registers_) places.resize(registers_);
  double *const first = room.data(), **const place = places.data(), *spare = first + registers_ * tile;
  for (std::size_t i = 0; i < registers_; ++i) place[i] = first + i * tile;
  for (std::size_t begin = 0; begin < count; begin += tile) {
    const std::size_t some = std::min(tile, count - begin);
    const double* const from = rows + begin * width;
    for (const Narrow& step : steps_) {
      if (step.code == Code::variable || step.code == Code::time) {
        const double* number = step.code == Code::time ? from : from + 1 + step.a;
        for (std::size_t k = 0; k < some; ++k, number += width) spare[k] = *number;
      } else {
        compute_tile(step.code, some, spare, place[step.a], place[step.b], place[step.c], 0.0, SameForAll{step.value});
      }
      std::swap(place[step.out], spare);
    }
    for (std::size_t i = 0; i < values; ++i) {
      const double* const value = place[outputs_[i]];
      for (std::size_t k = 0; k < some; ++k) out[(begin + k) * values + i] = value[k];
    }
  }
}

}  // namespace least::tape
