// SeriesReading interprets a program order by order: batches of like steps (core/tape/step_batches.hpp) run as many
// steps at a time as a register holds numbers, the other steps one by one.
#pragma once

#include "core/tape/series_rules.hpp"
#include "core/tape/step_batches.hpp"

namespace least::tape {

class SeriesReading {
 public:
  /// Prepares the program, whose steps and values it reorders. `widest` is the most numbers that a register may hold;
  /// results do not depend on it.
  explicit SeriesReading(Program& program, std::size_t widest = StepBatches::width);

  /// The numbers of a row of values, padding included.
  std::size_t stride() const { return stride_; }
  /// Approximate memory, without the rows.
  std::size_t bytes() const;
  /// Computes order 0 of all values from the variables and the time in `row`. `bounded`: as in Series::expand.
  void begin(const Program& program, double* row, bool bounded);
  /// Computes all orders of all values from order 0.
  void expand(const Program& program, const Workspace& of);

 private:
  template <std::size_t Wide>
  class Pass;
  void begin_by_two(const Program& program, double* row, bool bounded);
  void begin_by_four(const Program& program, double* row, bool bounded);
  void begin_by_eight(const Program& program, double* row, bool bounded);
  void expand_by_two(const Program& program, const Workspace& of);
  void expand_by_four(const Program& program, const Workspace& of);
  void expand_by_eight(const Program& program, const Workspace& of);

  /// Consecutive variables whose rates are consecutive values.
  struct Rates {
    Index variable, rate;
    std::size_t count;
  };

  StepBatches batches_;
  std::size_t widest_;
  std::vector<Rates> rates_;
  std::vector<std::size_t> weighted_;  ///< variables for which k times the coefficients are needed
  std::size_t stride_;
  std::vector<StepFactors> gains_;    ///< by step of the program
  std::vector<ProductEnds> ends_;     ///< by product
  std::vector<double> half_;          ///< by value
  std::vector<double> older_, sums_;  ///< by lane: as in KnownOf
  std::vector<double> scratch_;       ///< room for batches
};

}  // namespace least::tape
