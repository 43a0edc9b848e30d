// The statuses of the service's answers, and their words.
#pragma once

#include <string_view>

namespace least::server {

/// phrase returns the phrase of a status ("Not Found").
std::string_view phrase(int status);

/// error_name returns the name of an error in the `type` of a problem document ("not-found").
std::string_view error_name(int status);

}  // namespace least::server
