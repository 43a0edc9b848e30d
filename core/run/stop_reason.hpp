// Why a run stops where a step went wrong.
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

/// Of a step that failed or ended in something that is not finite. `parameter`: it was taken with a coordinate in the
/// place of the time; `why`: what the scheme says, may be empty; `singular_at`: when the motion becomes infinite, if it
/// does so near here.
StopReason stop_reason(const BlockResult& result, bool fixed, bool parameter, const std::string& why,
                       double singular_at);

}  // namespace least
