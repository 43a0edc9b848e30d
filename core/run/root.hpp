// The zero of a function between two points.
#pragma once

#include <functional>

namespace least {

/// root returns a zero of f between a and b, where f has different signs (or is zero), to the last digits of a double.
double root(const std::function<double(double)>& f, double a, double b);

}  // namespace least
