// Reads the member `sensitivities` of a run.
#pragma once

#include "server/decode/field_reader.hpp"
#include "server/decode/simulate_request.hpp"

namespace least::server {

/// pointer_in_one_way turns `/problem/parameters/m` into `/problem/m` and `/problem/m/2` into `/problem/m[3]`, the
/// spelling of answers.
std::string pointer_in_one_way(std::string pointer);

/// read_sensitivities reads which derivatives are asked for. `scheme` may be that of `auto`; it is null where the
/// scheme of the request was refused.
void read_sensitivities(const Json& root, const FieldPath& top, const SchemeCard* scheme, SimulateRequest& decoded);

}  // namespace least::server
