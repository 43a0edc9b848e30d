// JSON → what the studies of the core are asked for.
#pragma once

#include <vector>

#include "server/decode/simulate_request.hpp"

namespace least::server {

/// No request may ask for more schemes.
inline constexpr std::size_t most_schemes = 100;

/// Reads a request of POST /v1/work-precision: all that is wrong, or a plan as sound as a decoded run.
Result<StudyPlan, Faults> decode_work_precision(ParsedJson body, const Cards& cards, const Caps& caps);

/// The question for the longest stable steps; the scene's `limits.seconds` are for all of it.
struct StabilityPlan {
  Request scene;
  std::vector<SchemeConfig> schemes;
};
Result<StabilityPlan, Faults> decode_stability(ParsedJson body, const Cards& cards, const Caps& caps);

}  // namespace least::server
