#include "core/run/stop_reason.hpp"

#include <cmath>

#include "core/run/messages.hpp"

namespace least {

StopReason stop_reason(const BlockResult& result, bool fixed, bool parameter, const std::string& why,
                       double singular_at) {
  if (result.status == StepStatus::underflow && parameter)
    return {ReturnCode::parameter_step_underflow, messages::parameter_underflow()};
  if (result.status == StepStatus::solver_failed)
    return {ReturnCode::solver_failed, !why.empty() ? why : messages::unsolved(fixed), singular_at};
  if (std::isfinite(singular_at)) return {ReturnCode::singular, messages::blow_up(singular_at), singular_at};
  if (result.status == StepStatus::singular)
    return {ReturnCode::singular, !why.empty() ? why : messages::singular_step(fixed)};
  if (result.end == BlockEnd::stands_still) return {ReturnCode::singular, messages::stands_still()};
  if (result.status == StepStatus::underflow) return {ReturnCode::singular, messages::underflow()};
  return {ReturnCode::not_finite, messages::not_finite(fixed)};
}

}  // namespace least
