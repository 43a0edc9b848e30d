// Messages about a run and its end. They are kept out of the templates.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/run/message.hpp"

namespace least::messages {

/// `ratio` is hω as reached, `bound` the scheme's stability bound, `step` the longest stable step at this frequency.
std::string unstable(double ratio, double bound, double step);
/// `careful` is the hω from which a run warns; `bound` is 0 or infinite if the scheme has none to name.
std::string near_bound(double ratio, double careful, double bound);
std::string column(std::string_view name);
Message left_domain(double t);
Message blow_up(double t);
/// `ratio` is the rate of damping times the step.
std::string stiff(double ratio);
/// `damping_step` is αh at the time t, `limit` the bound that αh has to stay below.
Message damping_sign(double limit, double damping_step, double t);
Message stiff_damping(double limit, double damping_step, double t);
/// `rate` is γ|s|h.
std::string undamped_action(double damping_step);
std::string stiff_action(double rate);
/// `by_step` and `together` are the factors by which one step and all steps multiply an oscillation.
std::string grows(double by_step, double together, bool damped);
std::string grows_by_energy(double before, double now);
/// The end is sensitive: control runs part from each other at the time t; or differences grow at this rate, from t on.
Message sensitive_end(double t);
/// For a scene whose variational equations are too long to be derived.
std::string no_tangent();
Message sensitive_end(double t, double rate);
/// `uncertainty` is the error of the reference solution itself.
std::string uncertain(double uncertainty);
/// `uncertainty` is the error of derivatives relative to the largest of them.
std::string uncertain_sensitivities(double uncertainty);
Message beyond_singularity(double t);
/// For a scheme that was chosen automatically: the event that acts, and when it first did.
Message judged_before_acts(std::string_view event, double t);
/// `error` is far larger than the `tolerance` of the steps.
Message estimate_blind(double error, double t, double tolerance);
Message departs(double error, double t, double reached);
/// A warning of `count` of `few` members of an ensemble, with the index of the first of them.
std::string of_few(std::int64_t few, std::int64_t count, std::int64_t member);
/// For a hybrid, or for a scheme that solves for the length of its steps.
std::string fallback_steps(std::int64_t steps, bool hybrid);
std::string strain(double strain);
std::string digits_lost(double blur);
std::string energy_jump(double before, double now);
/// The shortest text that reads back as x.
std::string number(double x);
/// Events, by their names, for which the search within the step that ended at t did not finish.
Message unresolved(const std::vector<std::string_view>& names, double t);
/// `count` members of an ensemble, the index of the first of them, and the expression of the plane of their section.
std::string unresolved_members(std::string_view plane, std::int64_t count, std::int64_t first);
/// For a column of an ensemble that is not finite for `count` of the members that completed.
std::string values_left_out(std::string_view column, std::int64_t count, std::int64_t completed);
/// For a section with more points than so many numbers have room for.
std::string section_truncated(std::int64_t samples);
std::string step_limit(std::int64_t steps);
std::string deadline(double seconds);
/// For a step that could not be taken; `fixed` where steps are of equal length.
std::string unsolved(bool fixed);
std::string not_finite(bool fixed);
std::string singular_step(bool fixed);
/// For a scheme whose step lengths follow a density by a symmetric recursion.
std::string density_lost();
std::string underflow();
std::string stands_still();
std::string parameter_underflow();
/// For an event that sets variables.
std::string act_not_finite(std::string_view event);
Message accumulates(std::string_view event, double limit);
Message rests_against(std::string_view event);

}  // namespace least::messages
