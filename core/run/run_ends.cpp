// How a run ends: at its time or step, at an event, or where something goes wrong.
#include <algorithm>
#include <cmath>

#include "core/run/diagnostics/error.hpp"
#include "core/run/one_run.hpp"
#include "core/run/standstill.hpp"
#include "core/run/stop_reason.hpp"

namespace least {
namespace {

Message infinite_damping(double pole) {
  return "the damping becomes infinite at " + Message::time(pole) + ": no motion leads across";
}

}  // namespace

void Run::finish() {
  if (ended_) return finish_at_event();
  if (fixed_ && grid_.tail > 0 && !within_step_limit()) return;
  if (!fixed_ && end_ < infinite && !draw(end_)) return;
  if (const double outside_at = fixed_ ? time_outside() : unknown; !std::isnan(outside_at))
    if (!leave_domain(outside_at)) return;
  const double before = state_.x.t;
  StepInfo step = last_step();
  if (const BlockResult result = integrator_->finish(state_, end_, guard_); !result) {
    step_back();
    if (!fail(result)) return;
  } else if (state_.x.t != before && diagnostics_.sees_steps()) {
    look_within(*integrator_, state_, end_, diagnostics_);
    diagnostics_.see(state_.x);
    const bool crossed = diagnostics_.clear_crossed();
    if (crossed || integrator_->parts() > 1) locate_sections();
    if (crossed && fixed_) locate_watched(integrator_->left(), state_.x);
    if (!searched()) return;
    if (!ended_) diagnostics_.resume(state_.x);
  }
  if (ended_) return finish_at_event();
  for (const std::size_t which : reached_at_end(problem_, *integrator_, state_, watch_)) {
    if (ended_) {  // zeros in the same instant as one that acts are handled after its act
      ended_->also.push_back(which);
      continue;
    }
    add_event({state_.x.t, which}, state_.x);
    if (!watch_.ends(which) || !outcome_.event.empty()) continue;  // the first that stops the run counts
    if (request_.events[which].act)
      ended_.emplace(EndAtEvent{state_.x, which, {}});
    else
      outcome_.event = watch_.name(which);
  }
  if (fixed_) step.discrete_energy = last_step().discrete_energy;  // that of the shorter step
  if (end_ < infinite && (!fixed_ || draw(end_))) save_rest(state_.x, step);
}

double Run::time_outside() const {
  if (std::isnan(problem_.inside(state_.x))) return unknown;
  SaveSchedule schedule = schedule_;
  SectionTimes times = section_times_;
  RunState x = state_.x;
  for (;;) {
    const double t = std::min(schedule.time(), times.time());
    if (!(t < end_)) return unknown;
    if (integrator_->state_at(state_, t, x) == StepStatus::ok && problem_.outside(x)) return t;
    if (schedule.time() == t) schedule.next();
    if (times.time() == t) times.next();
  }
}

bool Run::save_rest(const RunState& x, const StepInfo& step) {
  while (due() <= x.t) {
    RunState y = x;
    StepStatus status = due() < x.t ? integrator_->state_at(state_, due(), y) : StepStatus::ok;
    if (status != StepStatus::ok && due() < state_.x.t) status = between_ends_of_step(due(), y);
    if (status != StepStatus::ok) return fail(BlockResult::failed(status));
    if (!save_next(y, step)) return false;
  }
  return true;
}

void Run::finish_at_event() {
  const RunState x = ended_->x;
  const std::size_t which = ended_->which;
  if (draw(x.t)) save_rest(x, last_step());
  look_within(*integrator_, state_, x.t, diagnostics_);
  if (x.t > state_.x.t) ++state_.n;
  state_.x = x;
  diagnostics_.end(x);
  if (going() && !request_.events[which].act) outcome_.event = watch_.name(which);
}

bool Run::start_anew() {
  if (!going() || !ended_ || !request_.events[ended_->which].act) return false;
  const EndAtEvent at = *std::exchange(ended_, std::nullopt);
  Watch::Signs acted = Watch::Signs{1} << at.which;
  if (!act(at.which)) return false;
  for (const std::size_t which : at.also) {
    add_event({at.x.t, which}, request_.is_plane(which) ? at.x : state_.x);
    if (!watch_.ends(which)) continue;
    acted |= Watch::Signs{1} << which;
    if (request_.events[which].act && !act(which)) return false;
    if (!request_.events[which].act && outcome_.event.empty()) outcome_.event = watch_.name(which);
  }
  if (!outcome_.event.empty()) {
    diagnostics_.end(state_.x);
    return false;
  }
  if (fixed_) {
    grid_ = Grid(request_, nominal_step(), state_.x.t, state_.n);
    last_step_ = grid_.steps;
    if (request_.until_steps) schedule_.move_end(state_.x.t, grid_.end);
    planned_end_ = grid_.end;
  }
  end_ = planned_end_;
  put_aside_ = work();
  integrator_ = backend_.bind(request_, state_.x, grid_, std::min(end_, own_clock_end()));
  keep_last_step();
  method_ = integrator_->method();
  began_ = state_.x.t;
  watch_.begin_anew(began_, acted);
  diagnostics_.begin_anew(state_.x);
  if (!(state_.x.t < end_)) return false;
  const BlockResult result = integrator_->check_start(state_.x, guard_);
  return result || fail(result);
}

bool Run::act(std::size_t which) {
  const std::string& name = watch_.name(which);
  const Acts::Effect effect = acts_.act(which, state_.x);
  if (effect == Acts::Effect::not_finite) return stop(ReturnCode::not_finite, messages::act_not_finite(name));
  if (!outcome_.events.empty() && Watch::time(outcome_.events.back()) == state_.x.t)
    outcome_.extend_event(Watch::after(card_, shown_variables(request_, problem_.traits, state_.x)));
  acted_ = true;  // from here on evidence is that of the part since the act
  evidence_ = Evidence(problem_.traits, fixed_ ? std::optional(grid_.steps - state_.n) : std::nullopt, false);
  evidence_.start(problem_, state_.x);
  const bool over = effect == Acts::Effect::completes || request_.events[which].stop;
  if (over && outcome_.event.empty()) {
    outcome_.event = name;
    outcome_.event_count = acts_.count(which);
  }
  if (effect == Acts::Effect::piles_up)
    return stop(ReturnCode::accumulating_events, messages::accumulates(name, acts_.limit()), acts_.limit());
  if (effect == Acts::Effect::rests)
    return stop(ReturnCode::accumulating_events, messages::rests_against(name), acts_.limit());
  return true;
}

bool Run::fail(const BlockResult& result) {
  if (result.status == StepStatus::solver_failed)  // also the status of a step that was told to end
    if (const ReturnCode reason = budget_.look(); reason != ReturnCode::completed) return goes_on(reason);
  if (result.end == BlockEnd::left_domain) return leave_domain();
  if (result.end == BlockEnd::too_fast) return stop_as_unstable();
  std::string words = integrator_->failure();
  if (const double pole = pole_ahead(); std::isfinite(pole))
    return stop(ReturnCode::singular, words.empty() ? infinite_damping(pole) : Message(words), pole);
  const double when = result.end == BlockEnd::not_finite && fixed_ ? unknown : true_singularity();
  if (words.empty() && scheme_.id == "adaptive_verlet" && result.status == StepStatus::singular)
    words = messages::density_lost();
  const auto why = stop_reason(result, fixed_, method_.has_value(), words, when);
  const double singular_at = std::isfinite(why.singular_at)
                                 ? why.singular_at
                                 : singular_time(backend_, request_, result.status, state_.x.t, grid_.step,
                                                 work().forces, [this] { return keep_going(); });
  return stop(why.reason, why.detail, singular_at);
}

double Run::true_singularity() {
  if (problem_.traits.quadratic_contact) {
    if (request_.probe) return unknown;
    // For adaptive steps the mean: the last ones before an end are as short as the resolution of time.
    const bool adapts = !fixed_ && state_.n > 0;
    const double step = adapts ? (state_.x.t - scene_.start) / static_cast<double>(state_.n) : grid_.step;
    // The run may have stepped over something that the motion cannot be followed through: a damping γs with ever more
    // changes of sign. A step of a series is longer than one of a scheme.
    constexpr std::int64_t few = 1000;
    std::int64_t left = std::max(few, state_.n);
    if (step > 0)
      return scene_.mechanics->blow_up_time(scene_, state_.x.t + 10 * step, step,
                                            [&] { return left-- > 0 && keep_going(); });
  }
  return unknown;
}

bool Run::stop_at_pole() {
  if (!(state_.x.t < damping_pole_)) step_back();
  return stop(ReturnCode::singular, infinite_damping(damping_pole_), damping_pole_);
}

double Run::pole_ahead() const {
  constexpr double few_steps = 10, near = 1e-5;
  const double gone = state_.x.t - scene_.start, left = damping_pole_ - state_.x.t;
  double step = grid_.step;
  if (!fixed_ && !integrator_->failure().empty() && state_.n > 0) step = gone / static_cast<double>(state_.n);
  return left <= std::max(few_steps * step, near * (gone + left)) ? damping_pole_ : unknown;
}

bool Run::stop_as_unstable() {
  if (request_.probe) return stop(ReturnCode::unstable_step, {});
  const double ratio = guard_.largest();
  const auto known = stable_steps(request_.scheme, request_.settings, ratio / nominal_step(), guarded_damping(problem_),
                                  nominal_step());
  return stop(ReturnCode::unstable_step, messages::unstable(ratio, guard_.bound(), known.limit));
}

bool Run::leave_domain(double outside_at) {
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  const double when = exit_time(problem_, *integrator_, state_, outside_at);
  RunState x = state_.x;
  if (!watch_.empty() && integrator_->state_at(state_, std::min(when, end_), x) == StepStatus::ok)
    locate_watched(state_.x, x);
  if (!searched()) return false;
  // The run ends at the last time known to lie inside, since `when` is rounded.
  double until = std::min(when, end_);
  for (double back = epsilon * std::abs(when); until > state_.x.t; back *= 2) {
    if (until < when && integrator_->state_at(state_, until, x) == StepStatus::ok && !problem_.outside(x)) break;
    until = std::max(until - back, state_.x.t);
  }
  StepInfo partial = last_step();
  if (!fixed_) partial.step_size = until - state_.x.t;
  while (due() < until) {
    const StepStatus status = integrator_->state_at(state_, due(), x);
    if (status != StepStatus::ok) return fail(BlockResult::failed(status));
    if (problem_.outside(x)) break;
    if (!save_next(x, partial)) return false;
  }
  if (ended_) return true;
  if (const StepStatus status = integrator_->state_at(state_, until, x); status != StepStatus::ok)
    return fail(BlockResult::failed(status));
  if (!draw(until)) return false;
  if (when > end_) {
    state_ = {x, state_.n + 1};
    diagnostics_.end(x);
    return true;
  }
  if (diagnostics_.watches_sections()) events_.add(0, false, when, x[0]);
  if (x.t > state_.x.t) {
    look_within(*integrator_, state_, x.t, diagnostics_);
    state_.x = x;
    diagnostics_.end(x);
  }
  return stop(ReturnCode::left_domain, messages::left_domain(when), when);
}

Solution Run::conclude() {
  const Work work = this->work();
  outcome_.cost = {state_.n, work.forces, work.iterations, budget_.seconds()};  // the rest is not part of the cost
  save_passed();
  if (!writer_.finish(budget_.half()) || !section_writer_.finish(budget_.half())) receiver_is_gone();
  warn_of_the_run();
  for (const TrajectoryWriter* writer : {&writer_, &section_writer_})
    if (writer->lacks_truth()) warn_of_missing_reference(outcome_.warnings, unknown, writer->why_no_truth());
  outcome_.acts = acts_.reports();
  outcome_.t = state_.x.t;
  outcome_.final = shown_variables(request_, problem_.traits, state_.x);
  if (request_.diagnostics.empty()) return std::move(outcome_);
  const RunEnd end{backend_,
                   scene_,
                   request_,
                   scheme_,
                   state_.x,
                   snapshots_.states(),
                   events_,
                   {[this] { return keep_going(); }, [this] { return request_.limits.seconds - budget_.seconds(); },
                    budget_.cancelled()},
                   outcome_.warnings};
  outcome_.diagnostics = diagnostics_.reports(end);
  return std::move(outcome_);
}

void Run::warn_of_the_run() {
  if (request_.probe) return;
  if (kept_ > most_rows_) warn("samples_truncated", "more rows of columns than limits.samples; the first are kept");
  if (points_ > most_points_) warn("section_truncated", messages::section_truncated(request_.limits.samples));
  watch_.warn(outcome_.warnings);
  evidence_.finish(problem_, state_);
  const KeepGoing shortly = budget_.shortly();
  std::optional<Request> alone;
  if (acted_) alone.emplace(request_).control = false;  // a control run does not apply acts
  const Request& last = alone ? *alone : request_;
  warn_of_run({backend_, last, scheme_, state_, grid_.step, *integrator_, guard_, evidence_, acted_, shortly},
              outcome_.warnings);
  if (events_.full()) warn("events_truncated", "more events than limits.samples has room for; the first are listed");
}

}  // namespace least
