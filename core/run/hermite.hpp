// Quintic Hermite interpolation between two states, from the equations of motion and their derivative along the motion.
// Source: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, II.6.
#pragma once

#include "core/run/problem_table.hpp"

namespace least {

/// HermitePath is the polynomial of degree 5 through `a` and `b` with the first and second derivatives of the motion at
/// both ends. Error O(h⁶). It costs four evaluations of the equations of motion, two of them with a derivative, for any
/// number of times.
class HermitePath {
 public:
  HermitePath(const ProblemTable& problem, StateView a, StateView b);

  /// The state at the time t.
  RunState operator()(double t) const;

 private:
  /// End is one end with ẋ, and with ẍ by differentiating the equations of motion along the motion.
  struct End {
    RunState x;
    StateNumbers first, second;
  };
  static End end_at(const ProblemTable& problem, StateView x);

  End a_, b_;
};

}  // namespace least
