// One run from the text of a request to its answer; HTTP and the command line share it.
#pragma once

#include "server/endpoint.hpp"

namespace least::server {

/// POST /v1/simulate: whole in one of the `forms`, or line by line while it runs.
Prepared simulate(const Context& context, const HttpRequest& request);

}  // namespace least::server
