// Turns states into rows of the columns asked for and hands them to the sink in blocks.
#pragma once

#include <cmath>
#include <string_view>
#include <vector>

#include "core/run/columns.hpp"
#include "core/run/outcome.hpp"

namespace least {

template <class P, class X>
class TrajectoryWriter {
 public:
  /// `columns`: positions among the card's columns. A problem without samples has none.
  TrajectoryWriter(const P& problem, const ProblemCard& card, const std::vector<std::size_t>& columns, RowSink& sink)
      : problem_(problem), sink_(sink) {
    const auto all = columns_of<P, X>(card);
    for (const std::size_t index : columns) columns_.push_back(all.at(index));
    rows_.reserve(columns.size() * block);
  }

  enum class Written { yes, not_finite, refused };

  /// One row at x; a row with a number that is not finite is not written, unless the number may be unknown.
  Written write_row(const X& x, const StepInfo& step) {
    const std::size_t before = rows_.size();
    for (const auto& column : columns_) {
      rows_.push_back(column.value(problem_, x, step, column.index));
      if (std::isfinite(rows_.back()) || column.card.nullable) continue;
      wrong_ = column.card.name;
      rows_.resize(before);
      return Written::not_finite;
    }
    return rows_.size() + columns_.size() <= rows_.capacity() || flush() ? Written::yes : Written::refused;
  }

  /// The column that was not finite.
  std::string_view wrong_column() const { return wrong_; }

  bool flush() {
    const bool accepted = rows_.empty() || sink_.append(rows_);
    rows_.clear();
    return accepted;
  }

 private:
  static constexpr std::size_t block = 512;

  const P& problem_;
  RowSink& sink_;
  std::vector<Column<P, X>> columns_;
  std::vector<double> rows_;
  std::string_view wrong_;
};

}  // namespace least
