// How far a quantity departs from where it began.
#pragma once

#include <cmath>

#include "core/problem_traits.hpp"

namespace least {

/// Extremes of one quantity along a run; unknown until it starts.
struct DriftExtremes {
  double initial = unknown, final = unknown, most = unknown;
  void start(double x) {
    initial = final = x;
    most = 0;
  }
  void see(double x) {
    final = x;
    const double change = std::abs(x - initial);
    if (!(change <= most)) most = change;  // NaN comes in and stays
  }
};

}  // namespace least
