// What a run says of its end, in words. Kept out of the templates.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/run/message.hpp"

namespace least::messages {

/// `ratio` is hω as met, `bound` the scheme's, `step` the longest stable step at this frequency.
std::string unstable(double ratio, double bound, double step);
/// `careful` is the hω from which a run warns; `bound` 0 or infinite: the scheme has none to name.
std::string near_bound(double ratio, double careful, double bound);
std::string column(std::string_view name);
Message left_domain(double t);
Message blow_up(double t);
/// `ratio` is the rate of damping times the step.
std::string stiff(double ratio);
/// `damping_step` is αh at the time t, `limit` what it may not reach.
Message damping_sign(double limit, double damping_step, double t);
Message stiff_damping(double limit, double damping_step, double t);
/// `rate` is γ|s|h.
std::string undamped_action(double damping_step);
std::string stiff_action(double rate);
/// By what a step multiplies an oscillation, and all of them.
std::string grows(double by_step, double together, bool damped);
std::string grows_by_energy(double before, double now);
/// By control runs that part from each other at the time t; or where differences grow at this rate.
Message sensitive_end(double t);
/// Of a scene whose variational equations are not derived.
std::string no_tangent();
Message sensitive_end(double t, double rate);
/// Of a reference by itself.
std::string uncertain(double uncertainty);
/// Of derivatives, as a part of the largest of them.
std::string uncertain_sensitivities(double uncertainty);
Message beyond_singularity(double t);
/// Of a scheme that was chosen: the event that acts, and when it first did.
Message judged_before_acts(std::string_view event, double t);
/// Of a run whose steps were allowed `tolerance`.
Message estimate_blind(double error, double t, double tolerance);
Message departs(double error, double t, double reached);
/// What `count` of `few` members of an ensemble say, this one first.
std::string of_few(std::int64_t few, std::int64_t count, std::int64_t member);
/// Of a hybrid, or of a scheme that solves for the length of its steps.
std::string fallback_steps(std::int64_t steps, bool hybrid);
std::string strain(double strain);
std::string digits_lost(double blur);
std::string energy_jump(double before, double now);
/// The shortest text that reads back as x.
std::string number(double x);
/// Of events, by their names, of which a search within the step that ended at t had no end.
Message unresolved(const std::vector<std::string_view>& names, double t);
/// Of so many members of an ensemble, the first of them by its index, and the plane of their section.
std::string unresolved_members(std::string_view plane, std::int64_t count, std::int64_t first);
/// Of a section with more points than so many numbers have room for.
std::string section_truncated(std::int64_t samples);
std::string step_limit(std::int64_t steps);
std::string deadline(double seconds);
/// Of a step that could not be taken, `fixed` where steps are of equal length.
std::string unsolved(bool fixed);
std::string not_finite(bool fixed);
std::string singular_step(bool fixed);
/// Of a scheme whose steps follow a density by a symmetric recursion.
std::string density_lost();
std::string underflow();
std::string stands_still();
std::string parameter_underflow();
/// Of an event that sets variables.
std::string act_not_finite(std::string_view event);
Message accumulates(std::string_view event, double limit);
Message rests_against(std::string_view event);

}  // namespace least::messages
