// Between two states: quintic Hermite interpolation, from the equations of motion and their derivative along the
// motion. Source: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, II.6.
#pragma once

#include "core/run/problem_table.hpp"

namespace least {

/// Between `a` and `b`: the polynomial of degree 5 that meets values, first and second derivatives at both ends. Error
/// O(h⁶). Four evaluations of the equations of motion, two of them with a derivative, whatever the number of times.
class HermitePath {
 public:
  HermitePath(const ProblemTable& problem, StateView a, StateView b);

  /// The state at the time t.
  RunState operator()(double t) const;

 private:
  /// ẋ, and ẍ by differentiating the equations of motion along themselves.
  struct End {
    RunState x;
    StateNumbers first, second;
  };
  static End end_at(const ProblemTable& problem, StateView x);

  End a_, b_;
};

}  // namespace least
