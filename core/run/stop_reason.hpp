// The reason why a run stops at a step that went wrong.
#pragma once

#include <string>

#include "core/run/integrator.hpp"
#include "core/run/outcome.hpp"

namespace least {

struct StopReason {
  ReturnCode reason;
  Message detail;
  double singular_at = unknown;
};

/// stop_reason describes a step that failed or ended in a state that is not finite. `parameter`: the step was taken
/// with a coordinate as parameter in place of the time; `why`: the scheme's own words, may be empty; `singular_at`:
/// when the motion becomes infinite, if that is near.
StopReason stop_reason(const BlockResult& result, bool fixed, bool parameter, const std::string& why,
                       double singular_at);

}  // namespace least
