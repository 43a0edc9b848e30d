#include "core/run/steep_steps.hpp"

#include "core/schemes/least_size.hpp"

namespace least {

double SteepSteps::resolved_part(StateView from, StateView to, double tolerance) const {
  const double length = to.t - from.t;
  if (!steep_ || !(length > 0)) return 1;
  StateNumbers first_rate(components_), last_rate(components_);
  field_.rate(field_.problem, from.t, from.numbers, first_rate.data());
  field_.rate(field_.problem, to.t, to.numbers, last_rate.data());
  std::int64_t evaluations = 0;
  return steep_->resolved_part({{from.t, from.numbers, first_rate.data()},
                                {to.t, to.numbers, last_rate.data()},
                                components_,
                                components_,
                                field_.rate,
                                field_.complete,
                                field_.problem,
                                least_size(largest_of({from.numbers, components_}))},
                               tolerance, evaluations) /
         length;
}

}  // namespace least
