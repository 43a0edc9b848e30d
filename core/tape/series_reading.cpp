#include "core/tape/series_reading.hpp"

#include "core/tape/batch_passes.hpp"
#include "core/tape/wide.hpp"

namespace least::tape {

SeriesReading::SeriesReading(Program& program) : batches_(program) {
  constexpr std::size_t line =
      StepBatches::most;  // rows that lie an odd number of lines apart share few places of a cache
  const std::size_t lines = (at(program.rows) + batches_.copied.size()) / line + 2;
  stride_ = (lines + 1 - lines % 2) * line;
  gains_.resize(program.steps.size());
  ends_.resize(program.products.size());
  half_.resize(stride_);
  older_.resize(program.lane_a.size());
  sums_.resize(program.lane_a.size());
  scratch_.resize(batches_.scratch);
}

void SeriesReading::begin_by_two(const Program& program, double* row, bool bounded) {
  Pass<2>(*this, program).begin(row, bounded);
}
LEAST_BY_FOUR void SeriesReading::begin_by_four(const Program& program, double* row, bool bounded) {
  Pass<4>(*this, program).begin(row, bounded);
}
LEAST_BY_EIGHT void SeriesReading::begin_by_eight(const Program& program, double* row, bool bounded) {
  Pass<8>(*this, program).begin(row, bounded);
}
void SeriesReading::expand_by_two(const Program& program, const Workspace& of) { Pass<2>(*this, program).expand(of); }
LEAST_BY_FOUR void SeriesReading::expand_by_four(const Program& program, const Workspace& of) {
  Pass<4>(*this, program).expand(of);
}
LEAST_BY_EIGHT void SeriesReading::expand_by_eight(const Program& program, const Workspace& of) {
  Pass<8>(*this, program).expand(of);
}

void SeriesReading::begin(const Program& program, double* row, bool bounded) {
  if (LEAST_HAS_BY_EIGHT) return begin_by_eight(program, row, bounded);
  if (LEAST_HAS_BY_FOUR) return begin_by_four(program, row, bounded);
  begin_by_two(program, row, bounded);
}

void SeriesReading::expand(const Program& program, const Workspace& of) {
  if (LEAST_HAS_BY_EIGHT) return expand_by_eight(program, of);
  if (LEAST_HAS_BY_FOUR) return expand_by_four(program, of);
  expand_by_two(program, of);
}

}  // namespace least::tape
