// POST /v1/periodic, from the text of a request to the answer.
#pragma once

#include "server/endpoint.hpp"

namespace least::server {

/// close_orbit_request answers as a whole, or line by line as members of the family are found.
Prepared close_orbit_request(const Context& context, const HttpRequest& request);

}  // namespace least::server
