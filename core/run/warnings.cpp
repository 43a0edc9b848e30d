#include "core/run/warnings.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/run/control.hpp"
#include "core/run/kink_start.hpp"
#include "core/run/messages.hpp"
#include "core/run/sensitivity.hpp"

namespace least {
namespace {

RunState start_of(const FinishedRun& run) {
  const Scene& scene = *run.request.scene;
  return run.backend.motion().start(scene.initial, scene.start);
}

/// warn_of_step warns of ωh from half the stability bound on, or from the problem's careful_step.
void warn_of_step(const FinishedRun& run, std::vector<Warning>& warnings) {
  const StepGuard& guard = run.guard;
  const double fastest = guard.largest(), most = guard.bound(2 * fastest);
  double careful = most > 0 ? most / 2 : std::numeric_limits<double>::infinity();
  careful = std::min(careful, run.backend.table().traits.careful_step);
  if (fastest > careful)
    warnings.push_back({"step_near_stability_bound", messages::near_bound(fastest, careful, guard.bound())});
}

/// warn_of_damping warns of rates of damping that a step does not resolve.
void warn_of_damping(const FinishedRun& run, std::vector<Warning>& warnings) {
  const ProblemTable& problem = run.backend.table();
  if (const double ratio = problem.stiffness_rate() * run.step; ratio > 0.5)
    warnings.push_back({"stiff_step", messages::stiff(ratio)});
  if (const auto found = run.integrator.strong_damping(run.state.n)) {
    const auto [t, strength, limit, flips] = *found;
    if (flips)
      warnings.push_back({"damping_sign", messages::damping_sign(limit, strength, t)});
    else
      warnings.push_back({"stiff_step", messages::stiff_damping(limit, strength, t)});
  }
  // Schemes without structure do not even damp.
  const double rate = run.evidence.damping() * run.step, most = run.scheme.structure == "none" ? 1 : 2;
  if (rate > most) warnings.push_back({"stiff_step", messages::stiff_action(rate)});
  if (problem.traits.constant_damping && problem.traits.full) {
    constexpr double still = 1e-6;  // ωh of almost no oscillation, so that the damping of s decides
    const double damping_step = problem.damping(run.state.x.t) * run.step;
    if (run.scheme.structure == "none" && damping_step > 1 &&
        !is_stable(run.request.scheme, run.request.settings, still, damping_step))
      warnings.push_back({"stiff_step", messages::undamped_action(damping_step)});
  }
}

/// warn_of_growth warns of schemes that add to the energy at every step.
void warn_of_growth(const FinishedRun& run, std::vector<Warning>& warnings) {
  constexpr double small = 0.05;
  const double by_step = run.guard.growth(), together = std::pow(by_step, static_cast<double>(run.state.n));
  const auto [off, before, now] = run.evidence.energy();
  if (together > 1 + small)
    warnings.push_back({"grows_at_every_step", messages::grows(by_step, together, run.guard.damped())});
  else if (run.guard.grows_undamped() && off > small)
    warnings.push_back({"grows_at_every_step", messages::grows_by_energy(before, now)});
}

/// warn_of_energy warns of energy that left its level.
void warn_of_energy(const FinishedRun& run, std::vector<Warning>& warnings) {
  constexpr double large = 0.3;
  const auto [off, before, now] = run.evidence.energy();
  std::string why = run.integrator.accuracy_warning();
  if (off > large) why = messages::energy_jump(before, now);
  if (!why.empty()) warnings.push_back({"off_energy_level", why});
}

/// warn_of_kink warns of a run that begins at rest on a kink to which forces on both sides lead back, unless it stays
/// there, as some schemes do under dry friction. Returns whether the run begins so.
bool warn_of_kink(const FinishedRun& run, std::vector<Warning>& warnings) {
  const RunState start = start_of(run);
  if (!begins_on_kink(*run.request.scene, run.backend.motion(), start, run.state.x.t - start.t)) return false;
  const std::size_t moving = run.backend.motion().traits.moving;
  const auto moved = [&](const RunState& x) {
    return !std::equal(start.numbers.begin(), start.numbers.begin() + static_cast<std::ptrdiff_t>(moving),
                       x.numbers.begin());
  };
  if (std::ranges::any_of(run.evidence.states(), moved))
    warnings.push_back({"starts_on_kink", std::string(starts_on_kink)});
  return true;
}

/// warn_of_blur warns of formulas that lose their digits where the motion goes.
void warn_of_blur(const FinishedRun& run, std::vector<Warning>& warnings) {
  constexpr double far = 100, least = 1e-10;
  const double blur = run.integrator.blur();
  if (blur > std::max(far * run.request.setting("tolerance", run.scheme), least))
    warnings.push_back({"digits_lost", messages::digits_lost(blur)});
}

/// departure_of returns how far control runs are from this run; `large` is the error from which on closer controls have
/// to agree.
constexpr double large_error = 0.1;
Departure departure_of(const FinishedRun& run, double large = large_error) {
  constexpr std::int64_t few = 5000, many = 40'000;  // force evaluations: a millisecond
  constexpr double usual = 1e-8, closest = 1e-14;
  const Scene& scene = *run.request.scene;
  const std::int64_t allowed =
      std::clamp<std::int64_t>(4 * run.integrator.work().forces, few, many) / weight_of_force(*scene.mechanics);
  const double tolerance = run.scheme.id == "dormand_prince_5"  // the control's own
                               ? std::clamp(0.1 * run.request.setting("tolerance", run.scheme), closest, usual)
                               : usual;
  return departure(run.backend, start_of(run), run.evidence.states(), run.request.norm, kinds_of(scene.card()), large,
                   tolerance, allowed, run.keep_going);
}

/// warn_of_blind_estimates warns of an error that is not large, but far larger than the tolerance of the steps, whose
/// error estimates missed it: the control run shows it, and closer controls agree with each other. The control's own
/// error does not matter.
void warn_of_blind_estimates(const FinishedRun& run, const Departure& control, std::vector<Warning>& warnings) {
  constexpr double far = 1e4, least = 1e-8;
  const double tolerance = run.request.setting("tolerance", run.scheme), beyond = far * std::max(tolerance, least);
  if (!run.scheme.own_clock || !(beyond < large_error) || !(control.error > beyond)) return;
  const Departure sure = departure_of(run, beyond);
  if (sure.error > beyond && !sure.parted_at)
    warnings.push_back({"estimate_blind", messages::estimate_blind(sure.error, sure.t, tolerance)});
}

/// sensitivity_of looks for sensitivity to the start, for a run whose end the control run did not confirm.
std::optional<Sensitivity> sensitivity_of(const FinishedRun& run) {
  constexpr std::int64_t few = 20'000, many = 40'000;  // operations of an order of a series, some milliseconds
  const std::int64_t allowed = std::clamp<std::int64_t>(4 * run.integrator.work().forces, few, many);
  const Scene& scene = *run.request.scene;
  const RunState start = start_of(run);
  const auto states = run.evidence.states();
  const auto sizes = divisors_along(run.backend, start, {states.begin(), states.end()}, run.request.norm,
                                    kinds_of(scene.card()), run.keep_going);
  constexpr double share = 0.1;  // of the tolerance, by which steps are off in fact
  const double noise = run.scheme.find("tolerance") ? share * run.request.setting("tolerance", run.scheme) : 0;
  return sensitivity(run.backend, start, states, run.request.norm, sizes, large_error, noise, allowed, run.keep_going);
}

/// warn_of_rest warns of a scene given as text that starts at 0 in all variables and rests there: most likely the start
/// was forgotten. A run that moves, by an event or by itself, may well return to 0.
void warn_of_rest(const FinishedRun& run, std::vector<Warning>& warnings) {
  const Scene& scene = *run.request.scene;
  const auto at_zero = [](const auto& numbers) {
    return std::ranges::all_of(numbers, [](double x) { return x == 0; });
  };
  if (!scene.mechanics->text() || run.state.n == 0 || run.acted) return;
  if (!at_zero(scene.initial) || !at_zero(run.state.x.numbers)) return;
  const ProblemTable& problem = run.backend.motion();
  const RunState start = start_of(run);
  StateNumbers rates(std::max(start.size(), problem.traits.components));
  problem.rates(start, rates.data());
  const auto still = [&](const RunState& x) { return at_zero(x.numbers); };
  if (at_zero(rates) && std::ranges::all_of(run.evidence.states(), still))
    warnings.push_back({"starts_at_rest_in_equilibrium", std::string(nothing_moves)});
}

}  // namespace

void warn_of_run(const FinishedRun& run, std::vector<Warning>& warnings) {
  constexpr double right = 0.01;
  Departure control;
  if (run.request.control) control = departure_of(run);
  const auto states = run.evidence.states();
  const bool came_to_end = !states.empty() && control.reached == states.back().t;
  std::optional<Sensitivity> sensitive;
  if (run.request.control && !(came_to_end && control.error <= large_error && !control.parted_at)) try {
      sensitive = sensitivity_of(run);
    } catch (const tape::TooManyOperations&) {
      warnings.push_back({"sensitivity_unknown", messages::no_tangent()});
    }
  if (!(came_to_end && control.error <= right)) {
    if (run.backend.table().traits.has_frequency) warn_of_step(run, warnings);
    warn_of_damping(run, warnings);
    warn_of_growth(run, warnings);
  }
  if (const auto steps = run.integrator.fallback_steps(); steps > 0)
    warnings.push_back({"steps_in_time", messages::fallback_steps(steps, run.integrator.method().has_value())});
  if (!warn_of_kink(run, warnings)) warn_of_energy(run, warnings);
  warn_of_blur(run, warnings);
  warn_of_rest(run, warnings);
  if (!(control.error <= large_error))
    warnings.push_back({"large_error", messages::departs(control.error, control.t, control.reached)});
  if (control.error <= large_error && control.stands_at)
    warnings.push_back({"beyond_singularity", messages::beyond_singularity(*control.stands_at)});
  else if (sensitive)
    warnings.push_back({"sensitive_end", messages::sensitive_end(sensitive->until, sensitive->rate)});
  else if (control.error <= large_error && control.parted_at)
    warnings.push_back({"sensitive_end", messages::sensitive_end(*control.parted_at)});
  else
    warn_of_blind_estimates(run, control, warnings);
}

}  // namespace least
