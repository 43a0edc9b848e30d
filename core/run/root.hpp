// Where a function changes its sign.
#pragma once

#include <functional>

namespace least {

/// A zero of f between a and b, where f has different signs (or is zero), to the last digits of a double.
double root(const std::function<double(double)>& f, double a, double b);

}  // namespace least
