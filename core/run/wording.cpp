#include "core/run/wording.hpp"

#include <fmt/format.h>

#include <cmath>

namespace least::wording {

std::string unstable(double ratio, double bound, double step) {
  return fmt::format(
      "hω = {:.4g} exceeds the stability bound {:.6g} of this scheme; here a step below {:.3g} is stable", ratio, bound,
      step);
}

std::string near_bound(double ratio, double careful, double bound) {
  const std::string errors = fmt::format("hω reached {:.4g}: from {:.3g} on expect large errors", ratio, careful);
  return bound > 0 && std::isfinite(bound) ? fmt::format("{}, beyond {:.6g} instability", errors, bound) : errors;
}

std::string step_limit(std::int64_t steps) { return fmt::format("limits.steps = {} was reached", steps); }

std::string deadline(double seconds) { return fmt::format("limits.seconds = {} ran out", seconds); }

}  // namespace least::wording
