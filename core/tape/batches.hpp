// The steps of a large formula in batches: of one operation each, on values that stand one after the other. A batch
// waits for nothing of itself, so that its loop runs on the wide registers of the machine. Every value is computed by
// the same operation from the same operands as one after the other: to the last bit the same.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/tape/operation.hpp"

namespace least::tape {

class Batches {
 public:
  /// Of steps whose values at `ends` are asked for; nothing where there are too few alike for it to be faster.
  static std::shared_ptr<const Batches> of(std::span<const Operation> steps, std::span<const Index> ends);

  /// out[i] is the value of ends[i] at the variables x and the time t.
  void evaluate(const double* x, double t, double* out) const noexcept;

 private:
  using Place = std::uint32_t;
  /// Where a batch reads the values of one of its operands.
  struct Operand {
    bool scattered = false;  ///< at places_[at], places_[at + 1] …, else one after the other from `at`
    std::uint32_t at = 0;
  };
  struct Batch {
    Code code;
    std::uint32_t count;
    Place out = 0;
    Operand a{}, b{}, c{};
    std::uint32_t value = 0;  ///< the first of its numbers in values_, where the operation has one
  };
  class Scheduler;

  std::vector<Batch> batches_;
  std::vector<Place> places_, ends_;
  std::vector<double> values_;
  std::size_t room_ = 0;  ///< values that stand at once
};

}  // namespace least::tape
