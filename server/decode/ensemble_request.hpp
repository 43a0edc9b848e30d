// JSON → an ensemble: a scene, a scheme, and how the members differ.
#pragma once

#include "core/ensemble/ensemble.hpp"
#include "server/decode/simulate_request.hpp"

namespace least::server {

/// Reads a request of POST /v1/ensemble: all that is wrong, or a plan as sound as a decoded run.
Result<EnsemblePlan, Faults> decode_ensemble(ParsedJson body, const Cards& cards, const Caps& caps);

}  // namespace least::server
