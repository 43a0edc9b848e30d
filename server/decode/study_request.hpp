// JSON → requests for the studies of the core.
#pragma once

#include <vector>

#include "server/decode/simulate_request.hpp"

namespace least::server {

/// Limit of schemes in a request.
inline constexpr std::size_t most_schemes = 100;

/// decode_work_precision reads a request of POST /v1/work-precision: a checked plan, or all faults.
Result<StudyPlan, Faults> decode_work_precision(ParsedJson body, const Cards& cards, const Caps& caps);

/// StabilityPlan asks for the longest stable steps; `limits.seconds` of its scene is for all schemes together.
struct StabilityPlan {
  Request scene;
  std::vector<SchemeConfig> schemes;
};
Result<StabilityPlan, Faults> decode_stability(ParsedJson body, const Cards& cards, const Caps& caps);

}  // namespace least::server
