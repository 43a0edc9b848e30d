// JSON → an ensemble: a scene, a scheme, and how the members differ.
#pragma once

#include "core/ensemble/ensemble.hpp"
#include "server/decode/simulate_request.hpp"

namespace least::server {

/// decode_ensemble reads a request of POST /v1/ensemble: a plan that is as thoroughly checked as a decoded run, or all
/// faults.
Result<EnsemblePlan, Faults> decode_ensemble(ParsedJson body, const Cards& cards, const Caps& caps);

}  // namespace least::server
