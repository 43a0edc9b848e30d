// The warning of a run whose error is not known.
#pragma once

#include <string_view>
#include <vector>

#include "core/problem_traits.hpp"
#include "core/run/outcome.hpp"

namespace least {

/// warn_of_missing_reference warns, once for a run, that the true motion is missing: for the reason given if it is
/// known (Truth::missing), or since its uncertainty is as large as the errors.
void warn_of_missing_reference(std::vector<Warning>& warnings, double uncertainty, std::string_view missing);

}  // namespace least
