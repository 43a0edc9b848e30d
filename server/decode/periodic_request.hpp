// JSON → the question for a closed orbit.
#pragma once

#include "core/periodic/closed_orbit.hpp"
#include "server/decode/simulate_request.hpp"

namespace least::server {

/// decode_periodic reads a request of POST /v1/periodic: a checked question, or all faults.
Result<periodic::Question, Faults> decode_periodic(ParsedJson body, const Cards& cards, const Caps& caps);

}  // namespace least::server
