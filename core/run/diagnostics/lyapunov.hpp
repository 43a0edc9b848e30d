// lyapunov: how fast neighbours of the run part.
#pragma once

#include <string_view>

namespace least {

/// In words what the growth of differences means: `growth` is the logarithm of all of it.
std::string_view verdict_of(double growth, double megno);

}  // namespace least
