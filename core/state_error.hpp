// The *error* of a state, as the contract defines it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace least {

/// What a difference is divided by: max(1, the largest component of the true state), or that component alone, which is
/// for states far below 1.
enum class Norm : std::uint8_t { absolute, relative };

/// The largest component-wise difference from the true state of the first `size` components, in this norm. Not finite
/// where a component is not, or where the true state is zero in the relative norm and the other is not.
template <class A, class B>
double state_error(const A& x, const B& truth, std::size_t size, Norm norm = Norm::absolute) {
  double difference = 0, most = norm == Norm::absolute ? 1 : 0;
  for (std::size_t i = 0; i < size; ++i) {
    const double here = std::abs(x[i] - truth[i]);
    if (!(here <= difference) && !std::isnan(difference)) difference = here;  // NaN comes in and stays
    most = std::max(most, std::abs(truth[i]));
  }
  return difference == 0 ? 0 : difference / most;
}
template <class X>
double state_error(const X& x, const X& truth, Norm norm = Norm::absolute) {
  return state_error(x, truth, X::size, norm);
}

}  // namespace least
