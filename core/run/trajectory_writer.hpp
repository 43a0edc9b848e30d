// Turns states into rows of the columns asked for and hands them to the sink in blocks; all at the end where a column
// says the error, for the truth is found in one sweep.
#pragma once

#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include "core/run/columns.hpp"
#include "core/run/outcome.hpp"
#include "core/run/request.hpp"

namespace least {

template <class P, class X>
class TrajectoryWriter {
 public:
  /// The request's columns are positions among the card's. A problem without samples has none.
  TrajectoryWriter(const P& problem, const Request& request, RowSink& sink)
      : problem_(problem), request_(request), sink_(sink) {
    const auto all = columns_of<P, X>(request.scene->card());
    for (const std::size_t index : request.columns) {
      if (all.at(index).card.name == error_column) error_ = columns_.size();
      columns_.push_back(all.at(index));
    }
    rows_.reserve(columns_.size() * block);
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
    if (error_) {
      times_.push_back(x.t);
      for (std::size_t i = 0; i < StateOf<P>::size; ++i) states_.push_back(value_of(x[i]));
      return Written::yes;
    }
    return rows_.size() + columns_.size() <= rows_.capacity() || flush() ? Written::yes : Written::refused;
  }

  /// Hands over what is written so far, unless it waits for its errors, and says how far the run got. False: the sink
  /// takes no more.
  bool report(double t, std::int64_t steps) { return (error_ || flush()) && sink_.progress(t, steps); }

  /// The column that was not finite.
  std::string_view wrong_column() const { return wrong_; }

  /// What is still kept. `keep_going` is asked while the truth is sought; false leaves the rest of the errors unknown.
  bool finish(const KeepGoing& keep_going) {
    if (error_ && !times_.empty()) fill_errors(keep_going);
    return flush();
  }
  /// Errors were asked for, and some are unknown for want of a truth.
  bool lacks_truth() const { return lacks_truth_; }

 private:
  bool flush() {
    const bool accepted = rows_.empty() || sink_.append(rows_);
    rows_.clear();
    return accepted;
  }
  void fill_errors(const KeepGoing& keep_going) {
    constexpr std::size_t size = StateOf<P>::size;
    const Truth truth = request_.scene->mechanics->truth(*request_.scene, times_, keep_going);
    lacks_truth_ = !truth.complete;
    for (std::size_t k = 0; k < truth.states.size(); ++k)
      rows_[k * columns_.size() + *error_] = state_error(&states_[k * size], truth.states[k], size, request_.norm);
  }

  static constexpr std::size_t block = 512;

  const P& problem_;
  const Request& request_;
  RowSink& sink_;
  std::vector<Column<P, X>> columns_;
  std::vector<double> rows_;
  std::optional<std::size_t> error_;    ///< the column of errors
  std::vector<double> times_, states_;  ///< of every row, where there is one
  bool lacks_truth_ = false;
  std::string_view wrong_;
};

}  // namespace least
