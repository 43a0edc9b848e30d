// Times at which the damping α(t) of a contact scene is infinite, so that no motion leads across.
#pragma once

#include "core/run/problem_table.hpp"

namespace least {

/// damping_pole returns the first time after `start` and up to `end` at which α is infinite like 1/|t − t*| or more
/// strongly, as 2/t is at t = 0: there e^{−∫α} is 0, infinite or undefined, and no motion leads across. Weaker
/// infinities, as that of |t − t*|^{−1/2}, are none: the motion goes on behind them. The search looks at 256 points of
/// the span and narrows changes of sign and maxima of |α| between them, so that poles nearer to each other than that
/// may be missed. Infinite where none is found, for constant or periodic damping, and where `end` is infinite.
double damping_pole(const ProblemTable& problem, double start, double end);

}  // namespace least
