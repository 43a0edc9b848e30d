// The statuses that the service answers with, and their words.
#pragma once

#include <string_view>

namespace least::server {

/// The phrase that belongs to a status ("Not Found").
std::string_view phrase(int status);

/// The name of an error in the `type` of a problem document ("not-found").
std::string_view error_name(int status);

}  // namespace least::server
