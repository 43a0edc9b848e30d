// Turns states into rows of the columns asked for and hands them to the sink in blocks. All rows are handed over at the
// end if there is an error column, since the true motion is computed in one sweep, or if they have to lie evenly along
// a curve.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/run/acts.hpp"
#include "core/run/columns.hpp"
#include "core/run/curve.hpp"
#include "core/run/outcome.hpp"
#include "core/run/request.hpp"

namespace least {

/// shown_variables returns the variables of the card as an answer shows them: `unknown` for optional ones that nobody
/// asked for or that are not finite.
inline std::vector<double> shown_variables(const Request& request, const ProblemTraits& traits, StateView x) {
  const auto& cards = request.scene->card().variables;
  std::vector<double> all;
  all.reserve(cards.size());
  const auto acts_on = [&](std::size_t i) {
    return std::ranges::any_of(request.events, [i](const EventAsked& event) {
      const auto sets = [i](const Setting& one) { return !one.velocity && one.index == i; };
      return event.act && (event.act->values.reads_variable(i) || std::ranges::any_of(event.act->settings, sets));
    });
  };
  for (std::size_t i = 0; i < cards.size(); ++i) {
    const bool asked = request.measures.reads_variable(i) || request.watched.reads_variable(i) || acts_on(i) ||
                       std::ranges::find(request.columns, i + 1) != request.columns.end();
    const double value = asked || !cards[i].optional ? variable(traits, x, i) : unknown;
    all.push_back(cards[i].optional && !std::isfinite(value) ? unknown : value);
  }
  return all;
}

class TrajectoryWriter {
 public:
  /// `asked`: indices of columns, beyond `all` those of the request's own; empty if nothing is kept. `curve`: the
  /// number of rows along a curve, 0 without one.
  TrajectoryWriter(const ProblemTable& problem, const Request& request, std::span<const std::size_t> asked,
                   const std::vector<Column>& all, std::int64_t curve, RowSink& sink)
      : problem_(problem), request_(request), sink_(sink) {
    for (const std::size_t place : asked) {
      const ColumnCard& card = request.column(place);
      if (card.name == error_column) error_ = columns_.size();
      if (card.name != "t") drawn_.push_back(columns_.size());
      if (place < all.size())
        columns_.push_back({card, all[place].value, all[place].index});
      else
        columns_.push_back({card, nullptr, place - all.size()});
    }
    measured_.resize(request.measures.size());
    if (drawn_.empty() && !columns_.empty()) drawn_ = {0};  // only the time
    if (curve > 0) {
      curve_.emplace(static_cast<std::size_t>(curve));
      held_.add(2 * sizeof(double) * curve_->most());
    }
    rows_.reserve(columns_.size() * rows_of_block());
  }

  enum class Written { yes, not_finite, refused };

  /// Writes one row at x. A row with a non-finite number is not written, unless its column may be unknown.
  Written write_row(StateView x, const StepInfo& step) {
    const std::size_t before = rows_.size();
    if (error_ || curve_) make_room(rows_, before + columns_.size(), held_);
    measure(x);
    for (const auto& column : columns_) {
      rows_.push_back(value(column, x, step));
      if (std::isfinite(rows_.back()) || column.card.nullable) continue;
      wrong_ = column.card.name;
      rows_.resize(before);
      return Written::not_finite;
    }
    if (error_) {
      make_room(times_, times_.size() + 1, held_);
      make_room(states_, states_.size() + problem_.traits.moving, held_);
      times_.push_back(x.t);
      states_.insert(states_.end(), x.numbers, x.numbers + problem_.traits.moving);
    }
    if (curve_) {
      const std::size_t n = rows_.size() / columns_.size();
      if (curve_->add(n > 1 ? chord(n - 2, n - 1) : 0)) drop_next_to_last();
      if (curve_->full()) keep_rows(curve_->thin());
    }
    if (error_ || curve_) return Written::yes;
    return rows_.size() + columns_.size() <= rows_.capacity() || flush() ? Written::yes : Written::refused;
  }

  /// The number of parts into which the way to x has to be divided for a curve; at x a fraction `share` of the run's
  /// time is over.
  std::size_t parts(StateView x, const StepInfo& step, double share) {
    double square = 0;
    measure(x);
    if (!rows_.empty())
      for (const std::size_t i : drawn_) {
        const double d = value(columns_[i], x, step) - rows_.end()[row_place(i)];
        if (std::isfinite(d)) square += d * d;
      }
    return curve_->parts(std::sqrt(square), share);
  }

  /// Hands over the rows written so far, unless they wait for the end. False: the sink takes no more.
  bool hand_over() { return error_ || curve_ || flush(); }

  /// The name of the column that was not finite.
  std::string_view wrong_column() const { return wrong_; }

  /// Hands over the rows that are still kept. If keep_going(), asked during the computation of the true motion, returns
  /// false, the remaining errors are unknown.
  bool finish(const KeepGoing& keep_going) {
    if (curve_ && !rows_.empty()) keep_rows(curve_->choose());
    if (error_ && !times_.empty()) fill_errors(keep_going);
    return flush();
  }
  /// Whether errors were asked for of which some are unknown for lack of a true motion.
  bool lacks_truth() const { return lacks_truth_; }
  std::string_view why_no_truth() const { return missing_; }  ///< Truth::missing

 private:
  /// Asked is a column of the list of all, or one of the request's own.
  struct Asked {
    const ColumnCard& card;
    decltype(Column::value) value;
    std::size_t index;
  };

  /// measure evaluates the request's own columns at x; a value that is not finite is unknown, and does not stop the
  /// run.
  void measure(StateView x) {
    if (measured_.empty()) return;
    request_.measures.evaluate(observe(problem_, x, request_.measures).data(), x.t, measured_.data());
    for (double& value : measured_)
      if (!std::isfinite(value)) value = unknown;
  }
  /// The value of a column at x, after measure(x).
  double value(const Asked& column, StateView x, const StepInfo& step) const {
    return column.value ? column.value(problem_, x, step, column.index) : measured_[column.index];
  }
  /// The position of column i of the last row, from the end of rows_.
  std::ptrdiff_t row_place(std::size_t i) const {
    return static_cast<std::ptrdiff_t>(i) - static_cast<std::ptrdiff_t>(columns_.size());
  }
  /// The distance between two rows in the space of all columns but the time; unknown values are left out.
  double chord(std::size_t from, std::size_t to) const {
    double square = 0;
    for (const std::size_t i : drawn_) {
      const double d = rows_[to * columns_.size() + i] - rows_[from * columns_.size() + i];
      if (std::isfinite(d)) square += d * d;
    }
    return std::sqrt(square);
  }
  /// Keeps the rows of `width` numbers with these indices, in order.
  static void keep(std::vector<double>& numbers, std::size_t width, std::span<const std::size_t> kept) {
    for (std::size_t i = 0; i < kept.size(); ++i)
      std::copy_n(numbers.begin() + std::ptrdiff_t(kept[i] * width), width,
                  numbers.begin() + std::ptrdiff_t(i * width));
    numbers.resize(kept.size() * width);
  }
  void keep_rows(std::span<const std::size_t> kept) {
    keep(rows_, columns_.size(), kept);
    if (!error_) return;
    keep(times_, 1, kept);
    keep(states_, problem_.traits.moving, kept);
  }
  /// Replaces the row before the last one by the last.
  static void drop_next_to_last(std::vector<double>& numbers, std::size_t width) {
    const auto last = numbers.end() - std::ptrdiff_t(width);
    numbers.erase(last - std::ptrdiff_t(width), last);
  }
  void drop_next_to_last() {
    drop_next_to_last(rows_, columns_.size());
    if (!error_) return;
    drop_next_to_last(times_, 1);
    drop_next_to_last(states_, problem_.traits.moving);
  }
  bool flush() {
    bool accepted = true;
    const std::size_t piece = rows_of_block() * columns_.size();
    for (std::span<const double> rest(rows_); accepted && !rest.empty();
         rest = rest.subspan(std::min(piece, rest.size())))
      accepted = sink_.append(rest.first(std::min(piece, rest.size())));
    rows_.clear();
    return accepted;
  }
  void fill_errors(const KeepGoing& keep_going) {
    const std::size_t size = problem_.traits.moving, bytes_of_a_time = 128 + 5 * size * sizeof(double);
    const Held held = HeldByThread::take(times_.size() * bytes_of_a_time);
    const Truth truth = truth_along(*request_.scene, times_, request_.norm, keep_going);
    const auto error = [&](std::size_t row) -> double& { return rows_[row * columns_.size() + *error_]; };
    double most = 0;
    for (std::size_t k = 0; k < truth.states.size(); ++k) {
      error(k) = state_error(&states_[k * size], truth.states[k], size, truth.sizes_in(request_.norm));
      most = std::max(most, error(k));
    }
    const bool told = can_tell(truth.uncertainty_in(request_.norm), most);
    lacks_truth_ = !truth.complete || !told;
    missing_ = truth.missing;
    for (std::size_t k = 0; k < truth.states.size() && !told; ++k) error(k) = unknown;
  }

  /// The number of rows in a block: fewer if there are thousands of columns.
  std::size_t rows_of_block() const {
    constexpr std::size_t most = 512, least = 16, numbers = 1 << 16;
    return std::clamp(numbers / std::max<std::size_t>(columns_.size(), 1), least, most);
  }

  const ProblemTable& problem_;
  const Request& request_;
  RowSink& sink_;
  std::vector<Asked> columns_;
  std::vector<std::size_t> drawn_;  ///< indices of the columns that span the space of the curve: all but the time
  std::optional<CurveThinner> curve_;
  Held held_ = HeldByThread::take(0);  ///< memory of rows that are kept until the end
  std::vector<double> rows_;
  std::vector<double> measured_;        ///< values of the request's own columns at the last state
  std::optional<std::size_t> error_;    ///< the column of errors
  std::vector<double> times_, states_;  ///< time and state of every row, if there is an error column
  bool lacks_truth_ = false;
  std::string_view missing_;
  std::string_view wrong_;
};

}  // namespace least
