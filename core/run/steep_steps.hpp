// Steep functions of forces within steps of methods that do not look for them themselves, as series and pairs of
// schemes do: a step that may hide one has to be shortened.
#pragma once

#include <memory>
#include <utility>

#include "core/run/run_state.hpp"
#include "core/schemes/odeint.hpp"

namespace least {

class SteepSteps {
 public:
  /// `field`: the equations of motion of states with so many components; `steep`: null if nothing is steep.
  SteepSteps(const odeint::Field& field, std::shared_ptr<const tape::SteepForces> steep, std::size_t components)
      : field_(field), steep_(std::move(steep)), components_(components) {}

  bool empty() const { return !steep_; }
  /// resolved_part returns the fraction of the step between two states that resolves the steep functions, or somewhat
  /// less; 1: the whole step. `tolerance` is that of a step.
  double resolved_part(StateView from, StateView to, double tolerance) const;

 private:
  odeint::Field field_;
  std::shared_ptr<const tape::SteepForces> steep_;
  std::size_t components_;
};

/// steep_steps returns the SteepSteps of a problem, which has to outlive them.
template <class P>
SteepSteps steep_steps(const P& problem) {
  return {AnyOdeintStepper<P, StateOf<P>>::field_of(problem, nullptr), steep_forces(problem), StateOf<P>::size};
}

}  // namespace least
