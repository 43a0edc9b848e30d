// The formula of terms made cheaper before it is evaluated for many: what follows from the numbers of a term alone is
// one number, an argument like others; factors that are numbers are collected, and signs go with what is added.
#pragma once

#include <span>
#include <vector>

#include "core/tape/symbol.hpp"

namespace least::tape {

class PreparedTerms {
 public:
  /// What the terms add: the value at a place of the formula, or its opposite.
  struct Result {
    Index place = none;
    bool negated = false;
  };

  /// Of terms on the tape.
  PreparedTerms(const Tape& tape, const Terms& terms);

  /// Of one term, on a tape of its own.
  const Tape& formula() const { return formula_; }
  const std::vector<Result>& results() const { return results_; }
  /// Of each argument of the formula what it is of every term, where that is a number; else nothing. Those beyond the
  /// arguments of the terms are numbers.
  const std::vector<std::vector<double>>& numbers() const { return numbers_; }

 private:
  void precompute(const Tape& from);
  void compute(const Tape& from, const std::vector<Index>& places);

  Tape formula_;
  std::vector<Result> results_;
  std::vector<std::vector<double>> numbers_;
  std::size_t count_;
};

}  // namespace least::tape
