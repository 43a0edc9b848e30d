// Events between steps: the zeros of a scene's sections, located within the step, and quantities derived from them.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/run/outcome.hpp"
#include "core/run/problem_table.hpp"

namespace least {

/// Events collects the zeros of sections of a run. Sections by number: 0 a coordinate, 1 its velocity, 2 the
/// denominator of a slope.
class Events {
 public:
  /// Lists grow no longer than `most`.
  explicit Events(std::size_t most) : most_(most) {}

  /// locate adds every change of sign between the states `left` and `right` of a step; `at(t)` returns the state at a
  /// time between them.
  void locate(const ProblemTable& problem, const RunState& left, const RunState& right,
              const std::function<RunState(double t)>& at);
  /// Adds a zero that is known otherwise: its time, and the first component there.
  void add(std::size_t section, bool upwards, double t, double first);
  /// Whether a list of this length may grow.
  bool room(std::size_t length);
  /// Whether an event was left out for lack of room.
  bool full() const { return full_; }

  const std::vector<double>& zeros() const { return zeros_; }
  const std::vector<double>& poles() const { return poles_; }
  /// cycle reports the last whole cycle; null before there is one. `converged`: over the last third of the cycles
  /// neither period nor amplitude changed by more than one part in a thousand, nor will they if they converge on as
  /// they did over the last two thirds; null before there are three cycles.
  Report cycle() const;

 private:
  struct Cycle {
    double period, amplitude;
  };
  void note(std::vector<double>& list, double t);
  /// converged returns that for the period or the amplitude.
  bool converged(double Cycle::*number) const;

  std::size_t most_;
  bool full_ = false;
  Held held_ = HeldByThread::take(0);  ///< memory of the lists
  std::vector<double> zeros_, poles_;
  std::int64_t rises_ = 0;
  double last_rise_ = 0, amplitude_ = 0;
  std::vector<Cycle> cycles_;  ///< the last cycles
};

}  // namespace least
