// lyapunov: how fast neighbours of the run separate.
#pragma once

#include <string_view>

namespace least {

/// verdict_of returns in words what the growth of differences means; `growth` is ln of the total growth, `megno` the
/// MEGNO.
std::string_view verdict_of(double growth, double megno);

}  // namespace least
