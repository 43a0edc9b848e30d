// The member `sensitivities` of a run.
#pragma once

#include "server/decode/field_reader.hpp"
#include "server/decode/simulate_request.hpp"

namespace least::server {

/// `/problem/parameters/m` as `/problem/m`, `/problem/m/2` as `/problem/m[3]`: as answers name numbers of a request.
std::string pointer_in_one_way(std::string pointer);

/// Reads what derivatives are asked for, where the rest of the request has no fault. `scheme` may be that of `auto`.
void read_sensitivities(const Json& root, const FieldPath& top, const SchemeCard& scheme, SimulateRequest& decoded);

}  // namespace least::server
