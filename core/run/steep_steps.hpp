// Steep functions in the steps of a motion that is followed neither by series nor by a pair of schemes, which look for
// them by themselves: a step is to be shortened where one may hide in it.
#pragma once

#include <memory>

#include "core/schemes/odeint.hpp"

namespace least {

template <class P>
class SteepSteps {
 public:
  using X = StateOf<P>;

  /// The problem outlives it.
  explicit SteepSteps(const P& problem) : problem_(&problem), steep_(steep_forces(problem)) {}

  bool empty() const { return !steep_; }
  /// What part of the step from a state to another resolves them, or somewhat less; 1: all of it. `tolerance`: of a
  /// step.
  double resolved_part(const X& from, const X& to, double tolerance) const {
    const double length = to.t - from.t;
    if (!steep_ || !(length > 0)) return 1;
    const odeint::Field field = AnyOdeintStepper<P, X>::field_of(*problem_, steep_.get());
    const Values start = values(from), end = values(to);
    Values first_rate, last_rate;
    field.rate(problem_, from.t, start.data(), first_rate.data());
    field.rate(problem_, to.t, end.data(), last_rate.data());
    std::int64_t evaluations = 0;
    return steep_->resolved_part({{from.t, start.data(), first_rate.data()},
                                  {to.t, end.data(), last_rate.data()},
                                  X::size,
                                  X::size,
                                  field.rate,
                                  field.complete,
                                  problem_},
                                 tolerance, evaluations) /
           length;
  }

 private:
  using Values = Vec<X::size>;
  static Values values(const X& x) {
    Values y;
    for (std::size_t i = 0; i < X::size; ++i) y[i] = x[i];
    return y;
  }

  const P* problem_;
  std::shared_ptr<const tape::SteepForces> steep_;
};

}  // namespace least
