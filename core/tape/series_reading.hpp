// How a program is read: order by order, batches of like steps (core/tape/step_batches.hpp) by as many at a time as a
// register holds, the others one by one.
#pragma once

#include "core/tape/series_rules.hpp"
#include "core/tape/step_batches.hpp"

namespace least::tape {

class SeriesReading {
 public:
  /// Of the program, which it puts in order. Registers hold `widest` numbers at most: results do not depend on it.
  explicit SeriesReading(Program& program, std::size_t widest = StepBatches::width);

  /// How many numbers a row takes, with what lies between the values.
  std::size_t stride() const { return stride_; }
  /// In memory, about, beside the rows.
  std::size_t bytes() const;
  /// Order 0 of all values, from the variables and the time that stand there. `bounded`: as in Series::expand.
  void begin(const Program& program, double* row, bool bounded);
  /// All orders of all values, from order 0.
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

  /// Variables whose rates stand one after the other, as they do.
  struct Rates {
    Index variable, rate;
    std::size_t count;
  };

  StepBatches batches_;
  std::size_t widest_;
  std::vector<Rates> rates_;
  std::vector<std::size_t> weighted_;  ///< variables of which k times the coefficients are read
  std::size_t stride_;
  std::vector<StepFactors> gains_;    ///< by step of the program
  std::vector<ProductEnds> ends_;     ///< by product
  std::vector<double> half_;          ///< by value
  std::vector<double> older_, sums_;  ///< by lane, without the terms of the last order and with them
  std::vector<double> scratch_;       ///< of batches
};

}  // namespace least::tape
