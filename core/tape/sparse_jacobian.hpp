// Jacobians of formulas of many variables, of which each output reads few: the entries that are not zero whatever the
// state are found on the tape, and columns that share no row are differentiated at once by one dual number. Of a chain
// that takes three directions, however long it is. Source: Curtis, Powell, Reid, IMA J. Appl. Math. 13, 117 (1974).
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "core/number/asked_by_thread.hpp"
#include "core/number/dual.hpp"
#include "core/number/sparse_system.hpp"
#include "core/tape/formula.hpp"

namespace least::tape {

class SparseJacobian {
 public:
  /// Of outputs on a tape by its first variables, so many.
  SparseJacobian(const Tape& tape, std::span<const Index> outputs, std::size_t variables);

  const SparsityPattern& pattern() const { return pattern_; }
  /// Of its entries, in memory.
  std::size_t bytes() const;
  /// What one costs, in evaluations.
  std::size_t directions() const { return columns_.size(); }

  /// Calls take(row, column, ∂out_row/∂x_column) for every entry of the pattern; `formula` is that of the outputs.
  /// Where it is not to go on (AskedByThread) it leaves the rest out.
  template <class Take>
  void evaluate(const Formula& formula, const double* x, double t, Take&& take) const {
    thread_local std::vector<Directions> along, moved;
    along.resize(variables_);
    moved.resize(pattern_.size());
    for (std::size_t first = 0; first < columns_.size(); first += at_once) {
      if (first > 0 && !AskedByThread::goes_on()) return;
      const std::size_t count = std::min(at_once, columns_.size() - first);
      for (std::size_t j = 0; j < variables_; ++j) along[j] = Directions(x[j]);
      for (std::size_t k = 0; k < count; ++k)
        for (const std::uint32_t j : columns_[first + k].variables) along[j].slope[k] = 1;
      differentiate(formula, along.data(), t, moved.data());
      for (std::size_t k = 0; k < count; ++k)
        for (const auto& [row, column] : columns_[first + k].entries) take(row, column, moved[row].slope[k]);
    }
  }

 private:
  static constexpr std::size_t at_once = 4;
  using Directions = Dual<double, int(at_once)>;
  /// Variables that no output reads two of.
  struct Columns {
    std::vector<std::uint32_t> variables;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> entries;
  };
  static void differentiate(const Formula& formula, const Directions* x, double t, Directions* out);

  std::size_t variables_;
  SparsityPattern pattern_;
  std::vector<Columns> columns_;
};

}  // namespace least::tape
