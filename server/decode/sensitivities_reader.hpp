// The member `sensitivities` of a run.
#pragma once

#include "server/decode/field_reader.hpp"
#include "server/decode/simulate_request.hpp"

namespace least::server {

/// Reads what derivatives are asked for, where the rest of the request has no fault. `scheme` may be that of `auto`.
void read_sensitivities(const Json& root, const FieldPath& top, const SchemeCard& scheme, SimulateRequest& decoded);

}  // namespace least::server
