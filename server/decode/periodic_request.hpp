// JSON → the question for a closed orbit.
#pragma once

#include "core/periodic/closed_orbit.hpp"
#include "server/decode/simulate_request.hpp"

namespace least::server {

/// Reads a request of POST /v1/periodic: all that is wrong, or a question that the core takes.
Result<periodic::Question, Faults> decode_periodic(ParsedJson body, const Cards& cards, const Caps& caps);

}  // namespace least::server
