// PreparedTerms makes the formula of terms cheaper before it is evaluated for many terms. What follows from the
// constant arguments of a term alone is computed once and becomes one constant argument; constant factors are
// collected, and signs of results are left to the additions.
#pragma once

#include <span>
#include <vector>

#include "core/tape/symbol.hpp"

namespace least::tape {

class PreparedTerms {
 public:
  /// A result of the terms: the value of a node of the formula, or its opposite.
  struct Result {
    Index place = none;
    bool negated = false;
  };

  /// Prepares terms that the tape keeps.
  PreparedTerms(const Tape& tape, const Terms& terms);

  /// The formula of one term, on a tape of its own.
  const Tape& formula() const { return formula_; }
  const std::vector<Result>& results() const { return results_; }
  /// numbers()[argument][term] is the value of an argument that is a constant in every term; the list of any other
  /// argument is empty. Arguments beyond those of the terms are constants that were computed here.
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
