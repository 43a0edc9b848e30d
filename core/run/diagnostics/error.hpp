// What a run says where its error cannot be told.
#pragma once

#include <vector>

#include "core/problem_traits.hpp"
#include "core/run/outcome.hpp"

namespace least {

/// A run says once that its truth is missing, or no truth for being as uncertain as the errors it finds.
void warn_of_missing_reference(std::vector<Warning>& warnings, double uncertainty = unknown);

}  // namespace least
