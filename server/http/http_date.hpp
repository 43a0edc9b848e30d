// The time as HTTP writes it.
#pragma once

#include <string>

namespace least::server {

/// http_date() returns the current time as `Sun, 06 Nov 1994 08:49:37 GMT` (RFC 9110, 5.6.7).
std::string http_date();

}  // namespace least::server
