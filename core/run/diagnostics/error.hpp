// What a run says where its error cannot be told.
#pragma once

#include <string_view>
#include <vector>

#include "core/problem_traits.hpp"
#include "core/run/outcome.hpp"

namespace least {

/// A run says once that its truth is missing, why if that is known (Truth::missing), or no truth for being as uncertain
/// as the errors it finds.
void warn_of_missing_reference(std::vector<Warning>& warnings, double uncertainty, std::string_view missing);

}  // namespace least
