// The *error* of a state, as the contract defines it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace least {

/// The largest component-wise difference from the true state, divided by max(1, the largest component of the true one),
/// of the first `size` components. Not finite where a component is not.
template <class A, class B>
double state_error(const A& x, const B& truth, std::size_t size) {
  double difference = 0, most = 1;
  for (std::size_t i = 0; i < size; ++i) {
    const double here = std::abs(x[i] - truth[i]);
    if (!(here <= difference) && !std::isnan(difference)) difference = here;  // NaN comes in and stays
    most = std::max(most, std::abs(truth[i]));
  }
  return difference / most;
}
template <class X>
double state_error(const X& x, const X& truth) {
  return state_error(x, truth, X::size);
}

}  // namespace least
