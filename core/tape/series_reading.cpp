#include "core/tape/series_reading.hpp"

#include "core/tape/batch_passes.hpp"
#include "core/tape/wide.hpp"

namespace least::tape {

SeriesReading::SeriesReading(Program& program, std::size_t widest) : batches_(program), widest_(widest) {
  // Rows that are an odd number of lines apart spread over all sets of a cache.
  constexpr std::size_t line = StepBatches::width;
  const std::size_t lines = (at(program.rows) + batches_.copied.size()) / line + 2;
  stride_ = (lines + 1 - lines % 2) * line;
  for (std::size_t i = 0; i < program.variables; ++i) {
    const Index variable = Program::first_variable + static_cast<Index>(i), rate = program.rate[i];
    if (rates_.empty() || rates_.back().rate + static_cast<Index>(rates_.back().count) != rate)
      rates_.push_back({variable, rate, 0});
    ++rates_.back().count;
    if (program.weighted[i] != Program::waste) weighted_.push_back(i);
  }
  gains_.resize(program.steps.size());
  ends_.resize(program.products.size());
  half_.resize(stride_);
  older_.resize(program.lane_a.size() + line);  // a batch may begin anywhere and reads whole registers
  sums_.resize(older_.size());
  scratch_.resize(batches_.scratch);
}

std::size_t SeriesReading::bytes() const {
  return sizeof(double) * (batches_.numbers.size() + half_.size() + older_.size() + sums_.size() + scratch_.size()) +
         sizeof(StepFactors) * gains_.size() + sizeof(ProductEnds) * ends_.size() +
         sizeof(Index) * (batches_.places.size() + batches_.copied.size()) +
         sizeof(StepBatch) * batches_.batches.size() + sizeof(StepBatches::Product) * batches_.products.size();
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
  if (widest_ >= 8 && LEAST_HAS_BY_EIGHT) return begin_by_eight(program, row, bounded);
  if (widest_ >= 4 && LEAST_HAS_BY_FOUR) return begin_by_four(program, row, bounded);
  begin_by_two(program, row, bounded);
}

void SeriesReading::expand(const Program& program, const Workspace& of) {
  if (widest_ >= 8 && LEAST_HAS_BY_EIGHT) return expand_by_eight(program, of);
  if (widest_ >= 4 && LEAST_HAS_BY_FOUR) return expand_by_four(program, of);
  expand_by_two(program, of);
}

}  // namespace least::tape
