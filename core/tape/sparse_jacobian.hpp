// SparseJacobian computes Jacobians of formulas of many variables, of which each output reads few. It finds the entries
// that are not identically zero on the tape, and differentiates columns that share no row at once along one direction
// of dual numbers: a chain takes three directions, however long it is. With few variables and short formulas, the
// entries are formulas of their own, which are cheaper than dual numbers and share subexpressions with the outputs.
// Source: Curtis, Powell, Reid, IMA J. Appl. Math. 13, 117 (1974).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/number/asked_by_thread.hpp"
#include "core/number/dual.hpp"
#include "core/number/sparse_system.hpp"
#include "core/tape/formula.hpp"

namespace least::tape {

class SparseJacobian {
 public:
  /// The outputs of a Hessian are the derivatives of one function, so entries off the diagonal are equal in pairs.
  enum class Kind : std::uint8_t { general, hessian };
  /// The most variables and outputs for which entries may be formulas.
  static constexpr std::size_t few = 8;

  /// Prepares ∂outputs/∂x for nodes of the tape and its first `variables` variables.
  SparseJacobian(const Tape& tape, std::span<const Index> outputs, std::size_t variables, Kind kind = Kind::general);

  const SparsityPattern& pattern() const { return pattern_; }
  /// Approximate memory in bytes.
  std::size_t bytes() const;
  /// Whether its entries are formulas.
  bool is_written_out() const { return !written_.empty(); }
  /// The cost of a Jacobian in evaluations: one for each direction, or 1 if the entries are formulas.
  std::size_t evaluations() const { return is_written_out() ? 1 : columns_.size(); }

  /// Calls take(row, column, ∂out_row/∂x_column) for every entry of the pattern. `formula` evaluates the outputs, whose
  /// values are written to `values` unless it is null. With many variables, it stops and leaves out the rest of the
  /// entries when AskedByThread::goes_on() says so.
  template <class Take>
  void evaluate(const Formula& formula, const double* x, double t, Take&& take, double* values = nullptr) const {
    if (is_written_out()) {
      std::array<double, few * few + few> all;  // NOLINT: written before it is read
      (values ? with_outputs_ : entries_).evaluate(x, t, all.data());
      for (const Written& entry : written_) take(entry.row, entry.column, all[entry.place]);
      if (values) std::copy_n(all.begin() + std::ptrdiff_t(entries_.outputs()), pattern_.size(), values);
      return;
    }
    if (values && columns_.empty()) return formula.evaluate(x, t, values);
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
      if (values && first == 0)
        for (std::size_t i = 0; i < pattern_.size(); ++i) values[i] = moved[i].value;
      for (std::size_t k = 0; k < count; ++k)
        for (const auto& [row, column] : columns_[first + k].entries) take(row, column, moved[row].slope[k]);
    }
  }

 private:
  static constexpr std::size_t at_once = 4;
  using Directions = Dual<double, int(at_once)>;
  /// Columns that share no row: variables no two of which are read by the same output.
  struct Columns {
    std::vector<std::uint32_t> variables;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> entries;
  };
  /// An entry and the number of its formula.
  struct Written {
    std::uint32_t row, column, place;
  };
  static void differentiate(const Formula& formula, const Directions* x, double t, Directions* out);
  void write_out(Tape tape, std::span<const Index> outputs, Kind kind);

  std::size_t variables_;
  SparsityPattern pattern_;
  std::vector<Columns> columns_;
  std::vector<Written> written_;  ///< empty where dual numbers are the cheaper way
  Formula entries_, with_outputs_;
};

}  // namespace least::tape
