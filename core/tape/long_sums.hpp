// Sums of many terms in the steps of a formula, which are added up as one step each.
#pragma once

#include <span>
#include <vector>

#include "core/tape/operation.hpp"

namespace least::tape {

/// Calls f with each step that this one reads.
template <class F>
void for_each_operand(const Operation& step, F&& f) {
  if (step.code == Code::variable) return;  // whose a is no step
  for (const Index part : {step.a, step.b, step.c})
    if (part != none) f(part);
}

/// Sums and differences of which each but the last is read by the next alone, as one sum where there are many.
class LongSums {
 public:
  /// The terms are added to the head in this order, times their signs, 1 or −1.
  struct Sum {
    Index head = none;
    std::vector<Index> terms;
    std::vector<double> signs;
  };

  /// Of steps whose values at `ends` are asked for.
  LongSums(std::span<const Operation> steps, std::span<const Index> ends);

  /// The sum whose value is that of the step; null where the step is no long sum.
  const Sum* at(Index step) const {
    const Index sum = sum_of_[static_cast<std::size_t>(step)];
    return sum == none ? nullptr : &sums_[static_cast<std::size_t>(sum)];
  }
  /// Whether the step is one of the sums within a long sum.
  bool absorbs(Index step) const { return absorbed_[static_cast<std::size_t>(step)]; }

 private:
  std::vector<Sum> sums_;
  std::vector<Index> sum_of_;   ///< of each step
  std::vector<bool> absorbed_;  ///< of each step
};

}  // namespace least::tape
