// Jacobians of formulas of many variables, of which each output reads few: the entries that are not zero whatever the
// state are found on the tape, and columns that share no row are differentiated at once by one dual number. Of a chain
// that takes three directions, however long it is. Of few variables and short formulas the entries are written as
// formulas of their own, which cost less than dual numbers and share what they have in common with the outputs. Source:
// Curtis, Powell, Reid, IMA J. Appl. Math. 13, 117 (1974).
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
  /// Of a Hessian, whose outputs are the derivatives of one function, each entry off the diagonal is known twice.
  enum class Kind : std::uint8_t { general, hessian };
  /// Variables up to which entries may be written as formulas.
  static constexpr std::size_t few = 8;

  /// Of outputs on a tape by its first variables, so many.
  SparseJacobian(const Tape& tape, std::span<const Index> outputs, std::size_t variables, Kind kind = Kind::general);

  const SparsityPattern& pattern() const { return pattern_; }
  /// Of its entries, in memory.
  std::size_t bytes() const;
  /// Whether its entries are formulas.
  bool is_written_out() const { return !written_.empty(); }
  /// What one costs, in evaluations; with the values of the outputs, one at least.
  std::size_t evaluations() const { return is_written_out() ? 1 : columns_.size(); }

  /// Calls take(row, column, ∂out_row/∂x_column) for every entry of the pattern; `formula` is that of the outputs,
  /// whose values are left in `values` unless that is null. Where it is not to go on (AskedByThread), which it asks of
  /// many variables only, it leaves the rest out.
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
  /// Variables that no output reads two of.
  struct Columns {
    std::vector<std::uint32_t> variables;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> entries;
  };
  /// An entry, and which one of the formulas it is.
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
