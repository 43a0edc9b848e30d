// Where a function changes its sign, once or twice.
#pragma once

#include <functional>
#include <optional>

namespace least {

/// A zero of f between a and b, where f has different signs (or is zero), to the last digits of a double.
double root(const std::function<double(double)>& f, double a, double b);
/// A place between a and b where f is negative, which is not at either of them: none where f does not fall towards a
/// minimum in between, or not so far.
std::optional<double> dip(const std::function<double(double)>& f, double a, double b);

}  // namespace least
