// Ensembles, from the text of a request to the answer, over HTTP and on the command line.
#pragma once

#include "server/endpoint.hpp"

namespace least::server {

/// POST /v1/ensemble: the whole answer, or line by line as blocks are computed.
Prepared run_ensemble_request(const Context& context, const HttpRequest& request);

}  // namespace least::server
