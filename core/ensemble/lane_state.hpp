// Single states of members: columns, and the path of a step. In the numbers of the lanes, so that they have
// the same bits on every machine. Only the narrowest unit of lanes includes this header.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/ensemble/lane_run.hpp"
#include "core/run/columns.hpp"
#include "core/run/problem_entries.hpp"

namespace least {

template <template <class> class P>
void lane_columns(const LaneState& state) {
  using X = FullStateOf<P<double>>;
  static const auto all = columns_of(traits_of<P<double>, X>(), About<P>::card());
  const ProblemEntries<P<double>, X> table(from_values<P<double>>(About<P>::fields, state.parameters));
  std::array<double, X::size> numbers{};  // what is not carried is not read
  std::copy_n(state.values, state.full ? X::size : StateOf<P<double>>::size, numbers.begin());
  for (std::size_t i = 0; i < state.columns.size(); ++i) {
    const auto& column = all[state.columns[i]];
    state.out[i] = column.value(table, {state.t, numbers.data()}, {}, column.index);
  }
}

/// Of the first pack of a group of the same members.
class BoundPath final : public LanePath {
 public:
  BoundPath(GroupSteps& steps, const std::vector<Lanes>& start, double t) : steps_(steps), start_(start), t_(t) {}
  bool at(double t, double* state) const override {
    Lanes* const x = std::copy_n(start_.data(), steps_.size(), steps_.state(0)) - steps_.size();
    StepObservations seen;
    steps_.advance(t_, t_, 0, 0, 1, t - t_, seen);
    steps_.take_back();
    bool good = all(seen.well[0]);
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      state[i] = x[i][0];
      good = good && std::isfinite(state[i]);
    }
    return good;
  }

 private:
  GroupSteps& steps_;
  const std::vector<Lanes>& start_;
  double t_;
};
template <template <class> class P>
void show_path(const LaneStep& step, LaneHost& host) {
  using X = FullStateOf<P<double>, Lanes>;
  Group<P<Lanes>> problems;
  problems.fill(parameters::in<Lanes>(from_values<P<double>>(About<P>::fields, step.parameters)));
  std::vector<Lanes> x(packs * X::size);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = i % X::size < step.before.size() ? step.before[i % X::size] : 0.0;
  with_bound_scheme<P<Lanes>, X>(step.scheme, step.settings, [&](const void* scheme, auto bind, std::size_t) {
    const auto steps = bind(scheme, problems, x.data(), step.t);
    steps->use(1);
    steps->keep();
    host.look(BoundPath(*steps, x, step.t));
  });
}

}  // namespace least
