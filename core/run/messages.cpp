#include "core/run/messages.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "core/tape/tape.hpp"

namespace least::messages {

std::string unstable(double ratio, double bound, double step) {
  if (bound == 0)
    return fmt::format("the damping makes this scheme unstable; here a step below {:.3g} is stable", step);
  const double below = step * (1 - 5e-7);  // not rounded up
  return fmt::format(
      "hω = {:.6g} exceeds the stability bound {:.6g} of this scheme; here a step below {:.6g} is stable", ratio, bound,
      below);
}

std::string near_bound(double ratio, double careful, double bound) {
  const std::string errors = fmt::format("hω reached {:.4g}: from {:.3g} on expect large errors", ratio, careful);
  return bound > 0 && std::isfinite(bound) ? fmt::format("{}, beyond {:.6g} instability", errors, bound) : errors;
}

std::string column(std::string_view name) { return fmt::format("the column {} is not finite here", name); }

Message left_domain(double t) {
  return "the motion leaves its domain: what must stay positive reaches zero at " + Message::time(t);
}

Message blow_up(double t) { return "the action reaches infinity at " + Message::time(t); }

std::string stiff(double ratio) {
  return fmt::format(
      "the fastest rate of damping times the step is {:.3g}: above 0.5 expect large errors, above 1 nonsense", ratio);
}

Message damping_sign(double limit, double damping_step, double t) {
  return fmt::format("αh ≥ {:.3g} at ", limit) + Message::time(t, 6) +
         fmt::format(", it is {:.3g}: a step turns the momentum over, the motion only damps it", damping_step);
}

Message stiff_damping(double limit, double damping_step, double t) {
  return fmt::format("αh > {:.3g} at ", limit) + Message::time(t, 6) +
         fmt::format(", it is {:.3g}: a step of this scheme does not resolve the damping", damping_step);
}

std::string undamped_action(double damping_step) {
  return fmt::format(
      "αh = {:.3g}: this scheme does not damp the action s, which grows at every step, and with it the energy",
      damping_step);
}

std::string stiff_action(double rate) {
  return fmt::format("γ|s|h reached {:.3g}: a step does not resolve the damping γs; take a shorter one", rate);
}

std::string grows(double by_step, double together, bool damped) {
  return fmt::format("each step multiplies the oscillation by {:.6g}, all of them by {:.3g}: {}", by_step, together,
                     damped ? "take a shorter step" : "this scheme does so at any step");
}

std::string grows_by_energy(double before, double now) {
  return fmt::format("the energy went from {:.4g} to {:.4g}: this scheme adds to it at every step, however short",
                     before, now);
}

std::string no_tangent() {
  return fmt::format("how small differences grow was not looked at: their equations take more than {} operations",
                     tape::most_of_equations);
}

Message sensitive_end(double t) {
  return "from " + Message::time(t, 4) +
         " on control runs of Dormand–Prince 5(4) at tolerances of 1e-10 and 1e-12 part from it and from each other: "
         "no state beyond is sure";
}

Message sensitive_end(double t, double rate) {
  return fmt::format("small differences grow by a factor of 10 in {:.3g} of time: from about ", std::log(10) / rate) +
         Message::time(t, 4) + " on no digit of the state means anything, averages may";
}

Message beyond_singularity(double t) {
  return "control runs of Dormand–Prince 5(4) come to a standstill at " + Message::time(t, 7) +
         ", where this one went on: the motion is singular there, or as good as that";
}

Message judged_before_acts(std::string_view event, double t) {
  return "the scheme was chosen by runs up to " + Message::time(t, 6) +
         fmt::format(
             ", where {} acts for the first time: what it does to the motion, and errors beyond, were not "
             "looked at",
             event);
}

Message estimate_blind(double error, double t, double tolerance) {
  return "at " + Message::time(t, 4) +
         fmt::format(
             " it is off by {:.2g}, by control runs of Dormand–Prince 5(4) that agree: far more than steps "
             "within {:.2g} should come to",
             error, tolerance);
}

std::string uncertain(double uncertainty) {
  return fmt::format("the reference solution is uncertain by {:.2g} itself, which is as much as what it found",
                     uncertainty);
}

std::string uncertain_sensitivities(double uncertainty) {
  return fmt::format("by a second way sensitivities are off by {:.2g} times the largest of them", uncertainty);
}

Message departs(double error, double t, double reached) {
  return "at " + Message::time(t, 4) +
         fmt::format(" it is off by {:.2g}, by a control run of Dormand–Prince 5(4) that went as far as ", error) +
         Message::time(reached, 4);
}

std::string of_few(std::int64_t few, std::int64_t count, std::int64_t member) {
  return fmt::format("said by {} of {} members that were run alone, too; the first is member {}", count, few, member);
}

std::string fallback_steps(std::int64_t steps, bool hybrid) {
  return fmt::format("{} {} could not be taken {}", steps, steps == 1 ? "step" : "steps",
                     hybrid ? "along any coordinate and went in time instead"
                            : "at a length that keeps the discrete energy and went at the nominal one instead");
}

std::string digits_lost(double blur) {
  return fmt::format(
      "the motion goes so near to where a formula is 0/0 that rounding of its terms alone may make the run be off by "
      "{:.2g}: another form of it, as a series beside that place, keeps its digits",
      blur);
}

std::string strain(double strain) {
  return fmt::format(
      "(E₀ − V + κ)/(K + κ), 1 on the energy level, was off by {:.2g} in its square: expect large errors; take a "
      "shorter step or another κ",
      strain);
}

std::string energy_jump(double before, double now) {
  return fmt::format(
      "the energy went from {:.4g} to {:.4g}, where the motion keeps it: the result is worthless; take a shorter step "
      "or a smaller tolerance",
      before, now);
}

std::string number(double x) { return fmt::format("{}", x); }

Message unresolved(const std::vector<std::string_view>& names, double t) {
  return fmt::format(
             "{} {} faster than closer looks at the run can follow, or {} zero but for round-off, first in the "
             "step to ",
             fmt::join(names, ", "), names.size() > 1 ? "change" : "changes", names.size() > 1 ? "are" : "is") +
         Message::time(t, 6) + ": zeros may be missing";
}

std::string unresolved_members(std::string_view plane, std::int64_t count, std::int64_t first) {
  return fmt::format(
      "{} changes faster than closer looks at {} {} can follow, or is zero but for round-off; the first is member {}: "
      "points of the section may be missing",
      plane, count, count == 1 ? "member" : "members", first);
}

std::string values_left_out(std::string_view column, std::int64_t count, std::int64_t completed) {
  return fmt::format(
      "{} is not a finite number for {} of the {} members that completed: statistics and histograms are "
      "of the others",
      column, count, completed);
}

std::string section_truncated(std::int64_t samples) {
  return fmt::format("more points of the section than limits.samples = {} has room for; the first are kept", samples);
}

std::string step_limit(std::int64_t steps) { return fmt::format("limits.steps = {} was reached", steps); }

std::string deadline(double seconds) { return fmt::format("limits.seconds = {} ran out", seconds); }

std::string unsolved(bool fixed) {
  return fixed ? "Newton's method found no solution of the implicit step; a shorter step may"
               : "the equations of the step have no solution near here; a shorter step may";
}

std::string not_finite(bool fixed) {
  return fixed ? "the next state is not finite, or beyond 1e75 where energies overflow"
               : "the next state is not finite, or beyond 1e75 where energies overflow, or time stood still";
}

std::string singular_step(bool fixed) {
  return fixed ? "the step is singular here; a shorter one may not be"
               : "a step comes to rates that are infinite or not defined; where its length is a setting a shorter one "
                 "may not";
}

std::string density_lost() {
  return "the lengths of steps follow something that changes too much within one, as a local frequency does where V″ "
         "vanishes or jumps; shorter steps, or the monitor arclength, may go on";
}

std::string underflow() {
  return "a step within the tolerance is too short to advance the time: the motion is singular near here, or the time "
         "too large";
}

std::string stands_still() {
  return "steps within the tolerance no longer advance the time: the rates of the motion become infinite, or are not "
         "defined, near here";
}

std::string parameter_underflow() {
  return "the parameter's step fell below 2⁻³⁰ of its nominal length: the orbit turns ever more sharply, as in a "
         "collision or where the motion comes to rest";
}

std::string act_not_finite(std::string_view event) {
  return fmt::format("what {} sets is no finite number here", event);
}

Message accumulates(std::string_view event, double limit) {
  return fmt::format("{} follows on itself ever faster: infinitely often before ", event) + Message::time(limit, 9);
}
Message rests_against(std::string_view event) {
  return fmt::format("{} leaves the motion at rest there, and would have to act again at once", event);
}

}  // namespace least::messages
