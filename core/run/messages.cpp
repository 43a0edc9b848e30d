#include "core/run/messages.hpp"

#include <fmt/format.h>

#include <cmath>

namespace least::messages {

std::string unstable(double ratio, double bound, double step) {
  if (bound == 0)
    return fmt::format("the damping makes this scheme unstable; here a step below {:.3g} is stable", step);
  return fmt::format(
      "hω = {:.4g} exceeds the stability bound {:.6g} of this scheme; here a step below {:.3g} is stable", ratio, bound,
      step);
}

std::string near_bound(double ratio, double careful, double bound) {
  const std::string errors = fmt::format("hω reached {:.4g}: from {:.3g} on expect large errors", ratio, careful);
  return bound > 0 && std::isfinite(bound) ? fmt::format("{}, beyond {:.6g} instability", errors, bound) : errors;
}

std::string column(std::string_view name) { return fmt::format("the column {} is not finite here", name); }

std::string left_domain(double t) {
  return fmt::format("the motion leaves its domain: what must stay positive reaches zero at t = {}", t);
}

std::string blow_up(double t) { return fmt::format("the action reaches infinity at t = {}", t); }

std::string stiff(double ratio) {
  return fmt::format(
      "the fastest rate of damping times the step is {:.3g}: above 0.5 expect large errors, above 1 nonsense", ratio);
}

std::string damping_sign(double t) {
  return fmt::format("αh ≥ 2 at t = {:.6g}: each step turns the momentum over where the motion only damps it", t);
}

std::string fallback_steps(std::int64_t steps) {
  return fmt::format("{} {} could not be taken along any coordinate and went in time instead", steps,
                     steps == 1 ? "step" : "steps");
}

std::string strain(double strain) {
  return fmt::format(
      "(E₀ − V + κ)/(K + κ), 1 on the energy level, was off by {:.2g} in its square: expect large errors; take a "
      "shorter step or another κ",
      strain);
}

std::string energy_jump(double before, double now) {
  return fmt::format(
      "the energy went from {:.4g} to {:.4g}: steps leapt over what they should have followed; take a smaller "
      "tolerance",
      before, now);
}

std::string number(double x) { return fmt::format("{}", x); }

std::string step_limit(std::int64_t steps) { return fmt::format("limits.steps = {} was reached", steps); }

std::string deadline(double seconds) { return fmt::format("limits.seconds = {} ran out", seconds); }

}  // namespace least::messages
