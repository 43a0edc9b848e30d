// Runs that are compared at the same number of force evaluations.
#pragma once

#include <algorithm>

#include "tests/support/runs.hpp"

namespace bench {

/// at_cost() returns the setting (step, θ or σ) at which `request(setting)` spends about `budget` force evaluations, by
/// iteration from `setting`: the cost of an implicit step is not known beforehand.
template <class Make>
double at_cost(double budget, double setting, Make&& request) {
  for (int k = 0; k < 6; ++k)
    setting *= static_cast<double>(runs::go(request(setting)).outcome.cost.force_evaluations) / budget;
  return setting;
}

/// milliseconds() returns the shortest time of seven runs.
inline double milliseconds(const least::Request& request) {
  double seconds = 1e9;
  for (int k = 0; k < 7; ++k) seconds = std::min(seconds, runs::go(request).outcome.cost.seconds);
  return seconds * 1e3;
}

}  // namespace bench
