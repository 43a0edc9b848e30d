// Turns states into rows of the columns asked for and hands them to the sink in blocks.
#pragma once

#include <cmath>
#include <vector>

#include "core/run/observer.hpp"

namespace least {

/// Names of the columns of a problem, in the order that Recorder knows them: t, variables, step_size, energy,
/// mechanical_energy, invariants, quantities, mode, parameter.
template <class P>
std::vector<std::string_view> column_names(const ProblemCard& card) {
  std::vector<std::string_view> names{"t"};
  for (const auto& variable : card.variables) names.push_back(variable.name);
  names.emplace_back("step_size");
  if (HasEnergy<P>) names.emplace_back("energy");
  if (Contact<P>) names.emplace_back("mechanical_energy");
  for (const auto& invariant : card.invariants) names.push_back(invariant.name);
  for (const auto& quantity : card.quantities) names.push_back(quantity.name);
  if (Conservative<P>) names.insert(names.end(), {"mode", "parameter"});
  return names;
}

/// How a sample was reached. Unknown: it was not reached by a step, or the scheme has no modes.
struct Manner {
  double step_size = unknown, mode = unknown, parameter = unknown;
};

template <class P, class X>
class Recorder {
 public:
  Recorder(const P& problem, const ProblemCard& card, const std::vector<std::size_t>& columns, Sink& sink)
      : problem_(problem),
        variables_(card.variables.size()),
        columns_known_(card.columns.size()),
        columns_(columns),
        sink_(sink) {
    rows_.reserve(columns.size() * block);
  }

  enum class Taken { yes, not_finite, refused };

  /// One row at x; a row with a number that is not finite is not written. A slope at its pole is unknown, not infinite,
  /// and so is a manner that does not apply.
  Taken take(const X& x, const Manner& manner) {
    const std::size_t before = rows_.size();
    bool finite = true;
    for (const std::size_t column : columns_) {
      rows_.push_back(value(x, column, manner));
      if (std::isfinite(rows_.back()) || may_be_unknown(column)) continue;
      finite = false;
      wrong_ = column;
    }
    if (!finite) {
      rows_.resize(before);
      return Taken::not_finite;
    }
    return rows_.size() + columns_.size() <= rows_.capacity() || flush() ? Taken::yes : Taken::refused;
  }

  /// The column that was not finite.
  std::size_t wrong_column() const { return wrong_; }

  bool flush() {
    const bool accepted = rows_.empty() || sink_.append(rows_);
    rows_.clear();
    return accepted;
  }

 private:
  static constexpr std::size_t block = 512;

  bool may_be_unknown(std::size_t column) const {
    if (CarriesSlope<P> && column == X::size + 1) return true;
    return column == variables_ + 1 || (Conservative<P> && column + 2 >= columns_known_);
  }

  double value(const X& x, std::size_t column, const Manner& manner) const {
    if (column == 0) return x.t;
    if (column <= variables_) return variable(x, column - 1);
    std::size_t i = column - variables_ - 1;
    if (i-- == 0) return manner.step_size;
    if (Conservative<P> && column + 2 == columns_known_) return manner.mode;
    if (Conservative<P> && column + 1 == columns_known_) return manner.parameter;
    if constexpr (HasEnergy<P>)
      if (i-- == 0) {
        if constexpr (SaysEnergy<P, X>) return energy_of(problem_, x);
        return unknown;
      }
    if constexpr (Contact<P>)
      if (i-- == 0) return mechanical_energy(problem_, x.q, x.p, phase(problem_, x.t));
    if constexpr (HasInvariants<P>) return problem_.invariants(x.q, x.p, x.t)[i];
    if constexpr (HasQuantities<P>) return problem_.quantities(x.y, x.t)[i];
    return unknown;  // no such column: the card does not name it
  }

  const P& problem_;
  std::size_t variables_, columns_known_, wrong_ = 0;
  const std::vector<std::size_t>& columns_;
  Sink& sink_;
  std::vector<double> rows_;
};

}  // namespace least
