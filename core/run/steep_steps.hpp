// Steep functions in the steps of a motion that is followed neither by series nor by a pair of schemes, which look for
// them by themselves: a step is to be shortened where one may hide in it.
#pragma once

#include <memory>
#include <utility>

#include "core/run/run_state.hpp"
#include "core/schemes/odeint.hpp"

namespace least {

class SteepSteps {
 public:
  /// `field`: the equations of motion of states with so many components; `steep`: null where there is nothing steep.
  SteepSteps(const odeint::Field& field, std::shared_ptr<const tape::SteepForces> steep, std::size_t components)
      : field_(field), steep_(std::move(steep)), components_(components) {}

  bool empty() const { return !steep_; }
  /// What part of the step from a state to another resolves them, or somewhat less; 1: all of it. `tolerance`: of a
  /// step.
  double resolved_part(StateView from, StateView to, double tolerance) const;

 private:
  odeint::Field field_;
  std::shared_ptr<const tape::SteepForces> steep_;
  std::size_t components_;
};

/// Of a problem, which outlives it.
template <class P>
SteepSteps steep_steps(const P& problem) {
  return {AnyOdeintStepper<P, StateOf<P>>::field_of(problem, nullptr), steep_forces(problem), StateOf<P>::size};
}

}  // namespace least
