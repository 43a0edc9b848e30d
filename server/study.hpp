// The studies, from the text of a request to the answer.
#pragma once

#include "server/endpoint.hpp"

namespace least::server {

/// POST /v1/work-precision: the whole answer, or line by line while it is measured.
Prepared measure_work_precision(const Context& context, const HttpRequest& request);

/// POST /v1/stability.
Prepared measure_stability(const Context& context, const HttpRequest& request);

}  // namespace least::server
