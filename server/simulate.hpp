// One run, from the text of a request to its answer; shared by HTTP and the command line.
#pragma once

#include "server/endpoint.hpp"

namespace least::server {

/// POST /v1/simulate: the whole answer in one of the `forms`, or line by line while it runs.
Prepared simulate(const Context& context, const HttpRequest& request);

}  // namespace least::server
