// TermSums evaluates the sums of terms of one form (Terms). In double each operation runs over a tile of many terms at
// a time. Terms are sorted so that the values they read, and the sums they are added to, are mostly contiguous: the
// terms of a double sum over i < j go by j − i. Bits do not depend on the instruction set: many terms of one sum are
// added in eight partial sums on every machine.
#pragma once

#include <algorithm>
#include <functional>

#include "core/tape/formula.hpp"
#include "core/tape/fused_steps.hpp"

namespace least::tape {

class PreparedTerms;

class TermSums {
 public:
  /// `registered(node)` is the register of the calling formula that holds an operand that is neither a constant nor a
  /// variable.
  TermSums(const Tape& tape, const Terms& terms, const std::function<std::uint32_t(Index)>& registered);

  /// Writes all sums at the variables x to `sums`; r are the registers of the calling formula.
  template <class T>
  void evaluate(const T* x, const T* r, T* sums) const {
    thread_local std::vector<T> arguments, values, registers;
    arguments.resize(columns_.size());
    values.resize(results_.size());
    if (registers.size() < formula_.registers_) registers.resize(formula_.registers_);
    std::fill_n(sums, count_of_sums_, T(0));
    for (std::size_t term = 0; term < count_; ++term) {
      for (std::size_t k = 0; k < columns_.size(); ++k) {
        const Column& column = columns_[k];
        arguments[k] = column.source == Source::number     ? T(numbers_[column.first + term])
                       : column.source == Source::variable ? x[places_[column.first + term]]
                                                           : r[places_[column.first + term]];
      }
      formula_.run(arguments.data(), 0.0, registers.data(), values.data());
      for (std::size_t k = 0; k < results_.size(); ++k) {
        const std::uint32_t into = places_[results_[k].first + term];
        if (into == dropped) continue;
        sums[into] = results_[k].negated ? sums[into] - values[k] : sums[into] + values[k];
      }
    }
  }
  void evaluate(const double* x, const double* r, double* sums) const noexcept;

  /// Whether terms read registers of the calling formula, and not its variables alone.
  bool reads_registers() const {
    return std::ranges::any_of(columns_, [](const Column& column) { return column.source == Source::formula; });
  }
  /// The number of operations of all terms together.
  std::size_t operations() const { return count_ * steps_.size(); }

 private:
  static constexpr std::size_t tile = 256;  ///< terms computed at a time
  static constexpr std::size_t parts = 8;   ///< partial sums into which the terms of one sum are added
  static constexpr std::uint32_t dropped = static_cast<std::uint32_t>(-1);
  static constexpr std::size_t few_in_segment = 4;  ///< average, below which values are read and added one by one

  enum class Source : std::uint8_t { number, variable, formula };
  /// An argument of all terms: from `first` on, numbers_ holds its values, or places_ the places of its values. A
  /// `gathered` column is copied into a tile; the others are read directly, by differences alone.
  struct Column {
    Source source = Source::number;
    std::uint32_t first = 0;
    bool gathered = false;
  };
  /// A result of all terms: `operand`, or its opposite, is added to the sums that places_ lists from `first` on.
  struct Result {
    std::uint32_t first = 0;
    std::uint16_t operand = 0;
    bool negated = false;
  };
  /// The places of a column along a segment: consecutive from `from` on if it moves, else always `from`.
  struct Reach {
    std::uint32_t from = 0;
    bool moves = false;
  };
  /// Terms that are computed together; they consist of `segments` segments.
  struct Tile {
    std::uint32_t first_segment = 0, segments = 0;
  };
  /// An operation on all terms of a tile. Operands are numbered: first the columns of arguments, then tiles of results.
  struct Step {
    Code code;
    Fused fused = Fused::nothing;
    bool difference = false;  ///< a − b of two columns, read segment by segment
    std::uint16_t out = 0, a = 0, b = 0, c = 0;
    double value = 0;
  };
  class Order;

  void set_columns(const Tape& tape, const Terms& terms, const PreparedTerms& prepared,
                   const std::function<std::uint32_t(Index)>& registered);
  void set_steps(const Tape& tape, std::span<const Index> results);
  void set_segments();
  std::size_t reaches() const { return columns_.size() + results_.size(); }

  void gather(std::size_t k, const Tile& some, std::size_t begin, std::size_t count, const double* from,
              double* to) const noexcept;
  void subtract(const Step& step, const Tile& some, const double* x, const double* r, double* out) const noexcept;
  void add_segments(const Tile& some, const double* const* operand, double* sums) const noexcept;
  void add_each(std::size_t begin, std::size_t count, const double* const* operand, double* sums) const noexcept;

  std::size_t count_ = 0, count_of_sums_ = 0;
  Formula formula_;  ///< of one term
  std::vector<Column> columns_;
  std::vector<Result> results_;
  std::vector<double> numbers_;
  std::vector<std::uint32_t> places_;
  std::vector<Step> steps_;
  std::size_t operands_ = 0;
  bool in_segments_ = false;
  std::vector<Tile> tiles_;
  std::vector<std::uint16_t> lengths_;  ///< number of terms of each segment
  std::vector<Reach> reach_;            ///< by segment: the columns, then the results
};

template <class T, class S>
void Formula::add_up(const TermSums& sums, const T* x, const S&, const T* r, T* out) {
  sums.evaluate(x, r, out);
}

}  // namespace least::tape
