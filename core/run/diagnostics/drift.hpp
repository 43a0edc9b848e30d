// How far a quantity departs from its start.
#pragma once

#include <cmath>

#include "core/problem_traits.hpp"

namespace least {

/// DriftExtremes are the start, end and largest change of one quantity along a run; unknown until it starts.
struct DriftExtremes {
  double initial = unknown, final = unknown, most = unknown;
  void start(double x) {
    initial = final = x;
    most = 0;
  }
  void see(double x) {
    final = x;
    const double change = std::abs(x - initial);
    if (!(change <= most)) most = change;  // NaN stays
  }
};

}  // namespace least
