// LongSums finds sums of many terms in the steps of a formula, each of which can be added up as one step.
#pragma once

#include <span>
#include <vector>

#include "core/tape/operation.hpp"

namespace least::tape {

/// Calls f with each step that this one reads.
template <class F>
void for_each_operand(const Operation& step, F&& f) {
  if (step.code == Code::variable) return;  // its a is no step
  for (const Index part : {step.a, step.b, step.c})
    if (part != none) f(part);
}

/// A long sum is a chain of many additions and subtractions, each of which but the last is read by the next one alone.
class LongSums {
 public:
  /// The value of a sum is the step `head` plus the steps `terms`, in this order, times their signs, 1 or −1.
  struct Sum {
    Index head = none;
    std::vector<Index> terms;
    std::vector<double> signs;
  };

  /// Finds the long sums of steps; the values of the steps `ends` are the outputs.
  LongSums(std::span<const Operation> steps, std::span<const Index> ends);

  /// The sum whose value is that of the step; null where the step is no long sum.
  const Sum* at(Index step) const {
    const Index sum = sum_of_[static_cast<std::size_t>(step)];
    return sum == none ? nullptr : &sums_[static_cast<std::size_t>(sum)];
  }
  /// Whether the step is an intermediate sum of a long sum, whose value nothing else reads.
  bool absorbs(Index step) const { return absorbed_[static_cast<std::size_t>(step)]; }

 private:
  std::vector<Sum> sums_;
  std::vector<Index> sum_of_;   ///< of each step
  std::vector<bool> absorbed_;  ///< of each step
};

}  // namespace least::tape
