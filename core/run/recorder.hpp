// Turns states into rows of the columns asked for and hands them to the sink in blocks.
#pragma once

#include <cmath>
#include <vector>

#include "core/describe.hpp"
#include "core/problem.hpp"
#include "core/run/outcome.hpp"

namespace least {

/// Names of the columns of a problem, in the order that Recorder knows them: t, variables, energy, step_size,
/// invariants.
inline std::vector<std::string_view> column_names(const ProblemCard& card) {
  std::vector<std::string_view> names{"t"};
  for (const auto& variable : card.variables) names.push_back(variable.name);
  names.insert(names.end(), {"energy", "step_size"});
  for (const auto& invariant : card.invariants) names.push_back(invariant.name);
  return names;
}

template <class P>
class Recorder {
 public:
  Recorder(const P& problem, const std::vector<std::size_t>& columns, Sink& sink)
      : problem_(problem), columns_(columns), sink_(sink) {
    rows_.reserve(columns.size() * block);
  }

  enum class Taken { yes, not_finite, refused };

  /// One row at x; a row with a number that is not finite is not written.
  Taken take(const StateOf<P>& x, double step_size) {
    const std::size_t before = rows_.size();
    for (const std::size_t column : columns_) rows_.push_back(value(x, column, step_size));
    for (std::size_t i = before; i < rows_.size(); ++i)
      if (!std::isfinite(rows_[i])) {
        rows_.resize(before);
        return Taken::not_finite;
      }
    return rows_.size() + columns_.size() <= rows_.capacity() || flush() ? Taken::yes : Taken::refused;
  }

  bool flush() {
    const bool accepted = rows_.empty() || sink_.append(rows_);
    rows_.clear();
    return accepted;
  }

 private:
  static constexpr std::size_t block = 512;

  double value(const StateOf<P>& x, std::size_t column, double step_size) const {
    constexpr std::size_t n = P::dof;
    if (column == 0) return x.t;
    if (column <= n) return x.q[column - 1];
    if (column <= 2 * n) return x.p[column - n - 1];
    if (column == 2 * n + 1) return hamiltonian(problem_, x.q, x.p, x.t);
    if (column == 2 * n + 2) return step_size;
    if constexpr (HasInvariants<P>) {
      return problem_.invariants(x.q, x.p, x.t)[column - 2 * n - 3];
    } else {
      return 0;  // no such column: the card does not name it
    }
  }

  const P& problem_;
  const std::vector<std::size_t>& columns_;
  Sink& sink_;
  std::vector<double> rows_;
};

}  // namespace least
